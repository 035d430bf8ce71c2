"""Which label was taken for what, and what of a label map is not used.

Labels that a table does not name are not meshed. That is a part of the brain missing
as often as it is meant, so every label is accounted for.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.labels.label_tables import LabelTable
from physgnn.geometry.segmentation.volume_fit import dice

# Of the labelled volume that is not outside of the brain.
MOST_UNUSED = 0.02
# Neighbours of a segmentation are mostly alike, those of a scan hardly ever. Fewer
# labels than these are no grey values.
ALIKE, GREY_VALUES = 0.5, 20
SHOWN = 12  # labels in one line


def label_volumes(labels: LabelVolume) -> dict[int, float]:
    """Return the volume of every label but 0, ml."""
    values, counts = np.unique(labels.data, return_counts=True)
    ml = labels.grid.voxel_volume_mm3 / 1000.0
    return {
        int(value): float(count * ml)
        for value, count in zip(values, counts, strict=True)
        if value != 0
    }


def check_is_segmentation(labels: LabelVolume) -> None:
    """Check that whole numbers are labels, not grey values.

    Raises
    ------
    InputError
        If there are many values and neighbouring voxels are mostly different.
    """
    if len(np.unique(labels.data)) < GREY_VALUES:
        return
    first, second = labels.data[:-1], labels.data[1:]
    both = (first != 0) & (second != 0)
    alike = float((first == second)[both].mean()) if both.any() else 1.0
    if alike < ALIKE:
        raise InputError(
            "a segmentation must hold labels (this is an image, not a segmentation: "
            f"only {alike:.0%} of neighbouring voxels are alike): see 'physgnn segment'"
        )


def check_all_used(
    volumes: Mapping[int, float], table: LabelTable, *, ignore_labels: bool = False
) -> list[str]:
    """Check that no part of the labelled volume is left out unawares.

    Parameters
    ----------
    volumes : mapping of label to ml
        As `label_volumes` returns them, of the file itself, without a mask.
    table : LabelTable
        What they mean.
    ignore_labels : bool
        Whether the user has said that labels may be left out.

    Returns
    -------
    list of str
        Lines on what is not used, lies outside, or was asked for and is not there.

    Raises
    ------
    InputError
        If more than 2 % of the labelled volume is not used.
    """
    outside = [label for label in volumes if label in table.outside]
    unused = [n for n in volumes if n not in outside and table.tissue(n) is None]
    left_out = sum(volumes[label] for label in unused)
    whole = sum(volumes.values()) - sum(volumes[label] for label in outside)
    what = f"{_listed(unused)} ({left_out:.3g} ml)"
    if left_out > MOST_UNUSED * whole and not ignore_labels:
        first = next(iter(table.labels["brain"]))
        below = [label for label in unused if label < 0]
        named = f"name them, such as brain={first}+{unused[0]}"
        if below:  # they cannot be named, which only numbers above 0 can
            named = f"give {_listed(below)} a number above 0 and name it"
        raise InputError(
            f"every label must be named (not used: {what}, {left_out / whole:.0%} of "
            f"the labelled volume): {named}, or pass --ignore-labels "
            "(ignore_labels=True) if they are not to be meshed"
        )
    lines = [f"not used: {what}"] if unused else []
    if outside:
        ml = sum(volumes[label] for label in outside)
        lines.append(f"outside of the brain: {_listed(outside)} ({ml:.3g} ml)")
    return lines


def not_there(volumes: Mapping[int, float], table: LabelTable) -> list[str]:
    """Return a line for each tissue that lacks a label that was asked for."""
    missing = {
        tissue: [label for label in labels if label not in volumes]
        for tissue, labels in table.labels.items()
    }
    return [
        f"asked for, not there: {tissue}={'+'.join(map(str, labels))}"
        for tissue, labels in missing.items()
        if labels
    ]


def label_lines(
    labels: LabelVolume,
    table: LabelTable,
    regions: NDArray[np.int32],
    names: tuple[str, ...],
    *,
    whole: float | None = None,
) -> list[str]:
    """Return a line for each label that is used: its tissue, volume and fit.

    Parameters
    ----------
    labels : LabelVolume
        The label map.
    table : LabelTable
        What its labels mean.
    regions : (nx, ny, nz) integer array
        The mesh's region at each voxel, −1 outside of it.
    names : tuple of str
        The tissue of each region.
    whole : float, optional
        Dice of the whole brain, its sulci filled; where the table has them filled, the
        labels of brain alone agree less with the mesh.
    """
    filled = ""
    if whole is not None and table.closing_mm > 0:
        filled = f" (of the whole brain, its sulci filled, {whole:.3f})"
    dices = {
        tissue: dice(labels.mask(ids), regions == names.index(tissue))
        for tissue, ids in table.labels.items()
    }
    lines = []
    for label, ml in label_volumes(labels).items():
        tissue = table.tissue(label)
        if tissue is not None:
            meaning = f" ({table.names[label]})" if label in table.names else ""
            lines.append(
                f"label {label} → {tissue}{meaning}: {ml:.4g} ml; "
                f"Dice of {tissue} with the mesh {dices[tissue]:.3f}"
                + (filled if tissue == "brain" else "")
            )
    return lines


def _listed(labels: list[int]) -> str:
    more = f" and {len(labels) - SHOWN} more" if len(labels) > SHOWN else ""
    return ", ".join(map(str, labels[:SHOWN])) + more
