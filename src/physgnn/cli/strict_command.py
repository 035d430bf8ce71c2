"""A command that refuses options which nothing would use."""

from typing import Any

from typer.core import TyperCommand

from physgnn.stages.naming import COMMANDS
from physgnn.stages.option_rules import check_options

ON_COMMAND_LINE = "COMMANDLINE"


class StrictCommand(TyperCommand):
    """One that asks `physgnn.stages.option_rules` before it begins."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command, unless an option is of no use beside the others."""
        given = [name for name in ctx.params if _is_given(ctx, name)]
        shown = {parameter.name: _shown(parameter) for parameter in self.params}
        check_options(COMMANDS[str(self.name)], given, shown.__getitem__)
        return super().invoke(ctx)


def _is_given(ctx: Any, name: str) -> bool:
    source = ctx.get_parameter_source(name)
    return source is not None and source.name == ON_COMMAND_LINE


def _shown(parameter: Any) -> str:
    """Return a parameter as a user writes it."""
    long = (name for name in parameter.opts if name.startswith("--"))
    return next(long, f"the argument {parameter.name}")
