"""VTK's readers, which may crash without harm to anybody else.

`physgnn.io.untrusted.reader_process` runs this file, which imports NumPy and VTK alone:
see `physgnn.io.vtk.isolated` for the other side.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

POLYGON, STRIP = 7, 6


def serve(request: dict[str, Any]) -> dict[str, Any]:
    """Return the arrays of a file; ValueError with what VTK complains of."""
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
    from vtkmodules.vtkIOLegacy import vtkDataSetReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

    readers: dict[str, Any] = {
        ".vtk": vtkDataSetReader,
        ".vtp": vtkXMLPolyDataReader,
        ".vtu": vtkXMLUnstructuredGridReader,
    }
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    reader = readers[Path(request["path"]).suffix.lower()]()
    reader.SetFileName(request["path"])
    reader.Update()
    complaint = " ".join(window.GetOutput().split())
    if complaint:
        raise ValueError(complaint.split(" (0x")[0])
    data = reader.GetOutput()
    kind = "nothing" if data is None else data.GetClassName()
    if kind not in ("vtkPolyData", "vtkUnstructuredGrid"):
        raise ValueError(f"it holds {kind}, neither polygons nor a grid of cells")
    return _arrays(data)


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
