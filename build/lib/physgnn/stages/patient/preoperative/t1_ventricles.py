"""Ventricles for a label map that has none, from the T1 it was drawn on."""

from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.labels.label_tables import MASKED, LabelTable
from physgnn.io.medical.images.formats import read_image
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log


def with_t1_ventricles(
    labels: LabelVolume,
    table: LabelTable,
    path: str | Path,
    *,
    affine: str | None = None,
    log: Log = no_log,
) -> tuple[LabelVolume, LabelTable]:
    """Add the ventricles that a T1 shows to a label map, under a label of their own.

    They are looked for in the brain; of a convention that labels lesions alone, such as
    BraTS, in what the mask has added, so that tumour, oedema and cavity stay.

    Parameters
    ----------
    labels : LabelVolume
        Brain, and the tumour if there is one.
    table : LabelTable
        What the labels mean.
    path : path
        The T1, on the same voxels.
    affine : str, optional
        "sform" or "qform", where the T1's two disagree.
    log : callable
        Called with how much was found.

    Returns
    -------
    LabelVolume, LabelTable
        With the ventricles, and what their label means.

    Raises
    ------
    InputError
        If the map has ventricles or no brain, the T1 has other voxels, or the
        ventricles cannot be told from the rest in it.
    """
    from physgnn.segmentation.scan_labels import brain_ventricles

    named = table.labels.get("ventricle", ())
    if not table.needs_mask and np.isin(labels.data, named).any():
        own = "+".join(map(str, named))
        raise InputError(
            f"the label map has ventricles of its own (label {own}): leave "
            "--ventricles out"
        )
    t1 = read_image(path, affine=affine, log=log)
    same = t1.data.shape == labels.data.shape
    if not same or not np.allclose(t1.affine, labels.affine, atol=1e-3):
        raise InputError(
            f"{path}: the T1 must have the voxels of the label map, "
            f"{labels.data.shape} (got {t1.data.shape}, or another affine): resample it"
        )
    healthy = (MASKED,) if table.needs_mask else table.labels["brain"]
    inside = [n for tissue in table.labels.values() for n in tissue]
    brain = labels.mask(tuple(inside))
    if not labels.mask(healthy).any():
        raise InputError("the label map has no healthy brain for ventricles to lie in")
    with reading(path, "a T1"):
        found = brain_ventricles(t1, brain, brain & ~labels.mask(healthy), log=log)
    taken = {*np.unique(labels.data).tolist(), *inside, *table.outside}
    new = next(n for n in count(1) if n not in taken)
    tissues = {**table.labels, "ventricle": (*named, new)}
    names = {**table.names, new: "ventricle, from the T1"}
    data = np.where(found, new, labels.data)
    return replace(labels, data=data), replace(table, labels=tissues, names=names)
