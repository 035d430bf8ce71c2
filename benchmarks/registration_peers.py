"""Registrations in silico beside rigid motions, splines and image-based ones.

    OMP_NUM_THREADS=1 ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS=1 \
        python benchmarks/registration_peers.py --cases 20
    python benchmarks/registration_peers.py --cases 0   # only print what the log has

The truth is of `physgnn.evaluation.in_silico`: a finer mesh, other tissue and another
line of support than the mesh that is registered. It moves by forces that are none of
our load modes ("shift"), sags as the fluid drains ("sag"), or its tumour is taken out
and the cavity falls together as the fluid drains ("resection").

Each is measured four ways (`KINDS`): 40 pairs on the surface, 2000 points of it without
pairs, 15 landmarks inside, and all together, with 0.5 to 1 mm of noise a coordinate. A
shift is measured well, with outliers, with swapped pairs, and 3 mm and 1.5° off as a
whole (`physgnn.evaluation.in_silico.measurement_errors`), without and with six points
of the bone; sag and resection are measured well. All methods get the same. Our
registration and linear elasticity, its first step, run as a user would have them: with
``--remove tumour`` after a resection, ``--rigid-offset`` where the navigation is off,
or ``--bone``; for the others, the rigid motion of the bone corrects what was measured.
The spline is told where the skull holds. It and the rigid motion take the points of a
surface only where there is nothing else. The registered tumour and craniotomy lie 7 and
9 mm beside the true ones; what was resected is known exactly.

Image-based registrations take the scans before and after
(`physgnn.evaluation.in_silico.simulated_images`), of other contrast each. After a
resection the tumour is gone from the second, and painted over in the first.

Target registration error: distance between true and registered place of every mesh
point; over the whole brain, within 50 mm of the craniotomy, and of the tumour, or the
wall of its cavity. Printed as mean over cases (largest mean of a case), mm. What the
log has is not measured again.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from held_out import USABLE, Log
from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.cases import BONE_NOISE_MM, Case
from physgnn.evaluation.in_silico.compared import SHIFT_METHODS, TOLD_MM
from physgnn.evaluation.in_silico.image_peers import IMAGE_METHODS
from physgnn.evaluation.in_silico.measurement_errors import (
    MEASUREMENT_ERRORS,
    given,
    moved_to,
    offset,
)
from physgnn.evaluation.in_silico.operations import PHYSIOLOGICAL, Operations
from physgnn.evaluation.in_silico.peers import rigid
from physgnn.evaluation.in_silico.simulated_images import (
    INTRAOPERATIVE,
    PREOPERATIVE,
    simulated_scan,
)
from physgnn.geometry.measured import PointPairs
from physgnn.imaging.field import grid_around
from registration_bounds import held
from tables import machine, table

VOXEL_MM, MARGIN_MM = 2.0, 12.0
KINDS = ("pairs", "surface", "landmarks", "all")
WITH_BONE = "offset with bone"
OF_SHIFTS = (*MEASUREMENT_ERRORS, WITH_BONE)
CONDITIONS = (*OF_SHIFTS, *PHYSIOLOGICAL)
OURS = ("linear", "register")
POINT_METHODS = ("zero", "rigid", "spline", *OURS)
METHODS = (*POINT_METHODS, *IMAGE_METHODS)
AREAS = {
    "brain": "whole brain",
    "near": "within 50 mm of the craniotomy",
    "tumour": "tumour, or the wall of its cavity",
}
LABELS = {
    "zero": "none",
    "rigid": "rigid",
    "spline": "spline with skull",
    "linear": "linear elasticity",
    "register": "**hyperelastic**",
}
IMAGE = "image"  # what image-based registrations take


@dataclass(frozen=True)
class Way:
    """What is measured, what is the matter with it, and what registers it."""

    skull: str
    condition: str
    kind: str
    method: str

    def __str__(self) -> str:
        return ", ".join((self.skull, self.condition, self.kind, self.method))


def spoilt(case: Case, seed: int, way: Way) -> list[Any]:
    """Return what a method is given; bone corrects it for those that take none."""
    rng = np.random.default_rng(seed + 10_000)
    measured = given(case, way.kind)
    if way.condition != WITH_BONE:
        wrong = MEASUREMENT_ERRORS.get(way.condition, MEASUREMENT_ERRORS["clean"])
        return wrong(measured, rng)
    *measured, bone = offset([*measured, case.bone], rng)
    if way.method in OURS:
        return [*measured, bone]
    back = PointPairs(bone.target, bone.source)
    return [
        moved_to(one, lambda points: points + rigid(back, points)) for one in measured
    ]


def by_points(
    operations: Operations, seed: int, way: Way
) -> tuple[FloatArray, dict[str, Any]]:
    """Return the displacement from what was measured of points, and what is said."""
    moved = operations.moved(way.condition, seed)
    body = operations.compared(way.condition)
    measured = spoilt(moved.case, seed, way)
    if way.method not in OURS:
        return SHIFT_METHODS[way.method](body, measured), {}
    found = body.registrar(
        measured,
        noise_mm={**dict.fromkeys(KINDS, TOLD_MM), "bone": BONE_NOISE_MM},
        rigid_offset=way.condition == "offset",
        linear=way.method == "linear",
    )
    bound = found.prediction.error_estimate_mm
    assert bound is not None
    return body.at_truth(found.prediction.displacement), {
        "status": found.prediction.status.name,
        "reasons": list(found.prediction.reasons),
        "bound_mean": bound.mean_mm,
        "bound_max": bound.max_mm,
    }


def by_images(
    operations: Operations, seed: int, way: Way
) -> tuple[FloatArray, dict[str, Any]]:
    """Return the displacement from the scans before and after."""
    moved = operations.moved(way.condition, seed)
    mesh = moved.mesh
    grid = grid_around(mesh, spacing_mm=VOXEL_MM, margin_mm=MARGIN_MM)
    still = np.zeros_like(mesh.points)
    before = simulated_scan(mesh, still, grid, PREOPERATIVE, seed=2 * seed)
    u = moved.case.displacement
    after = simulated_scan(mesh, u, grid, INTRAOPERATIVE, seed=2 * seed + 1)
    return IMAGE_METHODS[way.method](before, after, mesh.points), {}


def ways(options: argparse.Namespace) -> Iterator[Way]:
    """Yield all that was asked for and has a meaning."""
    conditions = options.conditions.split(",")
    if options.skull == "sliding":  # the others are of a brain that is held
        conditions = [one for one in conditions if one in OF_SHIFTS]
    methods = options.methods.split(",")
    for condition in conditions:
        for kind in options.kinds.split(","):
            if (condition, kind) == ("swapped", "surface"):
                continue  # no pairs to swap
            for method in methods:
                if method not in IMAGE_METHODS:
                    yield Way(options.skull, condition, kind, method)
        if condition in ("clean", *PHYSIOLOGICAL):
            for method in methods:
                if method in IMAGE_METHODS:
                    yield Way(options.skull, condition, IMAGE, method)


def measured_row(operations: Operations, seed: int, way: Way) -> dict[str, Any]:
    """Return the errors of one registration and what it said of them."""
    found = by_images if way.kind == IMAGE else by_points
    displacement, said = found(operations, seed, way)
    moved = operations.moved(way.condition, seed)
    error = np.linalg.norm(displacement - moved.case.displacement, axis=1)
    areas = moved.areas
    means = {name: float(error[inside].mean()) for name, inside in areas.items()}
    return {**means, "max": float(error.max()), **said}


Groups = Mapping[tuple[str, str, str], Sequence[Mapping[str, Any]]]


def grouped(log: Log, skull: str) -> Groups:
    """Return the records of each condition, kind and method."""
    groups: dict[tuple[str, str, str], list[Mapping[str, Any]]] = {}
    for record in log.records:
        held, condition, kind, method = record["what"].split(", ")
        if held == skull:
            groups.setdefault((condition, kind, method), []).append(record)
    return groups


def cell(records: Sequence[Mapping[str, Any]], area: str) -> str:
    """Return the mean over cases and the largest of a case."""
    if not records:
        return ""
    errors = [record[area] for record in records]
    return f"{np.mean(errors):.2f} ({np.max(errors):.1f})"


def point_rows(groups: Groups, area: str) -> Iterator[list[str]]:
    """Yield a row for each condition and kind of measurement."""
    for condition in CONDITIONS:
        for kind in KINDS:
            of = [groups.get((condition, kind, one), ()) for one in POINT_METHODS]
            if any(of):
                counts = str(max(map(len, of)))
                yield [f"{kind}, {condition}", counts, *(cell(o, area) for o in of)]


def image_rows(groups: Groups) -> Iterator[list[str]]:
    """Yield image-based registrations beside ours, of the same cases."""
    for condition in ("clean", *PHYSIOLOGICAL):
        name = "shift" if condition == "clean" else condition
        rows = {"none": groups.get((condition, "pairs", "zero"), ())}
        rows |= {one: groups.get((condition, IMAGE, one), ()) for one in IMAGE_METHODS}
        rows |= {
            f"**hyperelastic**, {kind}": groups.get((condition, kind, "register"), ())
            for kind in KINDS
        }
        seeds = [{record["path"] for record in rows[one]} for one in IMAGE_METHODS]
        both = set.intersection(*seeds)
        for method, of in rows.items():
            kept = [record for record in of if record["path"] in both]
            if kept:
                cells = [cell(kept, area) for area in AREAS]
                yield [f"{name}, {method}", str(len(kept)), *cells]


def trust_rows(groups: Groups) -> Iterator[list[str]]:
    """Yield how often our registration was ok and how often its bounds held.

    A row for each kind and condition, for each of these alone, and for all.
    """
    ours = {
        (condition, kind): groups.get((condition, kind, "register"), ())
        for condition in CONDITIONS
        for kind in KINDS
    }
    rows = {f"{kind}, {condition}": of for (condition, kind), of in ours.items()}
    for name in (*KINDS, *CONDITIONS):
        rows[name] = [r for key, of in ours.items() if name in key for r in of]
    rows["all of them"] = [r for of in ours.values() for r in of]
    for name, of in rows.items():
        if of:
            ok = sum(record["status"] in USABLE for record in of)
            records = [{**record, "mean": record["brain"]} for record in of]
            bounds = held(records, "mean"), held(records, "max")
            yield [name, str(len(of)), str(ok), *bounds]


def show(log: Log, skull: str) -> None:
    """Print the tables of one skull."""
    groups = grouped(log, skull)
    if not groups:
        return
    print(f"\nskull {skull}, beside image-based registrations:\n")
    table(("images before and after", "cases", *AREAS.values()), image_rows(groups))
    for area, name in AREAS.items():
        print(f"\nskull {skull}, {name}:\n")
        table(("measured", "cases", *LABELS.values()), point_rows(groups, area))
    print(f"\nskull {skull}, what our registration says of itself:\n")
    head = ("measured", "cases", "ok", "mean bound held, of error", "largest")
    table(head, trust_rows(groups))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--log", type=Path, default=Path("registration-peers.jsonl"))
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--points", type=int, default=2000)
    parser.add_argument("--first-seed", type=int, default=3000)
    parser.add_argument("--skull", choices=("fixed", "sliding"), default="fixed")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--conditions", default=",".join(CONDITIONS))
    parser.add_argument("--methods", default=",".join(METHODS))
    options = parser.parse_args()
    print(machine())
    log, operations = Log(options.log), None
    for seed in range(options.first_seed, options.first_seed + options.cases):
        for way in ways(options):
            for _ in log.missing([(seed, 0)], str(way)):
                operations = operations or Operations(options.points, options.skull)
                row = measured_row(operations, seed, way)
                log.add(path=seed, level=1, what=str(way), **row)
    for skull in ("fixed", "sliding"):
        show(log, skull)


if __name__ == "__main__":
    main()
