"""A displacement in the form that the next program wants; the file's name decides.

To add a form, write a function and a row in ``FORMS``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.medical.images.formats import WRITTEN, write_image
from physgnn.io.medical.images.nifti import SUFFIXES
from physgnn.io.medical.transforms import write_field
from physgnn.io.vtk.prediction_file import (
    DISPLACEMENT,
    NAVIGATION,
    REASONS,
    STATUS,
    write_deformed,
)
from physgnn.io.vtk.vtu import write_prediction

IMAGES = tuple(reversed(SUFFIXES))


@dataclass(frozen=True, eq=False)
class DisplacementFields:
    """A body, how it moves, and on which voxels that may be asked for.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    fields : mapping of str to array
        On its points; ``displacement_mm`` is among them.
    grid : ImageGrid, optional
        Of images; by default 2 mm voxels around the body.
    status : str
        What the displacement is called.
    reasons : tuple of str
        Why it is not ok, a line each.
    removed : TetMesh, optional
        Tissue that was taken out of the body, at rest.
    navigation : tuple of str
        What is known of the navigation that it was measured with, a line each.
    """

    mesh: TetMesh
    fields: Mapping[str, FloatArray]
    grid: ImageGrid | None = None
    status: str = ""
    reasons: tuple[str, ...] = ()
    removed: TetMesh | None = None
    navigation: tuple[str, ...] = ()

    @property
    def displacement(self) -> FloatArray:
        """On the mesh's points, (n_points, 3), mm."""
        return self.fields[DISPLACEMENT]

    @property
    def notes(self) -> dict[str, tuple[str, ...]]:
        """Status, reasons and navigation, as VTK files carry them."""
        status = (self.status,) if self.status else ()
        return {STATUS: status, REASONS: self.reasons, NAVIGATION: self.navigation}

    @property
    def voxels(self) -> ImageGrid:
        """The grid, or one that holds the body and the fade around it."""
        from physgnn.imaging import FADE_PER_DISPLACEMENT, grid_around

        if self.grid is not None:
            return self.grid
        largest = float(np.linalg.norm(self.displacement, axis=1).max())
        margin = max(30.0, FADE_PER_DISPLACEMENT * largest)
        return grid_around(self.mesh, margin_mm=margin)


@dataclass(frozen=True)
class FileForm:
    """One way to write a displacement.

    Attributes
    ----------
    suffixes : tuple of str
        What its files are called; the first is what messages name.
    write : callable
        Writes the fields.
    on_voxels : bool
        Whether they are written on the voxels of an image.
    by_name : bool
        Whether it is only meant where its name is said.
    """

    suffixes: tuple[str, ...]
    write: Callable[[Path, DisplacementFields], None]
    on_voxels: bool = False
    by_name: bool = False

    def check_image(self, path: str | Path, image: str | Path | None) -> None:
        """Raise InputError if an image is given whose voxels nothing is written on."""
        if image is not None and not self.on_voxels:
            raise InputError(
                f"{path}: --image is for a field or a label map, which this is not: "
                f"leave it out, or write {' or '.join(IMAGES)}"
            )


def form_of(path: str | Path, name: str | None = None) -> FileForm:
    """Return the form that a file is written in.

    Parameters
    ----------
    path : path
        Where the displacement goes.
    name : str, optional
        A row of ``FORMS``; by default the first that has the file's suffix. Labels
        are no displacement, so they are written only where they are named.

    Raises
    ------
    InputError
        If there is no such form, or it is written in other files.
    """
    if name is not None and name not in FORMS:
        raise InputError(f"form must be one of {', '.join(FORMS)} (got '{name}')")
    usual = [form for form in FORMS.values() if not form.by_name]
    for form in usual if name is None else [FORMS[name]]:
        if Path(path).name.lower().endswith(form.suffixes):
            return form
    wanted = [suffix for form in usual for suffix in form.suffixes]
    if name is not None:
        wanted = list(FORMS[name].suffixes)
    of = "a displacement" if name is None else f"form '{name}'"
    if name is None and Path(path).name.lower().endswith(FORMS["labels"].suffixes):
        wanted.append("the deformed labels, --as labels, as this too")
    raise InputError(
        f"{path}: {of} is written as {', '.join(dict.fromkeys(wanted))} "
        f"(got '{Path(path).name}')"
    )


def _write_rest(path: Path, fields: DisplacementFields) -> None:
    write_prediction(
        path, fields.mesh, fields.fields, notes=fields.notes, removed=fields.removed
    )


def _write_deformed(path: Path, fields: DisplacementFields) -> None:
    write_deformed(path, fields.mesh, fields.displacement, notes=fields.notes)


def _write_forward(path: Path, fields: DisplacementFields) -> None:
    from physgnn.imaging import forward_field

    field = forward_field(fields.mesh, fields.displacement, fields.voxels)
    write_field(path, field, convention="ras", note=fields.status)


def _write_inverse(path: Path, fields: DisplacementFields) -> None:
    from physgnn.imaging import inverse_field

    field = inverse_field(fields.mesh, fields.displacement, fields.voxels)
    write_field(path, field, note=fields.status)


def _write_labels(path: Path, fields: DisplacementFields) -> None:
    from physgnn.imaging import deformed_labels

    labels = deformed_labels(fields.mesh, fields.displacement, fields.voxels)
    write_image(path, labels, note=fields.status)


# Where two forms share a suffix, the first is what the name alone stands for.
FORMS: Mapping[str, FileForm] = {
    "rest": FileForm((".vtu",), _write_rest),
    "deformed": FileForm((".vtp", ".vtu"), _write_deformed),
    "transform": FileForm((".h5",), _write_inverse, on_voxels=True),
    "field": FileForm(IMAGES, _write_forward, on_voxels=True),
    "itk-field": FileForm(IMAGES, _write_inverse, on_voxels=True),
    "labels": FileForm(WRITTEN, _write_labels, on_voxels=True, by_name=True),
}
