"""What the page can give is what `register` takes, and is refused where that is."""

import inspect
from pathlib import Path

import pytest

from physgnn import choices
from physgnn.errors import InputError
from physgnn.serving.patient.desk import MeasuredState, RegisterOptions
from physgnn.stages.option_rules import RULES
from physgnn.stages.patient.intraoperative.registration import register
from physgnn.stages.patient.live_view.case_states import how_to_register
from physgnn.stages.patient.live_view.page_options import (
    CHOICES,
    ROLES,
    check_chosen,
    in_page_words,
    roles_for,
)

ARGUMENTS = inspect.signature(register).parameters


@pytest.mark.parametrize(
    ("name", "rows"), [("contrast", "Contrast"), ("transformed", "Transformed")]
)
def test_a_choice_has_what_the_command_has_and_its_default(
    name: str, rows: str
) -> None:
    assert sorted(CHOICES[name].values) == sorted(choices.names(rows))
    assert next(iter(CHOICES[name].values)) == ARGUMENTS[name].default


def test_a_choice_is_on_show_with_the_files_that_its_rule_needs() -> None:
    assert roles_for("contrast") == ["intraoperative"]
    assert roles_for("transformed") == ["initial transform"]
    assert {row.argument for row in ROLES.values()} <= set(ARGUMENTS)


def states(*roles: str) -> list[MeasuredState]:
    return [MeasuredState("a", {role: Path(role) for role in roles})]


def test_what_is_chosen_reaches_the_registration() -> None:
    chosen = {"contrast": "flair", "transformed": "after"}
    roles = ("intraoperative", "initial transform")
    how = how_to_register(states(*roles), RegisterOptions(0.7, True, chosen))
    assert (how.noise_mm, how.rigid_offset) == (0.7, True)
    assert (how.scan.contrast, how.transformed) == ("flair", "after")
    how = how_to_register(states("pairs"), RegisterOptions())
    assert (how.scan.contrast, how.transformed) == ("t1", "both")


@pytest.mark.parametrize(
    ("roles", "chosen", "says"),
    [
        (
            ("pairs",),
            {"contrast": "t2"},
            "contrast of the scan is of no use without scan of the operation: give",
        ),
        (
            ("pairs", "intraoperative"),
            {"transformed": "after"},
            "takes along is of no use without initial transform: give",
        ),
        (("after",), {}, "points after is of no use without points before: give"),
        (("pairs", "bone after"), {}, "without bone points before: give that too"),
        (("bone", "initial transform"), {}, "nothing was measured of the brain: add"),
        (("intraoperative",), {"contrast": "t3"}, r"t1, t1c, t2, flair \(got 't3'\)"),
        (("pairs",), {"skull": "none"}, "there is no 'skull' to choose"),
    ],
)
def test_what_nothing_would_use_is_refused_in_the_words_of_the_page(
    roles: tuple[str, ...], chosen: dict[str, str], says: str
) -> None:
    with pytest.raises(InputError, match=says) as error:
        check_chosen(roles, chosen)
    assert "--" not in str(error.value)


def test_every_rule_of_what_the_page_gives_is_asked() -> None:
    given = {row.argument: role for role, row in ROLES.items()}
    for argument, rule in RULES["register"].items():
        if argument in given and rule.needs:
            with pytest.raises(InputError, match="is of no use without"):
                check_chosen([given[argument]], {})


def test_options_of_the_command_are_called_what_the_page_calls_them() -> None:
    said = "give the transform (--initial-transform), or what it shows as --surface"
    expected = "give the transform (initial transform), or what it shows as exposed"
    assert in_page_words(said) == f"{expected} surface"
    assert in_page_words("--whole-surface and --bone") == (
        "whole surface and pairs of bone points"
    )
    assert in_page_words("start it with --save FOLDER") == "start it with --save FOLDER"
