"""One browser's patient: a craniotomy that is tried, files, states registered."""

import asyncio
import json
import logging
from collections.abc import Awaitable, Callable
from functools import partial
from shutil import rmtree

import numpy as np

from physgnn.errors import InputError
from physgnn.serving.patient.desk import (
    Desk,
    MeasuredState,
    Opening,
    RegisteredShift,
    RegisterOptions,
)
from physgnn.serving.patient.uploads import (
    Uploads,
    name_of,
    names_of,
    paths_of,
    states_of,
)
from physgnn.serving.protocol.patient_messages import (
    AdaptNetwork,
    Forget,
    MeasuredFile,
    OpenSkull,
    PatientMessage,
    Register,
    Save,
    SendMisfits,
    ShowState,
    TriedCraniotomy,
)
from physgnn.serving.scene.section import Section
from physgnn.serving.scene.viewed import view_mesh, view_run
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.patient_frames import (
    NamedState,
    failed_rows,
    opening_frame,
    shift_of,
    state_frame,
)
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
        self._states: list[NamedState] = []
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
        elif isinstance(message, SendMisfits):
            await self._send_misfits(message.state)
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
        measured = states_of(self._uploads.files, self._desk.roles)
        self._states = []
        folder = self._uploads.folder / "states"
        rmtree(folder, ignore_errors=True)  # of the registration before
        folder.mkdir()
        states = [
            MeasuredState(name_of(files, measured), paths_of(files), names_of(files))
            for files in measured
        ]
        options = RegisterOptions(
            message.noise_mm, message.rigid_offset, message.chosen
        )
        shifts = self._desk.register(states, folder, options)
        for number, state in enumerate(states):
            await self._say("registering", state=number, states=len(states))
            shift = await self._engine.register(partial(next, shifts))
            name = " + ".join(dict.fromkeys(state.called.values()))
            self._states.append((name, shift))
            if isinstance(shift, RegisteredShift):
                self._engine.publish(shift.found.prediction)
        await self._show_last()

    async def _show_last(self) -> None:
        """Show the last state that is registered; say so if none is."""
        there = [
            number
            for number, (_, state) in enumerate(self._states)
            if isinstance(state, RegisteredShift)
        ]
        if there:
            await self._show(there[-1], "deviation")
            return
        states, self._states = self._states, []
        await self._say("unregistered", states=len(states), failed=failed_rows(states))

    async def _show(self, number: int, field: str) -> None:
        make = partial(
            state_frame, self._engine, self._states, number, field, self._section()
        )
        await self._send_bytes(await self._engine.draw(make))

    async def _send_misfits(self, number: int) -> None:
        file = shift_of(self._states, number).misfits
        text = await self._engine.draw(partial(file.read_text, "utf-8"))
        await self._say("misfits", name=file.name, text=text)

    async def _save(self) -> None:
        if not self._states:
            raise InputError("nothing is registered yet: there is nothing to save")
        states = [state for _, state in self._states]
        files = await self._engine.register(partial(self._desk.save, states))
        await self._say("saved", files=files, what="registration")

    async def _say(self, kind: str, **what: object) -> None:
        await self._send_text(json.dumps({"kind": kind, **what}))
