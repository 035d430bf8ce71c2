"""The stream as pyigtl's own client reads it."""

import struct
import time
from collections.abc import Iterator

import numpy as np
import pytest
from live_server import Address, connect, patch_load, serving

from physgnn.serving.igtl import stream
from physgnn.serving.scene.viewed import Viewed
from physgnn.serving.server import listen
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.predictions import load_case

pyigtl = pytest.importorskip("pyigtl", reason="needs pyigtl: pip install '.[igtl]'")

WAIT = 120.0  # kernels may have to be compiled, on a busy machine


@pytest.fixture
def streamed(viewed: Viewed, request) -> Iterator[tuple[Address, int]]:
    surfaces = getattr(request, "param", False)
    engine, listening = Engine(viewed), listen(0)
    port = listening.getsockname()[1]
    with serving(engine, lambda: stream(engine, listening, surfaces=surfaces)) as page:
        yield page, port


@pytest.fixture
def client(streamed) -> Iterator["pyigtl.OpenIGTLinkClient"]:
    client = pyigtl.OpenIGTLinkClient("127.0.0.1", streamed[1])
    yield client
    client.stop()


def press(page: Address, force: float) -> None:
    with connect(page.live) as socket:
        socket.recv(timeout=WAIT)
        message = patch_load(force_n=(0.0, 0.0, force))
        socket.send(message.model_dump_json())
        socket.recv(timeout=WAIT)


def test_the_rest_state_comes_first_then_every_predict(
    streamed, client, viewed: Viewed
) -> None:
    rest = client.wait_for_message("Displacement", timeout=WAIT)
    assert rest.world_coordinate_system == "ras"
    assert not rest.image.any()
    press(streamed[0], -0.01)
    moved = client.wait_for_message("Displacement", timeout=WAIT)
    engine = Engine(viewed)
    case = load_case(engine, patch_load(force_n=(0.0, 0.0, -0.01)))
    expected = viewed.predictors["network"](case).displacement
    for point, displacement in list(
        zip(viewed.body.mesh.points, expected, strict=True)
    )[::7]:
        voxel = np.linalg.solve(moved.ijk_to_world_matrix, [*point, 1.0])[:3]
        i, j, k = np.round(voxel).astype(int)
        if np.allclose(voxel, [i, j, k], atol=1e-3):
            np.testing.assert_allclose(moved.image[k, j, i], displacement, atol=1e-5)
    assert moved.image[..., 2].min() < 0
    engine.close()


def test_a_second_client_gets_the_newest_answer_at_once(streamed, client) -> None:
    client.wait_for_message("Displacement", timeout=WAIT)
    press(streamed[0], -0.01)
    first = client.wait_for_message("Displacement", timeout=WAIT)
    late = pyigtl.OpenIGTLinkClient("127.0.0.1", streamed[1])
    same = late.wait_for_message("Displacement", timeout=WAIT)
    late.stop()
    np.testing.assert_array_equal(first.image, same.image)


def test_a_client_may_leave_at_any_moment(streamed) -> None:
    page, port = streamed
    for _ in range(3):
        client = pyigtl.OpenIGTLinkClient("127.0.0.1", port)
        time.sleep(0.05)
        client.stop()
    press(page, -0.01)


class Surfaces(pyigtl.PolyDataMessage):
    """What pyigtl 0.3.4 cannot: read POLYDATA (its reader subscripts a Struct)."""

    def _unpack_content(self, content: bytes) -> None:
        n_points, *_ = struct.unpack(">10I", content[:40])
        polygons_bytes = struct.unpack(">I", content[24:28])[0]
        end = 40 + 12 * n_points
        self.points = np.frombuffer(content[40:end], ">f4").reshape(-1, 3)
        self.polygons = np.frombuffer(content[end : end + polygons_bytes], ">u4")


@pytest.mark.parametrize("streamed", [True], indirect=True)
def test_surfaces_are_the_deformed_ones(
    streamed, viewed: Viewed, monkeypatch: pytest.MonkeyPatch
) -> None:
    constructors = pyigtl.messages.message_type_to_class_constructor
    monkeypatch.setitem(constructors, "POLYDATA", Surfaces)
    client = pyigtl.OpenIGTLinkClient("127.0.0.1", streamed[1])
    engine = Engine(viewed)
    rest = client.wait_for_message("Brain", timeout=WAIT)
    shown = engine.shown
    np.testing.assert_allclose(
        rest.points, viewed.body.mesh.points[shown.nodes], atol=1e-5
    )
    faces = rest.polygons.reshape(-1, 4)
    assert (faces[:, 0] == 3).all()
    np.testing.assert_array_equal(faces[:, 1:], shown.faces["brain"])
    press(streamed[0], -0.01)
    moved = client.wait_for_message("Brain", timeout=WAIT)
    assert (moved.points - rest.points)[:, 2].min() < 0
    client.stop()
    engine.close()
