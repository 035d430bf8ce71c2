"""Files of a browser: bounded, whole, and never where the page says."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from physgnn.errors import InputError
from physgnn.serving.patient import uploads as module
from physgnn.serving.patient.uploads import ReceivedFile, Uploads, states_of
from physgnn.serving.protocol.patient_messages import MOST_FILES, MeasuredFile

ROLES, SUFFIXES = ("pairs", "surface"), (".csv", ".mrk.json", ".stl")
NAMES = {role: role.upper() for role in (*ROLES, "before", "after")}


@pytest.fixture
def uploads() -> Iterator[Uploads]:
    made = Uploads(ROLES, SUFFIXES)
    yield made
    made.close()
    assert not made.folder.exists()


def announced(name: str = "a.csv", role: str = "pairs", n: int = 5) -> MeasuredFile:
    return MeasuredFile(name=name, role=role, n_bytes=n)


def test_a_file_in_pieces_is_whole(uploads: Uploads) -> None:
    uploads.announce(announced("Points after.mrk.json", n=5))
    uploads.add(b"abc")
    assert uploads.files == []
    uploads.add(b"de")
    (file,) = uploads.files
    assert (file.name, file.role) == ("Points after.mrk.json", "pairs")
    assert file.path.read_bytes() == b"abcde"
    assert file.path.parent == uploads.folder
    assert file.path.name == "measured-1.mrk.json"


@pytest.mark.parametrize(
    "name", ["../../etc/cron.d/x.csv", "/etc/passwd.csv", "..\\x.csv", "\0.csv", ".csv"]
)
def test_a_name_never_becomes_a_path(uploads: Uploads, name: str) -> None:
    uploads.announce(announced(name, n=1))
    uploads.add(b"x")
    assert [file.name for file in uploads.folder.iterdir()] == ["measured-1.csv"]
    assert "/" not in uploads.files[0].name and "\0" not in uploads.files[0].name


@pytest.mark.parametrize(
    ("message", "says"),
    [
        (announced("a.exe"), "must end in one of .csv, .mrk.json, .stl"),
        (announced("csv"), "must end in one of"),
        (announced(role="passwords"), "must be one of pairs, surface"),
    ],
)
def test_what_is_no_measured_file_is_refused(
    uploads: Uploads, message: MeasuredFile, says: str
) -> None:
    with pytest.raises(InputError, match=says):
        uploads.announce(message)
    with pytest.raises(InputError, match="got binary"):
        uploads.add(b"x")


def test_bytes_that_were_not_announced_are_refused(uploads: Uploads) -> None:
    with pytest.raises(InputError, match="got binary"):
        uploads.add(b"x")
    uploads.announce(announced(n=2))
    with pytest.raises(InputError, match="more bytes came"):
        uploads.add(b"xyz")
    assert uploads.files == [] and list(uploads.folder.iterdir()) == []


def test_half_a_file_is_none(uploads: Uploads) -> None:
    uploads.announce(announced(n=2))
    uploads.add(b"x")
    with pytest.raises(InputError, match="is not whole"):
        uploads.announce(announced())
    assert uploads.files == [] and list(uploads.folder.iterdir()) == []


def test_there_is_an_end_to_files_and_to_bytes(
    uploads: Uploads, monkeypatch: pytest.MonkeyPatch
) -> None:
    for _ in range(MOST_FILES):
        uploads.announce(announced(n=1))
        uploads.add(b"x")
    with pytest.raises(InputError, match="at most 32 files"):
        uploads.announce(announced(n=1))
    uploads.forget()
    assert list(uploads.folder.iterdir()) == []
    monkeypatch.setattr(module, "MAX_TOTAL_BYTES", 1 << 20)
    with pytest.raises(InputError, match="at most 1 MB together"):
        uploads.announce(announced(n=(1 << 20) + 1))


def received(*roles: str) -> list[ReceivedFile]:
    return [ReceivedFile(f"{i}", role, Path(f"{i}")) for i, role in enumerate(roles)]


def test_several_files_of_a_role_are_a_series() -> None:
    states = states_of(received("before", "after", "after", "after"), NAMES)
    assert [{role: f.name for role, f in s.items()} for s in states] == [
        {"before": "0", "after": name} for name in "123"
    ]
    assert len(states_of(received("pairs", "surface"), NAMES)) == 1


def test_a_series_of_unequal_parts_is_refused() -> None:
    with pytest.raises(InputError, match=r"equally many .*2 PAIRS, 3 SURFACE"):
        states_of(received("pairs", "pairs", "surface", "surface", "surface"), NAMES)
    with pytest.raises(InputError, match="nothing to register"):
        states_of([], NAMES)
