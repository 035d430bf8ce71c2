"""What a user of the page can give: files, each in a role, and what is chosen for them.

All of it is an argument of `register`, under a name that suits a page. So what the
command says is said here in the page's words, and what the command refuses is refused.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from physgnn.errors import InputError
from physgnn.io.medical.linear_transforms import ITK_SUFFIXES
from physgnn.io.medical.markups import POINT_READERS
from physgnn.io.surfaces.formats import SURFACE_READERS
from physgnn.stages.option_rules import RULES, check_options
from physgnn.stages.patient.intraoperative.measured_files import BESIDES


@dataclass(frozen=True)
class Role:
    """What a measured file may be.

    Attributes
    ----------
    name : str
        On the page.
    argument : str
        Of `register`.
    """

    name: str
    argument: str


@dataclass(frozen=True)
class Choice:
    """What is chosen where a file calls for it.

    Attributes
    ----------
    name : str
        On the page.
    values : mapping of str to str
        What `register` takes → its name on the page; the first is the default.
    """

    name: str
    values: Mapping[str, str]


ROLES: Mapping[str, Role] = {
    "pairs": Role("pairs of points", "points"),
    "before": Role("points before", "points"),
    "after": Role("points after", "target"),
    "surface": Role("exposed surface", "surface"),
    "landmarks": Role("pairs of landmarks", "landmarks"),
    "landmarks before": Role("landmarks before", "landmarks"),
    "landmarks after": Role("landmarks after", "landmarks_target"),
    "whole surface": Role("whole surface", "whole_surface"),
    "intraoperative": Role("scan of the operation", "intraoperative"),
    "bone": Role("pairs of bone points", "bone"),
    "bone before": Role("bone points before", "bone"),
    "bone after": Role("bone points after", "bone_target"),
    "initial transform": Role("initial transform", "initial_transform"),
}
CHOICES: Mapping[str, Choice] = {
    "contrast": Choice(
        "Contrast of the scan",
        {"t1": "T1", "t1c": "T1 with contrast agent", "t2": "T2", "flair": "FLAIR"},
    ),
    "transformed": Choice(
        "What the transform takes along",
        {"both": "points before and after", "after": "points after, not before"},
    ),
}
"""Argument of `register` → what is chosen for it."""

SCANS = (".nii.gz", ".nii", ".nrrd", ".mha", ".mgz")  # of one file each
TRANSFORMS = (".txt", *ITK_SUFFIXES)
SUFFIXES = list(dict.fromkeys((*POINT_READERS, *SURFACE_READERS, *SCANS, *TRANSFORMS)))
"""How measured files may end."""

_CHOSEN = {name: row.name.lower() for name, row in CHOICES.items()}
_NEEDED = {row.argument: row.name for row in ROLES.values()} | _CHOSEN
WORDS = {row.argument: row.name for row in reversed([*ROLES.values()])} | _CHOSEN
"""Argument of `register` → what it is called on the page."""
OPTION = re.compile(r"--([a-z][a-z-]*)")


def roles_for(choice: str) -> list[str]:
    """Return the roles of which one must be there for a choice to be of use."""
    needs = RULES["register"][choice].needs
    return [role for role, row in ROLES.items() if row.argument in needs]


def chosen_or_default(choice: str, chosen: Mapping[str, str]) -> str:
    """Return what is chosen, or what `register` takes where nothing is."""
    return chosen.get(choice, next(iter(CHOICES[choice].values)))


def check_chosen(roles: Collection[str], chosen: Mapping[str, str]) -> None:
    """Raise InputError if something is given that there is not or nothing would use.

    Parameters
    ----------
    roles : collection of str
        What the files are: keys of `ROLES`.
    chosen : mapping of str to str
        Key of `CHOICES` → one of its values.
    """
    for name, value in chosen.items():
        if name not in CHOICES:
            raise InputError(
                f"there is no '{name}' to choose: there is {', '.join(CHOICES)}"
            )
        if value not in CHOICES[name].values:
            known = ", ".join(CHOICES[name].values)
            raise InputError(f"{name} must be one of {known} (got '{value}')")
    arguments = {ROLES[role].argument for role in roles}
    check_options("register", [*arguments, *chosen], lambda name: _NEEDED.get(name, ""))
    if arguments and not arguments - BESIDES:
        raise InputError(
            "nothing was measured of the brain: add points, a surface or a scan of it"
        )


def in_page_words(text: str) -> str:
    """Return a line with options of `register` called what the page calls them."""
    return OPTION.sub(
        lambda found: WORDS.get(found[1].replace("-", "_"), found[0]), text
    )
