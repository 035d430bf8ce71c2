"""VTK's readers in a process of their own, which may crash without harm.

This file runs as a script, which imports NumPy and VTK alone: see
`physgnn.io.vtk.isolated` for its other side. Each line of standard input is a request
in JSON, ``{"path": …, "out": …}``; the arrays go to the .npz file ``out``, and one line
of JSON answers.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

POLYGON, STRIP = 7, 6


def main(limit_bytes: int) -> None:
    """Serve requests until standard input ends."""
    replies = os.fdopen(os.dup(1), "w")
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)  # VTK writes to both
    os.dup2(silence, 2)
    _bound_memory(limit_bytes)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            error = _serve(Path(request["path"]), Path(request["out"]))
        except Exception as caught:
            error = f"{type(caught).__name__}: {caught}"
        replies.write(json.dumps({"error": error}) + "\n")
        replies.flush()


def _bound_memory(limit_bytes: int) -> None:
    """Make allocations beyond a bound fail, where the system can."""
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, limit_bytes))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _serve(path: Path, out: Path) -> str:
    """Read a file and write its arrays; return what VTK complains of, or nothing."""
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
    from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

    readers: dict[str, Any] = {
        ".vtk": vtkUnstructuredGridReader,
        ".vtp": vtkXMLPolyDataReader,
        ".vtu": vtkXMLUnstructuredGridReader,
    }
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    reader = readers[path.suffix.lower()]()
    reader.SetFileName(str(path))
    reader.Update()
    complaint = " ".join(window.GetOutput().split())
    if complaint:
        return complaint.split(" (0x")[0][:200]
    np.savez(out, **_arrays(reader.GetOutput()))
    return ""


def _arrays(data: Any) -> dict[str, Any]:
    """Return everything of a data set as arrays, names as JSON in one of them."""
    from vtkmodules.util import numpy_support

    vtk_to_numpy: Any = numpy_support.vtk_to_numpy
    found: dict[str, Any] = {"points": np.empty((0, 3))}
    if data.GetPoints() is not None:
        found["points"] = vtk_to_numpy(data.GetPoints().GetData())
    lists = (
        [(data.GetCells(), None)]
        if hasattr(data, "GetCells")
        else [(data.GetPolys(), POLYGON), (data.GetStrips(), STRIP)]
    )
    for i, (cells, _) in enumerate(lists):
        found[f"connectivity_{i}"] = vtk_to_numpy(cells.GetConnectivityArray())
        found[f"offsets_{i}"] = vtk_to_numpy(cells.GetOffsetsArray())
    types = [
        vtk_to_numpy(data.GetCellTypesArray())
        if kind is None and data.GetNumberOfCells()
        else np.full(cells.GetNumberOfCells(), kind or 0)
        for cells, kind in lists
    ]
    found["types"] = np.concatenate(types)
    names: list[tuple[str, str]] = []
    for part in ("PointData", "CellData", "FieldData"):
        group = getattr(data, f"Get{part}")()
        for i in range(group.GetNumberOfArrays()):
            array = group.GetAbstractArray(i)
            found[f"array_{len(names)}"] = (
                np.array([array.GetValue(k) for k in range(array.GetNumberOfValues())])
                if array.GetClassName() == "vtkStringArray"
                else vtk_to_numpy(array)
            )
            names.append((part, array.GetName() or ""))
    found["names"] = np.frombuffer(json.dumps(names).encode(), np.uint8)
    return found


if __name__ == "__main__":
    main(int(sys.argv[1]))
