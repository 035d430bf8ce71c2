import re
from pathlib import Path

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.model_card import write_model_card
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train


def test_a_run_says_what_it_is(store: Store, split: Split, tmp_path: Path) -> None:
    config = TrainingConfig(options={"width": 8}, max_epochs=1)
    train(store, split, config, tmp_path / "run")
    card = RunFolder(tmp_path / "run").model_card.read_text()
    for part in ("Data", "Split", "Training", "Errors", "Limits"):
        assert f"\n## {part}\n" in card
    assert store.content_hash() in card
    assert "16 training, 4 validation and 4 test samples" in card
    assert re.search(r"of the processor: 0\.\d minutes", card)
    assert "Not evaluated yet" in card

    write_model_card(tmp_path / "run", errors="| mean |")
    card = RunFolder(tmp_path / "run").model_card.read_text()
    assert "| mean |" in card
    assert "Not evaluated yet" not in card
