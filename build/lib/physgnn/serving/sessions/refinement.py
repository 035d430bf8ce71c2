"""Finite elements in a process of their own, which can be dropped at any moment."""

import asyncio
import multiprocessing
import os
import signal
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import Prediction

NICENESS = 5  # the picture comes first

# A fork of a server that has imported everything starts in milliseconds, so that
# killing a solve nobody waits for costs little.
_CONTEXT = multiprocessing.get_context("forkserver")
_CONTEXT.set_forkserver_preload(["physgnn.prediction.finite_element"])


class Refiner:
    """Solves one load case at a time; the others wait in line.

    Parameters
    ----------
    body : Body
        What is loaded.
    """

    def __init__(self, body: Body) -> None:
        self._body = body
        self._turn = asyncio.Lock()
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    async def solve(self, case: LoadCase) -> Prediction:
        """Return the finite-element solution; cancelling this kills the solve.

        Raises
        ------
        InputError
            If the body cannot be solved, or the process died.
        """
        async with self._turn:
            pipe = self._started()
            try:
                await asyncio.to_thread(pipe.send, case)
                reply = await asyncio.to_thread(pipe.recv)
            except asyncio.CancelledError:
                self.close()
                raise
            except (EOFError, OSError) as error:
                self.close()
                raise InputError("the finite-element process ended early") from error
        if isinstance(reply, str):
            raise InputError(reply)
        assert isinstance(reply, Prediction)
        return reply

    def start(self) -> None:
        """Have a process ready before it is needed."""
        self._started()

    def close(self) -> None:
        """Kill the process; the next solve starts another."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
        # The pipe is not closed: a thread may still wait at it, and now meets its end.
        self._process = self._pipe = None

    def _started(self) -> Connection:
        if self._pipe is None or self._process is None or not self._process.is_alive():
            self.close()
            self._pipe, other = _CONTEXT.Pipe()
            self._process = _CONTEXT.Process(
                target=_serve, args=(other, self._body), daemon=True
            )
            self._process.start()
            other.close()  # so that a killed process is an end of file here
        return self._pipe


def _serve(pipe: Connection, body: Body) -> None:
    from physgnn.prediction.finite_element import FiniteElementPredictor

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    os.nice(NICENESS)
    solver: FiniteElementPredictor | None = None
    while True:
        try:
            case = pipe.recv()
        except EOFError:
            return
        try:
            solver = solver or FiniteElementPredictor(body)
            pipe.send(solver(case))
        except InputError as error:
            pipe.send(str(error))
