"""What the help lists is what the tables hold."""

import pytest

from physgnn import choices
from physgnn.dataset import PRESETS, SOLVERS, SPLITS
from physgnn.dataset.splits.samples import MESH
from physgnn.imaging.image_warping import INTERPOLATIONS
from physgnn.io.medical.nifti_place import FORMS
from physgnn.io.stress_curves import PA
from physgnn.learning.physgnn.precision import PRECISIONS
from physgnn.learning.training.budget import CLOCKS
from physgnn.learning.training.objective.losses import LOSSES
from physgnn.learning.training.schedules import SCHEDULES
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.materials.fitted_laws import FAMILIES
from physgnn.registration.skull import SUPPORTS
from physgnn.stages.patient.measured_files import TRANSFORMED


@pytest.mark.parametrize(
    ("names", "rows"),
    [
        (choices.PresetName, PRESETS),
        (choices.SolverName, SOLVERS),
        (choices.Element, ELEMENTS),
        (choices.FittedLaw, FAMILIES),
        (choices.StressUnit, PA),
        (choices.SplitName, [*SPLITS, MESH]),
        (choices.LossName, LOSSES),
        (choices.Schedule, SCHEDULES),
        (choices.Clock, CLOCKS),
        (choices.PrecisionName, PRECISIONS),
        (choices.Skull, SUPPORTS),
        (choices.Transformed, TRANSFORMED),
        (choices.Interpolation, INTERPOLATIONS),
        (choices.AffineForm, FORMS),
    ],
)
def test_every_name_has_a_row_and_every_row_a_name(names: type, rows: object) -> None:
    assert list(names) == list(rows)  # type: ignore[call-overload]
