"""MNI tag files: points in one volume, or pairs of points in two.

Source of the format: MNI tag point file, as of the libraries of the Montreal
Neurological Institute (Display, Register, RESECT). World axes are RAS+, mm.
"""

import re
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.io.medical.pairing import MarkedPoint
from physgnn.io.untrusted.text import read_text

HEAD = "MNI Tag Point File"
COMMENT = re.compile(r"^\s*[%#].*$", re.MULTILINE)
VOLUMES = re.compile(r"Volumes\s*=\s*(\d+)\s*;")
POINTS = re.compile(r"Points\s*=([^;]*);")
LABEL = re.compile(r'"([^"]*)"')
MORE = 3  # numbers after the coordinates: weight, structure, patient


def read_tag(path: Path) -> list[list[MarkedPoint]]:
    """Return a list of points for each volume of a tag file.

    Raises
    ------
    InputError
        If it is no tag file, is cut off, or a row has not the numbers it should.
    """
    text = read_text(path, names_in_latin1=True)
    if not text.lstrip().startswith(HEAD):
        raise InputError(f"expected an {HEAD} (it does not say so in its first line)")
    text = COMMENT.sub("", text)
    volumes, points = VOLUMES.search(text), POINTS.search(text)
    if volumes is None or volumes[1] not in ("1", "2"):
        raise InputError("it must say 'Volumes = 1;' or 'Volumes = 2;'")
    if points is None:
        raise InputError("its points must end in ';' (the file is cut off)")
    n = int(volumes[1])
    lists: list[list[MarkedPoint]] = [[] for _ in range(n)]
    for i, line in enumerate(filter(None, map(str.strip, points[1].splitlines()))):
        label = LABEL.search(line)
        numbers = np.array(LABEL.sub("", line).split()).astype(np.float64)
        if len(numbers) not in (3 * n, 3 * n + MORE):
            raise InputError(
                f"point {i + 1} must be {3 * n} coordinates, for {n} volumes (got "
                f"{len(numbers)} numbers)"
            )
        name = label[1].strip() if label else ""
        for one, position in zip(lists, numbers[: 3 * n].reshape(n, 3), strict=True):
            one.append(MarkedPoint(name, position))
    return lists
