"""The pages keep their word: tutorials run, and every command shown can be parsed.

In a tutorial every block of bash and Python runs, from top to bottom, in one temporary
folder; a block with a title is a file that the reader saves under that name. What
cannot run in a test (a server) says so in a comment, ``<!-- not run: why -->``.
Elsewhere a block of Python runs alone if ``<!-- run -->`` stands before it.
"""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import click
import pytest
import typer

from documented_pages import DOCS, PAGES, ROOT, Block, blocks, command_lines, name_of
from physgnn.cli import main
from physgnn.cli.app import app
from physgnn.geometry.meshing import tetgen_process

TUTORIALS = sorted(
    page for page in (DOCS / "tutorials").glob("*.md") if page.name != "index.md"
)
SHOWN = [
    pytest.param(block, id=f"{name_of(page)}:{block.line}")
    for page in PAGES
    for block in blocks(page)
    if block.language in ("bash", "python")
]
ALONE = [
    shown
    for shown in SHOWN
    if shown.values[0].note == "run" and shown.values[0].language == "python"
]
NEED_DATA = ("tissue.py",)
"""Scripts of figures that take a folder of data, which is not part of the project."""
COMMANDS: Any = typer.main.get_command(app)


def run(block: Block, names: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """Do what a reader does with a block, in the current folder."""
    if block.title is not None:
        path = Path(block.title)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text, "utf-8")
    elif block.language == "python":
        exec(compile(block.text, f"line {block.line}", "exec"), names)
    elif block.language == "bash":
        for words in command_lines(block):
            run_command(words, monkeypatch)


def run_command(words: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Run one command; those of the package in this process, which imported it."""
    if words[0] == "python":
        subprocess.run([sys.executable, *words[1:]], check=True)
        return
    if words[0] != "physgnn":
        subprocess.run(words, check=True)
        return
    monkeypatch.setattr(sys, "argv", words)
    try:
        main()
    except SystemExit as end:
        assert end.code in (0, None), f"{' '.join(words)} ended with {end.code}"


@pytest.mark.slow
@pytest.mark.skipif(not tetgen_process.available(), reason="needs the tetgen extra")
@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_tutorial(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "__main__"}
    for block in blocks(page):
        if not block.note.startswith("not run:"):
            run(block, names, monkeypatch)


@pytest.mark.parametrize("block", ALONE)
def test_block(block: Block, tmp_path: Path) -> None:
    # in a process of its own: what it adds to a table is not there for other tests
    subprocess.run([sys.executable, "-c", block.text], cwd=tmp_path, check=True)


@pytest.mark.parametrize("block", SHOWN)
def test_what_is_shown_can_be_parsed(block: Block) -> None:
    if block.language == "python":
        compile(block.text, f"line {block.line}", "exec")
        return
    for words in command_lines(block):
        while words and "=" in words[0]:  # NAME=value before a command
            words = words[1:]
        if words[:1] == ["physgnn"]:
            parse(words[1:])
        elif words[:1] == ["python"] and words[1].startswith("benchmarks/"):
            parse_benchmark(words[1:])


def parse(arguments: list[str]) -> None:
    """Have the command line parse what is shown, and do nothing."""
    name, *rest = arguments
    assert name in COMMANDS.commands, f"there is no command physgnn {name}"
    if "--help" not in rest:
        try:
            COMMANDS.commands[name].make_context(name, rest)
        except click.ClickException as error:  # pragma: no cover
            pytest.fail(f"physgnn {name}: {error.format_message()}")


def parse_benchmark(words: list[str]) -> None:
    """Check that a benchmark exists and names the options that it is given."""
    script = ROOT / words[0]
    source = script.read_text("utf-8")
    for shared in re.findall(r"^from (\w+) import .*add_arguments", source, re.M):
        source += (script.with_name(f"{shared}.py")).read_text("utf-8")
    for option in (word.split("=")[0] for word in words if word.startswith("-")):
        assert f'"{option}"' in source, f"{words[0]} has no option {option}"


def test_every_benchmark_is_in_the_index() -> None:
    index = (ROOT / "benchmarks" / "README.md").read_text("utf-8")
    scripts = {path.name for path in (ROOT / "benchmarks").glob("*.py")}
    assert {name for name in scripts if name not in index} == set()


@pytest.mark.slow
@pytest.mark.skipif("PHYSGNN_FIGURES" not in os.environ, reason="minutes of drawing")
def test_figures_are_made_anew(tmp_path: Path) -> None:
    for script in sorted((DOCS / "figures").glob("[!_]*.py")):
        if script.name not in NEED_DATA:
            subprocess.run([sys.executable, script, tmp_path], check=True)


@pytest.mark.slow
@pytest.mark.skipif("PHYSGNN_FIGURES" not in os.environ, reason="minutes of drawing")
@pytest.mark.parametrize("name", NEED_DATA)
def test_figures_of_data_elsewhere(name: str, shared: Path, tmp_path: Path) -> None:
    command = [sys.executable, DOCS / "figures" / name, tmp_path, shared / "real"]
    subprocess.run(command, check=True)
