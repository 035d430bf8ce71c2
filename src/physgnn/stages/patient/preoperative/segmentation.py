"""From a label map to a mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.plausibility import check_volume_ml
from physgnn.geometry.regions import REGIONS
from physgnn.geometry.segmentation.extract import extract_surfaces
from physgnn.geometry.segmentation.label_report import (
    check_all_used,
    check_is_segmentation,
    label_lines,
    label_volumes,
    not_there,
)
from physgnn.geometry.segmentation.labels.label_tables import (
    LABEL_TABLES,
    MASKED,
    LabelTable,
    label_table,
    resolved,
)
from physgnn.geometry.segmentation.labels.tissue_names import DEFAULT, tissues_by_name
from physgnn.geometry.segmentation.membranes import membrane_sets
from physgnn.geometry.segmentation.ventricles import with_ventricles
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging import deformed_labels
from physgnn.io.medical.images.formats import read_image, read_segmentation
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log
from physgnn.stages.patient.preoperative.surface_meshing import mesh_surfaces
from physgnn.stages.patient.preoperative.t1_ventricles import with_t1_ventricles


@dataclass(frozen=True)
class LabelOptions:
    """How a label map is read.

    Parameters
    ----------
    brain_mask, ventricles : path, optional
        See `mesh_segmentation`.
    affine : str, optional
        "sform" or "qform", where the two disagree.
    series : str, optional
        The UID of a DICOM series.
    ignore_labels, any_size : bool
        Whether labels may be left out, and the brain be of any size.
    """

    brain_mask: str | Path | None = None
    ventricles: str | Path | None = None
    affine: str | None = None
    series: str | None = None
    ignore_labels: bool = False
    any_size: bool = False


def mesh_segmentation(
    path: str | Path,
    labels: str = "mask",
    *,
    target_points: int = 10_000,
    log: Log = no_log,
    **options: Any,
) -> TetMesh:
    """Mesh a label map in the world coordinates of its image.

    Parameters
    ----------
    path : path
        Label map of any format in `physgnn.io.medical.images.formats`.
    labels : str
        A name in `physgnn.geometry.segmentation.labels.label_tables.LABEL_TABLES`, or
        such as ``"brain=1,tumour=4"``. Of a segmentation of 3D Slicer, "mask" goes by
        the names of its segments, and the list may have these names instead of numbers.
    target_points : int
        About how many points the mesh shall have.
    log : callable
        Called with what each label was taken for, what was repaired, and how volumes
        and surfaces compare.
    **options
        ``brain_mask``: image, not 0 in the brain, which fills what has no label;
        label maps of tumours alone need it (BraTS; the skull-stripped T1 will do).
        ``ventricles``: T1 on the same voxels, in which ventricles are looked for where
        the map, with its mask, has brain; a tumour and what surrounds it stay.
        ``affine``: "sform" or "qform", where the two disagree. ``series``: UID of a
        DICOM series. ``ignore_labels=True``:
        labels that are not named may be left out. ``any_size=True``: the brain may have
        less than 50 or more than 2500 ml. ``smoothing_mm``, ``closing_mm`` and
        ``smallest_mm3`` of `extract_surfaces`; ``rules`` and ``quality_floor`` of
        `physgnn.stages.patient.preoperative.surface_meshing.mesh_surfaces`.

    Returns
    -------
    TetMesh
        Region 0 brain, 1 tumour, 2 ventricle.

    Raises
    ------
    InputError
        If the file, the labels or an option cannot be used, more than 2 % of the
        labelled volume has labels that are not named, or the brain has no brain's size.
    """
    read = LabelOptions(**_taken(options, LabelOptions.__dataclass_fields__))
    with reading(path, "a label map"):
        volume, table = _label_map(path, labels, read, log)
    smoothing = _taken(options, ("smoothing_mm", "closing_mm", "smallest_mm3"))
    found = extract_surfaces(volume, table, target_points=target_points, **smoothing)
    for line in (*found.notes, *(f"{name}: {fit}" for name, fit in found.fits.items())):
        log(line)
    mesh = mesh_surfaces(
        found.brain,
        [*found.tumours, *found.ventricles],
        names=[name for name in found.fits if name != "brain"],
        target_points=target_points,
        log=log,
        **options,
    )
    mesh = with_ventricles(mesh, found.ventricles)
    sheets = membrane_sets(mesh, volume, table)
    for name, points in sheets.items():
        log(f"point set '{name}': {len(points)} points")
    mesh = mesh.with_point_sets(**{**sheets, **mesh.point_sets})
    at_rest = deformed_labels(mesh, np.zeros_like(mesh.points), volume.grid)
    whole = found.fits["brain"].dice
    for line in label_lines(volume, table, at_rest.data - 1, REGIONS, whole=whole):
        log(line)
    return mesh


def _taken(options: dict[str, Any], names: Any) -> dict[str, Any]:
    """Take the options of these names out of others."""
    return {name: options.pop(name) for name in names if name in options}


def _label_map(
    path: str | Path, labels: str, read: LabelOptions, log: Log
) -> tuple[LabelVolume, LabelTable]:
    """Return a label map and what its labels mean, once all of it is accounted for."""
    volume = read_segmentation(path, affine=read.affine, series=read.series, log=log)
    check_is_segmentation(volume)
    own = label_volumes(volume)  # a mask would drown what it leaves out
    name, lines = resolved(labels, own)
    table = label_table(name) if not volume.names else _named(labels, name, volume)
    if read.brain_mask is not None:
        volume = _with_brain(volume, table, read, log)
    elif table.needs_mask and not (volume.data == MASKED).any():
        raise InputError(
            f"label maps of the convention {name} mark the tumour alone, so they need "
            "the brain too: give --brain-mask (brain_mask=…), such as the "
            "skull-stripped T1"
        )
    if read.ventricles is not None:
        volume, table = with_t1_ventricles(
            volume, table, read.ventricles, affine=read.affine, log=log
        )
    volumes = label_volumes(volume)
    if labels not in LABEL_TABLES:  # a convention has labels that a patient has not
        lines += not_there(volumes, table)
    for line in lines:
        log(line)
    unused = check_all_used(own, table, ignore_labels=read.ignore_labels)
    for line in (*unused, *_check_brain(volumes, table, read)):
        log(line)
    return volume, table


def _named(labels: str, name: str, volume: LabelVolume) -> LabelTable:
    """Return what the labels of a file mean that has names for them."""
    if labels in LABEL_TABLES and labels != DEFAULT:
        return label_table(name)
    tissues = tissues_by_name(labels, sorted(label_volumes(volume)), volume.names)
    return LabelTable(tissues, names=volume.names)


def _check_brain(
    volumes: Mapping[int, float], table: LabelTable, read: LabelOptions
) -> list[str]:
    """Check the size of the whole brain; one that is not there is refused later."""
    ml = sum(volumes[n] for ids in table.labels.values() for n in ids if n in volumes)
    if ml == 0.0:
        return []
    return check_volume_ml(1000.0 * ml, "labelled brain", any_size=read.any_size)


def _with_brain(
    labels: LabelVolume, table: LabelTable, read: LabelOptions, log: Log
) -> LabelVolume:
    """Give the first label of brain to what a mask holds and no label claims."""
    path = read.brain_mask
    assert path is not None
    mask = read_image(path, affine=read.affine, log=log)
    same = mask.data.shape == labels.data.shape
    if not same or not np.allclose(mask.affine, labels.affine, atol=1e-3):
        raise InputError(
            f"{path}: the brain mask must have the voxels of the label map, "
            f"{labels.data.shape} (got {mask.data.shape}, or another affine): "
            "resample it"
        )
    inside = mask.data != 0
    mm3 = float(inside.sum()) * mask.grid.voxel_volume_mm3
    for line in check_volume_ml(mm3, f"{path}: brain mask", any_size=read.any_size):
        log(line)
    brain = table.labels["brain"][0]
    data = np.where((labels.data == 0) & inside, brain, labels.data)
    return replace(labels, data=data)
