"""Reads a linear ITK transform in a process of its own: `linear_transforms` starts it.

HDF5 crashes on damaged files; what happens here ends this process alone. Prints a JSON
object: the places of the origin and of the three unit vectors, or why there are none.
"""

import json
import sys

import numpy as np
import SimpleITK as sitk

from physgnn.errors import InputError
from physgnn.io.medical.transform_parts import COMPOSITE, EMPTY, check_sizes

DAMAGED = "ITK finds no linear transform in it: export it again, as .tfm or .h5"


def main() -> None:
    """Read the file that the command line names."""
    said: dict[str, object]
    try:
        transform = sitk.ReadTransform(sys.argv[1])
        _check(transform)
        corners = [np.zeros(3), *np.eye(3)]
        said = {"places": [transform.TransformPoint(c.tolist()) for c in corners]}
    except InputError as error:
        said = {"error": str(error)}
    except RuntimeError:  # several lines, with addresses of ITK's own objects
        said = {"error": DAMAGED}
    print(json.dumps(said))


def _check(transform: sitk.Transform) -> None:
    """Raise InputError if a transform is not linear, or is not all there."""
    if transform.GetDimension() != 3 or not transform.IsLinear():
        raise InputError("it must be linear in three dimensions")
    if transform.GetName() == COMPOSITE:
        parts = sitk.CompositeTransform(transform)
        if not parts.GetNumberOfTransforms():
            raise InputError(EMPTY)
        for i in range(parts.GetNumberOfTransforms()):
            _check(parts.GetNthTransform(i))
        return
    sizes = len(transform.GetParameters()), len(transform.GetFixedParameters())
    check_sizes(transform.GetName(), *sizes)


if __name__ == "__main__":
    main()
