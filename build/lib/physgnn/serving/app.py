"""The web application: a page, its WebSocket, and a load case to save."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager, suppress
from pathlib import Path

from fastapi import FastAPI, Request, Response, WebSocket, WebSocketDisconnect
from fastapi.responses import FileResponse, JSONResponse
from fastapi.staticfiles import StaticFiles

from physgnn.errors import InputError
from physgnn.serving.guard import Guard
from physgnn.serving.protocol.messages import MAX_BYTES, read_patch_load
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.predictions import load_case
from physgnn.serving.sessions.session import Session

STATIC = Path(__file__).with_name("static")
MOST_SESSIONS = 16
BODY_SECONDS = 10.0  # for a request to be whole

Beside = Callable[[], AbstractAsyncContextManager[None]]


def make_app(engine: Engine, *beside: Beside) -> FastAPI:
    """Return the application.

    Parameters
    ----------
    engine : Engine
        Predicts for all sessions; closed with the application.
    *beside : callables
        Contexts to run as long as the application does.
    """

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        warming = asyncio.create_task(engine.warm_up())
        async with _all(*beside):
            yield
        warming.cancel()
        engine.close()

    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, openapi_url=None)
    page = (STATIC / "index.html").read_text("utf-8")
    app.add_middleware(Guard, page=page, most_sessions=MOST_SESSIONS)
    app.add_api_route("/", _page, include_in_schema=False)
    app.mount("/static", StaticFiles(directory=STATIC), name="static")
    _add_load_case(app, engine)
    _add_live(app, engine)
    return app


def _add_load_case(app: FastAPI, engine: Engine) -> None:
    @app.post("/load-case")
    async def save(request: Request) -> Response:
        """Return a patch load's nodal forces, as ``physgnn predict --load`` reads."""
        try:
            async with asyncio.timeout(BODY_SECONDS):
                content = await _body(request)
            case = load_case(engine, read_patch_load(content))
        except TimeoutError:
            return JSONResponse({"error": "the request came too slowly"}, 408)
        except InputError as error:
            return JSONResponse({"error": str(error)}, 422)
        return JSONResponse(
            {"nodes": case.nodes.tolist(), "forces_n": case.forces.tolist()}
        )


async def _body(request: Request) -> str:
    """Return what was posted; of too much only the beginning, which is refused."""
    content = bytearray()
    async for part in request.stream():
        content += part
        if len(content) > MAX_BYTES:
            break
    return content.decode("utf-8", "replace")


def _add_live(app: FastAPI, engine: Engine) -> None:
    @app.websocket("/live")
    async def live(socket: WebSocket) -> None:
        await socket.accept()
        session = Session(engine, socket.send_text, socket.send_bytes)
        # The browser may leave while a prediction is on its way.
        with suppress(WebSocketDisconnect, RuntimeError):
            await session.run(_messages(socket))


async def _messages(socket: WebSocket) -> AsyncIterator[str | bytes]:
    while True:
        message = await socket.receive()
        if message["type"] == "websocket.disconnect":
            return
        text = message.get("text")
        yield message.get("bytes") or b"" if text is None else text


async def _page() -> FileResponse:
    return FileResponse(STATIC / "index.html")


@asynccontextmanager
async def _all(*contexts: Beside) -> AsyncIterator[None]:
    if not contexts:
        yield
        return
    async with contexts[0](), _all(*contexts[1:]):
        yield
