"""How the error of an expansion grows with the load, about rest and beyond."""

import numpy as np
from _common import GREY, ORANGE, TEAL, brain, materials, plt, push, save

import physgnn as pg

mesh = brain(400, 2500.0)
full = push(mesh, 6.0, 1)


def solve(factors: list[float]) -> np.ndarray:
    """Return the displacement at load factors; a negative one pulls instead."""
    sign = np.sign(factors[0])
    path = pg.LoadPath(
        nodes=full.nodes, forces=sign * full.forces, load_factors=np.abs(factors)
    )
    return pg.solve(mesh, path, materials=materials(), fixed="fixed").displacement


h = 0.02  # derivatives by central differences
plus, minus = solve([h])[0], solve([-h])[0]
u1, u2 = (plus - minus) / (2 * h), (plus + minus) / (2 * h**2)
factors = np.geomspace(0.03, 1.0, 10)
true = solve(factors.tolist())
figure, axes = plt.subplots(figsize=(6.0, 3.8))
for order, colour in ((1, ORANGE), (2, TEAL)):
    guess = [t * u1 + (order == 2) * t**2 * u2 for t in factors]
    error = [
        np.linalg.norm(a - b, axis=1).mean() for a, b in zip(guess, true, strict=True)
    ]
    label = ("first order: the linear solution", "second order")[order - 1]
    axes.loglog(factors, error, "o-", c=colour, label=label)
    axes.loglog(factors, error[2] * (factors / factors[2]) ** (order + 1), ":", c=GREY)
axes.set(xlabel="load factor", ylabel="mean error, mm")
axes.text(
    0.05,
    0.6,
    "dotted: slopes 2 and 3",
    transform=axes.transAxes,
    color=GREY,
    fontsize=8,
)
axes.legend()
save(figure, "asymptotic_expansion")
