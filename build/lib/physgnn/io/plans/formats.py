"""Plans of every format: one table, by the suffix.

To add a format, write a reader that returns a `Plan` and a row in ``PLAN_FORMATS``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from physgnn.errors import InputError
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.plans.obj_model import read_obj_model
from physgnn.io.plans.plan import Plan
from physgnn.io.plans.ply_model import read_ply_model
from physgnn.io.plans.point_lists import read_fcsv, read_markups, read_table, read_tags
from physgnn.io.plans.stl_model import read_stl_model
from physgnn.io.plans.tracts import read_tck, read_trk
from physgnn.io.plans.vtp_model import read_vtp_model
from physgnn.io.untrusted.input_errors import reading


@dataclass(frozen=True)
class PlanFormat:
    """How files of a suffix are read.

    Attributes
    ----------
    what : str
        What messages call one.
    read : callable
        From a path to the plan.
    """

    what: str
    read: Callable[[Path], Plan]


PLAN_FORMATS: Mapping[str, PlanFormat] = {
    ".mrk.json": PlanFormat("markups of 3D Slicer", read_markups),
    ".fcsv": PlanFormat("points of 3D Slicer", read_fcsv),
    ".tag": PlanFormat("MNI tags", read_tags),
    ".csv": PlanFormat("a table of points", read_table),
    ".stl": PlanFormat("a model, .stl", read_stl_model),
    ".vtp": PlanFormat("a model, .vtp", read_vtp_model),
    ".ply": PlanFormat("a model, .ply", read_ply_model),
    ".obj": PlanFormat("a model, .obj", read_obj_model),
    ".trk": PlanFormat("tracts of TrackVis", read_trk),
    ".tck": PlanFormat("tracts of MRtrix", read_tck),
}
"""By how a name ends."""


def plan_suffix(path: str | Path) -> str:
    """Return the suffix in the table that a name ends in, or nothing."""
    name = Path(path).name.lower()
    return next((suffix for suffix in PLAN_FORMATS if name.endswith(suffix)), "")


def read_plan(path: str | Path) -> Plan:
    """Read points, curves, a model or tracts; the format is the suffix's.

    Raises
    ------
    InputError
        If the file is missing, of an unknown format, damaged, holds no point, or what
        would not keep its shape.
    """
    path, suffix = Path(path), plan_suffix(path)
    if not suffix:
        raise InputError(
            f"{path}: a plan must be one of {', '.join(PLAN_FORMATS)} (got "
            f"'{path.name}')"
        )
    form = PLAN_FORMATS[suffix]
    with reading(path, form.what):
        plan = form.read(path)
        plan.as_bytes()  # what cannot be written back is this file's fault
        return plan


def write_plan(path: str | Path, plan: Plan) -> None:
    """Write a plan in the format that it was read from, whole or not at all.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    content = plan.as_bytes()
    with whole_file(Path(path)) as part:
        part.write_bytes(content)


def plan_named_like(out: str | Path, plan: str | Path) -> Path:
    """Return the name of a result: in the plan's format, which its suffix must say.

    Raises
    ------
    InputError
        If it has another suffix.
    """
    out, suffix = Path(out), plan_suffix(plan)
    if not out.suffix:
        return out.with_name(out.name + suffix)
    if plan_suffix(out) != suffix:
        raise InputError(
            f"{out}: a plan is written in its own format, {suffix} (got '{out.name}')"
        )
    return out
