"""What the benchmarks share: the machine's name, and tables in Markdown."""

import os
import platform
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import equal_levels
from physgnn.mechanics.materials import NeoHookean


def machine() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.is_file() else []
    models = [line.split(":")[1].strip() for line in lines if "model name" in line]
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba"))
    return (
        f"{models[0] if models else platform.processor()}, {os.cpu_count()} cores, "
        f"load {os.getloadavg()[0]:.1f} at the start; "
        f"Python {platform.python_version()}, {packages}; {platform.system()}"
    )


def table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(map(str, row)) + " |", flush=True)


def load_kernels() -> None:
    """Solve one tetrahedron, so that compiled code is there before time counts."""
    one = TetMesh(np.eye(4, 3, k=-1), np.array([[0, 1, 2, 3]]), np.array([0]))
    path = LoadPath([3], [[0.0, 0.0, 1e-4]], equal_levels(2))
    Solver(Body(one, {0: NeoHookean(3000.0, 0.3)}, np.arange(3))).solve(path)
