"""The patch that is solved exactly, in a body that is linear elsewhere."""

import numpy as np
from _common import CRANIOTOMY, brain, grid, scene, write

mesh = brain(1500, 500.0)
loaded = np.zeros(mesh.n_points, dtype=bool)
surface = mesh.point_set("loaded")
loaded[
    surface[np.argmin(np.linalg.norm(mesh.points[surface] - CRANIOTOMY, axis=1))]
] = True
plotter = scene(2, 1000, 400)
for panel, edges in enumerate((1, 2)):
    near = loaded.copy()
    for _ in range(edges):
        touched = near[mesh.cells].any(axis=1)
        near[mesh.cells[touched].ravel()] = True
    patch = near[mesh.cells].all(axis=1)
    plotter.subplot(0, panel)
    body = grid(mesh)
    plotter.add_mesh(
        body.extract_surface(algorithm=None),
        color="#d8cfc6",
        opacity=0.25,
        smooth_shading=True,
    )
    plotter.add_mesh(
        body.extract_cells(np.flatnonzero(patch)), color="#0f9d7e", show_edges=True
    )
    plotter.add_points(
        mesh.points[loaded],
        color="#e4572e",
        point_size=14,
        render_points_as_spheres=True,
    )
    plotter.add_text(
        f"{edges} edge{'s' * (edges > 1)}: {near.sum()} points, {3 * near.sum()} unknowns",
        font_size=10,
        color="black",
    )
    centre = CRANIOTOMY * 0.6
    plotter.camera_position = [
        centre + np.array([170.0, -190.0, 130.0]),
        centre,
        (0, 0, 1),
    ]
write(plotter, "reduced_model")
