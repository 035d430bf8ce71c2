"""What a record says of the call that led to a result."""

import sys
from pathlib import Path


def command_line() -> str:
    """Return what the user typed: a command, or the name of a script."""
    program, *words = sys.argv or ["python"]
    return " ".join([Path(program).name, *words])
