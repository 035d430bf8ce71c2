"""ITK's readers, which may crash without harm to anybody else.

`physgnn.io.untrusted.reader_process` runs this file, which imports NumPy and SimpleITK
alone: see `physgnn.io.medical.images.itk` for the other side.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

# DICOM's tags of a slice.
TAGS = {
    "modality": "0008|0060", "description": "0008|103e", "position": "0020|0032",
    "orientation": "0020|0037", "of": "0020|1002", "colours": "0028|0002",
    "series": "0020|000e", "frames": "0028|0008", "pixel spacing": "0028|0030",
    "number": "0020|0013",
}  # fmt: skip


def serve(request: dict[str, Any]) -> dict[str, Any]:
    """Return what was asked for, text as JSON in an array of bytes."""
    what = {"list": _list, "image": _image, "series": _series}[request["what"]]
    return what(request)


def _list(request: dict[str, Any]) -> dict[str, Any]:
    """Return the series of a folder, each with the tags of its slices."""
    import SimpleITK as sitk

    reader = sitk.ImageSeriesReader()
    found = []
    for uid in reader.GetGDCMSeriesIDs(request["path"]):
        names = reader.GetGDCMSeriesFileNames(request["path"], uid)
        slices = [_tags(name) for name in names]
        found.append({"uid": uid.rstrip("\0 "), "slices": slices})
    return {"text": _text(found)}


def _tags(name: str) -> dict[str, str]:
    reader = _opened(name)
    tags = dict.fromkeys(TAGS, "") | {"name": Path(name).name}
    for key, tag in TAGS.items():
        if reader.HasMetaDataKey(tag):
            tags[key] = reader.GetMetaData(tag).strip("\0 ")
    return tags


def _image(request: dict[str, Any]) -> dict[str, Any]:
    reader = _opened(request["path"])
    _check_size([reader], request["limit"])
    return _arrays(reader.Execute())


def _series(request: dict[str, Any]) -> dict[str, Any]:
    """Return the image of slices, in the order given."""
    import SimpleITK as sitk

    folder = Path(request["path"])
    names = [str(folder / name) for name in request["names"]]
    _check_size([_opened(name) for name in names], request["limit"])
    reader = sitk.ImageSeriesReader()
    reader.SetFileNames(names)
    return _arrays(reader.Execute())


def _opened(name: str) -> Any:
    import SimpleITK as sitk

    reader = sitk.ImageFileReader()
    reader.SetFileName(name)
    reader.ReadImageInformation()
    return reader


def _check_size(readers: list[Any], limit: int) -> None:
    """Raise ValueError if the images would take more than a number of bytes."""
    declared = 0
    for reader in readers:
        n_bytes = 8 * reader.GetNumberOfComponents()
        for n in reader.GetSize():
            n_bytes *= int(n)
        declared += n_bytes
    if declared > 8 * limit:
        raise ValueError(f"its header declares {declared / 8e9:.3g} GB or more")


def _arrays(image: Any) -> dict[str, Any]:
    import SimpleITK as sitk

    n = image.GetDimension()
    return {
        "data": sitk.GetArrayFromImage(image),
        "direction": np.reshape(image.GetDirection(), (n, n)),
        "spacing": np.array(image.GetSpacing()),
        "origin": np.array(image.GetOrigin()),
        "components": np.array(image.GetNumberOfComponentsPerPixel()),
    }


def _text(value: Any) -> Any:
    return np.frombuffer(json.dumps(value).encode(), np.uint8)
