"""Programs that begin with the libraries imported, each in a process of its own.

    python warm_python.py MODULE …

imports the modules and then forks a process for every program that it is sent. So the
seconds of the processor that it takes to import Lightning are paid once.
"""

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
OUT, ERR, STATUS = "out", "err", "status"


@dataclass(frozen=True)
class Running:
    """A program on its way, which writes what it says into a folder."""

    place: Path
    server: "subprocess.Popen[str]"

    def wait(self, timeout_s: float = 900.0) -> "subprocess.CompletedProcess[str]":
        """Wait until it has ended; the status is negative if a signal ended it."""
        status, end = self.place / STATUS, time.monotonic() + timeout_s
        while not status.exists():
            assert self.server.poll() is None, "the process that forks has ended"
            assert time.monotonic() < end, self.said(ERR)
            time.sleep(0.01)
        code = int(status.read_text())
        return subprocess.CompletedProcess([], code, self.said(OUT), self.said(ERR))

    def said(self, name: str) -> str:
        return (self.place / name).read_text("utf-8")


class WarmPython:
    """A process that has imported modules and forks others; a context manager."""

    def __init__(self, *modules: str) -> None:
        self.folder = TemporaryDirectory(prefix="physgnn-warm-")
        self.server = subprocess.Popen(
            [sys.executable, __file__, *modules],
            env={**os.environ, **ONE_THREAD, "PYTHONPATH": os.pathsep.join(sys.path)},
            stdin=subprocess.PIPE,
            text=True,
        )
        self.started = 0

    def __enter__(self) -> "WarmPython":
        return self

    def __exit__(self, *_: object) -> None:
        assert self.server.stdin is not None
        self.server.stdin.close()
        self.server.wait()
        self.folder.cleanup()

    def start(
        self, program: str, *arguments: object, folder: Path, **environment: str
    ) -> Running:
        """Start a program in a folder."""
        place = Path(self.folder.name) / str(self.started)
        place.mkdir()
        self.started += 1
        request = {
            "program": program,
            "arguments": [*map(str, arguments)],
            "folder": str(folder),
            "environment": environment,
            "place": str(place),
        }
        assert self.server.stdin is not None
        self.server.stdin.write(json.dumps(request) + "\n")
        self.server.stdin.flush()
        return Running(place, self.server)

    def run(
        self, program: str, *arguments: object, folder: Path, **environment: str
    ) -> "subprocess.CompletedProcess[str]":
        """Start a program and wait until it has ended."""
        return self.start(program, *arguments, folder=folder, **environment).wait()


def serve() -> dict[str, Any] | None:
    """Fork for every line of standard input; return what a forked process is to do."""
    for line in sys.stdin:
        request: dict[str, Any] = json.loads(line)
        if os.fork():
            continue
        program = os.fork()  # and the one in between waits for it
        if program == 0:
            return request
        _, status = os.waitpid(program, 0)
        part = Path(request["place"], "part")
        part.write_text(str(os.waitstatus_to_exitcode(status)))
        part.replace(part.with_name(STATUS))
        os._exit(0)
    return None


def become(request: dict[str, Any]) -> None:
    """Run a program as if this process had been started for it."""
    for number, name in ((1, OUT), (2, ERR)):
        file = os.open(Path(request["place"], name), os.O_WRONLY | os.O_CREAT)
        os.dup2(file, number)
        os.close(file)
    os.chdir(request["folder"])
    os.environ.update(request["environment"])
    sys.argv = ["program", *request["arguments"]]
    names = {"__name__": "__main__"}
    exec(compile(request["program"], "program", "exec"), names)


def main(*modules: str) -> None:
    """Import modules, then serve."""
    for module in modules:
        import_module(module)
    request = serve()
    if request is not None:
        become(request)


if __name__ == "__main__":
    main(*sys.argv[1:])
