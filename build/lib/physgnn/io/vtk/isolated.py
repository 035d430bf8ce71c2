"""Files that only VTK reads, read by VTK in another process."""

import json
from pathlib import Path

import numpy as np

from physgnn.io.untrusted.isolated import TIMEOUT_S, IsolatedReader
from physgnn.io.vtk import vtk_process
from physgnn.io.vtk.data import Array, VtkData


class VtkProcess:
    """A process that reads VTK files, started when it is first needed.

    Parameters
    ----------
    timeout_s : float
        How long one file may take.
    """

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        self._reader = IsolatedReader(vtk_process.__file__, "VTK", timeout_s)

    def read(self, path: Path) -> VtkData:
        """Read a file by VTK's reader of its suffix.

        Raises
        ------
        InputError
            With VTK's complaint, or if the reader crashed or took too long.
        """
        return _data(self._reader.read(path))

    def close(self) -> None:
        """End the process."""
        self._reader.close()


_shared: VtkProcess | None = None


def read_isolated(path: Path) -> VtkData:
    """Read a file by VTK in another process; see `VtkProcess.read`."""
    global _shared
    if _shared is None:
        _shared = VtkProcess()
    return _shared.read(path)


def _data(arrays: dict[str, Array]) -> VtkData:
    corners, ends = [np.empty(0, np.int64)], [np.zeros(1, np.int64)]
    for i in range(sum(name.startswith("offsets_") for name in arrays)):
        offsets = arrays[f"offsets_{i}"]
        if len(offsets) == 0 or offsets[0] != 0:
            offsets = np.concatenate([[0], offsets])
        ends.append(offsets[1:] + sum(map(len, corners)))
        corners.append(arrays[f"connectivity_{i}"])
    parts: dict[str, dict[str, Array]] = {}
    for i, (part, name) in enumerate(json.loads(arrays["names"].tobytes())):
        parts.setdefault(part, {})[name] = arrays[f"array_{i}"]
    is_grid = "offsets_1" not in arrays
    return VtkData(
        points=arrays["points"],
        connectivity=np.concatenate(corners),
        offsets=np.concatenate(ends),
        cell_types=arrays["types"],
        point_data=parts.get("PointData", {}),
        cell_data=parts.get("CellData", {}) if is_grid else {},
        field_data=parts.get("FieldData", {}),
    )
