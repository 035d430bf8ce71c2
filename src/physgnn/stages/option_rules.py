"""Options that nothing would use without another one, or beside it: refused.

What a user gives and no one reads is a silent mistake: a noise of points that were not
given, a label table beside a surface. All such options of all stages stand in `RULES`;
the command line and `batch`, which know what was given, ask.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from physgnn.errors import InputError

Shown = Callable[[str], str]


@dataclass(frozen=True)
class Rule:
    """What an option needs, and what it is of no use beside; names of arguments.

    Attributes
    ----------
    needs : tuple of str
        One of these must be given; none needs be if this is empty.
    useless_with : tuple of str
        None of these may be given.
    """

    needs: tuple[str, ...] = ()
    useless_with: tuple[str, ...] = ()


def _all_need(options: Sequence[str], *needs: str) -> dict[str, Rule]:
    return {name: Rule(needs) for name in options}


def _none_beside(options: Sequence[str], *others: str) -> dict[str, Rule]:
    return {name: Rule(useless_with=others) for name in options}


RULES: Mapping[str, Mapping[str, Rule]] = {
    "mesh": {
        **_all_need(
            (
                "labels", "brain_mask", "ventricles", "smoothing_mm", "closing_mm",
                "smallest_mm3", "ignore_labels", "affine", "series",
            ),
            "segmentation",
        ),
        "tumour": Rule(("brain",)),
        **_none_beside(("max_volume_mm3", "keep_surface"), "segmentation"),
    },
    "segment": {"tumour_labels": Rule(("tumour",))},
    "predict": {"affine": Rule(("image",))},
    "register": {
        "target": Rule(("points",), ("series",)),
        "landmarks_target": Rule(("landmarks",), ("series",)),
        "bone_target": Rule(("bone",), ("series",)),
        "transformed": Rule(("initial_transform", "series")),
        "landmark_noise_mm": Rule(("landmarks", "series")),
        "surface_noise_mm": Rule(("surface", "series")),
        "whole_surface_noise_mm": Rule(("whole_surface", "intraoperative", "series")),
        "bone_noise_mm": Rule(("bone", "series")),
        **_all_need(
            ("backend", "contrast", "picture", "any_size"), "intraoperative", "series"
        ),
        "affine": Rule(("image", "intraoperative", "series")),
    },
    "uncertainty": {"wrong_mm": Rule(("wrong",))},
    "view": {"igtl_surfaces": Rule(("igtl",)), "affine": Rule(("image",))},
    "simulate": {"workers": Rule(useless_with=("scheduler",))},
    "export": {
        "path": Rule(("febio", "series")),
        **_all_need(("preset", "loads"), "febio"),
    },
    "reproduce": {"tumour": Rule(("brain",))},
    "benchmark": {
        "data": Rule(("size",)),
        **_none_beside(("task", "method", "size", "minutes", "seed"), "report"),
    },
}  # fmt: skip
"""Function of `physgnn.stages` → argument → its rule."""


def check_options(command: str, given: Collection[str], shown: Shown) -> None:
    """Raise InputError if nothing would use one of the options that were given.

    Parameters
    ----------
    command : str
        The function of `physgnn.stages`.
    given : collection of str
        Arguments that the user named, not those with a default.
    shown : callable
        From an argument to what the user wrote for it; empty if they cannot give it.
    """
    for name, rule in RULES.get(command, {}).items():
        if name not in given:
            continue
        if rule.needs and not any(other in given for other in rule.needs):
            needed = " or ".join(filter(None, map(shown, rule.needs)))
            raise InputError(
                f"{shown(name)} is of no use without {needed}: give that too, or leave "
                f"{shown(name)} out"
            )
        for other in rule.useless_with:
            if other in given:
                raise InputError(
                    f"{shown(name)} is of no use beside {shown(other)}: leave one out"
                )
