"""VTK's readers, made to raise instead of writing to standard error."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pyvista as pv
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

from physgnn.errors import InputError

READERS: Mapping[str, Any] = {
    ".vtk": vtkUnstructuredGridReader,
    ".vtp": vtkXMLPolyDataReader,
    ".vtu": vtkXMLUnstructuredGridReader,
}


def read_vtk(path: Path) -> pv.DataSet:
    """Read a file by the VTK reader of its suffix.

    PyVista's own reader logs what VTK complains of; here it is the error's message.

    Raises
    ------
    InputError
        With VTK's complaint, if it has one.
    """
    reader = READERS[path.suffix.lower()]()
    reader.SetFileName(str(path))
    catcher = pv.VtkErrorCatcher(send_to_logging=False)
    with pv.vtk_verbosity("off"), catcher:
        reader.Update()
    if catcher.error_events:
        reason = " ".join(catcher.error_events[0].alert.split()).split(" (0x")[0]
        raise InputError(
            f"{path}: cannot be read as {path.suffix[1:].upper()} ({reason}): export "
            "it again"
        )
    data: pv.DataSet = pv.wrap(reader.GetOutput())
    return data
