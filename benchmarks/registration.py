"""Registration in silico: simulate a shift, measure the surface, recover the rest.

    OMP_NUM_THREADS=2 python benchmarks/registration.py --cases 24
    OMP_NUM_THREADS=2 python benchmarks/registration.py --cases 24 --skull sliding

The truth is of `benchmarks/shifts.py`: another mesh, other tissue, other loads. Within
30 mm of the craniotomy two things are measured with 0.5 to 1 mm of noise a coordinate,
of which the registration is told the middle, 0.75 mm: how 50 points moved, and where
2000 points of the surface lie, without telling which point is which.

Target registration error (TRE): distance between true and registered place of every
mesh point; over the whole brain, within 50 mm of the craniotomy, and in the tumour.
Printed as mean over cases (largest case mean), mm, against rigid motion, a thin-plate
spline through the points, and one that is also told that 60 points of the skull stay
where they are; smoothing of the splines by ten-fold cross-validation. For a surface
they have the nearest points of the body at rest, the rigid motion by iterated matching.
"""

import argparse
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pyvista as pv
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry import TetMesh, boundary_surface, mni152_phantom, tetrahedralize
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.registration.measurements.surfaces import N_SURFACE_POINTS
from physgnn.registration.registrar import Registrar
from physgnn.registration.result import Registration
from shifts import EXPOSED_MM, Truth, held

NEAR_MM, N_SKULL, ICP_STEPS = 50.0, 60, 30
HELD_MM, TOLD_MM = 75.0, 0.75
MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


def rigid(pairs: PointPairs, points: FloatArray) -> FloatArray:
    """Displacement of the rigid motion that fits the pairs best."""
    middle, to = pairs.source.mean(axis=0), pairs.target.mean(axis=0)
    turn, _ = Rotation.align_vectors(pairs.target - to, pairs.source - middle)
    return turn.apply(points - middle) + to - points


def nearest_pairs(surface: SurfacePoints, body: FloatArray) -> PointPairs:
    """Pair each measured point with the nearest of a body's."""
    return PointPairs(body[cKDTree(body).query(surface.points)[1]], surface.points)


def rigid_icp(
    surface: SurfacePoints, body: FloatArray, points: FloatArray
) -> FloatArray:
    """Displacement of the rigid motion found by matching again and again."""
    seen, moved = body.copy(), points.copy()
    for _ in range(ICP_STEPS):
        pairs = nearest_pairs(surface, seen)
        seen, moved = seen + rigid(pairs, seen), moved + rigid(pairs, moved)
    return moved - points


def spline(
    pairs: PointPairs, points: FloatArray, anchors: FloatArray | None = None
) -> FloatArray:
    """Displacement of a thin-plate spline; anchors, if there are any, stay."""
    n = len(pairs.source)
    extra = np.empty((0, 3)) if anchors is None else anchors
    x = np.concatenate([pairs.source, extra])
    d = np.concatenate([pairs.displacement, np.zeros_like(extra)])

    def left_out(smoothing: float) -> float:
        residual = []
        for held_out in np.array_split(np.random.default_rng(0).permutation(n), 10):
            kept = np.setdiff1d(np.arange(len(x)), held_out)
            model = RBFInterpolator(x[kept], d[kept], smoothing=smoothing)
            residual.append(model(x[held_out]) - d[held_out])
        return float((np.concatenate(residual) ** 2).sum())

    best = min(np.logspace(0, 9, 10), key=left_out)
    return RBFInterpolator(x, d, smoothing=best)(points)


class Compared:
    """The mesh that is registered, and what else it may be compared with."""

    def __init__(
        self,
        n_points: int,
        skull: str,
        x: FloatArray,
        causes: Sequence[str] | None = (),
    ) -> None:
        phantom = mni152_phantom(n_points=600)
        surfaces = phantom.brain, phantom.tumours
        mesh = tetrahedralize(*surfaces, target_points=n_points)
        self.mesh = held(mesh, phantom, HELD_MM)
        body = Body(self.mesh, MATERIALS)
        self.registrar = Registrar(body, skull=skull, causes=causes)
        self._x, self._locate = x, _sampler(self.mesh, x)
        chosen = np.random.default_rng(0).choice(self.mesh.point_set("fixed"), N_SKULL)
        self._anchors = self.mesh.points[chosen]
        outer = boundary_surface(self.mesh)
        middles = outer.points[outer.faces].mean(axis=1)
        exposed = np.concatenate([mesh.points[np.unique(outer.faces)], middles])
        offset = np.linalg.norm(exposed - phantom.craniotomy_point, axis=1)
        self._exposed = exposed[offset < EXPOSED_MM]

    def at_truth(self, displacement: FloatArray) -> FloatArray:
        """Return a displacement of the registered mesh at the true points."""
        return self._locate(displacement)

    def displacements(
        self, measured: PointPairs | SurfacePoints
    ) -> tuple[dict[str, FloatArray], Registration]:
        """Return the displacement of the true points by every method."""
        x = self._x
        if isinstance(measured, PointPairs):
            pairs, moved = measured, rigid(measured, x)
        else:
            few = measured.thinned(N_SURFACE_POINTS)
            pairs, moved = (
                nearest_pairs(few, self._exposed),
                rigid_icp(few, self._exposed, x),
            )
        line = self.registrar(measured, noise_mm=TOLD_MM, linear=True)
        found = self.registrar(measured, noise_mm=TOLD_MM)
        return {
            "no registration": np.zeros_like(x),
            "rigid": moved,
            "thin-plate spline": spline(pairs, x),
            "spline with skull": spline(pairs, x, self._anchors),
            "linear": self._locate(line.prediction.displacement),
            "nonlinear": self._locate(found.prediction.displacement),
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
            displacements, found = body.displacements(getattr(case, kind))
            print(table.add(case.displacement, displacements, found), flush=True)
    for table in tables.values():
        print(f"\n{table}")


def _sampler(mesh: TetMesh, x: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return a function that interpolates fields of a mesh at points.

    A point just outside takes the value of the nearest place of the nearest cell.
    """
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    corners = mesh.cells[grid.find_closest_cell(x)]
    first, edges = mesh.points[corners[:, 0]], mesh.points[corners[:, 1:]]
    edges = np.moveaxis(edges - first[:, None], 1, 2)
    others = np.linalg.solve(edges, (x - first)[..., None])[..., 0]
    weights = np.column_stack([1.0 - others.sum(axis=1), others]).clip(0.0)
    weights /= weights.sum(axis=1, keepdims=True)
    return lambda u: np.einsum("ni,nij->nj", weights, u[corners])


if __name__ == "__main__":
    main()
