"""Tracts of TrackVis (.trk) and MRtrix (.tck), by nibabel.

Both hold points in millimetres of the scan, RAS+, once nibabel has read them.
"""

import io
import struct
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.io.plans.plan import Plan
from physgnn.io.untrusted.text import read_bytes

# TrackVis's header (http://trackvis.org/docs/?subsect=fileformat): bytes of the whole
# and where its fields stand.
HEADER, SIZE_FIELD = 1000, 996
N_SCALARS, N_PROPERTIES, VOX_TO_RAS, N_TRACKS = 36, 238, 440, 988


def read_trk(path: Path) -> Plan:
    """Read tracts of TrackVis, with their scalars and properties.

    Raises
    ------
    InputError
        If a size in it does not fit the file, or it does not say where it lies.
    """
    from nibabel.streamlines.trk import TrkFile

    data = read_bytes(path)
    _check_trk(data)
    return _plan(TrkFile, data)


def read_tck(path: Path) -> Plan:
    """Read tracts of MRtrix."""
    from nibabel.streamlines.tck import TckFile

    data = read_bytes(path)
    if not data.startswith(b"mrtrix tracks"):
        raise InputError("expected tracts of MRtrix (it does not say so at its start)")
    return _plan(TckFile, data)


def _plan(form: Any, data: bytes) -> Plan:
    from nibabel.streamlines.tractogram import Tractogram

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what it warns of is checked
        loaded = form.load(io.BytesIO(data))
    tracts = loaded.streamlines
    if len(tracts) == 0 or len(tracts.get_data()) == 0:
        raise InputError("holds no tract: export it again")
    points = np.concatenate([np.asarray(one, np.float64) for one in tracts])
    ends = np.cumsum([len(one) for one in tracts])[:-1]

    def rewritten(moved: FloatArray) -> bytes:
        tractogram = Tractogram(
            [part.astype(np.float32) for part in np.split(moved, ends)],
            data_per_streamline=loaded.tractogram.data_per_streamline,
            data_per_point=loaded.tractogram.data_per_point,
            affine_to_rasmm=np.eye(4),
        )
        written = io.BytesIO()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            form(tractogram, header=loaded.header).save(written)
        return written.getvalue()

    return Plan(points, rewritten, what="tract point")


def _check_trk(data: bytes) -> None:
    """Raise InputError unless every size that is declared fits the file."""
    if len(data) < HEADER or not data.startswith(b"TRACK"):
        raise InputError("expected tracts of TrackVis (its header is cut off)")
    order = next(
        (o for o in "<>" if struct.unpack_from(f"{o}i", data, SIZE_FIELD)[0] == HEADER),
        "",
    )
    if not order:
        raise InputError("expected tracts of TrackVis (its header is damaged)")
    (scalars,) = struct.unpack_from(f"{order}h", data, N_SCALARS)
    (properties,) = struct.unpack_from(f"{order}h", data, N_PROPERTIES)
    (declared,) = struct.unpack_from(f"{order}i", data, N_TRACKS)
    affine = np.frombuffer(data, f"{order}f4", 16, VOX_TO_RAS).reshape(4, 4)
    if min(scalars, properties, declared) < 0:
        raise InputError("it declares a negative number of things: it is damaged")
    if affine[3, 3] == 0 or not abs(np.linalg.det(affine[:3, :3])) > 0:
        raise InputError(
            "it does not say where in the scan it lies (vox_to_ras is empty, as in "
            "files of TrackVis 1): save it again with a reference image"
        )
    at, found = HEADER, 0
    while at < len(data) and (found < declared or declared == 0):
        n = struct.unpack_from(f"{order}i", data, at)[0] if at + 4 <= len(data) else -1
        at += 4 + 4 * (n * (3 + scalars) + properties)
        if n < 0 or at > len(data):
            raise InputError(
                f"tract {found + 1} is longer than the file: it is cut off"
            )
        found += 1
    if found < declared:
        raise InputError(f"it declares {declared} tracts and holds {found}: cut off")
    if at < len(data):
        raise InputError(f"it holds more than the {declared} tracts that it declares")
