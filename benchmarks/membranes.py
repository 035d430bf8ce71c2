"""What falx and tentorium change: 20 shifts, with them held, elastic and left out.

Needs a label map that tells left from right and cerebrum from cerebellum::

    python benchmarks/membranes.py seg.nii.gz --labels freesurfer
"""

import argparse
from functools import partial
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.dataset import Preset
from physgnn.dataset.membranes import Membranes
from physgnn.errors import InputError
from physgnn.geometry import TetMesh, boundary_surface
from physgnn.io import read_mesh, write_mesh
from physgnn.mechanics import TISSUES, solve
from physgnn.mechanics.loads.sampling import cone_paths
from physgnn.stages.patient.preoperative.case_file import craniotomy_at
from physgnn.stages.patient.preoperative.segmentation import mesh_segmentation

TRACTION_PA = 500.0  # Pa on what is laid open
SUPPORTS = ("left-out", "elastic", "held")
MATERIALS = {
    i: TISSUES[name].material for i, name in enumerate(("brain", "tumour", "ventricle"))
}


def shifts(mesh: TetMesh, seed: int) -> tuple[dict[str, FloatArray], bool]:
    """Return the displacement for every support, and whether any snapped through."""
    random = np.random.default_rng(seed)
    surface = boundary_surface(mesh)
    points = surface.points[np.unique(surface.faces)]
    upper = points[points[:, 2] > np.quantile(points[:, 2], 0.6)]
    opened = craniotomy_at(surface, upper[random.integers(len(upper))], 30.0)
    paths = partial(
        cone_paths,
        total_force_n=TRACTION_PA * opened.area_mm2 * 1e-6,
        cone_deg=30.0,
        n_paths=1,
        n_levels=1,
        nodes_per_path=None,
        seed=seed,
    )
    found, snapped = {}, False
    for support in SUPPORTS:
        membranes = Membranes(falx=support, tentorium=support)
        preset = Preset(
            MATERIALS,
            paths,
            fixed=opened.fixed,
            loaded=opened.loaded,
            membranes=membranes,
        )
        body, (path,) = preset.on(mesh)
        solution = solve(body, path, materials=MATERIALS)
        if not solution.converged:
            raise InputError(f"{support}: {solution.message}")
        found[support] = solution.displacement[-1]
        snapped |= "snapped through" in solution.message
    return found, snapped


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("segmentation")
    parser.add_argument("--labels", default="freesurfer")
    parser.add_argument("--target-points", type=int, default=5000)
    parser.add_argument("--shifts", type=int, default=20)
    parser.add_argument("--mesh", help="where the mesh is kept, VTU")
    asked = parser.parse_args()
    if asked.mesh and Path(asked.mesh).exists():
        mesh = read_mesh(asked.mesh)
    else:
        mesh = mesh_segmentation(
            asked.segmentation,
            asked.labels,
            target_points=asked.target_points,
            mesher="tetwild",
            log=print,
        )
        if asked.mesh:
            write_mesh(asked.mesh, mesh)
    rows: dict[str, list[FloatArray]] = {name: [] for name in SUPPORTS[1:]}
    largest, n_failed, n_snapped = [], 0, 0
    for seed in range(asked.shifts):
        try:
            found, snapped = shifts(mesh, seed)
        except InputError as error:
            n_failed += 1
            print(f"shift {seed}: {error}", flush=True)
            continue
        without = found["left-out"]
        largest.append(np.linalg.norm(without, axis=1).max())
        for name, changes in rows.items():
            changes.append(np.linalg.norm(found[name] - without, axis=1))
        n_snapped += snapped
        said = ", snapped through" if snapped else ""
        print(seed, f"{largest[-1]:.2f} mm{said}", flush=True)
    print(
        f"\n{mesh.n_points} points; {len(largest)} shifts, the largest displacement "
        f"{np.mean(largest):.2f} mm in the mean; {n_snapped} snapped through, "
        f"{n_failed} were not solved\n"
    )
    print("| membranes | mean | median | 90 % | 95 % | largest, per shift | largest |")
    print("|---|---|---|---|---|---|---|")
    for name, changes in rows.items():
        every = np.concatenate(changes)
        middle, most, nearly = np.quantile(every, [0.5, 0.9, 0.95])
        per_shift = np.median([change.max() for change in changes])
        print(
            f"| {name} | {every.mean():.3f} | {middle:.3f} | {most:.3f} | "
            f"{nearly:.3f} | {per_shift:.2f} | {every.max():.2f} |"
        )


if __name__ == "__main__":
    main()
