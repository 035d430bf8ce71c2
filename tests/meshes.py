"""Small meshes that tests share."""

import numpy as np

from physgnn.geometry.tetmesh import TetMesh


def block_mesh(n: int, side: float = 10.0, jitter: float = 0.0) -> TetMesh:
    """A cube of n³ small cubes, six tetrahedra each, its bottom fixed.

    The upper half is region 1, so that tests meet two materials.
    """
    axis = np.linspace(0.0, side, n + 1)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    corner = index[:-1, :-1, :-1].ravel()
    step = np.array([(n + 1) ** 2, n + 1, 1])
    cells = []
    for first, second in ((0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)):
        third = 3 - first - second
        chain = [corner]
        for direction in (first, second, third):
            chain.append(chain[-1] + step[direction])
        even = (first, second) in ((0, 1), (1, 2), (2, 0))
        cells.append(np.stack(chain if even else [chain[i] for i in (0, 2, 1, 3)], -1))
    all_cells = np.concatenate(cells).astype(np.int32)
    if jitter:
        inside = ((points > 0) & (points < side)).all(axis=1)
        noise = np.random.default_rng(0).uniform(-1, 1, points.shape)
        points = points + inside[:, None] * noise * jitter * side / n
    centre = points[all_cells].mean(axis=1)
    return TetMesh(
        points=points,
        cells=all_cells,
        region=(centre[:, 2] > side / 2).astype(np.int32),
        point_sets={
            "fixed": np.flatnonzero(points[:, 2] == 0.0),
            "loaded": np.flatnonzero(points[:, 2] == side),
        },
    )


BOX_MM = 60.0


def brain_in_a_box() -> TetMesh:
    """A block in a box, open at the top, with a tumour near the top."""
    block = block_mesh(6, side=BOX_MM)
    x, y, z = block.points.T
    wall = (z == 0) | np.isin(x, [0, BOX_MM]) | np.isin(y, [0, BOX_MM])
    centres = block.points[block.cells].mean(axis=1)
    tumour = (np.abs(centres - [30, 30, 40]) < 10).all(axis=1)
    return TetMesh(
        block.points,
        block.cells,
        tumour.astype(np.int32),
        {"fixed": np.flatnonzero(wall)},
    )
