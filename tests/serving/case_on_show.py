"""A small case on show: a cube with a tumour below its top, which sinks."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np

from meshes import block_mesh
from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh
from physgnn.serving.scene.image_slices import GreyVolume
from physgnn.serving.scene.viewed import view
from physgnn.serving.sessions.engine import Engine
from physgnn.stages.patient.live_view.case_desk import CaseDesk

SIDE = 80.0


def write_case(folder: Path) -> Path:
    """Write the case, which nothing holds."""
    body = block_mesh(6, side=SIDE)
    centre = body.points[body.cells].mean(axis=1)
    near = np.linalg.norm(centre - [40, 40, 60], axis=1) < 16
    mesh = TetMesh(body.points, body.cells, near.astype(np.int32))
    write_mesh(folder / "case.vtu", mesh)
    return folder / "case.vtu"


@contextmanager
def case_engine(case: Path, folder: Path | None) -> Iterator[Engine]:
    """Yield what serves the case, with an image of stripes."""
    stripes = np.indices((90, 90, 90)).sum(axis=0) % 20 * 12
    image = GreyVolume(stripes.astype(np.uint8), np.eye(4))
    with closing(CaseDesk(case, folder)) as desk:
        yield Engine(view(case, desk.mesh), image, desk)


def sunk_pairs(mesh: TetMesh, depth_mm: float) -> FloatArray:
    """Return pairs of points of what is open, sunk most in the middle, (n, 6)."""
    before = mesh.points[mesh.point_set("loaded")]
    away = np.linalg.norm(before[:, :2] - SIDE / 2, axis=1)
    after = before - [0, 0, 1] * (depth_mm * np.exp(-((away / 25) ** 2)))[:, None]
    return np.hstack([before, after])


def csv_of(pairs: FloatArray) -> bytes:
    """Return pairs as a CSV file's bytes."""
    rows = [",".join(f"{value:.4f}" for value in row) for row in pairs]
    return "\n".join(rows).encode()
