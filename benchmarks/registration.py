"""Registration in silico: simulate a shift, measure 50 points, recover the rest.

    OMP_NUM_THREADS=2 python benchmarks/registration.py --cases 24

The truth is simulated on another mesh than the one that is registered, finer, with
other materials (Poisson's ratio, stiffness of the tumour) and other points held by the
skull, under loads outside the span of the load modes: weight in a random direction near
the craniotomy's, a retractor's narrow patch, and a pull on the tumour. Fifty points
within 30 mm of the craniotomy are measured with 0.5 to 1 mm of noise a coordinate, of
which the registration is told the middle, 0.75 mm.

Target registration error (TRE): distance between true and registered place of every
mesh point; over the whole brain, within 50 mm of the craniotomy, and in the tumour.
Printed as mean over cases (largest case mean), mm, against rigid motion, a thin-plate
spline through the points, and one that is also told that 60 points of the skull stay
where they are; smoothing of the splines by ten-fold cross-validation.
"""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator
from scipy.spatial.transform import Rotation

from physgnn.geometry import (
    Complement,
    Phantom,
    Sphere,
    TetMesh,
    boundary_faces,
    boundary_points,
    mni152_phantom,
    select,
    tetrahedralize,
)
from physgnn.geometry.point_pairs import PointPairs
from physgnn.mechanics import LoadPath, NeoHookean, RestState, Solver
from physgnn.prediction.registration import Registrar

FloatArray = NDArray[np.float64]
EXPOSED_MM, NEAR_MM, N_MEASURED, N_SKULL = 30.0, 50.0, 50, 60
NOISE_MM, TOLD_MM = (0.5, 1.0), 0.75
SHIFT_MM = (5.0, 12.0)
HELD_MM, TRUE_HELD_MM = 75.0, 80.0
BUCKLED = 1.5  # times the linear answer
MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
TRUE_MATERIALS = {0: NeoHookean(2500.0, 0.45), 1: NeoHookean(9000.0, 0.47)}


def held(mesh: TetMesh, phantom: Phantom, radius_mm: float) -> TetMesh:
    """Hold the surface outside of a sphere about the craniotomy."""
    opening = Sphere(tuple(phantom.craniotomy_point), radius_mm)
    return mesh.with_point_sets(fixed=select(mesh, Complement(opening)))


@dataclass(frozen=True)
class Case:
    """A true shift and what was measured of it."""

    pairs: PointPairs
    displacement: FloatArray
    seconds: float


class Truth:
    """Simulates shifts of a body that the registration does not know."""

    def __init__(self, n_points: int) -> None:
        self.phantom = mni152_phantom(n_points=900)
        surfaces = self.phantom.brain, self.phantom.tumours
        mesh = tetrahedralize(*surfaces, target_points=n_points)
        self.mesh = held(mesh, self.phantom, TRUE_HELD_MM)
        self.rest = RestState(self.mesh, TRUE_MATERIALS)
        self.solver = Solver(self.mesh, TRUE_MATERIALS)
        surface = boundary_points(self.mesh)
        self.free = np.setdiff1d(surface, self.rest.fixed)
        offset = self.mesh.points[self.free] - self.phantom.craniotomy_point
        self.exposed = self.free[np.linalg.norm(offset, axis=1) < EXPOSED_MM]
        faces = boundary_faces(self.mesh)
        self.faces = faces[np.isin(faces, self.exposed).all(axis=1)]

    def case(self, seed: int) -> Case:
        """Simulate a shift and measure it."""
        rng = np.random.default_rng(seed)
        wanted = rng.uniform(*SHIFT_MM)
        forces = self._forces(rng)
        forces *= wanted / np.linalg.norm(self.rest.solve(forces), axis=1).max()
        loaded = np.setdiff1d(np.arange(self.mesh.n_points), self.rest.fixed)
        path = LoadPath(loaded, forces[loaded], np.arange(1, 9) / 8)
        solution = self.solver.solve(path)
        reached = np.linalg.norm(solution.displacement, axis=2).max(axis=1)
        # a body that buckles under a retractor is no brain any more
        sound = reached < BUCKLED * wanted * path.load_factors
        u = solution.displacement[np.argmin(np.where(sound, abs(reached - wanted), 99))]
        corners = self.faces[rng.choice(len(self.faces), N_MEASURED)]
        weights = rng.dirichlet(np.ones(3), N_MEASURED)
        source, moved = (
            np.einsum("ni,nij->nj", weights, field[corners])
            for field in (self.mesh.points, self.mesh.points + u)
        )
        noise = rng.normal(scale=rng.uniform(*NOISE_MM), size=source.shape)
        return Case(PointPairs(source, moved + noise), u, solution.seconds)

    def _forces(self, rng: np.random.Generator) -> FloatArray:
        """Weight, a retractor and a pull on the tumour, in random proportions."""
        mesh, phantom = self.mesh, self.phantom
        inward = mesh.points.mean(axis=0) - phantom.craniotomy_point
        inward /= np.linalg.norm(inward)
        share = np.zeros(mesh.n_points)
        np.add.at(share, mesh.cells, mesh.cell_volumes[:, None] / 4)
        weight = share[:, None] * _near(rng, inward, 40.0)
        centre = mesh.points[rng.choice(self.exposed)]
        width = rng.uniform(15.0, 25.0)
        square = ((mesh.points - centre) ** 2).sum(axis=1) / (2 * width**2)
        retractor = np.zeros_like(weight)
        retractor[self.free] = np.exp(-square)[self.free, None] * _near(
            rng, inward, 60.0
        )
        tumour = np.unique(mesh.cells[mesh.region == 1])
        pull = np.zeros_like(weight)
        pull[tumour] = share[tumour, None] * _near(rng, inward, 180.0)
        parts = [weight, retractor, pull]
        largest = [np.linalg.norm(self.rest.solve(f), axis=1).max() for f in parts]
        amounts = rng.uniform([0.3, 0.0, 0.0], [1.0, 0.5, 0.2])
        return sum(
            a / size * f for a, size, f in zip(amounts, largest, parts, strict=True)
        )


