"""What physiological causes in the prior are worth, in silico.

    OMP_NUM_THREADS=1 python benchmarks/registration_causes.py --cases 4

The truth is on a finer mesh with other tissue and another line of support than the mesh
that is registered (`physgnn.evaluation.in_silico.shifts`). It moves by one cause:
tissue within 25 mm of the tumour swells, all brain contracts, the brain sags as the
fluid drains, or the tumour is taken out and the cavity falls together as the fluid
drains; or by forces that are none of them. 40 points of the cortex are measured with
0.75 mm of noise a coordinate.

Prints the shift and the error, mean over all points and cases, mm, with and without the
causes in the prior; of the cavity also when the tumour is left in. After that, how
often the bound on the largest error held.
"""

import argparse
from collections.abc import Mapping

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.cases import EXPOSED_MM
from physgnn.evaluation.in_silico.compared import HELD_MM, MATERIALS
from physgnn.evaluation.in_silico.physiological_shifts import (
    PhysiologicalShift,
    collapse,
    contraction,
    sag,
    swelling,
)
from physgnn.evaluation.in_silico.shifts import Truth, held
from physgnn.geometry import TetMesh, mni152_phantom, tetrahedralize
from physgnn.geometry.measured import PointPairs
from physgnn.imaging.point_displacement import displacement_at
from physgnn.mechanics.body import Body
from physgnn.registration.registrar import Registrar
from physgnn.registration.removed_region import resected
from tables import machine, table

N_PAIRS, NOISE_MM = 40, 0.75


def forces(truth: Truth, rng: np.random.Generator) -> tuple[TetMesh, FloatArray]:
    """Push by weight, a retractor and a pull on the tumour."""
    return truth.mesh, truth.case(int(rng.integers(1 << 30))).displacement


SHIFTS: Mapping[str, PhysiologicalShift] = {
    "swelling near the tumour": swelling,
    "contraction of all brain": contraction,
    "sag": sag,
    "cavity that collapses": collapse,
    "forces, no cause of these": forces,
}


def measured(
    truth: Truth, mesh: TetMesh, u: FloatArray, rng: np.random.Generator
) -> PointPairs:
    """Return pairs of points of the exposed cortex, none of them of a cavity."""
    away = np.linalg.norm(mesh.points - truth.phantom.craniotomy_point, axis=1)
    cortex = {tuple(x) for x in truth.mesh.points[truth.exposed]}
    there = [
        i for i in np.flatnonzero(away < EXPOSED_MM) if tuple(mesh.points[i]) in cortex
    ]
    chosen = rng.choice(there, min(N_PAIRS, len(there)), replace=False)
    noise = rng.normal(scale=NOISE_MM, size=(len(chosen), 3))
    return PointPairs(mesh.points[chosen], mesh.points[chosen] + u[chosen] + noise)


class Registrars:
    """The mesh that is registered, with and without causes and tumour."""

    def __init__(self, n_points: int) -> None:
        phantom = mni152_phantom(n_points=600)
        mesh = tetrahedralize(phantom.brain, phantom.tumours, target_points=n_points)
        whole = held(mesh, phantom, HELD_MM)
        rest = resected(whole, "tumour").remaining
        self.whole = {
            "with causes": Registrar(Body(whole, MATERIALS)),
            "without": Registrar(Body(whole, MATERIALS), causes=()),
        }
        self.rest = {
            "with causes": Registrar(Body(rest, MATERIALS)),
            "without": Registrar(Body(rest, MATERIALS), causes=()),
            "tumour left in": self.whole["without"],
        }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=4)
    parser.add_argument("--points", type=int, default=3000)
    parser.add_argument("--true-points", type=int, default=5000)
    asked = parser.parse_args()
    print(machine())
    truth, registrars = Truth(asked.true_points, "fixed"), Registrars(asked.points)
    rows = []
    for name, shift in SHIFTS.items():
        cavity = shift is collapse
        of_kind = registrars.rest if cavity else registrars.whole
        sizes: list[float] = []
        errors: dict[str, list[float]] = {one: [] for one in of_kind}
        kept = dict.fromkeys(of_kind, 0)
        for seed in range(asked.cases):
            rng = np.random.default_rng(seed)
            mesh, u = shift(truth, rng)
            pairs = measured(truth, mesh, u, rng)
            sizes.append(float(np.linalg.norm(u, axis=1).mean()))
            for one, registrar in of_kind.items():
                found = registrar(pairs, noise_mm=NOISE_MM)
                body, estimate = registrar.body.mesh, found.prediction.error_estimate_mm
                at = displacement_at(body, found.prediction.displacement, mesh.points)
                error = np.linalg.norm(at.vectors - u, axis=1)
                errors[one].append(float(error.mean()))
                kept[one] += estimate is not None and error.max() <= estimate.max_mm
        for one in of_kind:
            mean = f"{np.mean(errors[one]):.3f}"
            held_by = f"{kept[one]} of {asked.cases}"
            rows.append([name, f"{np.mean(sizes):.2f}", one, mean, held_by])
    table(["shift by", "mean shift", "prior", "mean error", "bounds held"], rows)


if __name__ == "__main__":
    main()
