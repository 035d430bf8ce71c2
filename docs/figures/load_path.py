"""A load path: the solution, and where polynomials through earlier levels point."""

import numpy as np
from _common import GREY, ORANGE, PURPLE, TEAL, brain, materials, plt, push, save

import physgnn as pg

mesh = brain(400, 2500.0)
path = push(mesh, 9.0, 10)
solution = pg.solve(mesh, path, materials=materials(), fixed="fixed")
u = np.concatenate([np.zeros((1, mesh.n_points, 3)), solution.displacement])
factors = np.append(0.0, path.load_factors)
point = path.nodes[0]
size = np.linalg.norm(u[:, point], axis=1)


def miss(degree: int) -> np.ndarray:
    """Return how far the polynomial through earlier levels misses each level, mm."""
    found = []
    for k in range(degree + 1, len(u)):
        past = slice(k - degree - 1, k)
        weights = [
            np.prod([(factors[k] - b) / (a - b) for b in factors[past] if b != a])
            for a in factors[past]
        ]
        guess = np.tensordot(weights, u[past], axes=1)
        found.append(np.linalg.norm(guess - u[k], axis=1).max())
    return np.array(found)


figure, (left, right) = plt.subplots(1, 2, figsize=(8.2, 3.4))
left.plot(factors, size, "o-", c=TEAL, label="levels solved")
left.plot(
    factors, size[1] / factors[1] * factors, "--", c=GREY, label="linear solution"
)
left.set(xlabel="load factor", ylabel="one loaded point, mm")
left.legend()
for degree, colour in ((0, GREY), (1, ORANGE), (2, PURPLE), (3, TEAL)):
    label = ("level before", "straight line", "parabola", "cubic")[degree]
    right.semilogy(
        factors[degree + 1 :], miss(degree), "o-", ms=4, c=colour, label=label
    )
right.set(xlabel="load factor", ylabel="warm start's largest error, mm")
right.legend(fontsize=8)
save(figure, "load_path")
