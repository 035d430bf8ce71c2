import pytest

from physgnn.errors import InputError
from physgnn.geometry.segmentation.labels.label_tables import (
    LABEL_TABLES,
    LabelTable,
    label_table,
)


def test_a_name_or_plain_words() -> None:
    assert label_table("brats") is LABEL_TABLES["brats"]
    table = label_table("brain=1+2, tumour=4")
    assert table.labels == {"brain": (1, 2), "tumour": (4,)}
    assert table.closing_mm == 0.0


@pytest.mark.parametrize(
    "text", ["", "brain", "brain=x", "brain=1,brain=2", "tumour=1", "brain=1,skull=2"]
)
def test_anything_else_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        label_table(text)


def test_a_label_has_one_meaning() -> None:
    for labels in ({"brain": (1,), "tumour": (1,)}, {"brain": (0, 1)}):
        with pytest.raises(InputError, match="one tissue"):
            LabelTable(labels)
