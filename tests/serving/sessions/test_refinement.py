import asyncio

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.serving.sessions.refinement import Refiner

WAIT = 120.0


@pytest.fixture
def case(body: Body) -> LoadCase:
    top = body.mesh.point_set("loaded")
    return LoadCase(top, np.tile([0, 0, -0.02 / len(top)], (len(top), 1)))


def test_a_cancelled_solve_is_killed_and_the_next_one_works(body, case) -> None:
    async def run() -> None:
        refiner = Refiner(body)
        refiner.start()
        first = refiner._process
        solving = asyncio.create_task(refiner.solve(case))
        await asyncio.sleep(0.01)
        solving.cancel()
        with pytest.raises(asyncio.CancelledError):
            await solving
        assert not first.is_alive()
        assert (await refiner.solve(case)).displacement.any()
        assert refiner._process is not first
        refiner.close()

    asyncio.run(run())


def test_solves_wait_in_line_and_a_waiting_one_can_leave(body, case) -> None:
    async def run() -> list[bool]:
        refiner = Refiner(body)
        tasks = [asyncio.create_task(refiner.solve(case)) for _ in range(3)]
        await asyncio.sleep(0)
        tasks[1].cancel()
        done = await asyncio.gather(*tasks, return_exceptions=True)
        refiner.close()
        return [isinstance(one, asyncio.CancelledError) for one in done]

    assert asyncio.run(run()) == [False, True, False]


def test_a_load_that_does_not_fit_is_an_input_error_not_a_crash(body: Body) -> None:
    pull = LoadCase(body.fixed[:1], np.ones((1, 3)))

    async def run() -> None:
        refiner = Refiner(body)
        for _ in range(2):
            with pytest.raises(InputError, match="fixed"):
                await refiner.solve(pull)
        refiner.close()

    asyncio.run(run())


def test_a_process_that_dies_is_an_input_error(body: Body, case) -> None:
    async def run() -> None:
        refiner = Refiner(body)
        solving = asyncio.create_task(refiner.solve(case))
        while refiner._process is None:
            await asyncio.sleep(0.01)
        refiner._process.kill()
        with pytest.raises(InputError, match="ended early"):
            await asyncio.wait_for(solving, WAIT)

    asyncio.run(run())
