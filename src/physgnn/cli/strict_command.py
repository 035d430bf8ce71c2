"""A command that refuses options which nothing would use."""

from typing import Any

from typer.core import TyperCommand

from physgnn.stages.naming import COMMANDS
from physgnn.stages.option_rules import check_options

ON_COMMAND_LINE = "COMMANDLINE"


class StrictCommand(TyperCommand):
    """One that asks `physgnn.stages.option_rules` before it begins."""

    def make_context(self, *args: Any, **extra: Any) -> Any:
        """Parse what was given; raise InputError if an option is of no use."""
        found = super().make_context(*args, **extra)
        given = [name for name in found.params if _is_given(found, name)]
        shown = {parameter.name: _shown(parameter) for parameter in self.params}
        check_options(COMMANDS[str(self.name)], given, shown.__getitem__)
        return found


def _is_given(ctx: Any, name: str) -> bool:
    source = ctx.get_parameter_source(name)
    return source is not None and source.name == ON_COMMAND_LINE


def _shown(parameter: Any) -> str:
    """Return a parameter as a user writes it."""
    long = (name for name in parameter.opts if name.startswith("--"))
    return next(long, f"the argument {parameter.name}")
