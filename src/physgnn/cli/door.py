"""The way out of every command: one line and an exit code, whatever happened.

0: done. 1: an error of ours, with the traceback in a file. 2: wrong input, or a file
that cannot be read or written. 3: done, but the status says not to rely on the result.
130 and 143: Ctrl-C and SIGTERM. Nothing heavy is imported before `main` guards it.
"""

import atexit
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from types import FrameType

FAILED, WRONG_INPUT = 1, 2
# Python's tracker of shared memory cleans up after a process that a signal ended, and
# says so, after our last line, unless a warning filter that it inherits says not to.
OF_THE_TRACKER = "ignore:resource_tracker:UserWarning"


def command(module: str = "physgnn.cli.app") -> None:
    """Run `main` as a program of its own, which ends without taking itself apart.

    Python frees every object of every module before it ends, which takes most of a
    second where PyTorch was imported. What was registered to be done at the end is
    done, and threads are waited for, as ever.
    """
    ended: list[int] = []
    atexit.register(_leave, ended)  # the first that is registered is the last to run
    try:
        main(module)
    except SystemExit as error:
        if isinstance(error.code, int):
            ended.append(error.code)
        raise


def _leave(ended: list[int]) -> None:
    """Leave with an exit code, if there is one."""
    if not ended:
        return
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # closed, or nobody reads
            stream.flush()
    os._exit(ended[0])


def main(module: str = "physgnn.cli.app") -> None:
    """Run the command line, or another module that has a function ``run``."""
    _silence_other_ranks()
    sys.exit(_code(module))


def _code(module: str) -> int:
    sys.warnoptions.append(OF_THE_TRACKER)
    # In a terminal Ctrl-C goes to all processes. The first one started the others such
    # that they ignore it, and ends them.
    numbers = (signal.SIGTERM,) if _is_other_rank() else (signal.SIGINT, signal.SIGTERM)
    _end_at_once_on_signals(numbers)
    from importlib import import_module

    from physgnn import interrupts

    run = import_module(module).run
    interrupts.install(numbers)
    code = _guarded(run)
    number = interrupts.received()
    return code if number is None else _interrupted(number)


def _guarded(run: Callable[[], int]) -> int:
    """Run the command and return its exit code; say what went wrong, in one line."""
    from physgnn import scratch
    from physgnn.errors import InputError

    try:
        scratch.clear_at_start()
        code = run()
        sys.stdout.flush()
        return code
    except InputError as error:
        return _complain(str(error))
    except BrokenPipeError:
        return _nobody_reads()
    except OSError as error:
        return _complain(
            f"{error.strerror or error}: {error.filename or ''}".rstrip(": ")
        )
    except MemoryError as error:
        return _complain(f"not enough memory {error}".strip())
    except SystemExit as error:
        return error.code if isinstance(error.code, int) else FAILED
    except KeyboardInterrupt:  # raised by a library, not by our handler
        return 128 + signal.SIGINT
    except Exception as error:
        from physgnn import interrupts

        if interrupts.received() is not None:
            return FAILED  # it followed from the signal
        from physgnn.cli.bug_report import write_report

        return _complain(write_report(error), FAILED)


def _interrupted(number: int) -> int:
    """End the processes this one started, and say why; threads get a moment to end."""
    from physgnn import interrupts

    _say(interrupts.name_of(number))
    interrupts.end_children()
    interrupts.end_soon(128 + number)
    with open(os.devnull, "w") as nowhere:  # noqa: PTH123
        os.dup2(nowhere.fileno(), 2)  # what threads still say is of no use
    return 128 + number


def _end_at_once_on_signals(numbers: tuple[signal.Signals, ...]) -> None:
    """End on a signal while modules are imported: nothing needs cleaning up yet.

    An exception would be printed, or lost, by whichever import it hits.
    """

    def end(number: int, _: FrameType | None) -> None:
        what = b"interrupted" if number == signal.SIGINT else b"terminated"
        os.write(2, b"physgnn: " + what + b"\n")
        os._exit(128 + number)

    with suppress(ValueError):  # not the main thread
        for number in numbers:
            signal.signal(number, end)


def _silence_other_ranks() -> None:
    """Of processes that train together, the first speaks for all."""
    if _is_other_rank():
        sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: PTH123, SIM115


def _is_other_rank() -> bool:
    return int(os.environ.get("LOCAL_RANK", 0)) > 0


def _nobody_reads() -> int:
    """Whoever read the output has left, as ``head`` does: no news for anyone."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return FAILED


def _complain(text: str, code: int = WRONG_INPUT) -> int:
    _say(text)
    return code


def _say(text: str) -> None:
    with suppress(OSError):  # standard error may be closed, too
        print(f"physgnn: {text}", file=sys.stderr, flush=True)
