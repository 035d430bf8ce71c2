"""An option that nothing would use is refused, by the command line and in a batch."""

import inspect

import pytest

from physgnn import stages
from physgnn.errors import InputError
from physgnn.stages.option_rules import RULES, check_options

PAIRS = [
    (command, name, rule)
    for command, rows in RULES.items()
    for name, rule in rows.items()
]


@pytest.mark.parametrize("command", RULES)
def test_rules_speak_of_arguments_that_there_are(command: str) -> None:
    arguments = set(inspect.signature(getattr(stages, command)).parameters)
    for name, rule in RULES[command].items():
        assert {name, *rule.needs, *rule.useless_with} <= arguments
        assert rule.needs or rule.useless_with
        assert name not in {*rule.needs, *rule.useless_with}


@pytest.mark.parametrize(("command", "name", "rule"), PAIRS)
def test_an_option_of_no_use_is_refused(command: str, name: str, rule: object) -> None:
    needs, beside = rule.needs, rule.useless_with  # type: ignore[attr-defined]
    if needs:
        with pytest.raises(InputError, match=f"<{name}> is of no use without <"):
            check_options(command, [name], "<{}>".format)
        for other in needs:
            check_options(command, [name, other], "<{}>".format)
    for other in beside:
        given = [name, other, *needs]
        with pytest.raises(InputError, match=f"<{name}> is of no use beside <{other}>"):
            check_options(command, given, "<{}>".format)


def test_what_one_cannot_give_is_not_asked_for() -> None:
    shown = {"contrast": "the contrast", "intraoperative": "a scan"}
    with pytest.raises(InputError, match=r"the contrast is .* without a scan: give"):
        check_options("register", ["contrast"], lambda name: shown.get(name, ""))


def test_other_commands_and_options_are_free() -> None:
    check_options("warp", ["image", "labels"], str)
    check_options("register", ["points", "noise_mm"], str)
