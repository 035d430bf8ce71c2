"""What the terminal shows while something takes long."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from physgnn.progress import Progress as Callback

err = Console(stderr=True)
"""Progress and errors; standard output holds results only."""


@contextmanager
def progress(title: str, *, transient: bool = False) -> Iterator[Callback]:
    """Show a bar with the remaining time, and yield the callback that moves it.

    A transient bar is wiped away at the end.
    """
    bar = Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(bar_width=30),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        TextColumn("[dim]{task.fields[doing]}"),
        console=err,
        transient=transient,
    )
    with bar:
        task = bar.add_task(title, total=None, doing="")

        def move(done: int, total: int, text: str) -> None:
            bar.update(task, completed=done, total=total, doing=text)

        yield move


@contextmanager
def working(title: str) -> Iterator[None]:
    """Show that something without countable steps is under way, and for how long."""
    with progress(title, transient=True):
        yield


def say(line: str) -> None:
    """Write a line about what is going on."""
    err.print(line, markup=False, highlight=False, soft_wrap=True)
