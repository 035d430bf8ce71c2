"""The steps that begin or end in images: one function behind each command."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.label_tables import LabelTable, label_table
from physgnn.geometry.segmentation import extract_surfaces
from physgnn.geometry.segmentation_regions import with_ventricles
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging import (
    before_after,
    folding,
    forward_field,
    inverse_field,
    jacobian_image,
    round_trip_mm,
    warp,
)
from physgnn.io import read_mesh, write_prediction
from physgnn.io.atomic import whole_file
from physgnn.io.displacement_files import write_field
from physgnn.io.markups import read_point_pairs
from physgnn.io.nifti import read_image, read_segmentation, write_image
from physgnn.io.prediction_file import read_displacement
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.materials.tissues import TISSUES
from physgnn.stages import mesh_surfaces

if TYPE_CHECKING:  # its package imports torch, which takes seconds
    from physgnn.prediction.registration import Registration

Log = Callable[[str], None]

DEFAULT_MATERIALS: Mapping[int, Material] = {
    region: TISSUES[name].material
    for region, name in enumerate(("brain", "tumour", "ventricle"))
}


def mesh_segmentation(
    path: str | Path,
    labels: str = "mask",
    *,
    brain_mask: str | Path | None = None,
    target_points: int = 10_000,
    log: Log = lambda _: None,
    **options: Any,
) -> TetMesh:
    """Mesh a label map in the world coordinates of its image.

    Parameters
    ----------
    path : path
        NIfTI label map.
    labels : str
        A name in `physgnn.geometry.label_tables.LABEL_TABLES`, or such as
        ``"brain=1,tumour=4"``.
    brain_mask : path, optional
        NIfTI image, not 0 in the brain, for label maps of tumours alone (BraTS; its
        skull-stripped T1 will do): fills what has no label.
    target_points : int
        About how many points the mesh shall have.
    log : callable
        Told what was mended, and how volumes and surfaces compare.
    **options
        ``smoothing_mm`` and ``closing_mm`` of `extract_surfaces`; ``rules`` and
        ``quality_floor`` of `physgnn.stages.mesh_surfaces`.

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


def warp_image(
    image: str | Path,
    prediction: str | Path,
    out: str | Path,
    *,
    labels: bool = False,
    interpolation: str | None = None,
    fields: Sequence[str | Path] = (),
    jacobian: str | Path | None = None,
    slices: str | Path | None = None,
    log: Log = lambda _: None,
) -> Image:
    """Deform an image as a prediction says, and write what goes with it.

    Parameters
    ----------
    image : path
        NIfTI of the rest state.
    prediction : path
        VTU with the point array ``displacement_mm``.
    out : path
        NIfTI of the deformed state, on the same voxels.
    labels : bool
        The image is a label map.
    interpolation : str, optional
        See `physgnn.imaging.warp`.
    fields : sequence of path
        Where the resampling transform goes: ``.h5`` and ``.nii.gz`` for ITK.
    jacobian : path, optional
        Where the map of det F goes, on the voxels of the rest state.
    slices : path, optional
        PNG of slices before, after and as a checkerboard.
    log : callable
        Told the round trip's error and what folds.

    Raises
    ------
    InputError
        If a file cannot be used, or image and mesh do not meet.
    """
    mesh, u = read_displacement(prediction)
    before = read_segmentation(image) if labels else read_image(image)
    inverse = inverse_field(mesh, u, before.grid)
    after = warp(before, inverse, interpolation=interpolation)
    write_image(out, after)
    error = round_trip_mm(forward_field(mesh, u, before.grid), inverse)
    if len(error):
        log(
            f"round trip inside the brain: {error.mean():.4f} mm on average, "
            f"{error.max():.3f} mm at most"
        )
    log(str(folding(mesh, u, inverse)))
    for path in fields:
        write_field(path, inverse)
    if jacobian is not None:
        write_image(jacobian, jacobian_image(mesh, u, before.grid))
    if slices is not None:
        most = int(np.linalg.norm(u, axis=1).argmax())
        centre = (mesh.points[most] + mesh.points.mean(axis=0)) / 2
        _save_figure(slices, before_after(before, after, centre))
    return after


def register(
    mesh: str | Path,
    points: str | Path,
    out: str | Path,
    *,
    target: str | Path | None = None,
    noise_mm: float = 1.0,
    materials: Mapping[int, Material] | None = None,
    fixed: str = "fixed",
) -> "Registration":
    """Find the displacement of a whole brain from measured points of its surface.

    Parameters
    ----------
    mesh : path
        VTU with the point set that the skull holds.
    points, target : path
        See `physgnn.io.markups.read_point_pairs`.
    out : path
        VTU; `physgnn warp` takes it.
    noise_mm : float
        Standard deviation of each coordinate of a measured displacement.
    materials : mapping of region to Material, optional
        By default the tissues of the published work; displacements depend on ratios of
        stiffness only.
    fixed : str
        Name of the point set.

    Raises
    ------
    InputError
        If a file cannot be used, or points are far from the surface.
    """
    from physgnn.prediction.registration import Registrar

    body = read_mesh(mesh)
    pairs = read_point_pairs(points, target)
    found = Registrar(body, materials or DEFAULT_MATERIALS, fixed)(
        pairs, noise_mm=noise_mm
    )
    fields = {
        "displacement_mm": found.prediction.displacement,
        "deviation_mm": found.deviation_mm,
        "force_n": found.forces,
    }
    write_prediction(out, body, fields)
    return found


def _save_figure(path: str | Path, figure: Figure) -> None:
    if Path(path).suffix != ".png":
        raise InputError(f"{path}: slices are written as .png")
    with whole_file(Path(path)) as part:
        figure.savefig(part, dpi=120)


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
