"""Rules of point sets in TOML: see `physgnn.geometry.point_sets`."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator

from physgnn.config.tables import read_as, read_toml, variants
from physgnn.geometry.point_sets import RULES, Rule


def _nested(table: Any) -> Rule:
    """Read a rule that another is made of."""
    rule: Rule = read_as(RULE, table, "a rule within")
    return rule


Nested = Annotated[Any, BeforeValidator(_nested)]
RULE: Any = variants(
    "kind", RULES, types={Rule: Nested, tuple[Rule, ...]: tuple[Nested, ...]}
)
"""The table of one rule: ``kind`` and the fields of that row of ``RULES``."""
RULES_BY_NAME: Any = dict[str, RULE]
"""The tables ``[point_sets.<name>]``."""


def read_point_sets(path: str | Path) -> dict[str, Rule]:
    """Read only the rules of the point sets of a TOML file; other tables may be there.

    Parameters
    ----------
    path : path
        The TOML file.

    Returns
    -------
    dict of str to Rule
        By the name of the point set.

    Raises
    ------
    InputError
        If the file cannot be read, or a rule is wrong.
    """
    tables = read_toml(path).get("point_sets", {})
    rules: dict[str, Rule] = read_as(RULES_BY_NAME, tables, path, at=("point_sets",))
    return rules
