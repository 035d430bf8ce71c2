"""Whether a file just written is complete, by what its format has at the end.

Cheap: nothing is parsed that a size or a last mark can tell. It finds a file cut short,
not one altered; checksums are for that.
"""

import gzip
import json
import math
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path

TAIL_BYTES = 64
HDF5_MARK = b"\x89HDF\r\n\x1a\n"
HDF5_END = {0: 40, 1: 44, 2: 28, 3: 28}
"""Superblock version to where the address of the file's end stands, 64-bit addresses
(HDF5 file format specification, version 3.0, II.A)."""


def what_is_missing(path: Path, *, may_be_empty: bool = False) -> str | None:
    """Return why a file is not complete, or None if it is."""
    if not path.exists():
        return "its writer left no file"
    if path.is_dir():
        return None
    if path.stat().st_size == 0:
        return None if may_be_empty else "its writer left an empty file"
    name = path.name.lower()
    check = next((c for end, c in CHECKS.items() if name.endswith(end)), None)
    try:
        whole = check is None or check(path)
    except (OSError, EOFError, ValueError, zlib.error, struct.error, KeyError):
        whole = False
    return None if whole else "its writer left an incomplete file"


def _ends_with(*marks: bytes) -> Callable[[Path], bool]:
    def check(path: Path) -> bool:
        with path.open("rb") as file:
            file.seek(max(0, path.stat().st_size - TAIL_BYTES))
            return file.read().rstrip().endswith(marks)

    return check


def _is_gzip(path: Path) -> bool:
    with gzip.open(path) as file:
        while file.read(1 << 20):
            pass
    return True


def _is_nifti(path: Path) -> bool:
    """Whether all voxels are there; NIfTI-1 as nibabel writes it, 348 bytes."""
    head = _head(path)
    order = "<" if struct.unpack("<i", head[:4])[0] == 348 else ">"
    dim = struct.unpack(order + "8h", head[40:56])
    bits = struct.unpack(order + "h", head[72:74])[0]
    offset = struct.unpack(order + "f", head[108:112])[0]
    n_voxels = math.prod(dim[1 : 1 + dim[0]])
    n_bytes: int = path.stat().st_size
    return bool(n_bytes >= int(offset) + n_voxels * int(bits) // 8)


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(348)


def _is_hdf5(path: Path) -> bool:
    head = _head(path)
    at = HDF5_END[head[8]]
    (end,) = struct.unpack("<Q", head[at : at + 8])
    return head.startswith(HDF5_MARK) and bool(path.stat().st_size >= end)


def _is_safetensors(path: Path) -> bool:
    with path.open("rb") as file:
        (length,) = struct.unpack("<Q", file.read(8))
        header = json.loads(file.read(length))
    header.pop("__metadata__", None)
    ends = [tensor["data_offsets"][1] for tensor in header.values()]
    return path.stat().st_size == 8 + int(length) + int(max(ends, default=0))


_IS_XML = _ends_with(b"</VTKFile>")
CHECKS: Mapping[str, Callable[[Path], bool]] = {
    ".vtu": _IS_XML,
    ".vtp": _IS_XML,
    ".gz": _is_gzip,
    ".mgz": _is_gzip,
    ".nii": _is_nifti,
    ".h5": _is_hdf5,
    ".npz": zipfile.is_zipfile,
    ".pt": zipfile.is_zipfile,
    ".ckpt": zipfile.is_zipfile,
    ".safetensors": _is_safetensors,
    ".png": _ends_with(b"IEND\xaeB`\x82"),
    ".html": _ends_with(b"</html>"),
    ".feb": _ends_with(b"</febio_spec>"),
    ".json": _ends_with(b"}", b"]"),
}
"""How a name ends to whether the file is complete; others only must not be empty."""
