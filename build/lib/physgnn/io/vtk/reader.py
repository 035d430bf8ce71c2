"""VTK files as arrays: by our own reader where it can, else by VTK, kept apart."""

from pathlib import Path

from physgnn.io.untrusted.input_errors import reading
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.isolated import read_isolated
from physgnn.io.vtk.xml_arrays import OtherFeatureError
from physgnn.io.vtk.xml_reader import KINDS, read_vtk_xml


def read_vtk(path: Path) -> VtkData:
    """Read a .vtu, .vtp or legacy .vtk file.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    suffix = path.suffix.lower()
    with reading(path, f"a {suffix[1:].upper()} file"):
        if suffix in KINDS:
            try:
                return read_vtk_xml(path)
            except OtherFeatureError:
                pass
        return read_isolated(path)
