"""Compressed input, read to its end and verified.

Readers that stop when they have what they want never reach the checksum, which stands
at the end: a flipped bit is then another label. So everything is unpacked here whole,
within the bounds of `physgnn.io.untrusted.limits`, before anybody parses it.
"""

import gzip
import io
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.limits import allowed_bytes, check_size
from physgnn.io.untrusted.text import read_bytes

GZIP_MARK = b"\x1f\x8b"
CHUNK = 1 << 22
NPY = ".npy"
# what NumPy writes; others can unpack without bounds
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)

Array = np.ndarray[Any, Any]
Declared = Callable[[bytes], int]


def undeclared(start: bytes) -> int:
    """Return 0: the first bytes say nothing of what follows."""
    del start
    return 0


def read_unpacked(path: str | Path, declared: Declared = undeclared) -> bytes:
    """Return a file's bytes, unpacked and verified if it is a gzip file.

    Parameters
    ----------
    path : path
        The file.
    declared : callable
        From the first bytes to how many bytes they declare that follow, 0 if nothing:
        too many are refused before they are unpacked.

    Raises
    ------
    InputError
        If it cannot be read, its checksum or length is wrong, or it is too large.
    """
    data = read_bytes(path)
    return unpacked(path, data, declared) if data.startswith(GZIP_MARK) else data


def unpacked(path: str | Path, data: bytes, declared: Declared = undeclared) -> bytes:
    """Return what a gzip stream of a file holds, verified; see `read_unpacked`."""
    limit = allowed_bytes(path)
    parts: list[bytes] = []
    total = 0
    with reading(path, "a whole gzip file"), gzip.open(io.BytesIO(data)) as file:
        while part := file.read(CHUNK):
            if not parts:
                check_size(path, declared(part), "the image")
            parts.append(part)
            total += len(part)
            if total > limit:
                check_size(path, total, "what it unpacks to")
    return b"".join(parts)


def inflated(path: str | Path, data: bytes, n_bytes: int) -> bytes:
    """Return what a zlib stream of a file holds, verified.

    Parameters
    ----------
    path : path
        The file.
    data : bytes
        The stream.
    n_bytes : int
        How much it must unpack to.

    Raises
    ------
    InputError
        If its checksum or length is wrong, it is cut off, or would be too large.
    """
    check_size(path, n_bytes)
    with reading(path, "a whole zlib stream"):
        stream = zlib.decompressobj()
        content = stream.decompress(data, n_bytes + 1)
        if len(content) != n_bytes or not stream.eof:
            raise InputError(
                f"it declares {n_bytes} bytes and unpacks to "
                f"{'more' if len(content) > n_bytes else 'less, or is cut off'}: "
                "export it again"
            )
    return content


def read_npz(path: str | Path) -> dict[str, Array]:
    """Return the arrays of an .npz file, each verified by its checksum.

    Raises
    ------
    InputError
        If it is no such file, is damaged or too large, or an array holds objects.
    """
    path = Path(path)
    data = read_bytes(path)
    with (
        reading(path, "arrays in an .npz file"),
        zipfile.ZipFile(io.BytesIO(data)) as archive,
    ):
        members = archive.infolist()
        check_size(path, sum(m.file_size for m in members), "its arrays")
        for member in members:
            if member.compress_type not in METHODS:
                raise InputError(
                    f"'{member.filename}' is compressed in a way that NumPy does not "
                    "write: save it with numpy.savez_compressed"
                )
        return {
            m.filename.removesuffix(NPY): _array(archive.read(m), m.filename)
            for m in members
        }


def _array(data: bytes, name: str) -> Array:
    """Return the array of an .npy file, once its header fits what follows."""
    file = io.BytesIO(data)
    version = np.lib.format.read_magic(file)
    read_header = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)
    if read_header is None:
        raise InputError(f"'{name}' is of an unknown version {version}")
    shape, _, dtype = read_header(file)
    if dtype.hasobject:
        raise InputError(f"'{name}' holds Python objects: save arrays of numbers")
    declared = dtype.itemsize
    for n in shape:  # in Python's integers, which do not overflow
        declared *= n
    if min(shape, default=0) < 0 or declared != len(data) - file.tell():
        raise InputError(
            f"'{name}' declares shape {shape}, which does not fit its "
            f"{len(data) - file.tell()} bytes"
        )
    file.seek(0)
    array: Array = np.lib.format.read_array(file, allow_pickle=False)
    return array
