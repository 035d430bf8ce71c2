"""Solve one load: 4 N on a patch of the bundled brain, in ten equal steps.

    python examples/01_solve_one_load.py [folder]

Writes solution.vtu for ParaView and picture.png. The load is dead: it keeps its
direction while the brain deforms.
"""

import sys
from pathlib import Path

import numpy as np
import pyvista as pv

import physgnn as pg
from physgnn.geometry import mni152_phantom
from physgnn.io import write_prediction

CRANIOTOMY = np.array([39.7, 8.8, 62.5])  # mm, over the bundled tumour


def main(folder: Path) -> dict[str, float]:
    """Solve, write, and return the largest displacement and what holds it, mm and N."""
    folder.mkdir(parents=True, exist_ok=True)
    phantom = mni152_phantom(n_points=700)
    mesh = pg.tetrahedralize(phantom.brain, phantom.tumours, target_points=3000)
    away = np.linalg.norm(mesh.points - CRANIOTOMY, axis=1)
    patch = np.argsort(away)[:30]
    fixed = np.flatnonzero(away > 70.0)  # the skull holds all that is far away
    inward = mesh.points.mean(axis=0) - CRANIOTOMY
    forces = np.tile(4.0 / 30 * inward / np.linalg.norm(inward), (30, 1))  # N

    path = pg.LoadPath(nodes=patch, forces=forces, load_factors=np.arange(1, 11) / 10)
    brain = pg.NeoHookean(youngs_modulus_pa=3000.0, poissons_ratio=0.49)
    tumour = pg.NeoHookean(youngs_modulus_pa=7500.0, poissons_ratio=0.49)
    solution = pg.solve(mesh, path, materials={0: brain, 1: tumour}, fixed=fixed)

    assert all(status == pg.Status.CONVERGED for status in solution.status)
    u = solution.displacement  # (10 levels, n_points, 3), mm
    write_prediction(folder / "solution.vtu", mesh, {"displacement_mm": u[-1]})
    draw(mesh, u[-1], folder / "picture.png")
    largest = np.linalg.norm(u, axis=2).max(axis=1)
    return {"largest_mm": largest[-1], "linear_mm": 10 * largest[0]}


def draw(mesh: pg.TetMesh, u: np.ndarray, file: Path) -> None:
    """Draw the deformed brain, coloured by how far each point moved."""
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points + u)
    grid["displacement, mm\n"] = np.linalg.norm(u, axis=1)  # a line above the numbers
    plotter = pv.Plotter(off_screen=True, window_size=(600, 450))
    bar = {"title_font_size": 24, "label_font_size": 20, "n_labels": 3, "fmt": "%.0f"}
    surface = grid.extract_surface(algorithm=None)
    plotter.add_mesh(surface, cmap="viridis", scalar_bar_args=bar)
    plotter.camera_position = [CRANIOTOMY * 6, (0, -15, -14), (0, 0, 1)]
    plotter.screenshot(file)
    plotter.close()


if __name__ == "__main__":
    found = main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    print(
        f"largest displacement {found['largest_mm']:.2f} mm; ten times that at a tenth "
        f"of the load would be {found['linear_mm']:.2f} mm"
    )
