"""What the help lists is what the tables hold."""

import pytest

from physgnn import choices
from physgnn.dataset import PRESETS, SOLVERS, SPLITS
from physgnn.dataset.split import MESH
from physgnn.imaging.warp import INTERPOLATIONS
from physgnn.learning.budget import CLOCKS
from physgnn.learning.losses import LOSSES
from physgnn.learning.precision import PRECISIONS
from physgnn.learning.schedules import SCHEDULES
from physgnn.mechanics.element import ELEMENTS
from physgnn.prediction.skull import SUPPORTS


@pytest.mark.parametrize(
    ("names", "rows"),
    [
        (choices.Preset, PRESETS),
        (choices.Solver, SOLVERS),
        (choices.Element, ELEMENTS),
        (choices.Split, [*SPLITS, MESH]),
        (choices.Loss, LOSSES),
        (choices.Schedule, SCHEDULES),
        (choices.Clock, CLOCKS),
        (choices.Precision, PRECISIONS),
        (choices.Skull, SUPPORTS),
        (choices.Interpolation, INTERPOLATIONS),
    ],
)
def test_every_name_has_a_row_and_every_row_a_name(names: type, rows: object) -> None:
    assert list(names) == list(rows)  # type: ignore[call-overload]
