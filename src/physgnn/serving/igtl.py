"""The deformation as an OpenIGTLink stream, for 3D Slicer and its kin.

Every client gets IMAGE "Displacement" (three float32 components, mm, RAS, 0 outside the
body), STRING "Status" (what the displacement is called, and why it is not ok if it is
not) and, where wanted, POLYDATA "Brain", "Tumour", … (the deformed surfaces). Only the
newest displacement is sent, so a slow client sees fewer frames and holds up nobody.
"""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
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
AT_REST = "at rest"  # what stands for a status before anything was pushed


@dataclass(frozen=True, eq=False)
class ShownShift:
    """A displacement, and what it is called."""

    displacement: FloatArray
    status: str

    @classmethod
    def of(cls, prediction: Prediction) -> "ShownShift":
        """Return a prediction's, with the reasons for its status."""
        words = [str(prediction.status), "; ".join(prediction.reasons)]
        text = ": ".join(word for word in words if word)
        # pyigtl 0.3.4 packs nothing but ASCII.
        text = text.replace("°", " degrees").encode("ascii", "replace").decode()
        return cls(prediction.displacement, text)


class Newest:
    """The newest shift, and a way to wait for the next."""

    def __init__(self, shift: ShownShift) -> None:
        self.shift = shift
        self.number = 0
        self._changed = asyncio.Condition()

    async def put(self, shift: ShownShift) -> None:
        """Replace it and wake who waits."""
        async with self._changed:
            self.shift, self.number = shift, self.number + 1
            self._changed.notify_all()

    async def after(self, number: int) -> tuple[int, ShownShift]:
        """Return it as soon as it is newer than a number."""
        async with self._changed:
            await self._changed.wait_for(lambda: self.number > number)
            return self.number, self.shift


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
    loaded_pyigtl()
    mesh = engine.viewed.body.mesh
    grid = await asyncio.to_thread(grid_over, mesh, GRID_MM)
    newest = Newest(ShownShift(np.zeros_like(mesh.points), AT_REST))
    pack = partial(_pack, engine, grid, surfaces)
    pending: set[asyncio.Task[None]] = set()

    def listen(prediction: Prediction) -> None:
        task = asyncio.create_task(newest.put(ShownShift.of(prediction)))
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
    pack: Callable[[ShownShift], bytes],
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
            number, shift = waiting.result()
            writer.write(await asyncio.to_thread(pack, shift))
            await writer.drain()
            await asyncio.sleep(PAUSE_SECONDS)
    leaving.cancel()
    writer.close()


async def _drained(reader: asyncio.StreamReader) -> None:
    """Read and drop what a client sends until it leaves."""
    with suppress(ConnectionError):
        while await reader.read(4096):
            pass


def _pack(engine: Engine, grid: SampleGrid, surfaces: bool, shift: ShownShift) -> bytes:
    pyigtl, displacement = loaded_pyigtl(), shift.displacement
    field = grid.at(displacement).astype(np.float32)
    messages = [
        pyigtl.ImageMessage(field, grid.to_world, "ras", device_name="Displacement"),
        pyigtl.StringMessage(shift.status, device_name="Status"),
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


def loaded_pyigtl() -> Any:
    """Return the package; InputError if it is not installed."""
    try:
        import pyigtl
    except ModuleNotFoundError as error:
        raise InputError(
            "OpenIGTLink needs the package pyigtl: pip install 'physgnn[igtl]'"
        ) from error
    return pyigtl
