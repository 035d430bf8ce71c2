"""NRRD images and the segmentations of 3D Slicer: .nrrd, .nhdr, .seg.nrrd.

An own reader and writer: ITK's reads a damaged header or stream as far as it can, and
its writer knows nothing of a full disk. Source of the format: Definition of NRRD file
format, https://teem.sourceforge.net/nrrd/format.html.
"""

import gzip
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.imaging.transforms import affine_in_lps, affine_in_ras
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.medical.images.segments import read_segments, segment_lines
from physgnn.io.medical.images.voxels import (
    AXES,
    ReadOptions,
    Voxels,
    affine_in_mm,
    check_colours,
    declared_bytes,
    three_axes,
    voxels_of,
)
from physgnn.io.untrusted.compressed import unpacked
from physgnn.io.untrusted.text import decoded, read_bytes

MARK = b"NRRD000"
BLANK = re.compile(rb"\r?\n\r?\n")
VECTOR = re.compile(r"\(([^()]*)\)|none")
# The names of number types, and NumPy's.
_NAMES = {
    "i1": "signed char, int8, int8_t",
    "u1": "uchar, unsigned char, uint8, uint8_t",
    "i2": "short, short int, signed short, signed short int, int16, int16_t",
    "u2": "ushort, unsigned short, unsigned short int, uint16, uint16_t",
    "i4": "int, signed int, int32, int32_t",
    "u4": "uint, unsigned int, uint32, uint32_t",
    "i8": "longlong, long long, long long int, signed long long, int64, int64_t",
    "u8": "ulonglong, unsigned long long, unsigned long long int, uint64, uint64_t",
    "f4": "float",
    "f8": "double",
}
TYPES = {name: code for code, names in _NAMES.items() for name in names.split(", ")}
SPACES = {
    "left-posterior-superior": "LPS", "lps": "LPS",
    "right-anterior-superior": "RAS", "ras": "RAS",
    "left-anterior-superior": "LAS", "las": "LAS",
}  # fmt: skip
LAYERS = "list"  # the kind of the axis of 3D Slicer's layers
COLOURS = re.compile(
    r".*color|hsv-color|xyz-color|complex|.*vector|.*matrix|quaternion"
)
ENCODINGS = ("raw", "gzip", "gz")


@dataclass(frozen=True)
class _Header:
    """Fields by name in lower case, and keys with values."""

    fields: Mapping[str, str]
    keys: Mapping[str, str]

    def words(self, name: str) -> list[str]:
        return self.fields.get(name, "").split()

    def need(self, name: str) -> str:
        if name not in self.fields:
            raise InputError(f"its header must say '{name}': export it again")
        return self.fields[name]


def read_nrrd(path: Path, options: ReadOptions) -> Voxels:
    """Read a NRRD image, of which the voxels may lie in a file beside it."""
    header, body = _split(read_bytes(path))
    shape = [int(word) for word in header.need("sizes").split()]
    if len(shape) != int(header.need("dimension")):
        raise InputError(f"its sizes {shape} must be as many as its dimension says")
    dtype = _dtype(header)
    declared_bytes(path, dtype, shape)
    data = voxels_of(path, _stored(path, header, body), dtype, shape)
    places = [i for i, vector in enumerate(_vectors(header, len(shape))) if vector]
    data, segments = _in_space(data, header, places)
    layered = bool(segments) and data.ndim > AXES
    data = data if layered else three_axes(data)
    shape = list(data.shape[1:] if layered else data.shape)
    return Voxels(data, _affine(path, header, shape, options), segments)


def _split(content: bytes) -> tuple[_Header, bytes]:
    if not content.startswith(MARK):
        raise InputError(
            "expected a NRRD image, but it cannot be read (it does not begin with "
            f"{MARK.decode()}): convert it"
        )
    end = BLANK.search(content)
    text = decoded(content[: end.start()] if end else content, names_in_latin1=True)
    fields, keys = {}, {}
    for line in text.splitlines()[1:]:
        if line.startswith("#"):
            continue
        key, is_key, value = line.partition(":=")
        name, is_field, said = line.partition(": ")
        if is_key and (not is_field or len(key) < len(name)):
            keys[key.strip()] = value.strip()
        elif is_field:
            fields[name.strip().lower().replace("datafile", "data file")] = said.strip()
    return _Header(fields, keys), content[end.end() :] if end else b""


def _dtype(header: _Header) -> np.dtype[Any]:
    name = header.need("type").lower()
    if name not in TYPES:
        raise InputError(f"an image must hold real numbers (its type is '{name}')")
    endian = header.fields.get("endian", "little").lower()
    if endian not in ("little", "big"):
        raise InputError(f"its endian must be little or big (got '{endian}')")
    return np.dtype((">" if endian == "big" else "<") + TYPES[name])


def _stored(path: Path, header: _Header, body: bytes) -> bytes:
    """Return the bytes of the voxels, unpacked and verified."""
    encoding = header.need("encoding").lower()
    if encoding not in ENCODINGS:
        raise InputError(
            f"its encoding must be raw or gzip (got '{encoding}'): save it again in "
            "3D Slicer or SimpleITK"
        )
    file = path
    if "data file" in header.fields:
        file = beside(path, header.fields["data file"])
        body = read_bytes(file)
    if {"line skip", "byte skip", "lineskip", "byteskip"} & header.fields.keys():
        skips = [int(n) for k, n in header.fields.items() if k.endswith("skip")]
        if any(skips):
            raise InputError("its header skips a part of the data: save it again")
    return body if encoding == "raw" else unpacked(file, body)


