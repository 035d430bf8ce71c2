"""Leave one out on the landmarks of a real operation, RESECT case 1.

    OMP_NUM_THREADS=1 python benchmarks/registration_resect.py before_after.tag

Thirteen landmarks inside a patient's brain, before and after the resection, by
ultrasound (Xiao et al., Medical Physics 44, 2017, 3875-3882; CC BY 4.0). There is no
image: the points lie in the bundled template brain as they are, opened about the cortex
nearest to their middle. Each is predicted from the twelve others, by no registration,
by their mean, by the rigid motion nearest to them, and by the body's, with an offset of
the navigation and without. Noise is the default, 1 mm; nothing was chosen after a look
at these points. Prints the mean error and, of each method, its mean difference from
rigid with the 95 % interval of a paired bootstrap over the points (Efron & Tibshirani,
*An Introduction to the Bootstrap*, 1993, section 13.3).
"""

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.compared import HELD_MM, MATERIALS
from physgnn.evaluation.in_silico.peers import rigid
from physgnn.geometry import boundary_points, mni152_phantom, tetrahedralize
from physgnn.geometry.measured import Landmarks, PointPairs
from physgnn.geometry.point_sets import Complement, Sphere, select
from physgnn.mechanics.body import Body
from physgnn.registration.measurements.places import cell_interpolation
from physgnn.registration.registrar import Registrar
from tables import machine, table

DRAWS = 10_000
Method = Callable[[Landmarks, FloatArray], FloatArray]


def read_tags(path: Path) -> Landmarks:
    """Read the pairs of an MNI tag file of two volumes, RAS mm."""
    rows = path.read_text("utf-8").split("Points =")[1].split(";")[0].splitlines()
    ends = np.array([row.split()[:6] for row in rows if row.strip()], dtype=float)
    return Landmarks(ends[:, :3], ends[:, 3:])


class Brain:
    """The template, opened above some points."""

    def __init__(self, n_points: int, points: FloatArray) -> None:
        phantom = mni152_phantom(n_points=600)
        mesh = tetrahedralize(phantom.brain, (), target_points=n_points)
        outer = mesh.points[boundary_points(mesh)]
        middle = points.mean(axis=0)
        nearest = outer[np.linalg.norm(outer - middle, axis=1).argmin()]
        opening = Complement(Sphere(tuple(nearest), HELD_MM))
        self.mesh = mesh.with_point_sets(fixed=select(mesh, opening))
        self._registrar = Registrar(Body(self.mesh, MATERIALS), causes=())

    def predicted(self, kept: Landmarks, at: FloatArray, *, offset: bool) -> FloatArray:
        """Return how points move after the registration of others."""
        found = self._registrar(kept, rigid_offset=offset)
        places = cell_interpolation(self.mesh, at, ("left out",) * len(at))
        moved: FloatArray = places @ found.prediction.displacement
        if offset:
            there = at + moved - found.offset.centre_mm
            turn = np.deg2rad(found.offset.rotation_deg)
            moved = moved + found.offset.translation_mm + np.cross(turn, there)
        return moved


def left_out(landmarks: Landmarks, method: Method) -> FloatArray:
    """Return the error of each point as the others predict it, mm."""
    errors = []
    for i in range(len(landmarks.source)):
        kept = np.arange(len(landmarks.source)) != i
        others = Landmarks(landmarks.source[kept], landmarks.target[kept])
        moved = method(others, landmarks.source[[i]])
        errors.append(np.linalg.norm(landmarks.displacement[[i]] - moved))
    return np.array(errors)


def difference(errors: FloatArray, rigid_errors: FloatArray) -> str:
    """Return the mean difference from rigid, and its interval over the points."""
    away = errors - rigid_errors
    chosen = np.random.default_rng(0).integers(len(away), size=(DRAWS, len(away)))
    low, high = np.quantile(away[chosen].mean(axis=1), [0.025, 0.975])
    return f"{away.mean():+.2f} ({low:+.2f} to {high:+.2f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("tags", type=Path)
    parser.add_argument("--points", type=int, default=1500)
    options = parser.parse_args()
    print(machine())
    landmarks = read_tags(options.tags)
    brain = Brain(options.points, landmarks.source)
    methods: Mapping[str, Method] = {
        "no registration": lambda _, at: np.zeros_like(at),
        "mean": lambda kept, at: np.tile(kept.displacement.mean(axis=0), (len(at), 1)),
        "rigid": lambda kept, at: rigid(PointPairs(kept.source, kept.target), at),
        "ours": lambda kept, at: brain.predicted(kept, at, offset=False),
        "ours, offset": lambda kept, at: brain.predicted(kept, at, offset=True),
    }
    errors = {name: left_out(landmarks, method) for name, method in methods.items()}
    rows = [
        (
            name,
            f"{of.mean():.2f}",
            f"{of.max():.2f}",
            "" if name == "rigid" else difference(of, errors["rigid"]),
        )
        for name, of in errors.items()
    ]
    table(("left out", "mean, mm", "largest", "minus rigid (95 %)"), rows)


if __name__ == "__main__":
    main()
