"""Packed files, whole or not at all.

They are packed in memory, not through an open gzip file: one that a full disk stops
complains once more, on its own, when it is collected (Python 3.12 and later).
"""

import gzip
from pathlib import Path

from physgnn.io.integrity.atomic import whole_file

PACKED_SUFFIXES = (".gz", ".mgz")
FASTEST = 1  # as nibabel packs: images of floats hardly get smaller with more


def write_packed(path: Path, data: bytes) -> None:
    """Write bytes, as a gzip file if the name says so; the same bytes every time.

    Raises
    ------
    InputError
        If the folder does not exist, or the file cannot be written whole.
    """
    if path.name.lower().endswith(PACKED_SUFFIXES):
        data = gzip.compress(data, compresslevel=FASTEST, mtime=0)
    with whole_file(path) as part:
        part.write_bytes(data)
