"""Tissues by the names that people give to segments and groups of cells."""

import re
from collections.abc import Collection, Mapping

from physgnn.errors import InputError
from physgnn.geometry.regions import BRAIN, REGIONS, TUMOUR, VENTRICLE

DEFAULT = "mask"
"""What ``--labels`` is if nobody says: names decide, where there are any."""
# How words begin; the first row that a word of the name fits.
WORDS: Mapping[str, tuple[str, ...]] = {
    REGIONS[TUMOUR]: (
        *("tumour", "tumor", "lesion", "glioma", "glioblastoma", "meningioma"),
        *("metastas", "necro", "enhancing"),
    ),
    REGIONS[VENTRICLE]: ("ventric",),
    REGIONS[BRAIN]: ("brain", "cereb", "parenchyma", "hemisphere", "cortex", "matter"),
}
SHOWN = 12


def tissue_of(name: str) -> str | None:
    """Return the tissue that a name means, or None if it means none we know."""
    words = re.split(r"[^a-z]+", name.lower())
    for tissue, beginnings in WORDS.items():
        if any(word.startswith(beginnings) for word in words):
            return tissue
    return None


def tissues_by_name(
    text: str, present: Collection[int], names: Mapping[int, str]
) -> dict[str, tuple[int, ...]]:
    """Return which numbers are which tissue.

    Parameters
    ----------
    text : str
        ``"mask"``: the names decide; a single number is the brain. Or such as
        ``"brain=Brain,tumour=2+Necrosis"``, of numbers and names.
    present : collection of int
        The numbers found.
    names : mapping of number to str
        What the file calls them.

    Raises
    ------
    InputError
        If there is no such name, a number comes twice, or nothing is the brain.
    """
    if text != DEFAULT:
        return _spelled(text, names)
    if len(present) == 1:
        return {REGIONS[BRAIN]: tuple(present)}
    found: dict[str, tuple[int, ...]] = {}
    for number in present:
        tissue = tissue_of(names.get(number, ""))
        if tissue is not None:
            found[tissue] = (*found.get(tissue, ()), number)
    if REGIONS[BRAIN] not in found:
        raise InputError(
            f"one must be called brain (it has {listed(present, names)}): say which is "
            "which, such as --labels brain=N,tumour=M with the numbers of yours"
        )
    return found


def listed(numbers: Collection[int], names: Mapping[int, str]) -> str:
    """Return numbers with their names in one line."""
    said = [f"{n} '{names[n]}'" if n in names else str(n) for n in sorted(numbers)]
    more = f" and {len(said) - SHOWN} more" if len(said) > SHOWN else ""
    return ", ".join(said[:SHOWN]) + more


def _spelled(text: str, names: Mapping[int, str]) -> dict[str, tuple[int, ...]]:
    found: dict[str, tuple[int, ...]] = {}
    for entry in text.split(","):
        tissue, equals, what = (part.strip() for part in entry.partition("="))
        if not equals or tissue not in REGIONS or tissue in found or not what:
            raise InputError(
                "labels must be such as 'brain=1+2,tumour=4', of numbers or names, "
                f"each tissue once (got '{text}')"
            )
        found[tissue] = tuple(_number(word.strip(), names) for word in what.split("+"))
    every = [number for numbers in found.values() for number in numbers]
    if REGIONS[BRAIN] not in found or len(set(every)) < len(every):
        raise InputError(
            f"one must be the brain, and each belong to one tissue (got '{text}')"
        )
    return found


def _number(word: str, names: Mapping[int, str]) -> int:
    same = [n for n, name in names.items() if name.lower() == word.lower()]
    if len(same) == 1:
        return same[0]
    if word.isdecimal():
        return int(word)
    have = listed(names, names) or "no names"
    raise InputError(f"nothing is called '{word}' (it has {have})")
