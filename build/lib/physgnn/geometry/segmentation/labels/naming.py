"""What messages call the pieces of a tissue: by the structures that they are made of.

A piece of ventricle is called after the labels in it, "left lateral, third and fourth
ventricle"; one whose labels have no names is numbered.
"""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import BoolArray
from physgnn.geometry.regions import REGIONS, VENTRICLE
from physgnn.geometry.segmentation.labels.label_table import LabelTable

# A structure that makes up less of a piece than this gives it no name.
LEAST_SHARE = 0.02


def piece_names(
    pieces: Sequence[BoolArray], data: NDArray[np.int32], table: LabelTable, tissue: str
) -> list[str]:
    """Return one name for each piece of a tissue.

    Parameters
    ----------
    pieces : sequence of boolean arrays
        Masks of one piece each.
    data : integer array
        The labels, of the masks' shape.
    table : LabelTable
        What they mean.
    tissue : str
        The tissue, which numbered pieces are called after.
    """
    anatomical = tissue == REGIONS[VENTRICLE]
    names = [
        (joined(structures_in(piece, data, table)) if anatomical else "") or tissue
        for piece in pieces
    ]
    often, seen, unique = Counter(names), Counter[str](), []
    for name in names:
        seen[name] += 1
        alone = name != tissue and often[name] == 1
        unique.append(name if alone else f"{name} {seen[name]}")
    return unique


def structure_names(table: LabelTable) -> tuple[str, ...]:
    """Return the names that a convention has for ventricles, each once."""
    labels = table.labels.get(REGIONS[VENTRICLE], ())
    return tuple(dict.fromkeys(table.names[n] for n in labels if n in table.names))


def structures(data: NDArray[np.int32], table: LabelTable) -> NDArray[np.int32]:
    """Return which named ventricle each voxel is: from 1 on, 0 for none."""
    found = np.zeros(data.shape, dtype=np.int32)
    labels = table.labels.get(REGIONS[VENTRICLE], ())
    for i, name in enumerate(structure_names(table)):
        found[np.isin(data, [n for n in labels if table.names.get(n) == name])] = i + 1
    return found


def structures_in(
    piece: BoolArray, data: NDArray[np.int32], table: LabelTable
) -> list[str]:
    """Return the names of the structures that a piece is made of, in their order."""
    names = structure_names(table)
    size = np.bincount(structures(data, table)[piece], minlength=len(names) + 1)
    least = LEAST_SHARE * int(piece.sum())
    return [name for i, name in enumerate(names) if size[i + 1] > least]


def joined(names: Sequence[str]) -> str:
    """Join names that end alike: "left lateral and third ventricle"."""
    if len(names) < 2:
        return "".join(names)
    first, last = names[:-1], names[-1]
    end = last.rsplit(" ", 1)[1]
    shared = f" {end}"
    return f"{', '.join(name.removesuffix(shared) for name in first)} and {last}"
