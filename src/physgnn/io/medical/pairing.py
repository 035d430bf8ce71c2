"""Two lists of marked points to pairs.

A point that is left out of one list must leave with its partner: filtered one by one,
the lists shift against each other, and all pairs after it are wrong.
"""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError

# Lists that share fewer labels than this fraction of the shorter are not of one set.
SHARED = 0.5


@dataclass(frozen=True, eq=False)
class MarkedPoint:
    """A point of a list of markups.

    Attributes
    ----------
    label : str
        Its name, empty if it has none.
    position : (3,) array
        RAS+, mm.
    missing : str
        Why it must not be used, such as "not placed"; empty if it may.
    """

    label: str
    position: FloatArray
    missing: str = ""


def paired(
    source: list[MarkedPoint], target: list[MarkedPoint]
) -> tuple[FloatArray, FloatArray, list[str], dict[str, str]]:
    """Return the ends of all pairs whose two points may be used.

    Points are paired by label if each list has labels of its own for all points and
    at least one is in both, otherwise by their order. Where the lists then differ in
    length, points that may not be used do not count.

    Returns
    -------
    source, target : (n, 3) arrays
        mm.
    names : list of str
        The label of each pair, or its number in the list.
    left_out : dict of str to str
        The names of the others, and why each was left out.

    Raises
    ------
    InputError
        If the lists are of different lengths without common labels, or share fewer
        than half of their labels.
    """
    ends, names, left_out = [], [], {}
    for name, one, other in _matches(source, target):
        why = "without a partner"
        if one is not None and other is not None:
            why = one.missing or other.missing
        if one is None or other is None or why:
            left_out[name] = why
        else:
            ends.append((one.position, other.position))
            names.append(name)
    both = np.array(ends, dtype=np.float64).reshape(-1, 2, 3)
    return both[:, 0], both[:, 1], names, left_out


def why_in_order(source: list[MarkedPoint], target: list[MarkedPoint]) -> str:
    """Return why labelled points are paired by their order; empty if by label."""
    for points in (source, target):
        labels = [point.label for point in points if point.label]
        twice = next((label for label in labels if labels.count(label) > 1), None)
        if twice is not None:
            return f"label '{twice}' stands twice"
    of_source, of_target = _by_label(source), _by_label(target)
    if of_source and of_target and not of_source.keys() & of_target.keys():
        return "no label is in both lists"
    return ""


Match = tuple[str, MarkedPoint | None, MarkedPoint | None]


def _matches(source: list[MarkedPoint], target: list[MarkedPoint]) -> list[Match]:
    of_source, of_target = (_by_label(points) for points in (source, target))
    shared = of_source.keys() & of_target.keys()
    if not shared:
        if len(source) != len(target):  # one list may hold the points not placed, too
            source, target = _there(source), _there(target)
        if len(source) != len(target):
            raise InputError(
                "every source point needs its target, by a common label or by its "
                f"place in the list (got {len(source)} and {len(target)})"
            )
        return [
            (one.label or str(i + 1), one, other)
            for i, (one, other) in enumerate(zip(source, target, strict=True))
        ]
    if len(shared) < SHARED * min(len(source), len(target)):
        raise InputError(
            f"the labels of source and target must match (only {len(shared)} of "
            f"{len(source)} and {len(target)} do): give pairs the same label"
        )
    names = [*of_source, *(name for name in of_target if name not in of_source)]
    return [(name, of_source.get(name), of_target.get(name)) for name in names]


def _there(points: list[MarkedPoint]) -> list[MarkedPoint]:
    return [point for point in points if not point.missing]


def _by_label(points: list[MarkedPoint]) -> dict[str, MarkedPoint]:
    """Return points by label; nothing if not every point has a label of its own."""
    labelled = {point.label: point for point in points if point.label}
    return labelled if len(labelled) == len(points) else {}
