"""Strangers' files read by foreign libraries in another process.

Such readers crash, hang and overwrite memory on damaged files. What happens there ends
that process alone, and is an InputError here. The process stays for the next file,
since importing the library takes most of the time.
"""

import atexit
import json
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.io.untrusted import reader_process
from physgnn.io.untrusted.compressed import read_npz
from physgnn.io.untrusted.limits import allowed_bytes
from physgnn.memory_limits import GB
from physgnn.scratch import scratch_folder

TIMEOUT_S = 60.0
# What the libraries and NumPy map themselves, and copies of the data on the way.
OWN_BYTES, COPIES = 4 * GB, 3

Arrays = dict[str, np.ndarray[Any, Any]]


class IsolatedReader:
    """A process that reads files, started when it is first needed.

    Parameters
    ----------
    reader : path
        The file of Python that reads; see `physgnn.io.untrusted.reader_process`.
    library : str
        What messages call it, such as "VTK".
    timeout_s : float
        How long one request may take.
    """

    def __init__(
        self, reader: str | Path, library: str, timeout_s: float = TIMEOUT_S
    ) -> None:
        self._reader = str(reader)
        self._library = library
        self.timeout_s = timeout_s
        self._process: subprocess.Popen[str] | None = None
        self._lock = threading.Lock()
        atexit.register(self.close)

    def read(self, path: Path, **request: Any) -> Arrays:
        """Return the arrays that the reader makes of a file.

        Parameters
        ----------
        path : path
            The file or folder, for the request and for bounds.
        **request
            What else the reader is told; goes through JSON.

        Raises
        ------
        InputError
            With the library's complaint, or if it crashed or took too long.
        """
        request["path"] = str(path.resolve())
        with self._lock, scratch_folder("read") as folder:
            out = Path(folder) / "arrays.npz"
            error = self._ask({**request, "out": str(out)}, allowed_bytes(path))
            if error:
                raise InputError(f"cannot be read by {self._library} ({error})")
            return read_npz(out)

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _ask(self, request: dict[str, Any], limit: int) -> str:
        if self._process is not None and self._process.poll() is not None:
            self.close()
        if self._process is None:
            self._process = self._started(int(OWN_BYTES + COPIES * limit))
        process, late = self._process, threading.Event()
        assert process.stdin is not None and process.stdout is not None

        def stop() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(self.timeout_s, stop)
        timer.start()
        try:
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
            return f"{self._library}'s reader took more than {self.timeout_s:g} s"
        return f"{self._library}'s reader crashed on it"

    def _started(self, limit_bytes: int) -> "subprocess.Popen[str]":
        script = reader_process.__file__
        return subprocess.Popen(
            [sys.executable, "-P", script, str(limit_bytes), self._reader],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
        )
