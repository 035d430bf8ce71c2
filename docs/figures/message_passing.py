"""The published network, and how far a load can be felt through its layers."""

import numpy as np
import pyvista as pv
from _boxes import arrow, box, canvas
from _common import (
    CRANIOTOMY,
    GREY,
    ORANGE,
    PURPLE,
    TEAL,
    brain,
    grid,
    save,
    scene,
    write,
)
from scipy.sparse import coo_matrix

figure, axes = canvas(9.2, 1.9)
box(axes, 0.8, 1.0, "7 features\na point", GREY, 1.3)
box(axes, 2.6, 1.0, "3 convolutions\nGraphConv", ORANGE, 1.5)
box(axes, 4.4, 1.0, "attention over\nlayers (LSTM)", PURPLE, 1.5)
box(axes, 6.2, 1.0, "3 convolutions\nSAGEConv", ORANGE, 1.5)
box(axes, 7.9, 1.0, "attention,\nhead", PURPLE, 1.2)
axes.text(8.75, 1.0, "u", fontsize=12, va="center", color=TEAL)
for a, b in ((1.47, 1.83), (3.37, 3.63), (5.17, 5.43), (6.97, 7.28), (8.52, 8.7)):
    arrow(axes, (a, 1.0), (b, 1.0))
save(figure, "published_network")

mesh = brain(1500, 400.0)
pairs = mesh.cells[:, [0, 0, 0, 1, 1, 2, 1, 2, 3, 2, 3, 3]].reshape(-1, 2, 6)
start, end = pairs[:, 0].ravel(), pairs[:, 1].ravel()
n = mesh.n_points
edges = coo_matrix((np.ones(len(start)), (start, end)), (n, n)).tocsr()
edges = edges + edges.T
hops = np.full(n, 7)
seen = np.zeros(n, dtype=bool)
seen[np.argmin(np.linalg.norm(mesh.points - CRANIOTOMY, axis=1))] = True
for hop in range(7):
    hops[seen & (hops == 7)] = hop
    seen = seen | (edges @ seen > 0)
made = grid(mesh)
made["hops"] = hops
plotter = scene(2, 1000, 400)
for panel, shown in enumerate(
    (made, made.clip(normal=(-0.54, 0.84, 0), origin=CRANIOTOMY))
):
    plotter.subplot(0, panel)
    plotter.add_mesh(shown, scalars="hops", cmap="viridis_r", n_colors=8, clim=(-0.5, 7.5),
                     show_edges=True, edge_color="#555555", line_width=0.4,
                     scalar_bar_args={"title": "hops from the load (7: more)", "fmt": "%.0f",
                                      "color": "black", "n_labels": 2})  # fmt: skip
    direction = (
        CRANIOTOMY / np.linalg.norm(CRANIOTOMY)
        if panel == 0
        else np.array([-0.45, 0.8, 0.35])
    )
    centre = np.array(made.center)
    plotter.camera_position = [centre + 430 * direction, centre, (0, 0, 1)]
write(plotter, "k_hop")
assert isinstance(made, pv.DataSet)
