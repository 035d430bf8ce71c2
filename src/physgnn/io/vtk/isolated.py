"""Files that only VTK reads, read by VTK in another process.

VTK's readers crash, hang and overwrite memory on damaged files. What happens there
ends that process alone, and is an InputError here. The process stays for the next
file, since importing VTK takes most of the time.
"""

import atexit
import json
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.io.untrusted.compressed import read_npz
from physgnn.io.untrusted.limits import allowed_bytes
from physgnn.io.vtk import vtk_process
from physgnn.io.vtk.data import Array, VtkData
from physgnn.memory_limits import GB

TIMEOUT_S = 60.0
# What VTK's libraries and NumPy map themselves, and copies of the data on the way.
OWN_BYTES, COPIES = 4 * GB, 3


class VtkProcess:
    """A process that reads VTK files, started when it is first needed.

    Parameters
    ----------
    timeout_s : float
        How long one file may take.
    """

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        self._timeout_s = timeout_s
        self._process: subprocess.Popen[str] | None = None
        self._lock = threading.Lock()

    def read(self, path: Path) -> VtkData:
        """Read a file by VTK's reader of its suffix.

        Raises
        ------
        InputError
            With VTK's complaint, or if the reader crashed or took too long.
        """
        with self._lock, tempfile.TemporaryDirectory(prefix="physgnn-vtk-") as folder:
            out = Path(folder) / "arrays.npz"
            error = self._ask(path, out)
            if error:
                raise InputError(
                    f"cannot be read as {path.suffix[1:].upper()} ({error})"
                )
            return _data(read_npz(out))

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _ask(self, path: Path, out: Path) -> str:
        if self._process is not None and self._process.poll() is not None:
            self.close()
        if self._process is None:
            limit = OWN_BYTES + COPIES * allowed_bytes(path)
            self._process = subprocess.Popen(
                [sys.executable, "-P", vtk_process.__file__, str(int(limit))],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                encoding="utf-8",
            )
        process, late = self._process, threading.Event()
        assert process.stdin is not None and process.stdout is not None

        def stop() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(self._timeout_s, stop)
        timer.start()
        try:
            request = {"path": str(path.resolve()), "out": str(out)}
            process.stdin.write(json.dumps(request) + "\n")
            process.stdin.flush()
            reply = process.stdout.readline()
        except OSError:
            reply = ""
        finally:
            timer.cancel()
        if reply:
            return str(json.loads(reply)["error"])
        self.close()
        if late.is_set():
            return f"VTK's reader took more than {self._timeout_s:g} s"
        return "VTK's reader crashed on it"


_shared: VtkProcess | None = None


def read_isolated(path: Path) -> VtkData:
    """Read a file by VTK in another process; see `VtkProcess.read`."""
    global _shared
    if _shared is None:
        _shared = VtkProcess()
        atexit.register(_shared.close)
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
