"""Programs that end with the process that waits for them, however that ends.

A process that is killed cannot end its children: a mesher would run on for half an
hour. Linux does it where a child asks for it before it becomes the program, see
PR_SET_PDEATHSIG in prctl(2). Elsewhere programs are started as they are.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Sequence

SET_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of linux/prctl.h
CANNOT_RUN = 126  # as in shells


def ending_with_us(command: Sequence[str]) -> list[str]:
    """Return the command for a program that ends when the starting thread does.

    The thread that starts it has to wait for it: Linux asks for the thread, not for the
    process.

    Parameters
    ----------
    command : sequence of str
        A program's path, and its arguments.
    """
    if not sys.platform.startswith("linux") or not sys.executable:
        return list(command)
    # neither the user's settings nor installed packages are read: it takes 20 ms
    return [sys.executable, "-I", "-S", __file__, str(os.getpid()), *command]


def main(parent: int, command: list[str]) -> None:
    """Become a program that ends with its parent; end if there is none any more."""
    ctypes.CDLL(None).prctl(SET_PARENT_DEATH_SIGNAL, signal.SIGKILL)
    if os.getppid() != parent:
        sys.exit(CANNOT_RUN)
    try:
        os.execv(command[0], command)
    except OSError as error:
        print(f"{command[0]}: {error.strerror}", file=sys.stderr)
        sys.exit(CANNOT_RUN)


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
