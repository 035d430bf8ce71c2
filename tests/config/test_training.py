"""How to train, from a file and from the command line."""

from pathlib import Path

import pytest

from physgnn.config import read_training
from physgnn.errors import InputError


def write(folder: Path, text: str) -> Path:
    path = folder / "settings.toml"
    path.write_text(text, "utf-8")
    return path


def test_the_lifted_network_is_trained_unless_another_is_meant(tmp_path: Path) -> None:
    assert read_training(None).model == "lifted"
    assert read_training(None, model="zero").model == "zero"
    assert read_training(None, options={"configuration": 3}).model == "physgnn"
    assert read_training(write(tmp_path, "[options]\ndataset = 1\n")).model == "physgnn"
    assert read_training(None, default_model="reduced").model == "reduced"


def test_training(tmp_path: Path) -> None:
    file = write(tmp_path, "batch_size = 4\nseed = 3\n[options]\nconfiguration = 9\n")
    config = read_training(file, seed=5, max_epochs=None, options={"dataset": 1})
    assert (config.batch_size, config.seed) == (4, 5)
    assert config.max_epochs == read_training(None).max_epochs
    assert config.options == {"configuration": 9, "dataset": 1}
    with pytest.raises(InputError, match=r"unknown key 'batchsize'.*batch_size"):
        read_training(write(tmp_path, "batchsize = 4"))
    with pytest.raises(InputError, match=r"batch_size .* must be int"):
        read_training(write(tmp_path, 'batch_size = "4"'))
    with pytest.raises(InputError, match=r"options must be a table.*got 3"):
        read_training(write(tmp_path, "options = 3"))
    for seed in (2**32, 99999999999999999999):
        with pytest.raises(InputError, match="seed"):
            read_training(None, seed=seed)
