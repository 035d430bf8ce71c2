"""What strangers may try on the server, what each gets, and that it serves on."""

import json
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from live_server import Address, connect, patch_load
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from physgnn.serving import server
from physgnn.serving.app import MOST_SESSIONS
from physgnn.serving.server import MAX_MESSAGE_BYTES

WAIT = 120.0
GOOD = patch_load().model_dump()
ROUTES = ("GET /", "GET /static/main.js", "POST /load-case", "GET /live", "GET /no")


@pytest.fixture(autouse=True)
def _serves_on(address: Address) -> Iterator[None]:
    yield
    assert status(address, "GET /") == 200
    with connect(address.live, origin=address.page) as live:
        live.recv(timeout=WAIT)
        live.send(json.dumps(GOOD))
        assert isinstance(live.recv(timeout=WAIT), bytes)


def ask(address: Address, text: bytes) -> bytes:
    """Send bytes, return all that comes back."""
    with socket.create_connection((address.host, address.port), timeout=WAIT) as raw:
        raw.sendall(text)
        parts = []
        while part := raw.recv(1 << 16):
            parts.append(part)
    return b"".join(parts)


def status(address: Address, route: str, *headers: str, body: bytes = b"") -> int:
    if not any(header.startswith("Host:") for header in headers):
        headers = (f"Host: {address.host}:{address.port}", *headers)
    lines = [f"{route} HTTP/1.1", *headers, "Connection: close"]
    lines += [f"Content-Length: {len(body)}"] if body else []
    text = "\r\n".join([*lines, "", ""]).encode("latin-1")
    return int(ask(address, text + body).split(b" ", 2)[1])


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        "",
        "https://127.0.0.1",
        "http://127.0.0.1:1",
        "http://127.0.0.1.evil.example",
        "http://localhost",
        "file://",
    ],
)
def test_other_pages_are_refused_on_every_route(
    address: Address, route: str, origin: str
) -> None:
    assert status(address, route, f"Origin: {origin}") == 403


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(
    "hosts",
    [
        ("evil.example",),
        ("127.0.0.1.evil.example",),
        ("127.0.0.1@evil.example",),
        ("[::1",),
        ("",),
        ("127.0.0.1", "evil.example"),
        ("127.0.0.1", "127.0.0.1"),
    ],
)
def test_other_hosts_are_refused_on_every_route(
    address: Address, route: str, hosts: tuple[str, ...]
) -> None:
    assert status(address, route, *(f"Host: {host}" for host in hosts)) == 400


def test_no_host_is_refused(address: Address) -> None:
    assert ask(address, b"GET / HTTP/1.0\r\n\r\n").split(b" ", 2)[1] == b"400"


def test_every_answer_has_the_headers_that_protect_the_page(address: Address) -> None:
    for route in ("/", "/static/main.js", "/no"):
        head = f"GET {route} HTTP/1.0\r\nHost: {address.host}:{address.port}\r\n\r\n"
        answer = ask(address, head.encode()).split(b"\r\n\r\n")[0].lower()
        for wanted in (
            b"content-security-policy: default-src 'none'; script-src 'self' 'sha256-",
            b"frame-ancestors 'none'",
            b"x-content-type-options: nosniff",
            b"x-frame-options: deny",
            b"referrer-policy: no-referrer",
        ):
            assert wanted in answer, (route, wanted)
        assert b"unsafe" not in answer


