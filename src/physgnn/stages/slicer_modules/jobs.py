"""What the modules do: they call the stages, with Slicer's kinds of files.

Slicer hands over volumes, models, markups and transforms as temporary files. Which axes
each is in, its header or field data says, and the readers and writers of `physgnn.io`
heed that. A mesh of ours stays a file: Slicer would lose its point sets.
"""

import inspect
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physgnn import stages
from physgnn.errors import InputError
from physgnn.progress import Log
from physgnn.scratch import scratch_folder
from physgnn.stages.slicer_modules.parameters import Job

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.prediction.prediction import Prediction

STATUS: str = "status"
REASON: str = "reason"
OK = "ok"
NOT_TOLD = "the displacement has none"
SHIFT = "shift"
FORMS = {"transform": "transform", "surfaces": "deformed"}
"""Parameter → the form of a displacement that goes there."""


def segment(job: Job) -> Mapping[str, Any]:
    """Segment a volume."""
    values = dict(job.values)
    out = _named(values, "segmentation")
    first = next(iter(_arguments("segment")))
    _call("segment", {first: values.pop("image"), **values, "out": out}, job)
    return {STATUS: OK}


def mesh(job: Job) -> Mapping[str, Any]:
    """Mesh a label map; points of a craniotomy say what the skull leaves free."""
    values = dict(job.values)
    surfaces = values.pop("surfaces", None)
    points, radius = values.pop("craniotomy", None), values.pop("radius_mm", None)
    out = _named(values, "mesh")
    with scratch_folder("slicer") as folder:
        if points is not None:
            values["sets"] = _write_sets(Path(folder), points, radius, job.log)
        made = _call("mesh", {**values, "out": out}, job)
    if surfaces is not None:
        import numpy as np

        from physgnn.io.vtk.prediction_file import write_deformed

        job.progress(1, 2, "surfaces")
        write_deformed(surfaces, made, np.zeros_like(made.points))
    return {STATUS: OK, "points": made.n_points}


def _write_sets(folder: Path, points: str, radius_mm: float, log: Log) -> Path:
    """Write the point sets about a craniotomy's middle, the mean of its points."""
    from physgnn.io.medical.markups import read_points

    found = read_points(points, log=log)
    if len(found) == 0:
        raise InputError("the craniotomy needs a point: place one on the cortex")
    centre = [float(x) for x in found.mean(axis=0)]
    sphere = f'{{ kind = "sphere", centre_mm = {centre}, radius_mm = {radius_mm} }}'
    path = folder / "sets.toml"
    path.write_text(
        f'[point_sets.fixed]\nkind = "complement"\nof = {sphere}\n', encoding="utf-8"
    )
    return path


def register(job: Job) -> Mapping[str, Any]:
    """Register a mesh to what was measured."""
    with scratch_folder("slicer") as folder:
        values, others = _shift(job, Path(folder))
        found = _call("register", values, job)
        _write_forms(values, others, job)
    return {
        **_said(found.prediction),
        "misfit_mm": f"{found.misfit_mm:.3f}",
        "held_out_mm": f"{found.held_out_mm:.3f}",
        "offset": str(found.offset),
        "bone": "not checked against bone" if found.bone is None else str(found.bone),
    }


def predict(job: Job) -> Mapping[str, Any]:
    """Predict the displacement under a load: a file, or a force on points."""
    with scratch_folder("slicer") as folder:
        values, others = _shift(job, Path(folder))
        points, force = values.pop("points", None), values.pop("force_n", None)
        if (points is None) == ("load" not in values):
            raise InputError("give a load file, or points to push: one of them")
        if points is not None:
            values["load"] = _write_load(Path(folder), points, force, job.log)
        values.setdefault("run", None)
        if not values.get("tolerance_mm"):
            values["tolerance_mm"] = None  # a form has a number, if it is 0
        found = _call("predict", values, job)
        _write_forms(values, others, job)
    return _said(found)


def _write_load(
    folder: Path, points: str, force_n: list[float] | None, log: Log
) -> Path:
    """Write a load case: a force, shared out among points."""
    from physgnn.io.medical.markups import read_points

    places = read_points(points, log=log)
    if force_n is None or len(force_n) != 3 or len(places) == 0:
        raise InputError(
            "points to push need a force of three numbers, N, and one point at least "
            f"(got {force_n} and {len(places)} points)"
        )
    share = [part / len(places) for part in force_n]
    load = {"points": places.tolist(), "forces_n": [share] * len(places)}
    path = folder / "load.json"
    path.write_text(json.dumps(load), encoding="utf-8")
    return path


def warp(job: Job) -> Mapping[str, Any]:
    """Deform a volume; the status is that of the displacement."""
    from physgnn.io.vtk.prediction_file import read_status

    values = dict(job.values)
    out = _named(values, "deformed")
    field = [values.pop("transform")] if "transform" in values else []
    _call("warp", {**values, "out": out, "field": field}, job)
    stored = read_status(values["prediction"])
    return {STATUS: stored.status or NOT_TOLD, REASON: "; ".join(stored.reasons)}


def _shift(job: Job, folder: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Return a stage's arguments, and the other forms of the displacement asked for."""
    values = dict(job.values)
    others = {name: values.pop(name) for name in FORMS if name in values}
    if SHIFT not in values and not others:
        raise InputError(f"name something to write: {SHIFT}, {' or '.join(FORMS)}")
    values["out"] = values.pop(SHIFT, folder / "shift.vtu")
    return values, others


def _write_forms(
    values: Mapping[str, Any], others: Mapping[str, str], job: Job
) -> None:
    """Write a displacement in its other forms, a part of the progress each."""
    if not others:
        return
    from physgnn.io.displacement_files import DisplacementFields, form_of
    from physgnn.io.medical.images.formats import read_image
    from physgnn.io.vtk.prediction_file import read_displacement

    body, displacement = read_displacement(values["out"])
    grid = read_image(values["image"]).grid if "image" in values else None
    fields = DisplacementFields(body, {"displacement_mm": displacement}, grid)
    for i, (name, path) in enumerate(others.items()):
        job.progress(i + 1, len(others) + 1, name)
        form_of(path, FORMS[name]).write(Path(path), fields)


def _said(found: "Prediction") -> dict[str, Any]:
    bound = found.error_estimate_mm
    return {
        STATUS: str(found.status),
        REASON: "; ".join(found.reasons) or found.status.remedy,
        "bound_mm": "" if bound is None else f"{bound.max_mm:.3f}",
    }


def _named(values: dict[str, Any], output: str) -> Any:
    """Take the file to write out of a module's values."""
    if output not in values:
        raise InputError(f"name something to write: {output}")
    return values.pop(output)


def _arguments(command: str) -> Mapping[str, inspect.Parameter]:
    return inspect.signature(getattr(stages, command)).parameters


def _call(command: str, values: Mapping[str, Any], job: Job) -> Any:
    """Call a stage with what it takes, and the callbacks it has."""
    told = _arguments(command)
    shown = {"log": job.log, "progress": job.progress}
    callbacks = {name: shown[name] for name in shown if name in told}
    return getattr(stages, command)(**values, **callbacks)
