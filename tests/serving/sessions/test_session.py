"""The server over its real sockets: one process, several clients."""

import asyncio
import json
from collections.abc import AsyncIterator
from socket import SO_RCVBUF, SOL_SOCKET, create_connection
from threading import Event

import numpy as np
import pytest
from live_server import Address, connect, patch_load, serving
from websockets.sync.client import ClientConnection

from physgnn.mechanics.equilibrium.solver import solve
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.serving.protocol.frames import decode
from physgnn.serving.protocol.messages import PatchLoad
from physgnn.serving.scene.viewed import Viewed
from physgnn.serving.sessions import session
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.predictions import load_case

WAIT = 120.0  # kernels may have to be compiled, on a busy machine


def frame(socket: ClientConnection):
    content = socket.recv(timeout=WAIT)
    return decode(content) if isinstance(content, bytes) else (json.loads(content), {})


def ask(socket: ClientConnection, message: PatchLoad):
    socket.send(message.model_dump_json())
    return frame(socket)


@pytest.fixture
def socket(address: Address):
    with connect(address.live) as socket:
        assert frame(socket)[0]["kind"] == "scene"
        yield socket


def test_the_scene_has_all_that_is_drawn(address: Address, viewed: Viewed) -> None:
    with connect(address.live) as socket:
        header, arrays = frame(socket)
    assert header["predictors"] == ["network", "linear"]
    assert header["coverage"] == 0.9
    assert set(arrays) == {"points", "exposed", "faces:brain", "faces:tumour"}
    exposed = arrays["points"][arrays["exposed"] == 1]
    np.testing.assert_allclose(exposed, viewed.exposed.points, atol=1e-6)


@pytest.mark.parametrize("name", ["network", "linear"])
def test_an_answer_is_the_predictors(socket, viewed: Viewed, name: str) -> None:
    message = patch_load(id=3, predictors=[name])
    header, arrays = ask(socket, message)
    engine = Engine(viewed)
    expected = viewed.predictors[name](load_case(engine, message))
    assert (header["kind"], header["id"], header["predictor"]) == (
        "prediction",
        3,
        name,
    )
    at = engine.shown.nodes
    np.testing.assert_allclose(
        arrays["displacement"], expected.displacement[at], rtol=1e-6, atol=1e-7
    )
    largest = np.linalg.norm(expected.displacement, axis=1).max()
    assert header["largest_mm"] == pytest.approx(largest)
    if name == "network":
        estimate = expected.error_estimate_mm
        assert header["error"]["max_mm"] == pytest.approx(estimate.max_mm)
    engine.close()


def test_a_load_outside_the_trained_range_says_so(socket) -> None:
    header, _ = ask(socket, patch_load(force_n=(0.0, 0.0, -0.5)))
    assert header["status"] == "outside trained range"
    assert any("N in all" in reason for reason in header["reasons"])


def test_both_answers_come_when_both_are_wanted(socket) -> None:
    first, _ = ask(socket, patch_load(predictors=["network", "linear"]))
    second, _ = frame(socket)
    assert (first["predictor"], second["predictor"]) == ("network", "linear")


@pytest.mark.parametrize("field", ["error", "volume"])
def test_a_field_comes_with_the_prediction(socket, field: str) -> None:
    _, arrays = ask(socket, patch_load(field=field))
    assert len(arrays["field"]) == len(arrays["displacement"])


def test_a_section_deforms_with_the_body(socket) -> None:
    socket.send('{"type": "section", "axis": "axial", "offset_mm": 8.0}')
    header, section = frame(socket)
    assert (header["kind"], header["axis"]) == ("section", 2)
    _, arrays = ask(socket, patch_load())
    moved = arrays["section_displacement"]
    assert moved.shape == section["points"].shape
    assert moved[:, 2].min() < 0
    socket.send('{"type": "section", "axis": null}')
    _, arrays = ask(socket, patch_load())
    assert "section_displacement" not in arrays


@pytest.mark.parametrize(
    "content",
    [
        "not JSON",
        b"\x00\x01",
        "[" * 5000,
        '{"type": "patch_load"}',
        patch_load(point=(0.0, 0.0, 900.0)).model_dump_json(),
    ],
)
def test_a_bad_message_is_answered_by_an_error_and_nothing_breaks(
    socket, content
) -> None:
    socket.send(content)
    header, _ = frame(socket)
    assert header["kind"] == "error"
    assert "\n" not in header["text"]
    assert ask(socket, patch_load(id=9))[0]["id"] == 9


def test_a_huge_message_costs_its_sender_the_connection_only(
    address: Address, socket
) -> None:
    with connect(address.live) as other:
        frame(other)
        # The server may hang up while the message is still on its way.
        with pytest.raises(Exception, match="1009"):
            other.send("x" * (2 << 20))
            frame(other)
    assert ask(socket, patch_load(id=1))[0]["id"] == 1


