"""Text as files hold it: one way to read it for every format.

UTF-8 with or without a byte order mark, and UTF-16 and UTF-32 with one, which
Notepad, PowerShell and spreadsheets write.
"""

import codecs
import json
import tomllib
from pathlib import Path
from typing import Any

from physgnn.errors import InputError
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.limits import check_size

# UTF-32's little-endian mark begins with that of UTF-16
MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)


def read_bytes(path: str | Path) -> bytes:
    """Return a file's bytes.

    Raises
    ------
    InputError
        If it is missing, no regular file, or too large.
    """
    path = Path(path)
    with reading(path, "a file"):
        if path.is_dir():
            raise InputError("expected a file (this is a folder): name a file in it")
        if path.exists() and not path.is_file():
            raise InputError("expected a regular file, which it is not")
        check_size(path, path.stat().st_size)
        return path.read_bytes()


def read_text(path: str | Path, *, names_in_latin1: bool = False) -> str:
    """Return a file's text.

    Parameters
    ----------
    path : path
        The file.
    names_in_latin1 : bool
        Whether names and comments in it may be in Latin-1: then it is read so where
        it is no UTF-8.

    Raises
    ------
    InputError
        If it cannot be read, or is in another encoding; with the byte and the line.
    """
    data = read_bytes(path)
    with reading(path, "text in UTF-8"):
        return decoded(data, names_in_latin1=names_in_latin1)


def decoded(data: bytes, *, names_in_latin1: bool = False) -> str:
    """Return the text that bytes hold; see `read_text`."""
    for mark, encoding in MARKS:
        if data.startswith(mark):
            return data[len(mark) :].decode(encoding)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        if names_in_latin1:
            return data.decode("latin-1")
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"text must be in UTF-8 (byte 0x{data[error.start]:02x} in line {line} is "
            "not, as in Latin-1): save it as UTF-8"
        ) from error


def read_json(path: str | Path) -> Any:
    """Return what a JSON file holds.

    Raises
    ------
    InputError
        If it is no JSON, or nested too deep.
    """
    text = read_text(path)
    with reading(path, "JSON"):
        return json.loads(text)


def read_toml_text(path: str | Path) -> dict[str, Any]:
    """Return the tables of a TOML file.

    Raises
    ------
    InputError
        If it is no TOML; with the line.
    """
    text = read_text(path).replace("\r\n", "\n")
    with reading(path, "a TOML file"):
        return tomllib.loads(text)
