"""The arrays of VTK's XML files: ASCII, base64 and raw, compressed by zlib or not.

Source of the format: VTK File Formats, https://docs.vtk.org/en/latest/
vtk_file_formats/vtkxml_file_format.html. Every size that a file declares is compared
with what is there, before anything is allocated.
"""

import base64
import xml.etree.ElementTree as ET
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.io.untrusted.limits import check_size

Array = np.ndarray[Any, Any]
TYPES = {
    "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4",
    "UInt32": "u4", "Int64": "i8", "UInt64": "u8", "Float32": "f4", "Float64": "f8",
}  # fmt: skip
STRING = "String"
BYTE_ORDERS = {"LittleEndian": "<", "BigEndian": ">"}
COMPRESSORS = (None, "vtkZLibDataCompressor")


class OtherFeatureError(Exception):
    """The file is written in a way that only VTK itself reads."""


@dataclass(frozen=True)
class ArrayReader:
    """Decodes the ``DataArray`` elements of one file.

    Parameters
    ----------
    path : str
        The file, for messages and bounds.
    order : str
        "<" or ">".
    word : str
        NumPy's name of the type of sizes, "u4" or "u8".
    compressed : bool
        Whether data come in blocks of zlib.
    appended : bytes
        What follows the underscore of ``AppendedData``.
    appended_base64 : bool
        Whether that is in base64.
    """

    path: str
    order: str
    word: str
    compressed: bool
    appended: bytes
    appended_base64: bool

    def read(self, element: ET.Element) -> Array:
        """Return an array, (n,) or (n, n_components); strings as an array of str."""
        kind = element.get("type", "")
        if kind != STRING and kind not in TYPES:
            raise OtherFeatureError(f"arrays of type {kind}")
        dtype = np.dtype(self.order + ("u1" if kind == STRING else TYPES[kind]))
        values = self._values(element, dtype)
        if kind == STRING:
            text = values.tobytes().decode("utf-8")
            return np.array(text.split("\0")[:-1])
        values = values.astype(dtype.newbyteorder("="), copy=False)
        width = int(element.get("NumberOfComponents") or 1)
        return values.reshape(-1, width) if width > 1 else values

    def _values(self, element: ET.Element, dtype: np.dtype[Any]) -> Array:
        form = element.get("format", "ascii")
        if form == "ascii":
            words = (element.text or "").split()
            return np.array(words).astype(dtype) if words else np.empty(0, dtype)
        if form == "appended":
            offset = int(element.get("offset", ""))
            if not 0 <= offset <= len(self.appended):
                raise InputError(f"an array begins at byte {offset}, beyond the end")
            stream = _Stream(self.appended, offset, in_base64=self.appended_base64)
        else:
            text = "".join((element.text or "").split()).encode("ascii")
            stream = _Stream(text, 0, in_base64=True)
        data = self._blocks(stream) if self.compressed else self._plain(stream)
        return np.frombuffer(data, dtype)

    def _plain(self, stream: "_Stream") -> bytes:
        word = np.dtype(self.order + self.word)
        start = stream.position
        head = stream.take(word.itemsize)
        n_bytes = int(np.frombuffer(head, word)[0])
        stream.check_left(n_bytes)
        if stream.padded_before():
            return stream.take(n_bytes)
        # others encode the size and the data in one go
        stream.position = start
        return stream.take(word.itemsize + n_bytes)[word.itemsize :]

    def _blocks(self, stream: "_Stream") -> bytes:
        word = np.dtype(self.order + self.word)
        start = stream.position
        n_blocks = int(np.frombuffer(stream.take(3 * word.itemsize), word)[0])
        stream.check_left(n_blocks * word.itemsize)
        stream.position = start
        head = np.frombuffer(stream.take((3 + n_blocks) * word.itemsize), word)
        _, size, last, *packed = (int(n) for n in head)
        if n_blocks == 0:
            return b""
        sizes = [size] * (n_blocks - 1) + [last or size]
        check_size(self.path, sum(sizes), "an array")
        stream.check_left(sum(packed))
        content = stream.take(sum(packed))
        parts, at = [], 0
        for n_packed, n in zip(packed, sizes, strict=True):
            parts.append(_unpacked(content[at : at + n_packed], n))
            at += n_packed
        return b"".join(parts)


def _unpacked(block: bytes, size: int) -> bytes:
    """Return a block of zlib, verified by its length and checksum."""
    inflate = zlib.decompressobj()
    data = inflate.decompress(block, size + 1)
    if len(data) != size or not inflate.eof:
        raise InputError("a compressed block is not of the size declared, or cut off")
    return data


@dataclass
class _Stream:
    """Bytes that are read group by group, in base64 each encoded by itself."""

    data: bytes
    position: int
    in_base64: bool

    def take(self, n_bytes: int) -> bytes:
        """Return the next group of so many bytes."""
        n = (n_bytes + 2) // 3 * 4 if self.in_base64 else n_bytes
        group = self.data[self.position : self.position + n]
        self.position += n
        if self.in_base64:
            group = base64.b64decode(group, validate=True)
        if len(group) < n_bytes:
            raise InputError("the data of an array are cut off")
        return group[:n_bytes]

    def check_left(self, n_bytes: int) -> None:
        """Raise InputError if fewer bytes are left than are declared."""
        if n_bytes > len(self.data) - self.position:
            raise InputError(
                f"an array declares {n_bytes} bytes, more than are left in the file"
            )

    def padded_before(self) -> bool:
        """Whether the group that was read last ends by itself."""
        return (
            not self.in_base64 or self.data[self.position - 1 : self.position] == b"="
        )
