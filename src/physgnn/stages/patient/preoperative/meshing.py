"""From surfaces, or a label map, to a mesh with its point sets."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from physgnn.errors import InputError
from physgnn.geometry import (
    Surface,
    TetMesh,
)
from physgnn.geometry.meshing import tetgen_process
from physgnn.geometry.meshing.tetrahedra import TETGEN, TETWILD, record
from physgnn.geometry.plausibility import check_millimetres, check_volume_ml
from physgnn.geometry.segmentation.masks import SMALLEST_MM3
from physgnn.geometry.surface import volume
from physgnn.progress import Log, no_log
from physgnn.stages.outputs import Output, writes

MESHED_LABELS_POINTS = 10_000  # about how many points a label map's mesh has


@writes(out=Output((".vtu",)))
def mesh(
    out: str | Path,
    *,
    segmentation: str | Path | None = None,
    labels: str = "mask",
    brain_mask: str | Path | None = None,
    ventricles: str | Path | None = None,
    smoothing_mm: float | None = None,
    closing_mm: float | None = None,
    smallest_mm3: float = SMALLEST_MM3,
    brain: str | Path | None = None,
    tumour: Sequence[str | Path] = (),
    mni152: bool = False,
    sets: str | Path | None = None,
    max_volume_mm3: float | None = None,
    target_points: int | None = None,
    keep_surface: bool = False,
    mesher: str | None = None,
    quality_floor: float | None = None,
    ignore_labels: bool = False,
    any_size: bool = False,
    affine: str | None = None,
    series: str | None = None,
    log: Log = no_log,
) -> TetMesh:
    """Fill surfaces, or a label map, with tetrahedra and name point sets.

    A mesh of tetrahedra that another program made is taken over as it is.

    Parameters
    ----------
    out : path
        Where the mesh goes, VTU.
    segmentation : path, optional
        Label map, see `physgnn.io.medical.images.formats`, or a mesh of tetrahedra, see
        `physgnn.stages.patient.preoperative.mesh_files`; or else `brain`, or `mni152`.
    labels, brain_mask, ventricles, smoothing_mm, closing_mm, smallest_mm3
        How the label map is read: see
        `physgnn.stages.patient.preoperative.segmentation.mesh_segmentation`.
    brain : path, optional
        Surface of the brain, in mm: see `physgnn.io.surfaces.formats`.
    tumour : sequence of path
        Surfaces inside the brain.
    mni152 : bool
        Take the bundled brain and tumour.
    sets : path, optional
        TOML with ``[point_sets.<name>]`` tables.
    max_volume_mm3 : float, optional
        Largest cell; by default the published rule.
    target_points : int, optional
        About how many points the mesh shall have; surfaces that are too fine for it
        are remeshed.
    keep_surface : bool
        Keep the surfaces' points, as published.
    mesher : str, optional
        ``"tetwild"``, by default where surfaces may be moved by 0.1 mm (label maps,
        `target_points`), or ``"tetgen"``, by default where they are kept.
    quality_floor : float, optional
        Smallest mean ratio a cell may have; see `physgnn.geometry.check_quality`.
    ignore_labels : bool
        Whether labels that are not named may be left out of the mesh.
    any_size : bool
        Whether the brain may have less than 50 or more than 2500 ml.
    affine : str, optional
        "sform" or "qform": which place of a label map is meant where its header has two
        that disagree.
    series : str, optional
        The UID of the series that is meant, where a label map is a folder of DICOM.
    log : callable
        Called with what was repaired, and the mesh's size and quality.

    Returns
    -------
    TetMesh
        The mesh that was written; mm.

    Raises
    ------
    InputError
        If not exactly one body is given, or a file or an option cannot be used.
    """
    from physgnn.config import read_point_sets
    from physgnn.io import write_mesh
    from physgnn.stages.patient.preoperative.mesh_files import (
        is_mesh_file,
        mesh_of_file,
    )
    from physgnn.stages.patient.preoperative.segmentation import mesh_segmentation
    from physgnn.stages.patient.preoperative.surface_meshing import mesh_surfaces

    if ventricles is not None and (segmentation is None or is_mesh_file(segmentation)):
        raise InputError("--ventricles needs a label map, which gets them from the T1")
    if [mni152, brain is not None, segmentation is not None].count(True) != 1:
        raise InputError("give a label map, --brain, or --mni152 for the bundled case")
    kept = keep_surface or (segmentation is None and target_points is None)
    shared: dict[str, Any] = {
        "rules": {} if sets is None else read_point_sets(sets),
        "quality_floor": quality_floor,
        "log": log,
    }
    by = _mesher(mesher, kept=kept)
    made_by = [] if segmentation is not None and is_mesh_file(segmentation) else [by]
    if segmentation is not None and is_mesh_file(segmentation):
        sizes = (target_points, max_volume_mm3, brain_mask, smoothing_mm, closing_mm)
        of_images = (mesher, affine, series)
        smallest = smallest_mm3 != SMALLEST_MM3
        if smallest or any(option is not None for option in (*sizes, *of_images)):
            raise InputError(
                "a mesh keeps its cells and its place: leave out --target-points, "
                "--max-volume-mm3, --brain-mask, --smoothing-mm, --closing-mm, "
                "--smallest-mm3, --mesher, --affine and --series"
            )
        made = mesh_of_file(
            segmentation,
            labels,
            ignore_labels=ignore_labels,
            any_size=any_size,
            **shared,
        )
    elif segmentation is not None:
        made = mesh_segmentation(
            segmentation,
            labels,
            brain_mask=brain_mask,
            ventricles=ventricles,
            target_points=(
                MESHED_LABELS_POINTS if target_points is None else target_points
            ),
            smoothing_mm=smoothing_mm,
            closing_mm=closing_mm,
            smallest_mm3=smallest_mm3,
            ignore_labels=ignore_labels,
            any_size=any_size,
            affine=affine,
            series=series,
            mesher=by,
            **shared,
        )
    else:
        surface, *inner = named_surfaces(brain, tumour)
        check_millimetres(surface.points, str(brain or "brain"))
        enclosed = abs(volume(surface))
        for line in check_volume_ml(enclosed, str(brain or "brain"), any_size=any_size):
            log(line)
        size: dict[str, Any] = {
            "max_volume_mm3": max_volume_mm3,
            "target_points": target_points,
            "keep_surface": keep_surface,
        }
        made = mesh_surfaces(surface, inner, **size, mesher=by, **shared)
    write_mesh(out, made, notes={"mesher": [record(name) for name in made_by]})
    return made


def _mesher(named: str | None, *, kept: bool) -> str:
    """Return the mesher that was named, else the better of those that are there."""
    if named is not None:
        return named
    return TETGEN if kept and tetgen_process.available() else TETWILD


def named_surfaces(
    brain: str | Path | None, tumours: Sequence[str | Path]
) -> list[Surface]:
    """Read the surfaces a user names, the brain first, or take the bundled ones."""
    from physgnn.geometry import mni152_phantom
    from physgnn.io import read_surface

    if brain is not None:
        return [read_surface(path) for path in (brain, *tumours)]
    phantom = mni152_phantom()
    return [phantom.brain, *phantom.tumours]
