"""What the terminal shows while something takes long."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from physgnn.progress import Progress as Callback

if TYPE_CHECKING:  # rich takes longer to import than any help
    from rich.console import Console
    from rich.progress import Task

    from physgnn.prediction.status import PredictionStatus

SECONDS_A_LINE = 60.0
NOT_USABLE = 3  # exit code; the file is written nevertheless


@cache
def _err() -> "Console":
    """Return where progress and errors go; standard output holds results only."""
    from rich.console import Console

    return Console(stderr=True)


@contextmanager
def progress(title: str, *, transient: bool = False) -> Iterator[Callback]:
    """Show a bar with the remaining time, and yield the callback that moves it.

    Where fewer steps are done than before, a further part of the work has begun: it is
    named, and has a bar of its own. A transient bar is wiped away at the end. Where no
    terminal shows it, as in the log of a run left alone, a line a minute takes its
    place.
    """
    from rich.progress import (
        BarColumn,
        Progress,
        SpinnerColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    err = _err()
    bar = Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(bar_width=30),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("elapsed,"),
        TimeRemainingColumn(),
        TextColumn("left"),
        TextColumn("[dim]{task.fields[doing]}"),
        console=err,
        transient=transient,
        disable=not err.is_terminal,  # a log holds lines, not the last state of a bar
    )
    with bar:
        task = bar.add_task(title, total=None, doing="")
        said, part = time.monotonic(), ""

        def move(done: int, total: int, text: str) -> None:
            nonlocal said, part
            if done * (bar.tasks[0].total or total) < bar.tasks[0].completed * total:
                part = text
                bar.reset(task, total=total, description=f"{title}, {part}")
            doing = "" if text == part else text
            bar.update(task, completed=done, total=total, doing=doing)
            if not err.is_terminal and time.monotonic() - said >= SECONDS_A_LINE:
                said = time.monotonic()
                say(_line(bar.tasks[0]))

        yield move


def _line(task: "Task") -> str:
    left = "" if task.time_remaining is None else f", {task.time_remaining:.0f} s left"
    return (
        f"{task.description}: {task.percentage:.1f} % after {task.elapsed or 0:.0f} s"
        f"{left} {task.fields['doing']}"
    )


@contextmanager
def working(title: str) -> Iterator[None]:
    """Show that something without countable steps is under way, and for how long."""
    with progress(title, transient=True):
        yield


def conclude(status: "PredictionStatus", reasons: Sequence[str]) -> None:
    """End a command: exit code 3, with the reasons, if a displacement is not usable."""
    for reason in reasons:
        say(f"  {reason}")
    if not status.usable:
        raise typer.Exit(NOT_USABLE)


def conclude_stored(path: Path) -> None:
    """End a command: exit code 3, with the status, if what it was given is not ok."""
    from physgnn.io.vtk.prediction_file import read_status

    stored = read_status(path)
    if not stored.usable:
        say(f"the displacement in {path} is not ok, nor what is made of it: {stored}")
        raise typer.Exit(NOT_USABLE)


def say(line: str) -> None:
    """Write a line about what is going on."""
    _err().print(line, markup=False, highlight=False, soft_wrap=True)
