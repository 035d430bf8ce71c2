import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh, without_unused_points
from physgnn.mechanics import (
    Body,
    Gravity,
    LoadPath,
    NeoHookean,
    PrescribedDisplacement,
    Solver,
)
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.support import check_held

BLOCK = block_mesh(2)


def two_blocks(step: tuple[float, float, float]) -> TetMesh:
    """Two blocks whose coinciding points are one."""
    points = np.concatenate([BLOCK.points, BLOCK.points + step]).round(9)
    cells = np.concatenate([BLOCK.cells, BLOCK.cells + BLOCK.n_points])
    merged, index = np.unique(points, axis=0, return_inverse=True)
    region = np.zeros(len(cells), dtype=np.int32)
    return TetMesh(merged, index.reshape(-1)[cells].astype(np.int32), region)


def bottom(mesh: TetMesh) -> np.ndarray:
    return np.flatnonzero((mesh.points[:, 2] == 0) & (mesh.points[:, 0] <= 10))


def test_a_block_that_shares_a_face_is_held_with_the_other() -> None:
    mesh = two_blocks((10.0, 0.0, 0.0))
    check_held(mesh, bottom(mesh))


@pytest.mark.parametrize(
    "step",
    [(10.0, 0.0, 10.0), (10.0, 10.0, 10.0), (30.0, 0.0, 0.0)],
    ids=["sharing an edge", "sharing a point", "apart"],
)
def test_a_block_that_shares_no_face_is_refused(step) -> None:  # type: ignore[no-untyped-def]
    mesh = two_blocks(step)
    with pytest.raises(InputError, match=r"1 of its 2 parts can move; .* 48 cells"):
        check_held(mesh, bottom(mesh))
    far = np.flatnonzero((mesh.points >= np.array(step) - 1e-9).all(axis=1))
    check_held(mesh, np.union1d(bottom(mesh), far))


def test_points_in_line_hold_nothing() -> None:
    line = np.flatnonzero((BLOCK.points[:, 1] == 0) & (BLOCK.points[:, 2] == 0))
    assert len(line) == 3
    with pytest.raises(InputError, match="not in line"):
        check_held(BLOCK, line)
    check_held(BLOCK, np.append(line, BLOCK.n_points - 1))


def test_a_part_held_by_a_part_that_is_held() -> None:
    """Three single cells in a row, each sharing three points but no face."""
    first = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    mesh = TetMesh(
        np.array([*first, [1, 1, 1], [2, 0, 0]], dtype=float),
        np.array([[0, 1, 2, 3], [1, 5, 4, 3]]),
        np.zeros(2),
    )
    with pytest.raises(InputError, match="1 of its 2 parts"):
        check_held(mesh, np.array([0, 1, 2]))
    check_held(mesh, np.array([0, 1, 2, 4]))


def test_halves_whose_points_were_not_merged_are_refused() -> None:
    upper = BLOCK.points[BLOCK.cells].mean(axis=1)[:, 2] > 5.0
    cells = BLOCK.cells + BLOCK.n_points * upper[:, None]
    mesh, _ = without_unused_points(
        np.concatenate([BLOCK.points, BLOCK.points]), cells, BLOCK.region,
        dict(BLOCK.point_sets),
    )  # fmt: skip
    materials = dict.fromkeys((0, 1), NeoHookean(3000.0, 0.45))
    with pytest.raises(InputError, match="merge points that coincide"):
        Body(mesh, materials).pattern  # noqa: B018


MATERIALS = {0: NeoHookean(3000.0, 0.4), 1: NeoHookean(3000.0, 0.4)}
NOTHING = np.empty(0, dtype=np.int64)


def moved(points: np.ndarray) -> LoadPath:
    """A load that moves some points of the block by 0.1 mm along x, and no more."""
    shift = np.tile([0.1, 0.0, 0.0], (len(points), 1))
    return LoadPath.of(np.ones(1), PrescribedDisplacement(points, shift))


def test_a_load_may_hold_the_body_alone() -> None:
    """Its bottom is moved: the whole block follows without strain."""
    body, path = Body(BLOCK, MATERIALS, NOTHING), moved(bottom(BLOCK))
    for u in (
        Solver(body).solve(path).displacement[0],
        Newton(body).solve(path, np.zeros_like(BLOCK.points)),
    ):
        np.testing.assert_allclose(u, np.tile([0.1, 0, 0], (len(u), 1)), atol=1e-6)


@pytest.mark.parametrize("fixed", [NOTHING, np.array([0, 1])], ids=["none", "two"])
@pytest.mark.parametrize("load", ["gravity", "one point"])
def test_a_load_that_leaves_the_body_free_is_refused(fixed, load) -> None:  # type: ignore[no-untyped-def]
    """Gravity holds nothing, and one point more does not hold what none or two do."""
    fall = LoadPath.of(np.ones(1), Gravity((0.0, 0.0, -1.0)))
    path = fall if load == "gravity" else moved(np.array([2]))
    for solve in (
        Solver(Body(BLOCK, MATERIALS, fixed)).solve,
        lambda p: Newton(Body(BLOCK, MATERIALS, fixed)).solve(p, 0 * BLOCK.points),
    ):
        with pytest.raises(InputError, match=r"must be fixed|must hold the whole"):
            solve(path)
