"""The files that 3D Slicer finds: a launcher and an XML description for each module."""

import os
import shlex
import sys
from pathlib import Path

import physgnn
from physgnn.io.integrity.atomic import whole_file, write_whole
from physgnn.stages.outputs import FOLDER, writes
from physgnn.stages.slicer_modules.description import xml_of
from physgnn.stages.slicer_modules.module_table import modules

LAUNCHED = "physgnn.cli.slicer_launcher"
OF_SLICER = ("PYTHONHOME", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH")
"""What Slicer sets for its own Python, which another cannot run with."""
EXECUTABLE = 0o755


@writes(out=FOLDER)
def slicer(out: str | Path) -> list[Path]:
    """Write the modules for 3D Slicer: segment, mesh, register, warp, predict.

    Add the folder to Slicer's module paths (*Edit*, *Application Settings*, *Modules*)
    and restart it. The launchers start this Python with this package: write them anew
    if either moves.

    Parameters
    ----------
    out : path
        Folder; it is made. Launchers of an earlier call are replaced.

    Returns
    -------
    list of paths
        The launchers, executable.

    Raises
    ------
    InputError
        If the folder cannot be written to.
    """
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for module in modules():
        write_whole(folder / f"{module.name}.xml", xml_of(module))
        made.append(_write_launcher(folder, module.name))
    return made


def _write_launcher(folder: Path, name: str) -> Path:
    is_windows = os.name == "nt"
    path = folder / (f"{name}.bat" if is_windows else name)
    text = _batch_file(name) if is_windows else _shell_script(name)
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")
        part.chmod(EXECUTABLE)
    return path


def _shell_script(name: str) -> str:
    """Return a script that starts a module with this Python, in this environment."""
    environment = ["PYTHONPATH=" + str(Path(physgnn.__file__).parents[1])]
    environment += [f"{k}={os.environ[k]}" for k in OF_SLICER if os.environ.get(k)]
    unset = [f"-u {k}" for k in OF_SLICER if not os.environ.get(k)]
    words = [*environment, sys.executable, "-m", LAUNCHED, name]
    command = " ".join(["env", *unset, *map(shlex.quote, words)])
    return f'#!/bin/sh\n# Written by physgnn slicer.\nexec {command} "$@"\n'


def _batch_file(name: str) -> str:
    lines = [
        "@echo off",
        "set PYTHONHOME=",
        f'"{sys.executable}" -m {LAUNCHED} {name} %*',
    ]
    lines.insert(2, f"set PYTHONPATH={Path(physgnn.__file__).parents[1]}")
    return "\r\n".join([*lines, ""])
