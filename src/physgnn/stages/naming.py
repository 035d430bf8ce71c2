"""How the words of a command become those of its function.

A function has the command's name, dashes written as underscores, but for ``import``,
which Python keeps for itself. An option's name is the argument's in the same way, but
for those in `OPTIONS`. Beside these a function may take what a terminal shows,
or what only Python can hand over: `CALLBACKS`.
"""

from collections.abc import Mapping

from physgnn import stages

IMPORT = "import_results"
COMMANDS: Mapping[str, str] = {
    "import" if name == IMPORT else name.replace("_", "-"): name for name in dir(stages)
}
"""Command → function of `physgnn.stages`."""
OPTIONS: Mapping[str, str] = {"as": "form", "from": "start"}
"""Option → argument, where the option's name is a keyword of Python."""
CALLBACKS = frozenset({"log", "progress", "registrar", "show"})
"""Arguments without option: called with what a terminal shows, or ready in Python."""
