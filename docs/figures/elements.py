"""Locking: the indentation of a block on ever finer meshes, two elements."""

import numpy as np
from _common import ORANGE, TEAL, block, plt, save

import physgnn as pg

SIZES = (2, 4, 6, 8, 12)
figure, panels = plt.subplots(1, 2, figsize=(7.6, 3.4), sharey=True)
for axes, nu in zip(panels, (0.3, 0.49), strict=True):
    for element, colour in (("tet4", ORANGE), ("tet4-averaged", TEAL)):
        found = []
        for n in SIZES:
            mesh = block(n)
            right = mesh.points[:, 0] == 40.0
            nodes = np.flatnonzero(right & (mesh.points[:, 2] > 0))
            forces = np.tile([0.0, 0.0, 0.15 / len(nodes)], (len(nodes), 1))
            solution = pg.solve(
                mesh,
                pg.LoadPath(nodes=nodes, forces=forces, load_factors=[0.5, 1.0]),
                materials={
                    0: pg.NeoHookean(youngs_modulus_pa=3000.0, poissons_ratio=nu)
                },
                fixed="fixed",
                element=element,
            )
            corner = np.flatnonzero((mesh.points == 40.0).all(axis=1))
            found.append(solution.displacement[-1, corner, 2].mean())
        axes.plot(SIZES, found, "o-", c=colour, label=element)
    axes.set(xlabel="cells a side", title=f"Poisson's ratio {nu}", xticks=SIZES)
panels[0].set(ylabel="rise of the loaded edge, mm", ylim=(0, None))
panels[0].legend()
save(figure, "elements")
