"""A case for the picture of the live view: the bundled brain, and what was measured.

Writes `case.vtu`, the mesh that is registered, into a folder, and three states of a
brain that sags as its fluid drains: pairs of points on the cortex, and pairs inside,
such as those of ultrasound. They are simulated on another, finer mesh with other
tissue and a larger craniotomy, and have noise. `kept` is for what the page saves::

    python docs/figures/live_case.py patient/
"""

import sys
from pathlib import Path

import numpy as np

import physgnn as pg
from physgnn.geometry import boundary_points, boundary_surface, mni152_phantom
from physgnn.geometry.point_sets import select
from physgnn.mechanics import Gravity, LoadPath
from physgnn.stages.patient.preoperative.case_file import craniotomy_at

OPEN_MM, TRUE_OPEN_MM, DEEP_MM = 30.0, 36.0, 45.0
N_CORTEX, N_INSIDE, NOISE_MM = 30, 15, 0.7
DRAINED = np.array([0.3, 0.6, 0.9])  # of the weight that fluid carried
TISSUE = {0: pg.NeoHookean(2500.0, 0.45), 1: pg.NeoHookean(9000.0, 0.47)}
HEADER = "source_x,source_y,source_z,target_x,target_y,target_z"

folder = Path(sys.argv[1])
(folder / "kept").mkdir(parents=True, exist_ok=True)
phantom = mni152_phantom(n_points=1500)
surfaces, middle = (phantom.brain, phantom.tumours), phantom.craniotomy_point
pg.write_mesh(folder / "case.vtu", pg.tetrahedralize(*surfaces, target_points=5000))

mesh = pg.tetrahedralize(*surfaces, target_points=7000)
opened = craniotomy_at(boundary_surface(mesh), middle, TRUE_OPEN_MM)
mesh = mesh.with_point_sets(fixed=select(mesh, opened.fixed))
down = Gravity(tuple(mesh.points.mean(axis=0) - middle))
sagged = pg.solve(mesh, LoadPath.of(DRAINED, down), materials=TISSUE)

distance = np.linalg.norm(mesh.points - middle, axis=1)
cortex = boundary_points(mesh)
inside = np.setdiff1d(np.arange(mesh.n_points), cortex)
cortex, inside = cortex[distance[cortex] < OPEN_MM], inside[distance[inside] < DEEP_MM]
random = np.random.default_rng(0)
for state, moved in enumerate(sagged.displacement, start=1):
    for name, among, count in (
        ("cortex", cortex, N_CORTEX),
        ("ultrasound", inside, N_INSIDE),
    ):
        seen = random.choice(among, count, replace=False)
        before = mesh.points[seen]
        after = before + moved[seen] + random.normal(scale=NOISE_MM, size=before.shape)
        file = folder / f"{name}-{state}.csv"
        pairs = np.hstack([before, after])
        np.savetxt(file, pairs, fmt="%.2f", delimiter=",", header=HEADER, comments="")
    largest = np.linalg.norm(moved, axis=1).max()
    print(f"state {state}: the largest displacement is {largest:.1f} mm")
