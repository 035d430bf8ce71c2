"""TetGen and fTetWild on the same surfaces: cells, distance, seconds, solutions.

    python benchmarks/meshers.py --paper ../shared/paper --points 5000

Without `--paper` on the bundled brain alone; `--segmentation` adds a label map. Prints
a Markdown table. Seconds are processor time of the mesher.
"""

import argparse
import resource
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pyvista as pv

from physgnn.arrays import FloatArray
from physgnn.dataset import Preset
from physgnn.geometry import (
    Surface,
    TetMesh,
    boundary_surface,
    check_surface,
    mni152_phantom,
    quality,
    tetrahedralize,
    volume,
)
from physgnn.geometry.boundary import region_faces
from physgnn.geometry.segmentation.extract import extract_surfaces
from physgnn.geometry.segmentation.labels.label_tables import label_table
from physgnn.io import read_surface
from physgnn.io.medical.images.formats import read_segmentation
from physgnn.mechanics import TISSUES, solve
from physgnn.mechanics.loads.sampling import cone_paths
from physgnn.stages.patient.preoperative.case_file import craniotomy_at

MATERIALS = {i: TISSUES[name].material for i, name in enumerate(("brain", "tumour"))}
TRACTIONS_PA = (500.0, 1000.0)
LEVELS = 5
COLUMNS = (
    "surfaces",
    "mesher",
    "points",
    "mean ratio: worst, median",
    "volume error, % (brain, inside)",
    "surface off by, mm: mean, largest",
    "processor s",
    "levels solved",
    "snap-throughs",
    "mean difference of the displacements, mm (largest displacement)",
)
Case = tuple[str, Surface, list[Surface]]


def cases(asked: argparse.Namespace) -> Iterator[Case]:
    """Yield name, brain and inner surfaces."""
    phantom = mni152_phantom()
    yield "bundled", phantom.brain, list(phantom.tumours)
    if asked.paper:
        brain, tumour = (
            check_surface(read_surface(Path(asked.paper) / f"{name}.stl"), name)[0]
            for name in ("brain", "tumour")
        )
        yield "paper", brain, [tumour]
    if asked.segmentation:
        labels = read_segmentation(asked.segmentation)
        found = extract_surfaces(
            labels, label_table(asked.labels), target_points=asked.points
        )
        yield asked.labels, found.brain, [*found.tumours, *found.ventricles]


def off(mesh: TetMesh, brain: Surface, inner: list[Surface]) -> FloatArray:
    """Return how far the mesh's surfaces lie from those given, mm."""
    distances = []
    for faces, given in ((boundary_surface(mesh).faces, [brain]),) + (
        ((region_faces(mesh, 1), inner),) if inner else ()
    ):
        whole = pv.merge(
            [
                pv.PolyData.from_regular_faces(s.points, s.faces.astype(int))
                for s in given
            ]
        )
        middles = mesh.points[faces].mean(axis=1)
        samples = np.concatenate([mesh.points[np.unique(faces)], middles])
        _, nearest = whole.extract_surface(
            algorithm="dataset_surface"
        ).find_closest_cell(samples, return_closest_point=True)
        distances.append(np.linalg.norm(samples - nearest, axis=1))
    return np.concatenate(distances)


def solutions(mesh: TetMesh, opened) -> tuple[int, int, list[FloatArray]]:  # type: ignore[no-untyped-def]
    """Return levels solved, snap-throughs and the last displacements of the loads."""
    solved, snaps, last = 0, 0, []
    for k, traction in enumerate(TRACTIONS_PA):
        paths = partial(
            cone_paths,
            total_force_n=traction * opened.area_mm2 * 1e-6,
            cone_deg=20.0,
            n_paths=1,
            n_levels=LEVELS,
            nodes_per_path=None,
            seed=k,
        )
        preset = Preset(MATERIALS, paths, fixed=opened.fixed, loaded=opened.loaded)
        body, (path,) = preset.on(mesh)
        found = solve(body, path, materials=MATERIALS)
        solved += int((found.status == 0).sum())
        snaps += found.message.count("snapped through")
        last.append(found.displacement[-1])
    return solved, snaps, last


def sampled(mesh: TetMesh, displacement: FloatArray, at: FloatArray) -> FloatArray:
    """Return a displacement at points of the body; NaN outside of it."""
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    grid["u"] = displacement
    found = pv.PolyData(at).sample(grid)
    inside = np.asarray(found["vtkValidPointMask"], dtype=bool)
    return np.where(inside[:, None], np.asarray(found["u"]), np.nan)


def row(name: str, mesher: str, case: Case, points: int):  # type: ignore[no-untyped-def]
    """Mesh and solve; return the cells of a row, the mesh and its solutions."""
    _, brain, inner = case
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    mesh = tetrahedralize(brain, inner, target_points=points, mesher=mesher, log=print)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    shape, apart = quality(mesh), off(mesh, brain, inner)
    wanted = sum(volume(s) for s in inner)
    errors = [mesh.cell_volumes.sum() / volume(brain) - 1]
    if inner:
        errors.append(mesh.cell_volumes[mesh.region == 1].sum() / wanted - 1)
    top = brain.points[(brain.points @ [0.55, 0.35, 0.75]).argmax()]
    opened = craniotomy_at(boundary_surface(mesh), top, 35.0)
    solved, snaps, last = solutions(mesh, opened)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    cells = [
        name,
        mesher,
        str(mesh.n_points),
        f"{shape.mean_ratio_min:.3f}, {shape.mean_ratio_median:.3f}",
        ", ".join(f"{100 * e:+.3f}" for e in errors),
        f"{apart.mean():.3f}, {apart.max():.3f}",
        f"{seconds:.1f}",
        f"{solved} of {LEVELS * len(TRACTIONS_PA)}",
        str(snaps),
    ]
    return cells, mesh, last


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--paper", help="folder of brain.stl and tumour.stl")
    parser.add_argument("--segmentation", help="a label map")
    parser.add_argument("--labels", default="freesurfer")
    parser.add_argument("--points", type=int, default=5000)
    asked = parser.parse_args()
    lines = [" | ".join(COLUMNS), " | ".join("---" for _ in COLUMNS)]
    for case in cases(asked):
        made = [
            row(case[0], mesher, case, asked.points) for mesher in ("tetgen", "tetwild")
        ]
        (_, one, first), (_, other, second) = made
        at = one.points[np.random.default_rng(0).permutation(one.n_points)[:2000]]
        differ = [
            np.linalg.norm(sampled(one, a, at) - sampled(other, b, at), axis=1)
            for a, b in zip(first, second, strict=True)
        ]
        largest = max(np.linalg.norm(u, axis=1).max() for u in first)
        mean = np.nanmean(np.concatenate(differ))
        for i, (cells, _, _) in enumerate(made):
            apart = f"{mean:.3f} ({largest:.2f})" if i else "—"
            lines.append(" | ".join([*cells, apart]))
            print(lines[-1], flush=True)
    print("\n" + "\n".join(f"| {line} |" for line in lines))


if __name__ == "__main__":
    main()
