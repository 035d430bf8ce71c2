"""A patient over the real sockets: craniotomy, measured files, registration, saving."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_on_show import case_engine, csv_of, sunk_pairs, write_case
from live_server import Address, connect, patch_load, serving
from websockets.sync.client import ClientConnection

from physgnn.serving.protocol.frames import decode
from physgnn.serving.sessions.engine import Engine
from physgnn.stages.patient.intraoperative.registration import register

WAIT = 120.0
SIDE_X = 80.0


def frame(socket: ClientConnection) -> tuple[dict[str, Any], dict[str, Any]]:
    content = socket.recv(timeout=WAIT)
    return decode(content) if isinstance(content, bytes) else (json.loads(content), {})


def ask(socket: ClientConnection, type_: str, **fields: Any) -> None:
    socket.send(json.dumps({"type": type_, **fields}))


def send_file(
    socket: ClientConnection, content: bytes, name: str, role: str = "pairs"
) -> None:
    ask(socket, "measured_file", name=name, role=role, n_bytes=len(content))
    for start in range(0, len(content), 400):
        socket.send(content[start : start + 400])


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[Engine]:
    (tmp_path / "kept").mkdir()
    with case_engine(write_case(tmp_path), tmp_path / "kept") as engine:
        yield engine


@pytest.fixture
def address(engine: Engine) -> Iterator[Address]:
    with serving(engine) as address:
        yield address


@pytest.fixture
def socket(address: Address) -> Iterator[ClientConnection]:
    with connect(address.live) as socket:
        header, _ = frame(socket)
        assert header["patient"]["saves"]
        assert header["patient"]["roles"]["surface"] == "exposed surface"
        assert header["patient"]["menus"]["contrast"]["roles"] == ["intraoperative"]
        assert "deviation" in header["fields"]
        yield socket


def test_a_craniotomy_is_shown_then_opened_and_kept(
    socket: ClientConnection, engine: Engine, tmp_path: Path
) -> None:
    ask(socket, "open_skull")
    assert "click it on the brain" in frame(socket)[0]["text"]
    ask(socket, "craniotomy", point=[SIDE_X, 40, 41], radius_mm=20)
    header, arrays = frame(socket)
    assert header["centre_mm"][0] == SIDE_X
    points = engine.viewed.body.mesh.points[engine.shown.nodes]
    assert (points[arrays["loaded"] == 1, 0] == SIDE_X).all()
    assert not (arrays["loaded"] & arrays["held"]).any()
    assert list((tmp_path / "kept").iterdir()) == []  # it was only tried
    ask(socket, "open_skull")
    header, arrays = frame(socket)
    assert header["kind"] == "scene"
    exposed = arrays["points"][arrays["exposed"] == 1]
    assert (exposed[:, 0] == SIDE_X).all()
    assert frame(socket)[0] == {
        "kind": "saved",
        "what": "craniotomy",
        "files": ["case.toml", "case.vtu"],
    }
    socket.send(
        patch_load(
            point=(SIDE_X, 40.0, 41.0), force_n=(-0.5, 0, 0), predictors=["linear"]
        ).model_dump_json()
    )
    header, arrays = frame(socket)
    assert header["kind"] == "prediction" and arrays["displacement"][:, 0].min() < 0


def test_a_dropped_file_is_registered_as_the_command_does(
    socket: ClientConnection, engine: Engine, tmp_path: Path
) -> None:
    content = csv_of(sunk_pairs(engine.viewed.body.mesh, 3.0))
    ask(socket, "section", axis="sagittal", offset_mm=35.0)
    _, section = frame(socket)
    send_file(socket, content, "pairs.csv")
    ask(socket, "register", noise_mm=0.8)
    assert frame(socket)[0] == {"kind": "registering", "state": 0, "states": 1}
    header, arrays = frame(socket)
    assert (header["kind"], header["name"]) == ("state", "pairs.csv")
    assert header["misfit_mm"] < 1.0 and header["status"]
    ask(socket, "misfits", state=0)
    misfits = frame(socket)[0]
    ask(socket, "save")
    names = ["case.vtu", "registered.vtu", "registered-misfits.csv"]
    assert frame(socket)[0]["files"] == names
    (tmp_path / "pairs.csv").write_bytes(content)
    kept = tmp_path / "kept"
    found = register(
        kept / "case.vtu",
        tmp_path / "command.vtu",
        points=tmp_path / "pairs.csv",
        noise_mm=0.8,
        misfits=tmp_path / "command.csv",
    )
    assert misfits["name"] == "registered-misfits.csv"
    assert misfits["text"] == (tmp_path / "command.csv").read_text()
    assert (kept / "registered-misfits.csv").read_text() == misfits["text"]
    assert header["offset"]["length_mm"] == pytest.approx(found.offset.length_mm)
    assert not header["offset"]["corrected"]
    theirs = (tmp_path / "command.vtu").read_bytes()
    assert (kept / "registered.vtu").read_bytes() == theirs
    at = engine.shown.nodes
    np.testing.assert_allclose(
        arrays["displacement"], found.prediction.displacement[at], atol=1e-5
    )
    np.testing.assert_allclose(arrays["field"], found.deviation_mm[at], rtol=1e-5)
    assert len(arrays["section_field"]) == len(section["points"])
    assert sorted(one["mm"] for one in header["misfits"]) == pytest.approx(
        sorted(one.distance_mm for one in found.misfits), abs=1e-5
    )
    assert len(arrays["measured"]) == len(found.misfits) == content.count(b"\n") + 1
    assert header["usable"] == found.prediction.status.usable
    assert header["reasons"] == list(found.prediction.reasons)


def test_a_network_is_adapted_and_predicts(socket: ClientConnection) -> None:
    ask(socket, "adapt")
    assert frame(socket)[0] == {"kind": "adapting"}
    header, _ = frame(socket)
    assert (header["kind"], header["predictors"]) == ("scene", ["network", "linear"])
    assert "adapted" in header["patient"]["note"]
    load = patch_load(point=(40.0, 40.0, SIDE_X), force_n=(0.0, 0.0, -0.5))
    socket.send(load.model_dump_json())
    assert frame(socket)[0]["predictor"] == "network"


def test_a_series_has_a_state_a_file(
    socket: ClientConnection, engine: Engine, tmp_path: Path
) -> None:
    for i in (1, 2):
        pairs = sunk_pairs(engine.viewed.body.mesh, 1.5 * i)
        send_file(socket, csv_of(pairs), f"{i}.csv")
    ask(socket, "register", rigid_offset=True)
    said = [frame(socket)[0] for _ in range(3)]
    assert [one["kind"] for one in said] == ["registering", "registering", "state"]
    assert (said[2]["state"], said[2]["states"]) == (1, 2)
    assert said[2]["offset"]["corrected"]
    ask(socket, "save")
    assert frame(socket)[0]["files"] == ["case.vtu", "states/"]
    kept = {file.name for file in (tmp_path / "kept" / "states").iterdir()}
    assert kept > {"1.vtu", "2.vtu", "2-misfits.csv", "results.csv", "series.pvd"}
    ask(socket, "state", state=0, field="displacement")
    first, arrays = frame(socket)
    assert (first["name"], "field" in arrays) == ("1.csv", False)
    assert first["largest_mm"] < said[2]["largest_mm"]
    ask(socket, "state", state=2)
    assert "not registered" in frame(socket)[0]["text"]


def test_a_failed_state_is_named_and_the_others_are_shown(
    socket: ClientConnection, engine: Engine, tmp_path: Path
) -> None:
    pairs = csv_of(sunk_pairs(engine.viewed.body.mesh, 3.0))
    for content, name in ((pairs, "a.csv"), (b"1,2,x\n", "b.csv"), (b"x", "c.csv")):
        send_file(socket, content, name)
    ask(socket, "register")
    said = [frame(socket)[0] for _ in range(4)]
    assert [one["kind"] for one in said] == ["registering"] * 3 + ["state"]
    shown = said[3]
    assert (shown["state"], shown["states"], shown["name"]) == (0, 3, "a.csv")
    assert [(row["state"], row["name"]) for row in shown["failed"]] == [
        (1, "b.csv"),
        (2, "c.csv"),
    ]
    assert shown["failed"][0]["reason"].startswith("b.csv: point 1 must be")
    for kind in ("state", "misfits"):
        ask(socket, kind, state=1)
        assert "b.csv could not be registered: b.csv" in frame(socket)[0]["text"]
    ask(socket, "save")
    assert frame(socket)[0]["files"] == ["case.vtu", "states/"]
    kept = {file.name for file in (tmp_path / "kept" / "states").glob("*.vtu")}
    assert kept == {"a.vtu"}


def test_a_series_of_which_nothing_is_registered_says_why_of_each(
    socket: ClientConnection,
) -> None:
    for name in ("a.csv", "b.csv"):
        send_file(socket, b"1,2,x\n", name)
    ask(socket, "register")
    *_, last = (frame(socket)[0] for _ in range(3))
    assert (last["kind"], last["states"]) == ("unregistered", 2)
    for row, name in zip(last["failed"], ("a.csv", "b.csv"), strict=True):
        assert row["name"] == name and row["reason"].startswith(f"{name}: ")
    ask(socket, "save")
    assert "nothing to save" in frame(socket)[0]["text"]


def test_a_transform_of_the_points_after_alone_is_that_of_the_command(
    socket: ClientConnection, engine: Engine, tmp_path: Path
) -> None:
    moved = np.eye(4)
    moved[0, 3] = 1.5
    pairs = sunk_pairs(engine.viewed.body.mesh, 3.0)
    text = "\n".join(" ".join(map(str, row)) for row in moved)
    send_file(socket, csv_of(pairs), "pairs.csv")
    send_file(socket, text.encode(), "tracker.txt", "initial transform")
    ask(socket, "register", chosen={"transformed": "after"})
    frame(socket)
    shown = frame(socket)[0]
    ask(socket, "save")
    kept = tmp_path / "kept"
    assert "registered.vtu" in frame(socket)[0]["files"]
    (tmp_path / "pairs.csv").write_bytes(csv_of(pairs))
    (tmp_path / "tracker.txt").write_text(text)
    files = {
        "points": tmp_path / "pairs.csv",
        "initial_transform": tmp_path / "tracker.txt",
    }
    out = tmp_path / "command.vtu"
    found = register(kept / "case.vtu", out, **files, transformed="after")
    assert (kept / "registered.vtu").read_bytes() == out.read_bytes()
    assert shown["misfit_mm"] == pytest.approx(found.misfit_mm)
    register(kept / "case.vtu", out, **files)
    assert (kept / "registered.vtu").read_bytes() != out.read_bytes()


def test_a_choice_that_nothing_would_use_is_refused(
    socket: ClientConnection, engine: Engine
) -> None:
    send_file(socket, csv_of(sunk_pairs(engine.viewed.body.mesh, 3.0)), "pairs.csv")
    for chosen, says in (
        ({"contrast": "t2"}, "is of no use without scan of the operation"),
        ({"transformed": "after"}, "is of no use without initial transform"),
        ({"colour": "red"}, "there is no 'colour' to choose"),
    ):
        ask(socket, "register", chosen=chosen)
        assert frame(socket)[0]["kind"] == "registering"
        assert says in frame(socket)[0]["text"]


@pytest.mark.parametrize(
    ("content", "name", "role", "says"),
    [
        (b"1,2,x\n", "../../my points.csv", "pairs", "my points.csv: point 1 must be"),
        (b"1,2,3\n", "before.csv", "pairs", "target"),
        (b"solid nothing", "surface.stl", "surface", "surface.stl"),
        (b'{"markups": 3}', "a.mrk.json", "pairs", "a.mrk.json"),
        (csv_of(np.full((9, 6), 900.0)), "far.csv", "pairs", "900"),
    ],
)
def test_a_bad_file_is_one_line_that_calls_it_by_its_name(
    socket: ClientConnection, content: bytes, name: str, role: str, says: str
) -> None:
    send_file(socket, content, name, role)
    ask(socket, "register")
    assert frame(socket)[0]["kind"] == "registering"
    header, _ = frame(socket)
    assert header["kind"] == "error"
    assert says in header["text"] and "\n" not in header["text"]
    assert "/tmp" not in header["text"] and "measured-1" not in header["text"]
    ask(socket, "save")
    assert "nothing to save" in frame(socket)[0]["text"]


FILE = {"type": "measured_file", "name": "a.csv", "role": "pairs", "n_bytes": 9}
TRY = {"type": "craniotomy", "point": [40, 40, 80], "radius_mm": 20}


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({**FILE, "n_bytes": 0}, "n_bytes"),
        ({**FILE, "n_bytes": 2**40}, "n_bytes"),
        ({**FILE, "name": ""}, "name"),
        ({**FILE, "role": "x"}, "pairs, before"),
        ({**TRY, "radius_mm": 4}, "radius_mm"),
        ({**TRY, "radius_mm": 99}, "must leave"),
        ({"type": "register", "noise_mm": 0}, "noise_mm"),
        ({"type": "register", "rigid_offset": "yes"}, "rigid_offset"),
        ({"type": "register", "chosen": {"contrast": 2}}, "chosen"),
        ({"type": "misfits", "state": 0}, "not registered"),
        ({"type": "register"}, "nothing to register"),
        ({"type": "state", "state": -1}, "state"),
        ({"type": "save", "path": "/etc"}, "path"),
    ],
)
def test_a_bad_wish_is_one_line_and_the_session_goes_on(
    socket: ClientConnection, fields: dict[str, Any], says: str
) -> None:
    socket.send(json.dumps(fields))
    header, _ = frame(socket)
    assert header["kind"] == "error" and says in header["text"]
    assert "\n" not in header["text"]
    ask(socket, "craniotomy", point=[40, 40, 80], radius_mm=20)
    assert frame(socket)[0]["kind"] == "craniotomy"


def test_files_of_one_browser_are_not_anothers(
    address: Address, socket: ClientConnection, engine: Engine
) -> None:
    with connect(address.live) as other:
        frame(other)
        send_file(other, csv_of(sunk_pairs(engine.viewed.body.mesh, 2.0)), "a.csv")
        ask(other, "register")
        assert frame(other)[0]["kind"] == "registering"
        ask(socket, "register")
        assert "nothing to register" in frame(socket)[0]["text"]


def test_a_run_has_no_patient(viewed: Any) -> None:
    with serving(Engine(viewed)) as address, connect(address.live) as socket:
        assert frame(socket)[0]["patient"] is None
        ask(socket, "register")
        assert "start physgnn view with a case" in frame(socket)[0]["text"]
