import json
import urllib.error
import urllib.request

import pytest
from live_server import Address, connect, patch_load
from websockets.exceptions import InvalidStatus

from physgnn.errors import InputError
from physgnn.io import read_load_case
from physgnn.serving.app import STATIC
from physgnn.serving.scene.viewed import Viewed
from physgnn.serving.server import listen
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.predictions import load_case

WAIT = 120.0  # kernels may have to be compiled, on a busy machine


def get(address: Address, path: str, host: str | None = None) -> tuple[int, bytes]:
    headers = {} if host is None else {"Host": host}
    try:
        request = urllib.request.Request(address.page + path, headers=headers)
        with urllib.request.urlopen(request, timeout=WAIT) as reply:
            return reply.status, reply.read()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read()


def post(address: Address, content: str) -> tuple[int, dict]:
    request = urllib.request.Request(
        address.page + "/load-case", data=content.encode(), method="POST"
    )
    try:
        with urllib.request.urlopen(request, timeout=WAIT) as reply:
            return reply.status, json.loads(reply.read())
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.loads(error.read())


def test_the_page_and_every_file_it_may_ask_for_are_served(address: Address) -> None:
    assert b"<title>physgnn" in get(address, "/")[1]
    for file in STATIC.rglob("*"):
        if file.is_file():
            name = file.relative_to(STATIC).as_posix()
            assert get(address, f"/static/{name}") == (200, file.read_bytes())


def test_nothing_outside_the_static_files_is_served(address: Address) -> None:
    for path in ("/static/../app.py", "/static/%2e%2e/app.py", "/docs", "/nothing"):
        assert get(address, path)[0] == 404


def test_the_page_asks_nobody_else() -> None:
    for file in STATIC.rglob("*.*"):
        if "vendor" in file.parts:
            continue
        text = file.read_text("utf-8").replace("http://www.w3.org/2000/svg", "")
        assert "http://" not in text, file
        assert "https://" not in text, file


def test_a_kept_load_case_is_what_predict_reads(
    address: Address, viewed: Viewed, tmp_path
) -> None:
    message = patch_load()
    status, content = post(address, message.model_dump_json())
    assert status == 200
    file = tmp_path / "load.json"
    file.write_text(json.dumps(content))
    read = read_load_case(file, viewed.body.mesh)
    engine = Engine(viewed)
    wanted = load_case(engine, message)
    engine.close()
    assert read.nodes.tolist() == wanted.nodes.tolist()
    assert read.forces.tolist() == wanted.forces.tolist()


@pytest.mark.parametrize("content", ["", "{}", "x" * 100_000, '{"type": "release"}'])
def test_a_bad_load_case_is_refused_in_one_line(address: Address, content) -> None:
    status, reply = post(address, content)
    assert status == 422
    assert "\n" not in reply["error"]


def test_other_names_and_other_pages_are_turned_away(address: Address) -> None:
    assert get(address, "/", host="evil.example")[0] == 400
    with pytest.raises(InvalidStatus, match="403"):
        connect(address.live, origin="http://evil.example")
    with connect(address.live, origin=address.page) as socket:
        assert isinstance(socket.recv(timeout=WAIT), bytes)


def test_a_port_that_is_taken_is_one_clear_line() -> None:
    with listen(0) as first, pytest.raises(InputError, match="name another"):
        listen(first.getsockname()[1])
