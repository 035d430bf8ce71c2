"""A registration of the bundled brain: what was measured, what follows, how sure."""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyvista as pv
from _common import CRANIOTOMY, brain, grid, materials, push, scene, write

import physgnn as pg

folder = Path(tempfile.mkdtemp())
mesh = brain(600, 1500.0)
u = pg.solve(
    mesh, push(mesh, 7.0, 3), materials=materials(), fixed="fixed"
).displacement[-1]
near = mesh.point_set("loaded")
noise = np.random.default_rng(0).normal(scale=0.7, size=(len(near), 3))
after = mesh.points[near] + u[near] + noise
header = "source_x,source_y,source_z,target_x,target_y,target_z"
pairs = np.hstack([mesh.points[near], after])
np.savetxt(folder / "measured.csv", pairs, delimiter=",", header=header, comments="")
pg.write_mesh(folder / "case.vtu", mesh)
command = [
    "register",
    "case.vtu",
    "--points",
    "measured.csv",
    "--noise-mm",
    "0.7",
    "-o",
    "shift.vtu",
]
program = "from physgnn.cli import main; main()"
subprocess.run([sys.executable, "-c", program, *command], cwd=folder, check=True)
shift = pv.read(folder / "shift.vtu")

plotter = scene(3)
moved = grid(mesh, shift["displacement_mm"])
moved["deviation"] = shift["deviation_mm"]
direction = np.array([0.15, 1.0, 0.35])
for panel in range(3):
    plotter.subplot(0, panel)
    if panel == 0:
        plotter.add_mesh(
            grid(mesh).extract_surface(algorithm=None),
            color="#d8cfc6",
            smooth_shading=True,
        )
        measured = after - mesh.points[near]
        arrows = pv.PolyData(
            mesh.points[near] - 2.0 * measured
        )  # they end at the surface
        arrows["shift"] = measured
        plotter.add_mesh(
            arrows.glyph(orient="shift", scale="shift", factor=2.0), color="#e4572e"
        )
        plotter.add_text("measured: 40 points", font_size=12, color="black")
        centre, view = CRANIOTOMY * 0.2, CRANIOTOMY / np.linalg.norm(CRANIOTOMY)
        plotter.camera_position = [centre + 400 * view, centre, (0, 0, 1)]
        continue
    name, title = (("mm", "displacement, mm"), ("deviation", "standard deviation, mm"))[
        panel - 1
    ]
    cut = moved.clip(normal=(0, 1, 0), origin=CRANIOTOMY)
    plotter.add_mesh(cut, scalars=name, cmap=("YlOrRd", "PuBu")[panel - 1],
                     scalar_bar_args={"title": title, "color": "black", "fmt": "%.1f", "n_labels": 3, "title_font_size": 20, "label_font_size": 18})  # fmt: skip
    plotter.add_text(
        ("found in the whole brain", "how sure")[panel - 1], font_size=12, color="black"
    )
    centre = np.array(moved.center)
    plotter.camera_position = [centre + 400 * direction, centre, (0, 0, 1)]
write(plotter, "registration")
