"""A server in a thread, and what to ask of it."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from websockets.sync import client

from physgnn.serving.app import Beside, make_app
from physgnn.serving.protocol.messages import PatchLoad
from physgnn.serving.server import listen, make_server
from physgnn.serving.sessions.engine import Engine

# A busy machine may leave a handshake waiting for longer than its client usually does.
connect = partial(client.connect, open_timeout=120.0, ping_interval=None)


@dataclass(frozen=True)
class Address:
    """Where a server listens."""

    host: str
    port: int

    @property
    def page(self) -> str:
        return f"http://{self.host}:{self.port}"

    @property
    def live(self) -> str:
        return f"ws://{self.host}:{self.port}/live"


@contextmanager
def serving(engine: Engine, *beside: Beside) -> Iterator[Address]:
    """Run a server in a thread."""
    listening = listen(0)
    server = make_server(make_app(engine, *beside))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        yield Address(*listening.getsockname())
    finally:
        server.should_exit = True
        thread.join(20)
        assert not thread.is_alive()


def patch_load(**change: Any) -> PatchLoad:
    """A gentle push on the middle of the block's top."""
    values = {
        "point": (5.0, 5.0, 10.0),
        "force_n": (0.0, 0.0, -0.01),
        "radius_mm": 6.0,
        "predictors": ["network"],
    }
    return PatchLoad(**{**values, **change})
