"""The deformation as an OpenIGTLink stream, for 3D Slicer and its kin.

Every client gets IMAGE "Displacement" (three float32 components, mm, RAS, 0 outside the
body) and, where wanted, POLYDATA "Brain", "Tumour", … (the deformed surfaces). Only the
newest displacement is sent, so a slow client sees fewer frames and holds up nobody.
"""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from socket import socket
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.prediction.prediction import Prediction
from physgnn.serving.scene.sample_grid import SampleGrid, grid_over
from physgnn.serving.sessions.engine import Engine

GRID_MM = 4.0  # about the edge length of the meshes: a finer grid shows no more
PAUSE_SECONDS = 0.04  # between frames of one client


class Newest:
    """The newest displacement, and a way to wait for the next."""

    def __init__(self, displacement: FloatArray) -> None:
        self.displacement = displacement
        self.number = 0
        self._changed = asyncio.Condition()

    async def put(self, displacement: FloatArray) -> None:
        """Replace it and wake who waits."""
        async with self._changed:
            self.displacement, self.number = displacement, self.number + 1
            self._changed.notify_all()

    async def after(self, number: int) -> tuple[int, FloatArray]:
        """Return it as soon as it is newer than a number."""
        async with self._changed:
            await self._changed.wait_for(lambda: self.number > number)
            return self.number, self.displacement


@asynccontextmanager
async def stream(
    engine: Engine, listening: socket, *, surfaces: bool = False
) -> AsyncIterator[None]:
    """Serve every prediction of the engine to OpenIGTLink clients.

    Parameters
    ----------
    engine : Engine
        Whose predictions are sent.
    listening : socket
        Bound to an address.
    surfaces : bool
        Send POLYDATA too. pyigtl's own client cannot read those.

    Raises
    ------
    InputError
        If pyigtl is not installed.
    """
    _pyigtl()
    mesh = engine.viewed.body.mesh
    grid = await asyncio.to_thread(grid_over, mesh, GRID_MM)
    newest = Newest(np.zeros_like(mesh.points))
    pack = partial(_pack, engine, grid, surfaces)
    pending: set[asyncio.Task[None]] = set()

    def listen(prediction: Prediction) -> None:
        task = asyncio.create_task(newest.put(prediction.displacement))
        pending.add(task)
        task.add_done_callback(pending.discard)

    engine.listeners.append(listen)
    server = await asyncio.start_server(
        partial(_send_all, newest, pack), sock=listening
    )
    try:
        yield
    finally:
        engine.listeners.remove(listen)
        server.close()


async def _send_all(
    newest: Newest,
    pack: Callable[[FloatArray], bytes],
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
) -> None:
    """Send one client every prediction it has time for, the present one at once."""
    leaving = asyncio.create_task(_drained(reader))
    number = -1
    with suppress(ConnectionError, asyncio.CancelledError):
        while not leaving.done():
            waiting = asyncio.create_task(newest.after(number))
            await asyncio.wait({waiting, leaving}, return_when=asyncio.FIRST_COMPLETED)
            if leaving.done():
                waiting.cancel()
                break
            number, displacement = waiting.result()
            writer.write(await asyncio.to_thread(pack, displacement))
            await writer.drain()
            await asyncio.sleep(PAUSE_SECONDS)
    leaving.cancel()
    writer.close()


async def _drained(reader: asyncio.StreamReader) -> None:
    """Read and drop what a client sends until it leaves."""
    with suppress(ConnectionError):
        while await reader.read(4096):
            pass


def _pack(
    engine: Engine, grid: SampleGrid, surfaces: bool, displacement: FloatArray
) -> bytes:
    pyigtl = _pyigtl()
    field = grid.at(displacement).astype(np.float32)
    messages = [
        pyigtl.ImageMessage(field, grid.to_world, "ras", device_name="Displacement")
    ]
    if surfaces:
        shown = engine.shown
        points = (engine.viewed.body.mesh.points + displacement)[shown.nodes]
        messages += [
            pyigtl.PolyDataMessage(
                points=points, polygons=_polygons(faces), device_name=name.title()
            )
            for name, faces in shown.faces.items()
        ]
    return b"".join(message.pack() for message in messages)


def _polygons(faces: IntArray) -> IntArray:
    """Return triangles as VTK lists them: each after the number of its corners."""
    return np.insert(faces, 0, 3, axis=1).ravel()


def _pyigtl() -> Any:
    try:
        import pyigtl
    except ModuleNotFoundError as error:
        raise InputError(
            "OpenIGTLink needs the package pyigtl: pip install 'physgnn[igtl]'"
        ) from error
    return pyigtl
