"""A folder of DICOM slices: one series, evenly spaced, upright.

ITK sorts and reads what it is given, and passes over slices that are missing or tilted.
So the place of every slice is looked at before.
"""

from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.io.medical.images.itk import read_slices, series_of
from physgnn.io.medical.images.voxels import ReadOptions, Voxels

# Positions are decimals of at most 16 characters; scanners round to 1e-3 mm or worse.
UNEVEN, TILT_MM, TURN = 0.02, 0.05, 1e-4
HEAD_BYTES = 1 << 16  # of a file, within which its series is named
SHOWN = 5  # names of files in a message
SHOWN_UID = "a path FOLDER/UID, or where a command has it by --series UID (series=…)"

Series = dict[str, Any]


def read_dicom(path: Path, options: ReadOptions) -> Voxels:
    """Read a series of DICOM.

    Parameters
    ----------
    path : path
        The folder, one of its files, or ``folder/UID``.
    options : ReadOptions
        ``series`` names the UID.

    Raises
    ------
    InputError
        If there is no series, or more than one and none is named, or its slices are
        missing, unreadable, tilted, doubled or no images of grey values.
    """
    folder = path if path.is_dir() else path.parent
    found = series_of(folder)
    if not found:
        within = any(child.is_dir() for child in folder.iterdir())
        more = "; its sub-folders may: name one" if within else ""
        raise InputError(f"expected a folder of DICOM files (it holds none{more})")
    series = _chosen(path, found, options.series)
    slices = series["slices"]
    _check_all_read(folder, found, slices, options)
    _check_kind(slices)
    if len(slices) > 1 or int(slices[0]["frames"] or 1) == 1:
        slices = _in_order(slices)
    options.log(f"{path}: DICOM series {_described(series)}")
    for line in _doubts(slices):
        options.log(f"warning: {path}: {line}: check that none is missing at an end")
    return read_slices(folder, [str(one["name"]) for one in slices], options)


def has_mark(path: Path) -> bool:
    """Whether a file has DICOM's mark behind its preamble of 128 bytes."""
    with path.open("rb") as file:
        return file.read(132)[128:] == b"DICM"


def _doubts(slices: list[dict[str, str]]) -> list[str]:
    """Return what the scanner's numbers say against a series being whole."""
    n, n_all = len(slices), slices[0]["of"]
    lines = []
    if n_all.isdecimal() and int(n_all) > n:
        lines.append(f"{n} slices, where the scanner made {n_all}")
    numbers = [int(one["number"]) for one in slices if one["number"].isdecimal()]
    if len(set(numbers)) == n > 1:
        first, last = min(numbers), max(numbers)
        if first > 1 or last - first >= n:
            lines.append(f"{n} slices, which the scanner numbered {first} to {last}")
    return lines


def _check_all_read(
    folder: Path,
    found: list[Series],
    slices: list[dict[str, str]],
    options: ReadOptions,
) -> None:
    """Refuse a file of the series that ITK passed over; log what else it did."""
    known = {one["name"] for series in found for one in series["slices"]}
    suffixes = {Path(one["name"]).suffix.lower() for one in slices} - {""}
    uid = slices[0]["series"].encode()
    damaged: list[str] = []
    others: list[str] = []
    for path in sorted(folder.iterdir()):
        if path.name in known or path.name.startswith(".") or not path.is_file():
            continue
        with path.open("rb") as file:
            of_series = bool(uid) and uid in file.read(HEAD_BYTES)
        mine = of_series or path.suffix.lower() in suffixes
        (damaged if mine else others).append(path.name)
    if damaged:
        raise InputError(
            f"every slice must be readable ({_shortened(damaged)} cannot be read: cut "
            "off, damaged or no image): copy the whole series, and nothing else"
        )
    if others:
        options.log(f"{folder}: left out, no DICOM images: {_shortened(others)}")


def _shortened(names: list[str]) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more


