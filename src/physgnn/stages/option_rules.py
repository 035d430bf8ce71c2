"""Options that nothing would use without another one, or beside it: refused.

What a user gives and no one reads is a silent mistake: a noise of points that were not
given, a label table beside a surface. All such options of all stages stand in `RULES`;
the command line and `batch`, which know what was given, ask.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from physgnn.errors import InputError


@dataclass(frozen=True)
class OptionRule:
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


def _all_need(options: Sequence[str], *needs: str) -> dict[str, OptionRule]:
    return {name: OptionRule(needs) for name in options}


def _none_beside(options: Sequence[str], *others: str) -> dict[str, OptionRule]:
    return {name: OptionRule(useless_with=others) for name in options}


RULES: Mapping[str, Mapping[str, OptionRule]] = {
    "mesh": {
        **_all_need(
            (
                "labels", "brain_mask", "ventricles", "smoothing_mm", "closing_mm",
                "smallest_mm3", "ignore_labels", "affine", "series",
            ),
            "segmentation",
        ),
        "tumour": OptionRule(("brain",)),
        **_none_beside(("max_volume_mm3", "keep_surface"), "segmentation"),
        "target_points": OptionRule(useless_with=("max_volume_mm3",)),
    },
    "segment": {"tumour_labels": OptionRule(("tumour",))},
    "predict": {"affine": OptionRule(("image",))},
    "register": {
        "target": OptionRule(("points",)),
        "landmarks_target": OptionRule(("landmarks",)),
        "bone_target": OptionRule(("bone",)),
        "rigid_offset": OptionRule(useless_with=("bone",)),
        "transformed": OptionRule(("initial_transform", "series")),
        "landmark_noise_mm": OptionRule(("landmarks", "series")),
        "surface_noise_mm": OptionRule(("surface", "series")),
        "whole_surface_noise_mm": OptionRule(
            ("whole_surface", "intraoperative", "series")
        ),
        "bone_noise_mm": OptionRule(("bone", "series")),
        **_all_need(
            ("backend", "contrast", "picture", "any_size"), "intraoperative", "series"
        ),
        "affine": OptionRule(("image", "intraoperative", "series")),
    },
    "uncertainty": {"wrong_mm": OptionRule(("wrong",))},
    "view": {"igtl_surfaces": OptionRule(("igtl",)), "affine": OptionRule(("image",))},
    "simulate": {"workers": OptionRule(useless_with=("scheduler",))},
    "export": {
        "path": OptionRule(("febio", "series")),
        "preset": OptionRule(("febio",), ("loads",)),
        "loads": OptionRule(("febio",)),
    },
    "reproduce": {"tumour": OptionRule(("brain",))},
    "benchmark": {
        "data": OptionRule(("size",)),
        **_none_beside(("task", "method", "size", "minutes", "seed"), "report"),
    },
}  # fmt: skip
"""Function of `physgnn.stages` → argument → its rule."""


def check_options(
    command: str, given: Collection[str], shown: Callable[[str], str]
) -> None:
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
