"""Slices of a preoperative image, to be laid on sections of the mesh."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.io.medical.images.formats import read_voxels
from physgnn.io.medical.images.voxels import ReadOptions
from physgnn.progress import Log, no_log
from physgnn.serving.scene.section import AXES

Bytes = NDArray[np.uint8]

BUNDLED = "mni152"
PIXEL_MM = 1.0
WINDOW = (1.0, 99.5)  # percentiles of the non-zero voxels shown as black and white


@dataclass(frozen=True, eq=False)
class GreyVolume:
    """A volume in world coordinates.

    Attributes
    ----------
    values : (i, j, k) uint8 array
        Grey values.
    to_voxel : (4, 4) array
        From world RAS mm to voxel indices.
    """

    values: Bytes
    to_voxel: FloatArray

    def slice(
        self, axis: str, offset_mm: float, low: FloatArray, high: FloatArray
    ) -> Bytes:
        """Return grey values on a plane, (rows, columns) along the other two axes.

        Rows and columns run with the higher and the lower of these axes, from `low` to
        `high` (3,), ends included.
        """
        across, up = (a for a in range(3) if a != AXES[axis])
        columns, rows = (
            np.linspace(low[a], high[a], int((high[a] - low[a]) / PIXEL_MM) + 1)
            for a in (across, up)
        )
        world = np.empty((4, len(rows), len(columns)))
        world[AXES[axis]], world[3] = offset_mm, 1.0
        world[across], world[up] = columns[None, :], rows[:, None]
        voxels = np.tensordot(self.to_voxel[:3], world, axes=1)
        grey: Bytes = map_coordinates(self.values, voxels, order=1)
        return grey


def read_grey(
    path: str | Path, *, affine: str | None = None, log: Log = no_log
) -> GreyVolume:
    """Read an image of any format, or the bundled template for the name "mni152".

    Parameters
    ----------
    path, affine, log
        As of `physgnn.io.medical.images.formats.read_image`.

    Raises
    ------
    InputError
        If it cannot be read or is not three-dimensional.
    """
    if str(path) == BUNDLED:
        from nilearn.datasets import load_mni152_template  # takes seconds to import

        bundled = load_mni152_template(resolution=1)
        values, place = np.asarray(bundled.dataobj), bundled.affine
    else:
        voxels = read_voxels(Path(path), ReadOptions(affine=affine, log=log))
        if voxels.data.ndim != 3:
            raise InputError(
                f"{path}: this is a segmentation in layers: give the image"
            )
        values, place = voxels.data, voxels.affine
    return GreyVolume(_windowed(values.astype(np.float32)), np.linalg.inv(place))


def _windowed(values: NDArray[np.float32]) -> Bytes:
    inside = values[values != 0]
    low, high = np.percentile(inside, WINDOW) if inside.size else (0.0, 1.0)
    scaled = np.clip((values - low) / max(high - low, 1e-12), 0.0, 1.0)
    grey: Bytes = (255 * scaled).astype(np.uint8)
    return grey
