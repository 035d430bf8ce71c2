"""Binary messages to the browser: a JSON header and plain arrays, nothing to parse.

Layout, little-endian: the four bytes ``PGV1``, the header's length in bytes as uint32,
the header in UTF-8 padded with spaces to a multiple of four, then the arrays one after
another, each padded to a multiple of four. The header's ``arrays`` lists name, type and
shape of each, so that a typed-array view is all the page needs.
"""

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError

MAGIC = b"PGV1"
TYPES: Mapping[str, str] = {"f4": "<f4", "i4": "<i4", "u1": "|u1"}


def encode(
    header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]] | None = None
) -> bytes:
    """Return a message; float arrays become float32, integers int32 or uint8.

    Parameters
    ----------
    header : mapping
        What JSON can hold; the key ``arrays`` is added.
    arrays : mapping of str to array
        What follows.
    """
    rows, parts = [], []
    for name, values in (arrays or {}).items():
        kind = _type_of(values)
        rows.append({"name": name, "type": kind, "shape": list(values.shape)})
        parts.append(_padded(np.ascontiguousarray(values, TYPES[kind]).tobytes()))
    text = json.dumps({**header, "arrays": rows}, allow_nan=False).encode()
    head = _padded(text, b" ")
    return b"".join([MAGIC, struct.pack("<I", len(head)), head, *parts])


def decode(message: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return header and arrays of a message; InputError if it is none."""
    if message[:4] != MAGIC:
        raise InputError(f"a frame starts with {MAGIC!r} (got {message[:4]!r})")
    (length,) = struct.unpack("<I", message[4:8])
    header = json.loads(message[8 : 8 + length])
    start, arrays = 8 + length, {}
    for row in header.pop("arrays"):
        count = int(np.prod(row["shape"]))
        values = np.frombuffer(message, TYPES[row["type"]], count, start)
        arrays[row["name"]] = values.reshape(row["shape"])
        start += -(-values.nbytes // 4) * 4
    return header, arrays


def _type_of(values: NDArray[Any]) -> str:
    if values.dtype == np.uint8:
        return "u1"
    return "f4" if np.issubdtype(values.dtype, np.floating) else "i4"


def _padded(content: bytes, with_: bytes = b"\0") -> bytes:
    return content + with_ * (-len(content) % 4)
