"""What the help lists is what the tables hold."""

import pytest

from physgnn import choices
from physgnn.dataset import PRESETS, SOLVERS, SPLITS
from physgnn.dataset.splits.samples import MESH
from physgnn.evaluation.benchmark.tasks import SIZES, TASKS
from physgnn.geometry.meshing.tetrahedra import MESHERS
from physgnn.imaging.image_warping import INTERPOLATIONS
from physgnn.io.medical.images.nifti_place import FORMS
from physgnn.io.medical.markups import POINT_READERS
from physgnn.io.plans.formats import PLAN_FORMATS
from physgnn.io.stress_curves import PA
from physgnn.io.surfaces.formats import SURFACE_READERS
from physgnn.learning.models import MODELS
from physgnn.learning.physgnn.precision import PRECISIONS
from physgnn.learning.training.budget import CLOCKS
from physgnn.learning.training.objective.losses import LOSSES
from physgnn.learning.training.schedules import SCHEDULES
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.materials.fitted_laws import FAMILIES
from physgnn.registration.skull import SUPPORTS
from physgnn.segmentation.backends import AUTO, BACKENDS
from physgnn.segmentation.contrasts import FLUID_IS_BRIGHT
from physgnn.stages.patient.intraoperative.measured_files import TRANSFORMED


@pytest.mark.parametrize(
    ("choice", "rows"),
    [
        ("PresetName", PRESETS),
        ("Mesher", MESHERS),
        ("SolverName", SOLVERS),
        ("Element", ELEMENTS),
        ("FittedLaw", FAMILIES),
        ("StressUnit", PA),
        ("SplitName", [*SPLITS, MESH]),
        ("LossName", LOSSES),
        ("Schedule", SCHEDULES),
        ("Clock", CLOCKS),
        ("PrecisionName", PRECISIONS),
        ("Skull", SUPPORTS),
        ("Transformed", TRANSFORMED),
        ("Interpolation", INTERPOLATIONS),
        ("AffineForm", FORMS),
        ("BrainBackend", [*BACKENDS, AUTO]),
        ("Contrast", FLUID_IS_BRIGHT),
        ("ModelName", MODELS),
        ("TaskName", [*TASKS, "all"]),
        ("TaskSize", SIZES),
        ("SurfaceSuffix", SURFACE_READERS),
        ("PointSuffix", POINT_READERS),
        ("PlanSuffix", PLAN_FORMATS),
    ],
)
def test_a_choice_names_the_rows_of_its_table(choice: str, rows: object) -> None:
    assert list(choices.names(choice)) == list(rows)  # type: ignore[call-overload]
    assert list(getattr(choices, choice)) == list(rows)  # type: ignore[call-overload]


def test_every_choice_is_compared_with_its_table() -> None:
    (compared,) = test_a_choice_names_the_rows_of_its_table.pytestmark  # type: ignore[attr-defined]
    assert {choice for choice, _ in compared.args[1]} == set(choices.TABLES)
