"""A slice of the grid: what the convolutional network is given, and what it is to say."""

import numpy as np
from _common import CRANIOTOMY, brain, materials, plt, push, save

import physgnn as pg
from physgnn.learning.grid_networks.cnn_model import CNNModel
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear.linear_elasticity import RestState

mesh = brain(1500, 4000.0)
body = Body(mesh, materials())
case: pg.LoadCase = push(mesh, 1.5, 1).case(0)
model = CNNModel(body)
grid, inputs = model.grid, model.encode(case)
known, _ = model.places.scatter(inputs[None, :, :3], inputs[None, :, 3])
moved = RestState(body).solve(case.on_points(mesh.n_points))

middle = round((CRANIOTOMY[1] - grid.origin[1]) / grid.spacing)
low, high = grid.positions[[0, -1]][:, [0, 2]]
half = grid.spacing / 2
extent = (low[0] - half, high[0] + half, low[1] - half, high[1] + half)
distance = model.shape[0, 1, :, middle].numpy() * 8.0 * grid.spacing
seen = np.linalg.norm(known[0, :, :, middle].numpy(), axis=0)
near = np.abs(mesh.points[:, 1] - CRANIOTOMY[1]) < 4.0
length = np.linalg.norm(moved, axis=1)

figure, axes = plt.subplots(1, 3, figsize=(9.0, 3.0), sharex=True, sharey=True)
drawn = [
    axes[0].imshow(distance.T, origin="lower", extent=extent, cmap="PuOr",
                   vmin=-60, vmax=60),
    axes[1].imshow(np.where(seen > 0, seen, np.nan).T, origin="lower", extent=extent,
                   vmin=0, vmax=length.max()),
    axes[2].scatter(*mesh.points[near][:, [0, 2]].T, c=length[near], s=14, vmin=0,
                    vmax=length.max()),
]  # fmt: skip
titles = ("signed distance, mm", "known, mm", "to be found, mm")
for each, what, title in zip(axes, drawn, titles, strict=True):
    each.set(title=title, xlabel="x, mm", aspect="equal")
    each.grid(visible=False)
    figure.colorbar(what, ax=each, shrink=0.8)
axes[0].set_ylabel("z, mm")
save(figure, "cnn")
