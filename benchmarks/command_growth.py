"""Seconds and memory of the commands as meshes grow: one body, finer and finer.

    OMP_NUM_THREADS=2 python benchmarks/command_growth.py -o growth

The bundled brain is meshed with about as many points, its surface refined alike. On
every mesh a load path of ten levels is solved, a network is trained on seven of them
for an epoch, the bundled family is adapted, a load predicted and pairs of points are
registered, each by its command, from start to file. Memory is the most that the command
held, all its processes together where it has several. What the folder has is not run
again. Prints a Markdown table.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import psutil
import pyvista as pv

from physgnn.geometry import mni152_phantom
from physgnn.io import read_mesh
from tables import machine, table

SURFACE_POINTS = 700 / 10_000 ** (2 / 3)  # of a mesh of n points: this times n^(2/3)
MEASURED = Path(__file__).parents[1] / "examples" / "measured.csv"
COMMANDS = ("mesh", "simulate", "train", "adapt", "predict", "register")
NOT_USABLE = 3  # exit code of a command whose answer is written and not ok


def words(name: str, folder: Path) -> list[str]:
    """Return a command's arguments on the files of a size."""
    case, loads = str(folder / "case.vtu"), str(folder / "loads.toml")
    data, trained, adapted = (str(folder / n) for n in ("loads.zarr", "run", "adapted"))
    surfaces = [
        *("--brain", str(folder / "brain.stl")),
        *("--tumour", str(folder / "tumour.stl")),
    ]
    load, displacement = str(folder / "load.json"), str(folder / "displacement.vtu")
    held, shift = str(folder / "held.vtu"), str(folder / "shift.vtu")
    return {
        "mesh": [*surfaces, "--target-points", folder.name, "-o", case],
        "simulate": [case, "--loads", loads, "--workers", "1", "-o", data],
        "train": [data, "--split", "published", "--max-epochs", "1", "-o", trained],
        "adapt": ["bundled-family", case, "--loads", loads, "-o", adapted],
        "predict": [adapted, "--load", load, "-o", displacement],
        "register": [held, "--points", str(MEASURED), "-o", shift],
    }[name]


def prepare(name: str, folder: Path) -> None:
    """Write what a command reads and no other command makes."""
    if name == "mesh":
        count = int(np.clip(SURFACE_POINTS * int(folder.name) ** (2 / 3), 300, 5000))
        phantom = mni152_phantom(n_points=count)
        for what, one in (("brain", phantom.brain), ("tumour", phantom.tumours[0])):
            surface = pv.PolyData.from_regular_faces(one.points, one.faces.astype(int))
            surface.save(folder / f"{what}.stl")
    elif name == "simulate":
        run(["init", str(folder / "case.vtu"), "-o", str(folder / "loads.toml")])
        text = (folder / "loads.toml").read_text("utf-8")
        fewer = re.sub(r"(?m)^paths = \d+$", "paths = 1", text)
        (folder / "loads.toml").write_text(fewer, "utf-8")
    elif name == "register":
        sets = ["--sets", str(folder / "loads.toml")]
        run(["mesh", str(folder / "case.vtu"), *sets, "-o", str(folder / "held.vtu")])
    elif name == "predict":
        load = {"points": [[39.7, 8.8, 62.5]], "forces_n": [[0.0, 0.0, -0.2]]}
        (folder / "load.json").write_text(json.dumps(load), "utf-8")


def run(arguments: Sequence[str]) -> dict[str, float]:
    """Return seconds, those of the processor, and the most memory, of a command."""
    start = time.perf_counter()
    child = subprocess.Popen(
        [sys.executable, "-m", "physgnn", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    watching = Thread(target=_watch, args=(child, peak := [0.0]), daemon=True)
    watching.start()
    assert child.stderr is not None
    said = child.stderr.read().decode()
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    watching.join()
    if child.returncode not in (0, NOT_USABLE):
        sys.exit(f"physgnn {' '.join(arguments)} failed: {said}")
    return {
        "seconds": time.perf_counter() - start,
        "processor": used.ru_utime + used.ru_stime,
        "memory_mb": max(peak[0], used.ru_maxrss / 1024),
        "exit_code": child.returncode,
    }


def _watch(child: "subprocess.Popen[bytes]", peak: list[float]) -> None:
    """Keep the most memory that a command and its processes hold together, MB."""
    root = psutil.Process(child.pid)
    while child.returncode is None:
        with suppress(psutil.Error):
            family = [root, *root.children(recursive=True)]
            held = sum(one.memory_info().rss for one in family) / 2**20
            peak[0] = max(peak[0], held)
        time.sleep(0.05)


def measured(folder: Path) -> dict[str, Any]:
    """Run what a size lacks, one command after the other; return all."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / "times.json"
    times: dict[str, Any] = json.loads(kept.read_text()) if kept.is_file() else {}
    for name in COMMANDS:
        if name not in times:
            prepare(name, folder)
            times[name] = run([name, *words(name, folder)])
            times["points"] = read_mesh(folder / "case.vtu").n_points
            kept.write_text(json.dumps(times, indent=1))
    return times


def exponent(points: Sequence[float], values: Sequence[float]) -> str:
    """Return by which power of the points values grow, over all sizes."""
    if len(points) < 2:
        return ""
    return f"{np.polyfit(np.log(points), np.log(values), 1)[0]:.2f}"


def rows(sizes: Sequence[dict[str, Any]]) -> Iterator[tuple[str, ...]]:
    """Yield a row a command: seconds and memory by size, and their exponents."""
    points = [times["points"] for times in sizes]
    for name in COMMANDS:
        for what, unit in (("seconds", "s"), ("processor", "s"), ("memory_mb", "MB")):
            values = [times[name][what] for times in sizes]
            shown = [f"{v:.1f}" if unit == "s" else f"{v:.0f}" for v in values]
            title = {"seconds": "clock, s", "processor": "processor, s"}
            yield name, title.get(what, "memory, MB"), *shown, exponent(points, values)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    sizes = [3_000, 10_000, 30_000, 100_000]
    parser.add_argument("--sizes", type=int, nargs="+", default=sizes)
    parser.add_argument("-o", "--out", type=Path, default=Path("growth"))
    given = parser.parse_args()
    print(machine(), flush=True)
    made = [measured(given.out / str(size)) for size in given.sizes]
    points = [f"{times['points']:,} points" for times in made]
    table(("command", "", *points, "points to the power"), rows(made))


if __name__ == "__main__":
    main()
