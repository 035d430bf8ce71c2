"""MetaImage files: .mha, and .mhd with its voxels in a file beside it.

An own reader and writer, for the reasons of `physgnn.io.medical.images.nrrd`. Source of
the format: MetaIO documentation, https://itk.org/Wiki/ITK/MetaIO/Documentation.
"""

import re
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.imaging.transforms import affine_in_lps, affine_in_ras
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.medical.images.nrrd import beside
from physgnn.io.medical.images.voxels import (
    AXES,
    ReadOptions,
    Voxels,
    affine_in_mm,
    check_colours,
    declared_bytes,
    voxels_of,
)
from physgnn.io.untrusted.compressed import inflated
from physgnn.io.untrusted.text import decoded, read_bytes

TYPES = {
    "MET_CHAR": "i1", "MET_UCHAR": "u1", "MET_SHORT": "i2", "MET_USHORT": "u2",
    "MET_INT": "i4", "MET_UINT": "u4", "MET_LONG": "i4", "MET_ULONG": "u4",
    "MET_LONG_LONG": "i8", "MET_ULONG_LONG": "u8", "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}  # fmt: skip
CODES = {code: name for name, code in TYPES.items() if "_LONG" not in name}
CODES |= {"i8": "MET_LONG_LONG", "u8": "MET_ULONG_LONG"}
LAST_FIELD = re.compile(rb"^ElementDataFile *= *([^\r\n]*)\r?\n?", re.MULTILINE)
LOCAL = "LOCAL"
# Older names of fields, and the ones that replaced them.
OLDER = {
    "Position": "Offset", "Origin": "Offset", "Rotation": "TransformMatrix",
    "Orientation": "TransformMatrix", "BinaryDataByteOrderMSB": "ElementByteOrderMSB",
    "ElementSize": "ElementSpacing",
}  # fmt: skip


def read_metaimage(path: Path, options: ReadOptions) -> Voxels:
    """Read a MetaImage; its axes are LPS, as of everything of ITK."""
    content = read_bytes(path)
    end = LAST_FIELD.search(content)
    if end is None or b"NDims" not in content[: end.start()]:
        raise InputError(
            "expected a MetaImage, but it cannot be read (it has no header of one): "
            "convert it"
        )
    fields = _fields(decoded(content[: end.start()], names_in_latin1=True))
    check_colours(int(fields.get("ElementNumberOfChannels", "1")))
    shape = [int(word) for word in fields.get("DimSize", "").split()]
    if len(shape) != int(fields["NDims"]):
        raise InputError(
            f"its DimSize must be as many numbers as NDims says (got {shape})"
        )
    dtype = _dtype(fields)
    n_bytes = declared_bytes(path, dtype, shape)
    name = end[1].decode("utf-8", "replace").strip()
    body = content[end.end() :] if name == LOCAL else read_bytes(beside(path, name))
    data = voxels_of(path, _stored(path, fields, body, n_bytes), dtype, shape)
    unit = fields.get("DistanceUnits", "")
    affine = affine_in_ras(_affine(fields, len(shape)), "LPS")
    unit = "" if unit == "?" else unit
    return Voxels(data, affine_in_mm(path, affine, shape, unit=unit, log=options.log))


def _fields(text: str) -> dict[str, str]:
    pairs = [line.partition("=") for line in text.splitlines()]
    names = [(name.strip(), value.strip()) for name, found, value in pairs if found]
    return {OLDER.get(name, name): value for name, value in names}


def _dtype(fields: Mapping[str, str]) -> np.dtype[Any]:
    name = fields.get("ElementType", "")
    if name not in TYPES:
        raise InputError(f"an image must hold real numbers (its type is '{name}')")
    msb = fields.get("ElementByteOrderMSB", "False").lower() in ("true", "1")
    return np.dtype((">" if msb else "<") + TYPES[name])


def _stored(path: Path, fields: Mapping[str, str], body: bytes, n_bytes: int) -> bytes:
    """Return the bytes of the voxels, unpacked and verified."""
    if fields.get("BinaryData", "True").lower() not in ("true", "1"):
        raise InputError("its voxels are text: save it again as binary data")
    if fields.get("CompressedData", "False").lower() in ("true", "1"):
        return inflated(path, body, n_bytes)
    skip = int(fields.get("HeaderSize", "0"))
    if skip < 0:  # the voxels are what is last in the file
        skip = max(len(body) - n_bytes, 0)
    return body[skip:]


def _affine(fields: Mapping[str, str], n_axes: int) -> FloatArray:
    """Return the affine in LPS, of the first three axes."""

    def numbers(name: str, default: FloatArray) -> FloatArray:
        given = [float(word) for word in fields.get(name, "").split()]
        if given and len(given) != default.size:
            raise InputError(f"its {name} must be {default.size} numbers (got {given})")
        return np.reshape(given, default.shape) if given else default

    # a row of the matrix is the direction of an axis
    directions = numbers("TransformMatrix", np.eye(n_axes)).T
    steps = directions * numbers("ElementSpacing", np.ones(n_axes))
    affine = np.eye(4)
    n = min(n_axes, AXES)
    affine[:n, :n] = steps[:n, :n]
    affine[:n, 3] = numbers("Offset", np.zeros(n_axes))[:n]
    return affine


def write_metaimage(path: Path, image: Image, note: str) -> None:
    """Write a MetaImage in LPS: .mha in one file, .mhd beside its packed voxels."""
    data = np.asarray(image.data)
    code = data.dtype.newbyteorder("<").str[1:]
    body = zlib.compress(data.astype("<" + code).tobytes(order="F"), 6)
    affine = affine_in_lps(image.affine)
    is_one = path.suffix.lower() != ".mhd"
    beside_it = path.with_suffix(".zraw")
    fields = {
        "ObjectType": "Image",
        "NDims": "3",
        **({"Comment": " ".join(note.split())} if note else {}),
        "BinaryData": "True",
        "BinaryDataByteOrderMSB": "False",
        "CompressedData": "True",
        "CompressedDataSize": str(len(body)),
        "TransformMatrix": _words((affine[:3, :3] / image.grid.voxel_mm).T),
        "Offset": _words(affine[:3, 3]),
        "CenterOfRotation": "0 0 0",
        "ElementSpacing": _words(image.grid.voxel_mm),
        "DimSize": " ".join(map(str, data.shape)),
        "ElementType": CODES[code],
        "ElementDataFile": LOCAL if is_one else beside_it.name,
    }
    head = "".join(f"{name} = {value}\n" for name, value in fields.items()).encode()
    if not is_one:
        with whole_file(beside_it) as part:
            part.write_bytes(body)
    with whole_file(path) as part:
        part.write_bytes(head + body if is_one else head)


def _words(numbers: FloatArray) -> str:
    return " ".join(repr(float(n)) for n in numbers.ravel())
