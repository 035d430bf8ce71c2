"""Make a small dataset in Python: a block pushed from above, 6 load paths, 2 splits."""

import sys
from pathlib import Path

import numpy as np

import physgnn as pg
from physgnn.dataset import generate, split_path
from physgnn.mechanics.loads.sampling import cone_paths


def block(n: int = 4, side: float = 40.0) -> pg.TetMesh:
    """Return a cube of n³ cells, each of six tetrahedra, mm; its bottom is fixed."""
    axis = np.linspace(0.0, side, n + 1)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    low = index[:-1, :-1, :-1].ravel()
    x, y, z = (n + 1) ** 2, n + 1, 1
    high = x + y + z
    turns = [(x, x + y), (x + y, y), (y, y + z), (y + z, z), (z, z + x), (z + x, x)]
    cells = [np.stack([low, low + a, low + b, low + high], -1) for a, b in turns]
    return pg.TetMesh(
        points=points,
        cells=np.concatenate(cells),
        region=np.zeros(6 * n**3),
        point_sets={
            "fixed": np.flatnonzero(points[:, 2] == 0.0),
            "loaded": np.flatnonzero(points[:, 2] == side),
        },
    )


def main(out: Path) -> None:
    """Simulate into a new store and say what is in it."""
    mesh = block()
    paths = cone_paths(
        mesh,
        mesh.point_set("loaded"),
        total_force_n=0.15,
        n_levels=5,
        n_paths=6,
        cone_deg=30.0,
        nodes_per_path=9,
    )
    store = pg.Store.create(
        out,
        pg.Body(
            mesh,
            {0: pg.NeoHookean(youngs_modulus_pa=3000.0, poissons_ratio=0.45)},
            mesh.point_set("fixed"),
        ),
        paths,
        provenance={"made by": "examples/simulate_block.py"},
    )
    generate(store)
    split = split_path(store)
    largest = max(np.linalg.norm(store.displacement(i), axis=2).max() for i in range(6))
    print(f"{len(store.samples())} samples, largest displacement {largest:.2f} mm")
    print(f"{len(split.train)} train, {len(split.test)} test, no load path in both")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "block.zarr"))
