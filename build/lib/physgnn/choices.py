"""What a user chooses from where the list is closed, by name and without its code.

Most lists are the names of a table's rows: a loss, a preset or a split is added to its
table, and nowhere else. The command line shows them in its help, and importing the
tables would import torch and compiled kernels first. So their names are read from the
tables' source, as text; a test compares them with the tables.
"""

import ast
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

PACKAGE = Path(__file__).parent
TABLES = {
    "PresetName": ("dataset/presets.py", "PRESETS"),
    "Mesher": ("geometry/meshing/tetrahedra.py", "MESHERS"),
    "SolverName": ("dataset/generation/pending_paths.py", "SOLVERS"),
    "Element": ("mechanics/elements/tet4.py", "ELEMENTS"),
    "FittedLaw": ("mechanics/materials/fitted_laws.py", "FAMILIES"),
    "StressUnit": ("io/stress_curves.py", "PA"),
    "SplitName": ("dataset/splits/samples.py", "SPLITS"),
    "LossName": ("learning/training/objective/losses.py", "LOSSES"),
    "Schedule": ("learning/training/schedules.py", "SCHEDULES"),
    "Clock": ("learning/training/budget.py", "CLOCKS"),
    "PrecisionName": ("learning/physgnn/precision.py", "PRECISIONS"),
    "Skull": ("registration/skull.py", "SUPPORTS"),
    "Transformed": ("stages/patient/intraoperative/measured_files.py", "TRANSFORMED"),
    "AffineForm": ("io/medical/images/nifti_place.py", "FORMS"),
    "Interpolation": ("imaging/image_warping.py", "INTERPOLATIONS"),
    "BrainBackend": ("segmentation/backends/__init__.py", "BACKENDS"),
    "ModelName": ("learning/models.py", "MODELS"),
    "Contrast": ("segmentation/contrasts.py", "FLUID_IS_BRIGHT"),
    "TaskName": ("evaluation/benchmark/tasks.py", "TASKS"),
    "TaskSize": ("evaluation/benchmark/tasks.py", "SIZES"),
    "SurfaceSuffix": ("io/surfaces/formats.py", "SURFACE_READERS"),
    "PointSuffix": ("io/medical/markups.py", "POINT_READERS"),
    "PlanSuffix": ("io/plans/formats.py", "PLAN_FORMATS"),
}
"""Choice → module and table whose rows it names."""
WITHOUT_ROW = {
    "SplitName": ("mesh",),  # holds out a whole store, not samples of one
    "BrainBackend": ("auto",),  # whichever is installed
    "TaskName": ("all",),
}


class Device(StrEnum):
    """Where a network is trained, as Lightning names it."""

    CPU = "cpu"
    CUDA = "cuda"
    GPU = "gpu"
    MPS = "mps"
    AUTO = "auto"


class MembraneSupport(StrEnum):
    """How falx and tentorium act: see `physgnn.dataset.membranes`."""

    HELD = "held"
    ELASTIC = "elastic"
    LEFT_OUT = "left-out"


class Estimate(StrEnum):
    """How the error of a prediction is estimated by `physgnn.prediction.Predictor`."""

    PHYSICAL = "physical"
    QUICK = "quick"


@cache
def names(choice: str) -> tuple[str, ...]:
    """Return the names of a choice in the order of its table.

    Parameters
    ----------
    choice : str
        A key of `TABLES`.
    """
    module, table = TABLES[choice]
    source = ast.parse((PACKAGE / module).read_text(encoding="utf-8"))
    (rows,) = (_value(node) for node in source.body if table in _targets(node))
    literals = rows.keys if isinstance(rows, ast.Dict) else getattr(rows, "elts", [])
    found = (ast.literal_eval(literal) for literal in literals if literal)
    return (*found, *WITHOUT_ROW.get(choice, ()))


def _targets(node: ast.stmt) -> list[str]:
    """Return the names that a statement assigns to."""
    targets: list[Any] = getattr(node, "targets", [getattr(node, "target", None)])
    return [target.id for target in targets if isinstance(target, ast.Name)]


def _value(node: ast.stmt) -> Any:
    return getattr(node, "value", None)


if TYPE_CHECKING:
    # what a type checker sees of the choices that the command line offers
    PresetName: TypeAlias = str
    Mesher: TypeAlias = str
    SolverName: TypeAlias = str
    Element: TypeAlias = str
    FittedLaw: TypeAlias = str
    StressUnit: TypeAlias = str
    SplitName: TypeAlias = str
    LossName: TypeAlias = str
    Clock: TypeAlias = str
    PrecisionName: TypeAlias = str
    Skull: TypeAlias = str
    Transformed: TypeAlias = str
    AffineForm: TypeAlias = str
    Interpolation: TypeAlias = str
    BrainBackend: TypeAlias = str
    Contrast: TypeAlias = str
    ModelName: TypeAlias = str
    TaskName: TypeAlias = str
    TaskSize: TypeAlias = str
else:

    def __getattr__(choice: str) -> type[StrEnum]:
        """Return a choice as the enum that the command line's help lists."""
        if choice not in TABLES:
            raise AttributeError(f"module '{__name__}' has no attribute '{choice}'")
        members = [(name, name) for name in names(choice)]
        enum = StrEnum(choice, members, module=__name__)
        globals()[choice] = enum
        return enum
