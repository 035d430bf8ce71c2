"""VTK's readers, made to raise instead of writing to standard error."""

from pathlib import Path

import pyvista as pv

from physgnn.errors import InputError


def read_vtk(path: Path) -> pv.DataSet:
    """Read a file that VTK can read.

    Raises
    ------
    InputError
        With VTK's first complaint, if it has one.
    """
    catcher = pv.VtkErrorCatcher(send_to_logging=False)
    try:
        with catcher:
            data = pv.read(path)
    except (OSError, ValueError, RuntimeError) as error:
        raise _unreadable(path, str(error)) from error
    if catcher.error_events:
        raise _unreadable(path, catcher.error_events[0].alert)
    return data


def _unreadable(path: Path, reason: str) -> InputError:
    kind = path.suffix[1:].upper()
    line = " ".join(reason.split())
    return InputError(f"{path}: cannot be read as {kind} ({line}): export it again")