BAD = {
    "overflow of a square": {**GOOD, "force_n": [0, 0, 1e200]},
    "overflow of a distance": {**GOOD, "point": [1e308, -1e308, 0]},
    "an integer too large": '{"type": "section", "axis": "axial", "offset_mm": 1%s}'
    % ("0" * 400),
    "an exponent too large": json.dumps(GOOD).replace("6.0", "6e99999"),
    "not a number": json.dumps(GOOD).replace("6.0", "NaN"),
    "infinity": json.dumps(GOOD).replace("6.0", "-Infinity"),
    "a large id": {**GOOD, "id": 2**64},
    "deep lists": "[" * 4000,
    "deep objects": '{"a":' * 800,
    "wrong types": {**GOOD, "point": "abc", "predictors": {}, "solve": "yes"},
    "a list": [1, 2, 3],
    "null": "null",
    "an empty text": "",
    "half a surrogate": '{"type": "\\ud800"}',
    "a key too many": {**GOOD, "__proto__": {}},
    "a long text": "x" * 5000,
    "an unknown type": {"type": "eval"},
    "an unknown field": {**GOOD, "field": "../../etc/passwd"},
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_message_is_one_line(address: Address, name: str) -> None:
    content = BAD[name] if isinstance(BAD[name], str) else json.dumps(BAD[name])
    assert status(address, "POST /load-case", body=content.encode()) in (400, 422)
    with connect(address.live, origin=address.page) as live:
        live.recv(timeout=WAIT)
        live.send(content)
        answer = json.loads(live.recv(timeout=WAIT))
        assert answer["kind"] == "error"
        assert "\n" not in answer["text"]
        live.send(json.dumps(GOOD))  # and the same socket serves on
        assert isinstance(live.recv(timeout=WAIT), bytes)


def test_binary_is_an_error(address: Address) -> None:
    with connect(address.live) as live:
        live.recv(timeout=WAIT)
        live.send(b"\0" * 1000)
        assert json.loads(live.recv(timeout=WAIT))["kind"] == "error"
    body = b"\xff\xfe" + b"\0" * 100
    assert status(address, "POST /load-case", body=body) == 422


def test_a_huge_message_ends_its_socket_alone(address: Address) -> None:
    with connect(address.live) as live, connect(address.live) as other:
        live.recv(timeout=WAIT)
        other.recv(timeout=WAIT)
        with pytest.raises(ConnectionClosed):
            live.send("x" * (MAX_MESSAGE_BYTES + 1))
            live.recv(timeout=WAIT)
        other.send(json.dumps(GOOD))
        assert isinstance(other.recv(timeout=WAIT), bytes)


@pytest.mark.parametrize(
    "request_",
    [
        b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 20_000 + b"\r\n",
        b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc",
        b"BREW / HTCPCP/1.0\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: -5\r\n\r\n",
    ],
    ids=["headers", "path", "tls", "protocol", "negative"],
)
def test_a_request_that_is_none(address: Address, request_: bytes) -> None:
    try:
        answer = ask(address, request_)
    except ConnectionError:
        return  # it was closed while we still sent
    assert answer == b"" or answer.split(b" ", 2)[1][:1] == b"4"


def once_free(address: Address) -> ClientConnection:
    """Open a session; a place is free as soon as one has left, which takes a moment."""
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        try:
            return connect(address.live)
        except InvalidStatus:
            time.sleep(0.05)
    pytest.fail("no place became free")


def test_so_many_sessions_and_no_more(address: Address) -> None:
    with ExitStack() as stack:
        for _ in range(MOST_SESSIONS):
            stack.enter_context(once_free(address)).recv(timeout=WAIT)
        with pytest.raises(InvalidStatus):
            stack.enter_context(connect(address.live))
    with once_free(address) as live:
        live.recv(timeout=WAIT)


def test_who_only_opens_a_connection_is_closed(
    address: Address, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "REQUEST_SECONDS", 0.5)
    with socket.create_connection((address.host, address.port), timeout=WAIT) as raw:
        raw.sendall(b"GET / HTTP/1.1\r\nHost: 127")
        assert raw.recv(100) == b""


def test_many_half_open_connections(address: Address) -> None:
    with ExitStack() as stack:
        for _ in range(60):
            raw = socket.create_connection((address.host, address.port), timeout=WAIT)
            stack.enter_context(raw).sendall(b"GET / HT")
        assert status(address, "GET /") == 200
