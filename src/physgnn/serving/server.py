"""Run the live view on this machine."""

import socket
from collections.abc import Callable
from pathlib import Path

import uvicorn

from physgnn.errors import InputError
from physgnn.serving.app import make_app
from physgnn.serving.scene.image_slices import read_image
from physgnn.serving.scene.viewed import view
from physgnn.serving.sessions.engine import Engine

HOST = "127.0.0.1"
PORT = 8750
# Longer messages are refused by `messages`; this only bounds what is read of them.
MAX_MESSAGE_BYTES = 1 << 20


def serve(
    path: str | Path | None = None,
    *,
    port: int = PORT,
    image: str | Path | None = None,
    igtl: int | None = None,
    igtl_surfaces: bool = False,
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
    igtl : int, optional
        Port to stream the deformation from by OpenIGTLink; 0 takes a free one.
    igtl_surfaces : bool
        Stream the deformed surfaces too.
    log : callable
        Receives the addresses, a line each.

    Raises
    ------
    InputError
        If there is nothing to show at the path, or a port is taken.
    """
    listening = listen(port)
    engine = Engine(view(path), None if image is None else read_image(image))
    beside = []
    if igtl is not None:
        from physgnn.serving.igtl import stream

        streaming = listen(igtl)
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
            ws_max_size=MAX_MESSAGE_BYTES,
            timeout_graceful_shutdown=1,
        )
    )


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
