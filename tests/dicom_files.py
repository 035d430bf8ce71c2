"""Small DICOM series, written by ITK."""

import locale
from pathlib import Path

import numpy as np
import SimpleITK as sitk

from physgnn.geometry.image import Image
from physgnn.imaging.transforms import to_itk

SHAPE = (5, 6, 7)


def write_series(
    folder: Path,
    image: Image,
    *,
    uid: str = "1.2.826.0.1.3680043.2.1125.1",
    description: str = "T1 MPRAGE",
    prefix: str = "IM",
    shift: np.ndarray | None = None,
) -> list[Path]:
    """Write an image a slice a file; `shift` moves each slice along LPS axes, mm."""
    folder.mkdir(exist_ok=True)
    whole = to_itk(Image(np.asarray(image.data, np.int16), image.affine))
    direction = np.reshape(whole.GetDirection(), (3, 3))
    turn = "\\".join(f"{n:.8f}" for n in (*direction[:, 0], *direction[:, 1]))
    # ITK's writer of DICOM leaves the process in the locale "C"; ours reads DICOM in a
    # process of its own.
    before = locale.setlocale(locale.LC_ALL)
    writer = sitk.ImageFileWriter()
    writer.KeepOriginalImageUIDOn()
    made = []
    for k in range(whole.GetDepth()):
        part = whole[:, :, k]
        place = np.array(whole.TransformIndexToPhysicalPoint((0, 0, k)))
        place += 0.0 if shift is None else k * np.asarray(shift)
        tags = {
            "0008|0060": "MR",
            "0008|103e": description,
            "0020|000d": "1.2.826.0.1.3680043.2.1125.99",
            "0020|000e": uid,
            "0008|0018": f"{uid}.{k + 1}",
            "0020|0013": str(k + 1),
            "0020|0032": "\\".join(f"{n:.6f}" for n in place),
            "0020|0037": turn,
        }
        for tag, value in tags.items():
            part.SetMetaData(tag, value)
        made.append(folder / f"{prefix}{k:03d}.dcm")
        writer.SetFileName(str(made[-1]))
        writer.Execute(part)
    locale.setlocale(locale.LC_ALL, before)
    return made
