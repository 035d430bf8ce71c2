"""What a NIfTI header declares, held against the file before nibabel acts on it.

nibabel repairs some headers by guesses that it only logs. What matters for the place or
the values of voxels is refused here instead.
"""

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physgnn.errors import InputError
from physgnn.io.untrusted.limits import check_size

if TYPE_CHECKING:
    import nibabel as nib

# The first word of the header is its length; the mark of a header with its voxels.
KINDS = {348: ("Nifti1Image", b"n+1"), 540: ("Nifti2Image", b"n+2")}
CODES = range(6)  # of sform_code and qform_code


def parsed_nifti(path: Path, content: bytes) -> "nib.Nifti1Image":
    """Return the image that bytes hold, once what it declares fits them.

    Raises
    ------
    InputError
        If they hold no NIfTI image in one file, the header contradicts itself or
        declares more voxels than there are, or a voxel is no real number.
    """
    kind, mark = _kind(content)
    header = _header(kind, content)
    _check_header(header, mark)
    _check_size(path, header, len(content))
    with _quiet():
        image: nib.Nifti1Image = kind.from_bytes(content)
    return image


def declared_by_nifti(start: bytes) -> int:
    """Return how many bytes of voxels the first bytes of a file declare.

    Raises
    ------
    InputError
        If they are no NIfTI header.
    """
    return _declared(_header(_kind(start)[0], start))


def _kind(start: bytes) -> tuple[Any, bytes]:
    """Return nibabel's class for what begins so, and the mark of its header."""
    import nibabel as nib

    sizes = {int.from_bytes(start[:4], order) for order in ("little", "big")}
    name, mark = next((KINDS[n] for n in sizes if n in KINDS), ("", b""))
    if not name:
        raise InputError(
            "expected a NIfTI image, but it cannot be read (it has no header of one): "
            "convert it"
        )
    return getattr(nib, name), mark


def _header(kind: Any, start: bytes) -> Any:
    with _quiet():
        return kind.header_class.from_fileobj(io.BytesIO(start), check=False)


def _declared(header: Any) -> int:
    declared = int(header.get_data_dtype().itemsize)
    for n in header.get_data_shape():  # in Python's integers, which do not overflow
        declared *= int(n)
    return declared


def _check_header(header: Any, mark: bytes) -> None:
    if not header["magic"].item().startswith(mark):
        raise InputError(
            f"its header must say {mark.decode()} (got {header['magic'].item()!r}): "
            "convert it to a single NIfTI file"
        )
    for name in ("sform_code", "qform_code"):
        if int(header[name]) not in CODES:
            raise InputError(f"{name} must be 0 to 5 (got {int(header[name])})")
    if int(header["sform_code"]) == 0 and not (header["pixdim"][1:4] > 0).all():
        raise InputError(
            f"voxels must have a size in mm (got {header['pixdim'][1:4]}): export it "
            "again"
        )
    dtype = header.get_data_dtype()
    if dtype.fields is not None or dtype.kind not in "buif":
        looks = "a colour" if dtype.fields is not None else f"a {dtype}"
        raise InputError(
            f"an image must hold one real number a voxel (this is {looks} image): "
            "convert it to grey values or labels"
        )


def _check_size(path: Path, header: Any, n_bytes: int) -> None:
    declared = _declared(header)
    check_size(path, declared, "the image")
    offset = float(header["vox_offset"])
    if not 0 <= offset <= n_bytes or declared > n_bytes - int(offset):
        raise InputError(
            f"its header declares {declared} bytes of voxels from byte {offset:g} on "
            f"(it has {n_bytes}): it is cut off or damaged, so it cannot be read; "
            "export it again"
        )


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep nibabel from logging what it raises as well, or what is harmless."""
    from nibabel.imageglobals import logger

    was = logger.disabled
    logger.disabled = True
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.disabled = was
