"""Three laws with the same small-strain moduli under tension and compression."""

import numpy as np
from _common import GREY, ORANGE, PURPLE, TEAL, block, plt, save

import physgnn as pg
import physgnn.mechanics as me

E, NU = 3000.0, 0.45
MU, KAPPA = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
LAWS = {
    "neo-Hookean": (me.NeoHookean(E, NU), TEAL),
    "Mooney–Rivlin": (me.MooneyRivlin(0.2 * MU, 0.3 * MU, KAPPA), PURPLE),
    "Ogden, α = −4.7": (me.Ogden((2 * MU,), (-4.7,), KAPPA), ORANGE),
}
mesh = block(3, (0.6, 0.6, 1.0))
top = mesh.point_set("top")
factors = np.arange(1, 11) / 10
figure, axes = plt.subplots(figsize=(6.4, 3.8))
for name, (law, colour) in LAWS.items():
    stretch, force = [1.0], [0.0]
    for total in (-0.6, 1.0):
        forces = np.tile([0.0, 0.0, total / len(top)], (len(top), 1))
        path = pg.LoadPath(nodes=top, forces=forces, load_factors=factors)
        solution = pg.solve(mesh, path, materials={0: law}, fixed="fixed")
        ok = np.asarray(solution.status) == 0
        stretch += (1 + solution.displacement[ok][:, top, 2].mean(axis=1) / 40).tolist()
        force += (1e3 * total * factors[ok]).tolist()
    order = np.argsort(stretch)
    axes.plot(
        np.array(stretch)[order],
        np.array(force)[order],
        "o-",
        ms=3.5,
        c=colour,
        label=name,
    )
lengths = np.array([0.7, 1.5])
axes.plot(
    lengths,
    1e3 * 1e-6 * E * 576 * (lengths - 1),
    "--",
    c=GREY,
    label="linear elasticity",
)
axes.set(
    xlabel="height over height at rest",
    ylabel="force on the top, mN",
    xlim=(0.68, 1.55),
    ylim=(-620, 900),
)
axes.legend()
save(figure, "hyperelasticity")
