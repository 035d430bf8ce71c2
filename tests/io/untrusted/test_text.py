"""Text in the encodings that editors write, and the one line for others."""

from pathlib import Path

import pytest

from physgnn.errors import InputError
from physgnn.io.untrusted.text import read_bytes, read_json, read_text, read_toml_text

TEXT = 'name = "Gliom é ⚕"\r\n'


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32", "utf-16-be"]
)
def test_every_encoding_with_a_mark(encoding: str, tmp_path: Path) -> None:
    mark = "\ufeff" if encoding == "utf-16-be" else ""
    (tmp_path / "a.toml").write_bytes((mark + TEXT).encode(encoding))
    assert read_text(tmp_path / "a.toml") == TEXT
    assert read_toml_text(tmp_path / "a.toml") == {"name": "Gliom é ⚕"}
    (tmp_path / "a.json").write_bytes((mark + '{"é": 1}').encode(encoding))
    assert read_json(tmp_path / "a.json") == {"é": 1}


def test_latin1_where_names_may_be(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes(b"1\n# \xe9\n")
    assert read_text(tmp_path / "a.txt", names_in_latin1=True) == "1\n# é\n"
    with pytest.raises(InputError, match=r"a\.txt.*byte 0xe9 in line 2"):
        read_text(tmp_path / "a.txt")


def test_what_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "deep.json").write_text("[" * 100_000)
    (tmp_path / "half.txt").write_bytes(b"\xff\xfea")
    for read, name in ((read_json, "deep.json"), (read_text, "half.txt")):
        with pytest.raises(InputError, match=name):
            read(tmp_path / name)
    with pytest.raises(InputError, match="this is a folder"):
        read_bytes(tmp_path)
    with pytest.raises(InputError, match="no such file"):
        read_bytes(tmp_path / "none")
