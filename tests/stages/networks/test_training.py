"""What a training is asked for must be something that it uses."""

from pathlib import Path

import pytest

from physgnn.errors import InputError
from physgnn.stages import train


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"max_epochs": 5}, "--max-epochs"),
        ({"learning_rate": 0.1, "batch_size": 4}, "--batch-size, --learning-rate"),
        ({"memory_mb": 5.0}, "--memory-mb"),
        ({"device": "cuda", "devices": 2}, "--device, --devices"),
    ],
)
def test_settings_of_steps_are_refused_for_what_has_none(
    given: dict, named: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=f"not trained by steps: leave {named} out"):
        train(tmp_path / "loads.zarr", tmp_path / "run", model="extra-trees", **given)
    assert not (tmp_path / "run").exists()
