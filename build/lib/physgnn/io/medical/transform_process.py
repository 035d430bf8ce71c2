"""Reads a linear ITK transform in a process of its own: `linear_transforms` starts it.

HDF5 crashes on damaged files; what happens here ends this process alone. Prints a JSON
object: the places of the origin and of the three unit vectors, or why there are none.
"""

import json
import sys

import numpy as np
import SimpleITK as sitk


def main() -> None:
    """Read the file that the command line names."""
    try:
        transform = sitk.ReadTransform(sys.argv[1])
        if transform.GetDimension() != 3 or not transform.IsLinear():
            said: dict[str, object] = {"error": "it is not linear in three dimensions"}
        else:
            corners = [np.zeros(3), *np.eye(3)]
            said = {"places": [transform.TransformPoint(c.tolist()) for c in corners]}
    except RuntimeError as error:
        lines = str(error).strip().splitlines()
        said = {"error": lines[-1].strip() if lines else "ITK cannot read it"}
    print(json.dumps(said))


if __name__ == "__main__":
    main()
