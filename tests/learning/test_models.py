"""Options of a method are of the kind that it has by default."""

import pytest

from physgnn.errors import InputError
from physgnn.learning.models import MODELS, resolved_options


@pytest.mark.parametrize(
    ("option", "wrong", "kind"),
    [
        ("any_axes", "false", "true or false"),
        ("any_axes", 1, "true or false"),
        ("width", "32", "a number"),
        ("layers", True, "a number"),
    ],
)
def test_a_value_of_another_kind_is_refused(
    option: str, wrong: object, kind: str
) -> None:
    with pytest.raises(
        InputError, match=f"'{option}' of model 'lifted' must be {kind}"
    ):
        resolved_options("lifted", {option: wrong})


@pytest.mark.parametrize("name", MODELS)
def test_the_defaults_are_of_their_own_kind(name: str) -> None:
    defaults = resolved_options(name, {})
    assert resolved_options(name, defaults) == defaults
