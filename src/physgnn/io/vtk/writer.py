"""VTK's XML writers, in memory: on a full disk they corrupt their own.

VTK 9 reports no error, leaves a file of no bytes, or crashes when a write fails. What
reaches the disk here is written by Python.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.io.integrity.atomic import whole_file

if TYPE_CHECKING:
    import pyvista as pv

WRITERS: Mapping[str, str] = {
    ".vtp": "vtkXMLPolyDataWriter",
    ".vtu": "vtkXMLUnstructuredGridWriter",
}


def write_vtk(path: Path, data: "pv.DataSet") -> None:
    """Write a data set in the XML format of the name's suffix, whole or not at all.

    Raises
    ------
    InputError
        If the file cannot be written whole.
    """
    from vtkmodules import vtkIOXML

    writer = getattr(vtkIOXML, WRITERS[path.suffix.lower()])()
    writer.SetInputData(data)
    writer.SetDataModeToBinary()  # in base64: the file is text
    writer.SetWriteToOutputString(True)
    if not writer.Write():
        raise InputError(f"cannot write {path}: VTK refuses the data")
    with whole_file(path) as part:
        part.write_text(writer.GetOutputString(), "utf-8")
