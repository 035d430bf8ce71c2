"""Run the live view on this machine."""

import asyncio
import socket
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from physgnn.errors import InputError
from physgnn.serving.app import make_app
from physgnn.serving.patient.desk import Desk
from physgnn.serving.scene.image_slices import read_grey
from physgnn.serving.scene.viewed import view
from physgnn.serving.sessions.engine import Engine

HOST = "127.0.0.1"
# Longer messages are refused by `messages`; these only bound what is read of them.
MAX_MESSAGE_BYTES = 1 << 16
MAX_HEADER_BYTES = 1 << 14
MAX_WAITING = 4  # messages of one client that are read ahead
MAX_CONNECTIONS = 128
REQUEST_SECONDS = 10.0  # for the first request to be whole


def serve(
    path: str | Path | None = None,
    *,
    port: int,
    image: str | Path | None = None,
    affine: str | None = None,
    igtl: int | None = None,
    igtl_surfaces: bool = False,
    desk: Desk | None = None,
    log: Callable[[str], None] = print,
) -> None:
    """Show a body in the browser until interrupted.

    Parameters
    ----------
    path : path, optional
        A run folder or a mesh; by default the bundled model.
    port : int
        On 127.0.0.1; 0 takes a free one.
    image : path, optional
        NIfTI volume for sections, or "mni152".
    affine : {"sform", "qform"}, optional
        Which of two places in the image's header is meant, where they disagree.
    igtl : int, optional
        Port to stream the deformation from by OpenIGTLink; 0 takes a free one.
    igtl_surfaces : bool
        Stream the deformed surfaces too.
    desk : Desk, optional
        Does what the page may do for a patient, whose mesh is shown then.
    log : callable
        Receives the addresses, a line each.

    Raises
    ------
    InputError
        If there is nothing to show at the path, a port is taken, or OpenIGTLink is
        wanted and not installed.
    """
    if igtl is not None:
        from physgnn.serving.igtl import loaded_pyigtl, stream

        loaded_pyigtl()  # before the model takes its time
    with ExitStack() as sockets:
        listening = sockets.enter_context(listen(port))
        grey = None if image is None else read_grey(image, affine=affine, log=log)
        engine = Engine(view(path, None if desk is None else desk.mesh), grey, desk)
        beside = []
        if igtl is not None:
            streaming = sockets.enter_context(listen(igtl))
            beside.append(lambda: stream(engine, streaming, surfaces=igtl_surfaces))
            log(f"OpenIGTLink: {HOST}:{streaming.getsockname()[1]}")
        server = make_server(make_app(engine, *beside))
        log(f"http://{HOST}:{listening.getsockname()[1]}  (Ctrl-C ends it)")
        server.run(sockets=[listening])


def make_server(app: object) -> uvicorn.Server:
    """Return a quiet server for the application."""
    return uvicorn.Server(
        uvicorn.Config(
            app,  # type: ignore[arg-type]
            log_level="warning",
            http=ImpatientProtocol,
            h11_max_incomplete_event_size=MAX_HEADER_BYTES,
            limit_concurrency=MAX_CONNECTIONS,
            ws_max_size=MAX_MESSAGE_BYTES,
            ws_max_queue=MAX_WAITING,
            ws_per_message_deflate=False,  # it never leaves this machine
            server_header=False,
            timeout_graceful_shutdown=1,
        )
    )


class ImpatientProtocol(H11Protocol):
    """Closes a connection whose first request does not come."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Start the clock."""
        super().connection_made(transport)
        self.loop.call_later(REQUEST_SECONDS, self._give_up, transport)

    def _give_up(self, transport: asyncio.Transport) -> None:
        begun: object = self.cycle  # uvicorn types it as if there always were one
        if transport.get_protocol() is self and begun is None:
            transport.close()


def listen(port: int) -> socket.socket:
    """Return a socket that listens on this machine only; InputError if taken."""
    listening = socket.socket()
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((HOST, port))
        listening.listen()  # who comes early waits
    except (OSError, OverflowError) as error:
        listening.close()
        raise InputError(
            f"port {port} cannot be used ({error}): name another, or 0 for a free one"
        ) from error
    return listening