def test_stale_loads_are_dropped_and_the_newest_is_answered(
    viewed: Viewed, monkeypatch: pytest.MonkeyPatch
) -> None:
    linear, begun, all_came = viewed.predictors["linear"], Event(), Event()

    def slow(case, **how):
        begun.set()
        assert all_came.wait(WAIT)
        return linear(case, **how)

    async def stay_cold(_: Engine) -> None:
        """No predictions but those that are asked for."""

    monkeypatch.setattr(Engine, "warm_up", stay_cold)
    monkeypatch.setitem(viewed.predictors, "linear", slow)
    with serving(Engine(viewed)) as address, connect(address.live) as socket:
        frame(socket)
        for i in range(50):
            socket.send(patch_load(id=i, predictors=["linear"]).model_dump_json())
            assert begun.wait(WAIT)  # the first is being predicted
        socket.send("no load")  # refused at once, after the loads before it were read
        assert frame(socket)[0]["kind"] == "error"
        all_came.set()
        answered = [frame(socket)[0]["id"] for _ in range(2)]
    assert answered == [0, 49]


def test_two_clients_get_their_own_answers(address: Address) -> None:
    with connect(address.live) as one, connect(address.live) as other:
        frame(one), frame(other)
        for i in range(10):
            one.send(patch_load(id=i).model_dump_json())
            other.send(
                patch_load(id=100 + i, force_n=(0.0, 0.0, -0.02)).model_dump_json()
            )
            mine, theirs = frame(one)[0], frame(other)[0]
            assert (mine["id"], theirs["id"]) == (i, 100 + i)
            assert theirs["largest_mm"] == pytest.approx(2 * mine["largest_mm"])


def test_a_client_that_does_not_read_does_not_stall_another(
    address: Address, socket
) -> None:
    narrow = create_connection((address.host, address.port))
    narrow.setsockopt(SOL_SOCKET, SO_RCVBUF, 4096)
    wanted = patch_load(
        predictors=["network", "linear"], field="volume"
    ).model_dump_json()
    with connect(address.live, sock=narrow, max_queue=1) as lazy:
        for i in range(300):
            lazy.send(wanted)
            assert ask(socket, patch_load(id=i))[0]["id"] == i
        narrow.close()


def test_finite_elements_follow_and_are_the_solvers(socket, viewed: Viewed) -> None:
    message = patch_load(id=5, solve=True, force_n=(0.0, 0.0, -0.05))
    assert ask(socket, message)[0]["predictor"] == "network"
    assert frame(socket)[0] == {"kind": "solving", "id": 5}
    header, arrays = frame(socket)
    assert (header["predictor"], header["id"]) == ("finite elements", 5)
    body, engine = viewed.body, Engine(viewed)
    case = load_case(engine, message)
    path = LoadPath(case.nodes, case.forces, np.array([0.5, 1.0]))
    expected = solve(body.mesh, path, materials=body.materials, fixed=body.fixed)
    np.testing.assert_allclose(
        arrays["displacement"],
        expected.displacement[-1][engine.shown.nodes],
        atol=5e-4,
    )
    engine.close()


def test_letting_go_cancels_the_solve(socket, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, cancelled = Event(), Event()

    async def endless(*_: object) -> None:
        begun.set()
        try:
            await asyncio.Future()
        finally:
            cancelled.set()

    monkeypatch.setattr(Engine, "solve", endless)
    ask(socket, patch_load(id=1, solve=True))
    assert frame(socket)[0] == {"kind": "solving", "id": 1}
    assert begun.wait(WAIT)
    socket.send('{"type": "release"}')
    assert cancelled.wait(WAIT)
    header, _ = ask(socket, patch_load(id=2))
    assert (header["predictor"], header["id"]) == ("network", 2)


@pytest.mark.parametrize("when", ["while its prediction is sent", "before it rests"])
def test_a_load_that_is_let_go_in_time_is_not_solved(
    viewed: Viewed, monkeypatch: pytest.MonkeyPatch, when: str
) -> None:
    at_once = when == "while its prediction is sent"
    monkeypatch.setattr(session, "REST_SECONDS", 0.0 if at_once else WAIT)
    engine, said = Engine(viewed), []

    async def run() -> None:
        sent, released = asyncio.Event(), asyncio.Event()

        async def send_text(text: str) -> None:
            said.append(text)

        async def send_bytes(content: bytes) -> None:
            if decode(content)[0]["kind"] == "prediction":
                sent.set()
                if at_once:
                    await released.wait()

        async def messages() -> AsyncIterator[str]:
            yield patch_load(id=1, solve=True).model_dump_json()
            await sent.wait()
            while not at_once and one._refinement is None:
                await asyncio.sleep(0)
            yield '{"type": "release"}'
            released.set()
            for _ in range(20):  # whatever is ready to run does
                await asyncio.sleep(0)
            assert one._refinement is None

        one = session.Session(engine, send_text, send_bytes)
        await one.run(messages())

    asyncio.run(run())
    engine.close()
    assert said == []
