"""Readers that may crash, in a process of their own.

This file runs as a script, which imports NumPy and one reader alone: see
`physgnn.io.untrusted.isolated` for its other side. The reader is a file with a function
``serve``, from a request to named arrays. Each line of standard input is a request in
JSON, ``{"out": …, …}``; the arrays go to the .npz file ``out``, and one line of JSON
answers.
"""

import json
import os
import runpy
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

LONGEST_COMPLAINT = 200


def main(limit_bytes: int, reader: str) -> None:
    """Serve requests until standard input ends."""
    replies = os.fdopen(os.dup(1), "w")
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)  # native libraries write to both
    os.dup2(silence, 2)
    _bound_memory(limit_bytes)
    serve = runpy.run_path(reader)["serve"]
    for line in sys.stdin:
        _end_with_parent(while_reading=True)
        answer = _answer(serve, json.loads(line))
        _end_with_parent(while_reading=False)
        replies.write(json.dumps({"error": answer}) + "\n")
        replies.flush()


def _answer(
    serve: Callable[[dict[str, Any]], Mapping[str, Any]], request: dict[str, Any]
) -> str:
    """Write what was asked for; return what is wrong with it, or nothing."""
    try:
        np.savez(request["out"], **serve(request))
    except SystemExit as end:  # of libraries that exit on bad input
        return f"its reader gave up ({end.code})"
    except Exception as caught:
        kind = "" if type(caught) is ValueError else f"{type(caught).__name__}: "
        return " ".join(f"{kind}{caught}".split())[:LONGEST_COMPLAINT]
    return ""


def _end_with_parent(*, while_reading: bool) -> None:
    """Have the system end this process if standard input closes, or not any more.

    Compiled code that hangs would not see it. Between requests `main` does.
    """
    if not hasattr(os, "O_ASYNC"):  # macOS, Windows
        return
    import fcntl

    fcntl.fcntl(0, fcntl.F_SETOWN, os.getpid())
    flags = fcntl.fcntl(0, fcntl.F_GETFL) & ~os.O_ASYNC
    fcntl.fcntl(0, fcntl.F_SETFL, flags | (os.O_ASYNC if while_reading else 0))


def _bound_memory(limit_bytes: int) -> None:
    """Make allocations beyond a bound fail, where the system can."""
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, limit_bytes))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
