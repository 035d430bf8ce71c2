"""The reference of the commands, written from the command line itself."""

import mkdocs_gen_files
import typer
from typer.cli import get_docs_for_click

from physgnn.cli.app import app

command = typer.main.get_command(app)
command.commands = {
    name: shown for name, shown in command.commands.items() if not shown.hidden
}
for shown in command.commands.values():  # whole sentences, not the first few words
    shown.short_help = (shown.help or "").split("\n\n")[0]
context = typer.Context(command, info_name="physgnn")
text = get_docs_for_click(obj=command, ctx=context, name="physgnn", title="Commands")
with mkdocs_gen_files.open("reference/commands.md", "w") as file:
    file.write(text)
