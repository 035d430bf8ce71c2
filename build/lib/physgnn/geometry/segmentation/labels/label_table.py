"""How to read one kind of label map: which label is which tissue, and its name."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from physgnn.errors import InputError
from physgnn.geometry.regions import REGIONS


@dataclass(frozen=True)
class LabelTable:
    """How to read one kind of label map.

    Attributes
    ----------
    labels : mapping of tissue to labels
        One entry a tissue of ``REGIONS``, ``"brain"`` among them; a label belongs to
        one tissue.
    closing_mm : float
        Radius of the closing that fills sulci which have no label.
    names : mapping of label to str
        What labels are called in messages, where that helps.
    outside : tuple of int
        Labels that are known to lie outside of the brain; they are not meshed.
    needs_mask : bool
        Whether the convention leaves the healthy brain without a label.
    left, right, cerebellum : tuple of int
        Labels of the left and the right cerebral cortex and of the cerebellum, where
        the convention tells them apart.

    Raises
    ------
    InputError
        If any of this does not hold.
    """

    labels: Mapping[str, tuple[int, ...]]
    closing_mm: float = 0.0
    names: Mapping[int, str] = field(default_factory=dict)
    outside: tuple[int, ...] = ()
    needs_mask: bool = False
    left: tuple[int, ...] = ()
    right: tuple[int, ...] = ()
    cerebellum: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        unknown = [name for name in self.labels if name not in REGIONS]
        if unknown or "brain" not in self.labels:
            raise InputError(
                f"labels are given for brain, and for tumour and ventricle if there "
                f"are any (got {', '.join(self.labels) or 'nothing'})"
            )
        every = [label for labels in self.labels.values() for label in labels]
        every += self.outside
        if len(set(every)) < len(every) or 0 in every:
            raise InputError(
                f"a label must be > 0 and belong to one tissue (got {sorted(every)})"
            )

    def tissue(self, label: int) -> str | None:
        """Return the tissue of a label, or None if the table does not name it."""
        return next((t for t, labels in self.labels.items() if label in labels), None)