def beside(path: Path, name: str) -> Path:
    """Return the file of voxels that a header names, which must lie in its folder.

    Raises
    ------
    InputError
        If it is a list or pattern of files, lies elsewhere, or is not there.
    """
    file = path.parent / name
    if name.split()[:1] == ["LIST"] or "%" in name:
        raise InputError("its voxels lie in several files: save it as one file")
    if Path(name).name != name or name in (".", ".."):
        raise InputError(
            f"its voxels must lie in its own folder (got '{name}'): move them there"
        )
    if not file.is_file():
        raise InputError(f"the file of its voxels, '{name}', is not there: give both")
    return file


def _vectors(header: _Header, n_axes: int) -> list[str]:
    """Return the direction of every axis as text, empty for one that has none."""
    if "space directions" not in header.fields:
        kinds = header.words("kinds") or ["space"] * n_axes
        return ["spacing" if _is_place(kind) else "" for kind in kinds[:n_axes]]
    found = [
        match[1] or "" for match in VECTOR.finditer(header.need("space directions"))
    ]
    if len(found) != n_axes:
        raise InputError(
            f"its space directions must be one an axis, {n_axes} (got {len(found)})"
        )
    return found


def _is_place(kind: str) -> bool:
    return kind != LAYERS and kind != "time" and not COLOURS.fullmatch(kind.lower())


def _in_space(
    data: NDArray[np.generic], header: _Header, places: list[int]
) -> tuple[NDArray[np.generic], Any]:
    """Return voxels by their three axes in space, after layers if there are any."""
    others = [i for i in range(data.ndim) if i not in places and data.shape[i] > 1]
    if len(places) == AXES and others:
        kinds = header.words("kinds")
        kind = kinds[others[0]] if len(kinds) == data.ndim else ""
        segments = read_segments(header.keys, data.shape[others[0]])
        if len(others) == 1 and segments and kind.lower() == LAYERS:
            return data.transpose(others[0], *places), segments
        if COLOURS.fullmatch(kind.lower()) or data.shape[others[0]] in (3, 4):
            check_colours(data.shape[others[0]])
        return data.transpose(*places, *others), ()
    ones = tuple(i for i in range(data.ndim) if i not in places and i not in others)
    return data.squeeze(ones), read_segments(header.keys, 1)


def _affine(
    path: Path, header: _Header, shape: list[int], options: ReadOptions
) -> FloatArray:
    affine = np.eye(4)
    vectors = VECTOR.finditer(header.fields.get("space directions", ""))
    columns = [_numbers(match[1]) for match in vectors if match[1]]
    if columns and len(columns) != AXES:
        raise InputError(f"an image needs three axes (it has {len(columns)} in space)")
    if columns:
        affine[:3, :3] = np.array(columns).T
        affine[:3, 3] = _numbers(
            header.fields.get("space origin", "(0,0,0)").strip("()")
        )
    elif "spacings" in header.fields:
        steps = [float(word) for word in header.words("spacings")]
        affine[:3, :3] = np.diag([step for step in steps if np.isfinite(step)][:3])
    space = header.fields.get("space", "").lower().removesuffix("-time")
    if space not in SPACES:
        options.log(
            f"{path}: its header does not say which axes it has ('{space}'): taken for "
            "left-posterior-superior, as ITK does"
        )
    units = set(re.findall(r'"([^"]*)"', header.fields.get("space units", "")))
    units.discard("")
    if len(units) > 1:
        raise InputError(
            f"its axes must have one unit (got {', '.join(sorted(units))})"
        )
    placed = affine_in_ras(affine, SPACES.get(space, "LPS"))
    unit = next(iter(units), "")
    return affine_in_mm(path, placed, shape, unit=unit, log=options.log)


def _numbers(text: str) -> list[float]:
    numbers = [float(word) for word in text.split(",")]
    if len(numbers) != AXES:
        raise InputError(f"a direction must be three numbers (got '{text}')")
    return numbers


def write_nrrd(path: Path, image: Image, note: str) -> None:
    """Write a NRRD image in LPS, packed by gzip; of a label map its names, too."""
    data = np.asarray(image.data)
    code = data.dtype.newbyteorder("<").str[1:]
    name = {"i1": "int8", "u1": "uint8", "f4": "float", "f8": "double"}.get(code)
    affine = affine_in_lps(image.affine)
    lines = [
        "NRRD0005",
        *([f"# {' '.join(note.split())}"] if note else []),
        f"type: {name or ('u' if code[0] == 'u' else '') + f'int{8 * int(code[1])}'}",
        "dimension: 3",
        "space: left-posterior-superior",
        f"sizes: {' '.join(map(str, data.shape))}",
        f"space directions: {' '.join(map(_vector, affine[:3, :3].T))}",
        "kinds: domain domain domain",
        "endian: little",
        "encoding: gzip",
        f"space origin: {_vector(affine[:3, 3])}",
        *(segment_lines(image) if path.name.lower().endswith(".seg.nrrd") else []),
    ]
    body = data.astype(data.dtype.newbyteorder("<")).tobytes(order="F")
    with whole_file(path) as part:
        head = ("\n".join(lines) + "\n\n").encode()
        part.write_bytes(head + gzip.compress(body, compresslevel=6, mtime=0))


def _vector(numbers: FloatArray) -> str:
    return f"({','.join(repr(float(n)) for n in numbers)})"
