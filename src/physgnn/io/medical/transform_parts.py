"""Whether a transform of ITK is all there: one transform, with all of its numbers.

ITK itself takes what is left of a cut file: without its last line a transform is the
identity, with too few numbers it goes on in memory that is not its own, and of two
transforms it takes the first.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from physgnn.errors import InputError

FIRST_LINE = "#Insight Transform File"
COMPOSITE = "CompositeTransform"  # its parts follow it
TRANSFORM, PARAMETERS, FIXED = "Transform", "Parameters", "FixedParameters"
EMPTY = f"{COMPOSITE} has no parts: the file is cut, export it again"


@dataclass(frozen=True)
class Sizes:
    """How many numbers a transform has, and how many that are fixed."""

    parameters: int
    fixed: tuple[int, ...] = (3,)


LINEAR: Mapping[str, Sizes] = {
    "AffineTransform": Sizes(12),
    "MatrixOffsetTransformBase": Sizes(12),
    "Rigid3DTransform": Sizes(12),
    "Euler3DTransform": Sizes(6, (3, 4)),  # before ITK 5 and since
    "VersorRigid3DTransform": Sizes(6),
    "VersorTransform": Sizes(3),
    "QuaternionRigidTransform": Sizes(7),
    "Similarity3DTransform": Sizes(7),
    "TranslationTransform": Sizes(3, (0,)),
    "ScaleTransform": Sizes(3),
    "ScaleVersor3DTransform": Sizes(9),
    "ScaleSkewVersor3DTransform": Sizes(15),
    "ComposeScaleSkewVersor3DTransform": Sizes(12),
}
"""Linear transforms in three dimensions, by ITK's names (ITK 5.4, class reference)."""


def check_sizes(name: str, parameters: int, fixed: int) -> None:
    """Raise InputError if a linear transform has more or fewer numbers than its kind.

    Parameters
    ----------
    name : str
        As ITK calls it.
    parameters, fixed : int
        How many the file has.
    """
    if name not in LINEAR:
        raise InputError(f"it must be linear in three dimensions (got {name})")
    wanted = LINEAR[name]
    if parameters != wanted.parameters:
        raise InputError(
            f"{name} has {wanted.parameters} parameters (got {parameters}): export it "
            "again"
        )
    if fixed not in wanted.fixed:
        numbers = " or ".join(map(str, wanted.fixed))
        raise InputError(
            f"{name} has {numbers} fixed parameters (got {fixed}): export it again"
        )


def check_transform_text(text: str) -> None:
    """Check the text of a .tfm file before ITK reads it.

    Parameters
    ----------
    text : str
        All of it.

    Raises
    ------
    InputError
        If it is no such file, holds no transform or several, or one is not linear in
        three dimensions or lacks numbers.
    """
    if not text.startswith(FIRST_LINE):
        raise InputError(f"the first line of a .tfm must be '{FIRST_LINE} V1.0'")
    if not text.endswith("\n"):
        raise InputError("it ends inside a line: the file is cut, export it again")
    found = list(_transforms(text))
    if not found:
        raise InputError("the file has no line 'Transform: …': export it again")
    composed = found[0].name == COMPOSITE
    parts = found[1:] if composed else found
    if not parts:
        raise InputError(EMPTY)
    if len(parts) != 1 and not composed:
        raise InputError(
            f"the file must hold one transform (got {len(parts)}): save the one that "
            "is meant"
        )
    for part in parts:
        parameters, fixed = (part.numbers(key) for key in (PARAMETERS, FIXED))
        check_sizes(part.name, parameters, fixed)


@dataclass(frozen=True)
class _Written:
    """One transform of a text: its name, and what follows each key."""

    name: str
    lines: Mapping[str, str]

    def numbers(self, key: str) -> int:
        """Return how many numbers follow a key."""
        if key not in self.lines:
            raise InputError(
                f"{self.name} has no line '{key}: …': the file is cut, export it again"
            )
        words = self.lines[key].split()
        for word in words:
            float(word)
        return len(words)


def _transforms(text: str) -> Iterator[_Written]:
    """Yield the transforms of a text, each with its lines."""
    lines: dict[str, str] = {}
    name = None
    for line in text.splitlines():
        found = re.match(rf"({TRANSFORM}|{PARAMETERS}|{FIXED})\s*:(.*)", line.strip())
        if found is None:
            continue
        key, value = found[1], found[2].strip()
        if key == TRANSFORM:
            if name is not None:
                yield _Written(name, lines)
            name, lines = value.split("_")[0], {}
        else:
            lines[key] = value
    if name is not None:
        yield _Written(name, lines)
