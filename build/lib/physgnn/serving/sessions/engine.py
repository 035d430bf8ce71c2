"""What all sessions share: the predictors, one thread for them, and the solver."""

import asyncio
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import TypeVar

import torch

from physgnn.choices import Estimate
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import Prediction
from physgnn.serving.patient.desk import Desk
from physgnn.serving.scene.image_slices import GreyVolume
from physgnn.serving.scene.surfaces import Shown
from physgnn.serving.scene.viewed import Viewed
from physgnn.serving.sessions.refinement import Refiner

WARM_UP = (0.1, 0.3, 0.5, 0.7, 0.9, 1.1, 1.4, 1.8)  # of the usual force
IDLE_SECONDS = 1.0  # warming up gives way to requests

T = TypeVar("T")


class Engine:
    """Predicts the load cases of every session, one after another.

    The predictors keep state (factorisations, buffers), so one thread runs them; a
    session has at most one question in its queue, so the queue stays short.

    Parameters
    ----------
    viewed : Viewed
        What is on show.
    image : GreyVolume, optional
        Preoperative image for sections.
    desk : Desk, optional
        Does what the page may do for a patient.

    Attributes
    ----------
    listeners : list of callables
        Each is called with every prediction shown, in the event loop.
    """

    def __init__(
        self,
        viewed: Viewed,
        image: GreyVolume | None = None,
        desk: Desk | None = None,
    ) -> None:
        self.viewed, self.image, self.desk = viewed, image, desk
        self._registering = asyncio.Lock()
        self.shown = Shown.of(viewed.body.mesh)
        self.listeners: list[Callable[[Prediction], None]] = []
        self._refiner = Refiner(viewed.body)
        self._asked = time.monotonic() - IDLE_SECONDS
        # One thread for torch as well: OpenMP counts them for each thread apart, a
        # network this small gains nothing from more, and the browser needs a core.
        self._drawing = ThreadPoolExecutor(1, "draw")
        self._thread = ThreadPoolExecutor(
            1, "predict", initializer=torch.set_num_threads, initargs=(1,)
        )

    async def work(self, job: Callable[[], T]) -> T:
        """Run a job in the predictors' thread."""
        self._asked = time.monotonic()
        return await self._in_thread(job)

    async def draw(self, job: Callable[[], T]) -> T:
        """Run a job that needs no predictor, such as a section, in a thread for all."""
        return await asyncio.get_running_loop().run_in_executor(self._drawing, job)

    async def _in_thread(self, job: Callable[[], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._thread, job)

    async def register(self, job: Callable[[], T]) -> T:
        """Run a job that takes seconds, one at a time, while predictions go on."""
        async with self._registering:
            return await asyncio.to_thread(job)

    async def reopen(self, make: Callable[[], Viewed]) -> None:
        """Show the same mesh, held and loaded elsewhere or with other predictors."""
        self.viewed = await self.work(make)
        self._refiner.close()
        self._refiner = Refiner(self.viewed.body)

    async def warm_up(self) -> None:
        """Make the first predictions, which factorise and compile.

        Loads of several sizes, since a network may keep a factor for each.
        """
        exposed = self.viewed.exposed
        for fraction in WARM_UP:
            force = -fraction * self.viewed.usual_force_n / len(exposed.nodes)
            case = LoadCase(exposed.nodes, force * exposed.normals)
            for predict in self.viewed.predictors.values():
                await self._idle()
                await self._in_thread(partial(predict, case, estimate=Estimate.QUICK))
        self._refiner.start()

    async def _idle(self) -> None:
        """Wait until nobody has asked anything for a moment."""
        while (since := time.monotonic() - self._asked) < IDLE_SECONDS:
            await asyncio.sleep(IDLE_SECONDS - since)

    async def solve(self, case: LoadCase) -> Prediction:
        """Solve by finite elements in another process; cancelling kills it."""
        return await self._refiner.solve(case)

    def publish(self, prediction: Prediction) -> None:
        """Pass a prediction that is on a screen to the listeners."""
        for listener in self.listeners:
            listener(prediction)

    def close(self) -> None:
        """Stop the thread and the solver."""
        self._refiner.close()
        for thread in (self._thread, self._drawing):
            thread.shutdown(wait=False, cancel_futures=True)
