"""A support on scattered points, and a shape function along a line through them."""

import numpy as np
from _common import GREY, ORANGE, TEAL, block, plt, save

from physgnn.mechanics.meshless.moving_least_squares import shape_functions
from physgnn.mechanics.meshless.supports import neighbours

RADIUS = 22.0  # mm
mesh = block(4)
points = mesh.points + np.random.default_rng(0).uniform(-1.5, 1.5, mesh.points.shape)
node = int(np.linalg.norm(points - 20.0, axis=1).argmin())
x = np.linspace(0.0, 40.0, 161)
line = np.column_stack([x, np.full_like(x, points[node, 1]), np.full_like(x, 20.0)])
radii = np.full(len(line), RADIUS)
near = neighbours(points, radii, line)
values, _ = shape_functions(points, radii, line, near)
of_place = np.repeat(np.arange(len(line)), np.diff(near.start))
phi = np.zeros(len(line))
phi[of_place[near.nodes == node]] = values[near.nodes == node]

figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.2))
layer = np.abs(points[:, 2] - 20.0) < 4.0
left.scatter(*points[layer, :2].T, s=14, c=GREY)
inside = layer & (np.linalg.norm(points - points[node], axis=1) < RADIUS)
left.scatter(*points[inside, :2].T, s=22, c=TEAL)
left.add_patch(plt.Circle(points[node, :2], RADIUS, fill=False, color=ORANGE))
left.plot(*points[node, :2], "x", c=ORANGE, ms=9, mew=2)
left.set(aspect="equal", xlabel="mm", ylabel="mm", xlim=(-4, 44), ylim=(-4, 44))
right.plot(x, phi, c=TEAL)
right.axvline(points[node, 0], color=GREY, ls=":")
right.set(xlabel="place on a line through the point, mm", ylabel="φ of the point")
save(figure, "meshless")