def _chosen(path: Path, found: list[Series], uid: str | None) -> Series:
    """Return the series that is meant."""
    if uid is None and path.is_file():
        mine = [s for s in found if any(x["name"] == path.name for x in s["slices"])]
        if not mine:
            raise InputError("expected a DICOM file (it has no image)")
        return mine[0]
    if uid is None and not path.exists():
        uid = path.name
    if uid is not None:
        named = [s for s in found if uid in (s["uid"], s["slices"][0]["series"])]
        if len(named) == 1:
            return named[0]
        raise InputError(f"there is no series '{uid}' (it holds {_listed(found)})")
    if len(found) > 1:
        raise InputError(
            f"a folder of DICOM must hold one series (it holds {len(found)}: "
            f"{_listed(found)}): pick one by {SHOWN_UID}"
        )
    return found[0]


def _listed(found: list[Series]) -> str:
    return "; ".join(map(_described, found))


def _described(series: Series) -> str:
    described = series["slices"][0]["description"] or "no description"
    n = len(series["slices"])
    return f"{series['uid']} ({n} slice{'' if n == 1 else 's'}, '{described}')"


def _check_kind(slices: list[dict[str, str]]) -> None:
    if any(one["modality"] in ("SEG", "RTSTRUCT") for one in slices):
        raise InputError(
            "this is a segmentation of DICOM: open it in 3D Slicer and save it as "
            ".seg.nrrd"
        )
    if any(one["colours"] not in ("", "1") for one in slices):
        raise InputError(
            "an image must hold one real number a voxel (this is a colour image): "
            "give the series of grey values"
        )


def _in_order(slices: list[dict[str, str]]) -> list[dict[str, str]]:
    """Return slices along their normal, once their places fit an upright grid."""
    if len(slices) < 2:
        raise InputError("a series needs two slices or more (this has 1)")
    turns = np.array([_numbers(one, "orientation", 6) for one in slices])
    places = np.array([_numbers(one, "position", 3) for one in slices])
    steps = np.array([_numbers(one, "pixel spacing", 2) for one in slices])
    if np.abs(steps - steps[0]).max() > TURN:
        i = int(np.abs(steps - steps[0]).max(axis=1).argmax())
        raise InputError(
            f"all slices must have one size of pixels ({slices[i]['name']} has "
            f"{steps[i, 0]:g} by {steps[i, 1]:g} mm, {slices[0]['name']} "
            f"{steps[0, 0]:g} by {steps[0, 1]:g} mm): give the slices of one volume"
        )
    if np.abs(turns - turns[0]).max() > TURN:
        raise InputError(
            "all slices must have one orientation (these have several, as a localiser "
            "has): give another series"
        )
    normal = np.cross(turns[0, :3], turns[0, 3:])
    order = np.argsort(places @ normal)
    _check_places(places[order], normal, [slices[i]["name"] for i in order])
    return [slices[i] for i in order]


def _check_places(places: FloatArray, normal: FloatArray, names: list[str]) -> None:
    steps = np.diff(places @ normal)
    step = float(np.median(steps))
    if (steps < UNEVEN * max(step, UNEVEN)).any():
        i = int(steps.argmin())
        raise InputError(
            f"each slice must have a place of its own ({names[i]} and {names[i + 1]} "
            "have the same, as in a series over time or of several echoes): give the "
            "slices of one volume"
        )
    uneven = np.abs(steps - step) > UNEVEN * step
    if uneven.any():
        i = int(np.abs(steps - step).argmax())
        missing = round(float(steps[i]) / step) - 1
        looks = f", so {missing} may be missing" if missing > 0 else ""
        raise InputError(
            f"slices must be evenly spaced (between {names[i]} and {names[i + 1]} are "
            f"{steps[i]:.2f} mm, elsewhere {step:.2f} mm{looks}): copy the whole series"
        )
    across = np.diff(places, axis=0)
    aside = np.linalg.norm(across - steps[:, None] * normal, axis=1)
    if aside.max() > TILT_MM * max(step, 1.0):
        angle = float(np.degrees(np.arctan2(aside.max(), step)))
        raise InputError(
            f"slices must lie behind each other (each is shifted by {aside.max():.2f} "
            f"mm: the gantry was tilted by {angle:.0f}°): resample the series first, "
            "such as with dcm2niix"
        )


def _numbers(one: dict[str, str], tag: str, n: int) -> list[float]:
    numbers = [float(word) for word in one[tag].split("\\") if word.strip()]
    if len(numbers) != n or not np.isfinite(numbers).all():
        raise InputError(
            f"{one['name']} must say its {tag} (it has none, as a picture or "
            "report): give the slices alone"
        )
    return numbers
