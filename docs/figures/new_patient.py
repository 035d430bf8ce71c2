"""Four synthetic patients of a family."""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from _common import grid, scene, write

import physgnn as pg

folder = Path(tempfile.mkdtemp())
program = "from physgnn.cli import main; main()"
command = ["anatomies", "-o", str(folder), "--count", "4", "--seed", "0"]
subprocess.run([sys.executable, "-c", program, *command], check=True)
plotter = scene(4, 1200, 330)
for panel, file in enumerate(sorted(folder.glob("*.vtu"))):
    mesh = pg.read_mesh(file)
    plotter.subplot(0, panel)
    body = grid(mesh)
    plotter.add_mesh(
        body.extract_surface(algorithm=None),
        color="#d8cfc6",
        opacity=0.35,
        smooth_shading=True,
    )
    plotter.add_mesh(
        body.extract_cells(np.flatnonzero(mesh.region == 1)), color="#8e44ad"
    )
    for name, colour in (("fixed", "#2f7fd6"), ("loaded", "#e4572e")):
        plotter.add_points(
            mesh.points[mesh.point_set(name)], color=colour, point_size=5
        )
    plotter.add_text(f"{mesh.n_points} points", font_size=9, color="black")
    centre = np.array(body.center)
    plotter.camera_position = [
        centre + np.array([250.0, 280.0, 190.0]),
        centre,
        (0, 0, 1),
    ]
write(plotter, "new_patient")
