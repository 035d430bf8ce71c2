"""One browser: its newest load is predicted, older ones are dropped."""

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable

from physgnn.choices import Estimate
from physgnn.errors import InputError
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import Prediction
from physgnn.serving.protocol.messages import (
    LoadMessage,
    Message,
    PatchLoad,
    SectionPlane,
    read_message,
)
from physgnn.serving.scene.colours import SolvedLoad
from physgnn.serving.scene.section import Section, cut
from physgnn.serving.scene.viewed import FINITE_ELEMENTS
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.patient_session import PatientSession
from physgnn.serving.sessions.predictions import (
    load_case,
    prediction_frame,
    scene_frame,
    section_frame,
)

SendText = Callable[[str], Awaitable[None]]
SendBytes = Callable[[bytes], Awaitable[None]]

REST_SECONDS = 0.25  # a load must stand still for so long before it is solved


class Session:
    """Serves one browser.

    Nothing is queued: a patch load replaces the one before it, a section likewise, and
    a frame is made only when the one before it has left. So a slow browser gets fewer
    frames, never older ones, and holds up nobody else.

    Parameters
    ----------
    engine : Engine
        Shared by all sessions.
    send_text, send_bytes : async callables
        To the browser; each returns when there is room for more.
    """

    def __init__(
        self, engine: Engine, send_text: SendText, send_bytes: SendBytes
    ) -> None:
        self._engine = engine
        self._send_text, self._send_bytes = send_text, send_bytes
        self._patch_load: PatchLoad | None = None  # to be predicted
        self._held: PatchLoad | None = None  # what the browser holds, None let go
        self._plane: SectionPlane | None = None
        self._cut: Section | None = None
        self._changed = asyncio.Event()
        self._refinement: asyncio.Task[None] | None = None
        self._patient: PatientSession | None = None
        if engine.desk is not None:
            self._patient = PatientSession(
                engine, engine.desk, send_text, send_bytes, lambda: self._cut
            )

    async def run(self, messages: AsyncIterator[str | bytes]) -> None:
        """Serve until the browser leaves."""
        predicting = asyncio.create_task(self._predict_newest())
        try:
            await self._send_bytes(scene_frame(self._engine))
            async for content in messages:
                try:
                    self._receive(content)
                except InputError as error:
                    await self._report(error)
        finally:
            predicting.cancel()
            self._stop_refinement()
            if self._patient is not None:
                self._patient.close()

    def _receive(self, content: str | bytes) -> None:
        if isinstance(content, bytes) and self._patient is not None:
            self._patient.add(content)
            return
        message: Message = read_message(content)
        if isinstance(message, LoadMessage):
            self._take(message)
        elif self._patient is not None:
            self._patient.take(message)
        else:
            raise InputError(
                "there is no patient here: start physgnn view with a case, .vtu"
            )

    def _take(self, message: LoadMessage) -> None:
        if isinstance(message, SectionPlane):
            self._plane = message
        else:
            self._stop_refinement()
            self._held = message if isinstance(message, PatchLoad) else None
            self._patch_load = self._held
        self._changed.set()

    async def _predict_newest(self) -> None:
        while True:
            await self._changed.wait()
            self._changed.clear()
            plane, self._plane = self._plane, None
            patch_load, self._patch_load = self._patch_load, None
            try:
                if plane is not None:
                    await self._section(plane)
                if patch_load is not None:
                    await self._predict(patch_load)
            except InputError as error:
                await self._report(error, patch_load)

    async def _section(self, plane: SectionPlane) -> None:
        self._cut = None
        if plane.axis is None:
            return
        axis, offset = plane.axis, plane.offset_mm
        mesh = self._engine.viewed.body.mesh

        def draw() -> tuple[Section, bytes]:
            made = cut(mesh, axis, offset)
            return made, section_frame(self._engine, axis, offset, made)

        made, frame = await self._engine.draw(draw)
        self._cut = made
        await self._send_bytes(frame)

    async def _predict(self, patch_load: PatchLoad) -> None:
        case = load_case(self._engine, patch_load)
        for name in patch_load.predictors:
            await self._predict_by(name, case, patch_load)
        if patch_load.solve and self._held is patch_load:
            self._refinement = asyncio.create_task(self._refine(case, patch_load))

    async def _predict_by(
        self, name: str, case: LoadCase, patch_load: PatchLoad
    ) -> None:
        predict = self._engine.viewed.predictors.get(name)
        if predict is None:
            raise InputError(f"there is no {name} here: only a mesh is on show")

        def job() -> tuple[Prediction, bytes]:
            prediction = predict(case, estimate=Estimate.QUICK)
            solved = SolvedLoad(name, case, prediction)
            return prediction, prediction_frame(
                self._engine, patch_load, solved, self._cut
            )

        prediction, frame = await self._engine.work(job)
        if name == patch_load.predictors[0]:
            self._engine.publish(prediction)
        await self._send_bytes(frame)

    async def _refine(self, case: LoadCase, patch_load: PatchLoad) -> None:
        """Solve a load that stands still, unless another comes first."""
        try:
            await asyncio.sleep(REST_SECONDS)
            await self._send_text(json.dumps({"kind": "solving", "id": patch_load.id}))
            prediction = await self._engine.solve(case)
            solved = SolvedLoad(FINITE_ELEMENTS, case, prediction)
            frame = await self._engine.work(
                lambda: prediction_frame(self._engine, patch_load, solved, self._cut)
            )
        except InputError as error:
            await self._report(error, patch_load)
            return
        self._engine.publish(prediction)
        await self._send_bytes(frame)

    def _stop_refinement(self) -> None:
        if self._refinement is not None:
            self._refinement.cancel()
        self._refinement = None

    async def _report(
        self, error: InputError, patch_load: PatchLoad | None = None
    ) -> None:
        about = None if patch_load is None else patch_load.id
        message = {"kind": "error", "id": about, "text": str(error)}
        await self._send_text(json.dumps(message))
