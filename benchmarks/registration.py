"""Registration in silico: simulate a shift, measure the surface, recover the rest.

    OMP_NUM_THREADS=2 python benchmarks/registration.py --cases 24
    OMP_NUM_THREADS=2 python benchmarks/registration.py --cases 24 --skull sliding

The truth is of `physgnn.evaluation.in_silico.shifts`: another mesh, other tissue, other
loads. Within 30 mm of the craniotomy two things are measured with 0.5 to 1 mm of noise
a coordinate, of which the registration is told the middle, 0.75 mm: how 50 points
moved, and where 2000 points of the surface lie, without telling which point is which.

Target registration error (TRE): distance between true and registered place of every
mesh point; over the whole brain, within 50 mm of the craniotomy, and in the tumour.
Printed as mean over cases (largest case mean), mm, against rigid motion, a thin-plate
spline through the points, and one that is also told that 60 points of the skull stay
where they are; smoothing of the splines by ten-fold cross-validation. For a surface
they have the nearest points of the body at rest, the rigid motion by iterated matching.
"""

import argparse
from collections.abc import Mapping

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.evaluation.in_silico.compared import (
    SHIFT_METHODS,
    TOLD_MM,
    Compared,
    ShiftMeasured,
)
from physgnn.evaluation.in_silico.peers import spline
from physgnn.evaluation.in_silico.shifts import Truth
from physgnn.registration.registrar import Registration

NEAR_MM = 50.0


def displacements(
    body: Compared, measured: ShiftMeasured
) -> tuple[dict[str, FloatArray], Registration]:
    """Return the displacement of the true points by every method."""
    found = body.registrar(measured, noise_mm=TOLD_MM)
    plain = spline(body.pairs(measured), body.x)
    return {
        "no registration": SHIFT_METHODS["zero"](body, measured),
        "rigid": SHIFT_METHODS["rigid"](body, measured),
        "thin-plate spline": plain,
        "spline with skull": SHIFT_METHODS["spline"](body, measured),
        "linear": SHIFT_METHODS["linear"](body, measured),
        "nonlinear": body.at_truth(found.prediction.displacement),
    }, found


class Table:
    """What came out for one kind of measurement, case by case."""

    def __init__(self, kind: str, where: Mapping[str, BoolArray]) -> None:
        self._kind, self._where = kind, where
        self._rows: dict[str, list[list[float]]] = {}
        self._ratios: list[list[float]] = []
        self._seconds: list[float] = []

    def add(
        self,
        truth: FloatArray,
        displacements: Mapping[str, FloatArray],
        found: Registration,
    ) -> str:
        """Take in one case and return a line about it."""
        for name, displacement in displacements.items():
            error = np.linalg.norm(displacement - truth, axis=1)
            means = [error[inside].mean() for inside in self._where.values()]
            self._rows.setdefault(name, []).append(means)
        bound, seconds = found.prediction.error_estimate_mm, found.prediction.seconds
        self._ratios.append([error.mean() / bound.mean_mm, error.max() / bound.max_mm])
        self._seconds.append(seconds)
        return (
            f"    {self._kind}: TRE {error.mean():.2f} ≤ {bound.mean_mm:.2f}, largest "
            f"{error.max():.2f} ≤ {bound.max_mm:.2f}; tumour {means[-1]:.2f}; held out "
            f"{found.held_out_mm:.2f}; {found.prediction.status}, {seconds:.1f} s"
        )

    def __str__(self) -> str:
        lines = [f"{self._kind + ': TRE, mm':<20}"]
        lines[0] += "".join(f"{name:>16}" for name in self._where)
        for name, values in self._rows.items():
            cells = zip(np.mean(values, axis=0), np.max(values, axis=0), strict=True)
            text = "".join(f"{m:9.2f} ({w:4.1f})" for m, w in cells)
            lines.append(f"{name:<20}{text}")
        mean_kept, max_kept = np.mean(np.array(self._ratios) <= 1.0, axis=0)
        mean_ratio, max_ratio = np.quantile(self._ratios, 0.9, axis=0)
        lines.append(
            f"error bound kept: mean {mean_kept:.0%}, largest {max_kept:.0%} of cases "
            f"(90% promised); error over bound at the 90th percentile: mean "
            f"{mean_ratio:.2f}, largest {max_ratio:.2f}; "
            f"{np.median(self._seconds):.1f} s a case (median)"
        )
        return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--points", type=int, default=3000)
    parser.add_argument(
        "--seed", "--first-seed", dest="first_seed", type=int, default=0
    )
    parser.add_argument("--skull", choices=("fixed", "sliding"), default="fixed")
    parser.add_argument("--assumed", choices=("fixed", "sliding"))
    arguments = parser.parse_args()
    truth = Truth(int(1.5 * arguments.points), arguments.skull)
    x = truth.mesh.points
    body = Compared(arguments.points, arguments.assumed or arguments.skull, x)
    offset = np.linalg.norm(x - truth.phantom.craniotomy_point, axis=1)
    tumour = truth.mesh.cells[truth.mesh.region == 1]
    where = {
        "brain": np.ones(len(x), dtype=bool),
        "near": offset < NEAR_MM,
        "tumour": np.isin(np.arange(len(x)), tumour),
    }
    tables = {kind: Table(kind, where) for kind in ("pairs", "surface")}
    print(
        f"truth {truth.mesh.n_points} points, registered {body.mesh.n_points}; "
        f"{len(truth.exposed)} points exposed; skull {arguments.skull}, taken for "
        f"{body.registrar.skull}"
    )
    for seed in range(arguments.first_seed, arguments.first_seed + arguments.cases):
        case = truth.case(seed)
        largest = np.linalg.norm(case.displacement, axis=1).max()
        print(f"{seed:3d}: shift {largest:5.1f} mm")
        for kind, table in tables.items():
            moved, found = displacements(body, getattr(case, kind))
            print(table.add(case.displacement, moved, found), flush=True)
    for table in tables.values():
        print(f"\n{table}")


if __name__ == "__main__":
    main()
