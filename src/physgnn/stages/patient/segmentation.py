"""From a label map to a mesh."""

from pathlib import Path
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.extract import extract_surfaces
from physgnn.geometry.segmentation.label_tables import LabelTable, label_table
from physgnn.geometry.segmentation.ventricles import with_ventricles
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.medical.nifti import read_image, read_segmentation
from physgnn.progress import Log, no_log
from physgnn.stages.patient.meshing import mesh_surfaces


def mesh_segmentation(
    path: str | Path,
    labels: str = "mask",
    *,
    brain_mask: str | Path | None = None,
    target_points: int = 10_000,
    log: Log = no_log,
    **options: Any,
) -> TetMesh:
    """Mesh a label map in the world coordinates of its image.

    Parameters
    ----------
    path : path
        NIfTI label map.
    labels : str
        A name in `physgnn.geometry.segmentation.label_tables.LABEL_TABLES`, or such as
        ``"brain=1,tumour=4"``.
    brain_mask : path, optional
        NIfTI image, not 0 in the brain, for label maps of tumours alone (BraTS; its
        skull-stripped T1 will do): fills what has no label.
    target_points : int
        About how many points the mesh shall have.
    log : callable
        Called with what was repaired, and how volumes and surfaces compare.
    **options
        ``smoothing_mm`` and ``closing_mm`` of `extract_surfaces`; ``rules`` and
        ``quality_floor`` of `physgnn.stages.patient.meshing.mesh_surfaces`.

    Returns
    -------
    TetMesh
        Region 0 brain, 1 tumour, 2 ventricle.

    Raises
    ------
    InputError
        If the file, the labels or an option cannot be used.
    """
    table = label_table(labels)
    volume = read_segmentation(path)
    if brain_mask is not None:
        volume = _with_brain(volume, table, brain_mask)
    smoothing = {
        key: options.pop(key)
        for key in ("smoothing_mm", "closing_mm")
        if key in options
    }
    found = extract_surfaces(volume, table, target_points=target_points, **smoothing)
    for line in (*found.notes, *(f"{name}: {fit}" for name, fit in found.fits.items())):
        log(line)
    mesh = mesh_surfaces(
        found.brain,
        [*found.tumours, *found.ventricles],
        target_points=target_points,
        log=log,
        **options,
    )
    return with_ventricles(mesh, found.ventricles)


def _with_brain(
    labels: LabelVolume, table: LabelTable, path: str | Path
) -> LabelVolume:
    """Give the first label of brain to what a mask holds and no label claims."""
    mask = read_image(path)
    same = mask.data.shape == labels.data.shape
    if not same or not np.allclose(mask.affine, labels.affine, atol=1e-3):
        raise InputError(
            f"{path}: the brain mask must have the voxels of the label map, "
            f"{labels.data.shape} (got {mask.data.shape}, or another affine): "
            "resample it"
        )
    brain = table.labels["brain"][0]
    data = np.where((labels.data == 0) & (mask.data != 0), brain, labels.data)
    return LabelVolume(data, labels.affine)