def _near(
    rng: np.random.Generator, direction: FloatArray, degrees: float
) -> FloatArray:
    axis = np.cross(direction, rng.normal(size=3))
    turn = np.deg2rad(rng.uniform(0, degrees)) * axis / np.linalg.norm(axis)
    return Rotation.from_rotvec(turn).apply(direction)


def rigid(pairs: PointPairs, points: FloatArray) -> FloatArray:
    """Displacement of the rigid motion that fits the pairs best."""
    middle, to = pairs.source.mean(axis=0), pairs.target.mean(axis=0)
    turn, _ = Rotation.align_vectors(pairs.target - to, pairs.source - middle)
    return turn.apply(points - middle) + to - points


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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--points", type=int, default=3000)
    parser.add_argument("--first-seed", type=int, default=0)
    arguments = parser.parse_args()
    truth = Truth(n_points=int(1.5 * arguments.points))
    phantom = mni152_phantom(n_points=600)
    mesh = tetrahedralize(
        phantom.brain, phantom.tumours, target_points=arguments.points
    )
    mesh = held(mesh, phantom, HELD_MM)
    registrar = Registrar(mesh, MATERIALS)
    x = truth.mesh.points
    anchors = mesh.points[
        np.random.default_rng(0).choice(mesh.point_set("fixed"), N_SKULL)
    ]
    locate = _sampler(mesh, x)
    methods: Mapping[str, Callable[[PointPairs], FloatArray]] = {
        "rigid": lambda pairs: rigid(pairs, x),
        "thin-plate spline": lambda pairs: spline(pairs, x),
        "spline with skull": lambda pairs: spline(pairs, x, anchors),
    }
    where = {
        "brain": np.ones(len(x), dtype=bool),
        "near": np.linalg.norm(x - phantom.craniotomy_point, axis=1) < NEAR_MM,
        "tumour": np.isin(np.arange(len(x)), truth.mesh.cells[truth.mesh.region == 1]),
    }
    print(
        f"truth {truth.mesh.n_points} points, registered {mesh.n_points}; "
        f"{len(truth.exposed)} points exposed, {N_MEASURED} measured"
    )
    rows: dict[str, list[list[float]]] = {}
    ratios, seconds = [], []
    for seed in range(arguments.first_seed, arguments.first_seed + arguments.cases):
        case = truth.case(seed)
        answers = {"no registration": np.zeros_like(x)}
        answers |= {name: method(case.pairs) for name, method in methods.items()}
        line = registrar(case.pairs, noise_mm=TOLD_MM, linear=True)
        found = registrar(case.pairs, noise_mm=TOLD_MM)
        answers["linear"] = locate(line.prediction.displacement)
        answers["nonlinear"] = locate(found.prediction.displacement)
        for name, answer in answers.items():
            error = np.linalg.norm(answer - case.displacement, axis=1)
            rows.setdefault(name, []).append([error[m].mean() for m in where.values()])
        error = np.linalg.norm(answers["nonlinear"] - case.displacement, axis=1)
        bound = found.prediction.error_estimate_mm
        ratios.append([error.mean() / bound.mean_mm, error.max() / bound.max_mm])
        seconds.append(found.prediction.seconds)
        largest = np.linalg.norm(case.displacement, axis=1).max()
        print(
            f"{seed:3d}: shift {largest:5.1f} mm, TRE {error.mean():.2f} ≤ "
            f"{bound.mean_mm:.2f}, largest {error.max():.2f} ≤ {bound.max_mm:.2f}; "
            f"tumour {rows['nonlinear'][-1][2]:.2f}; held out "
            f"{found.held_out_mm:.2f}; {found.prediction.status}, "
            f"{found.prediction.seconds:.1f} s"
        )
    print(f"\n{'TRE, mm':<20}" + "".join(f"{name:>16}" for name in where))
    for name, values in rows.items():
        cells = zip(np.mean(values, axis=0), np.max(values, axis=0), strict=True)
        print(f"{name:<20}" + "".join(f"{m:9.2f} ({w:4.1f})" for m, w in cells))
    mean_kept, max_kept = np.mean(np.array(ratios) <= 1.0, axis=0)
    mean_ratio, max_ratio = np.quantile(ratios, 0.9, axis=0)
    print(
        f"\nerror bound kept: mean {mean_kept:.0%}, largest {max_kept:.0%} of cases "
        f"(90% promised); error over bound at the 90th percentile: mean "
        f"{mean_ratio:.2f}, largest {max_ratio:.2f}\n"
        f"{np.median(seconds):.1f} s a case (median)"
    )


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
