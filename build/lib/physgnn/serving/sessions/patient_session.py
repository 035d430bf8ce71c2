"""One browser's patient: a craniotomy that is tried, files, states registered."""

import asyncio
import json
import logging
from collections.abc import Awaitable, Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.serving.patient.desk import Desk, Opening, RegisteredShift
from physgnn.serving.patient.uploads import ReceivedFile, Uploads, states_of
from physgnn.serving.protocol.patient_messages import (
    AdaptNetwork,
    Forget,
    MeasuredFile,
    OpenSkull,
    PatientMessage,
    Register,
    Save,
    ShowState,
    TriedCraniotomy,
)
from physgnn.serving.scene.section import Section
from physgnn.serving.scene.viewed import view_mesh, view_run
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.patient_frames import opening_frame, state_frame
from physgnn.serving.sessions.predictions import scene_frame

LOG = logging.getLogger("uvicorn.error")
REPORT = "please report what stands in its terminal"

SendText = Callable[[str], Awaitable[None]]
SendBytes = Callable[[bytes], Awaitable[None]]


class PatientSession:
    """Does for one browser what it asks at the desk, one thing after another.

    Of each kind of message the newest waits, so nothing queues.

    Parameters
    ----------
    engine : Engine
        Shared by all sessions.
    desk : Desk
        The engine's.
    send_text, send_bytes : async callables
        To the browser.
    section : callable
        Returns the cut that the browser shows, if there is one.
    """

    def __init__(
        self,
        engine: Engine,
        desk: Desk,
        send_text: SendText,
        send_bytes: SendBytes,
        section: Callable[[], Section | None],
    ) -> None:
        self._engine, self._desk, self._section = engine, desk, section
        self._send_text, self._send_bytes = send_text, send_bytes
        self._uploads = Uploads(list(desk.roles), desk.suffixes)
        self._states: list[tuple[str, RegisteredShift]] = []
        self._opening: Opening | None = None
        self._waiting: dict[type[PatientMessage], PatientMessage] = {}
        self._changed = asyncio.Event()
        self._task: asyncio.Task[None] | None = None

    def take(self, message: PatientMessage) -> None:
        """Take a message; what needs time is done later."""
        if isinstance(message, MeasuredFile):
            self._uploads.announce(message)
        elif isinstance(message, Forget):
            self._uploads.forget()
        else:
            self._waiting[type(message)] = message
            self._changed.set()
            self._task = self._task or asyncio.create_task(self._serve())

    def add(self, content: bytes) -> None:
        """Take the next bytes of a file."""
        self._uploads.add(content)

    def close(self) -> None:
        """Stop, and delete the files."""
        if self._task is not None:
            self._task.cancel()
        self._uploads.close()

    async def _serve(self) -> None:
        while True:
            await self._changed.wait()
            self._changed.clear()
            while self._waiting:
                message = self._waiting.pop(next(iter(self._waiting)))
                try:
                    await self._answer(message)
                except InputError as error:
                    await self._say("error", id=None, text=str(error))
                except Exception as error:  # ours; the page must not wait for ever
                    LOG.exception("an error in physgnn itself")
                    text = f"an error in physgnn itself ({type(error).__name__})"
                    await self._say("error", id=None, text=f"{text}: {REPORT}")

    async def _answer(self, message: PatientMessage) -> None:
        if isinstance(message, TriedCraniotomy):
            await self._try(message)
        elif isinstance(message, OpenSkull):
            await self._open()
        elif isinstance(message, AdaptNetwork):
            await self._adapt()
        elif isinstance(message, Register):
            await self._register(message)
        elif isinstance(message, ShowState):
            await self._show(message.state, message.field)
        elif isinstance(message, Save):
            await self._save()

    async def _try(self, message: TriedCraniotomy) -> None:
        point, radius = np.array(message.point), message.radius_mm
        self._opening = await self._engine.draw(
            partial(self._desk.opening, point, radius)
        )
        await self._send_bytes(opening_frame(self._engine, self._opening))

    async def _open(self) -> None:
        if self._opening is None:
            raise InputError("there is no craniotomy yet: click it on the brain")
        files = await self._engine.register(partial(self._desk.open, self._opening))
        mesh, title = self._desk.mesh, self._engine.viewed.title
        await self._engine.reopen(lambda: view_mesh(mesh, title))
        self._states = []  # they were registered in another skull
        await self._send_bytes(scene_frame(self._engine))
        await self._say("saved", files=files, what="craniotomy")

    async def _adapt(self) -> None:
        await self._say("adapting")
        run = await self._engine.register(self._desk.adapt)
        title = self._engine.viewed.title
        await self._engine.reopen(lambda: view_run(run, title))
        await self._send_bytes(scene_frame(self._engine))

    async def _register(self, message: Register) -> None:
        measured = states_of(self._uploads.files)
        self._states = []
        for number, files in enumerate(measured):
            await self._say("registering", state=number, states=len(measured))
            job = partial(self._one_state, number, files, message.noise_mm)
            name, shift = await self._engine.register(job)
            self._states.append((name, shift))
            self._engine.publish(shift.prediction)
        await self._show(len(self._states) - 1, "deviation")

    def _one_state(
        self, number: int, files: dict[str, ReceivedFile], noise_mm: float
    ) -> tuple[str, RegisteredShift]:
        out = self._uploads.folder / f"registered-{number + 1}.vtu"
        paths = {role: file.path for role, file in files.items()}
        name = " + ".join(dict.fromkeys(file.name for file in files.values()))
        try:
            shift = self._desk.register(paths, out, noise_mm)
        except InputError as error:
            raise InputError(_named(str(error), files, self._uploads.folder)) from error
        notes = [_named(note, files, self._uploads.folder) for note in shift.notes]
        return name, replace(shift, notes=tuple(notes))

    async def _show(self, number: int, field: str) -> None:
        if number >= len(self._states):
            raise InputError("this state is not registered: register it again")
        make = partial(
            state_frame, self._engine, self._states, number, field, self._section()
        )
        await self._send_bytes(await self._engine.draw(make))

    async def _save(self) -> None:
        if not self._states:
            raise InputError("nothing is registered yet: there is nothing to save")
        shifts = [shift for _, shift in self._states]
        files = await self._engine.register(partial(self._desk.save, shifts))
        await self._say("saved", files=files, what="registration")

    async def _say(self, kind: str, **what: object) -> None:
        await self._send_text(json.dumps({"kind": kind, **what}))


def _named(text: str, files: dict[str, ReceivedFile], folder: Path) -> str:
    """Return a line with files called what the page calls them."""
    for file in files.values():
        text = text.replace(str(file.path), file.name)
        text = text.replace(file.path.name, file.name)
    return text.replace(f"{folder}/", "")
