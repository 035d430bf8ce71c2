"""Meshes of label maps: how well volumes and surfaces follow the labels, and seconds.

    python benchmarks/segmentation.py --target-points 5000 10000 100000

Label maps of the bundled MNI152 template (its brain mask at 1 mm, cut to the tissue
maps, with a tumour and two ventricles painted in), the same resampled to thick slices
of an oblique scan, and an ellipsoid of known volume in LPS. The volume is that of the
mesh's cells; the distance is the mean of both ways between surface and labels, printed
by `physgnn mesh` as well.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import SimpleITK as sitk
from nilearn.datasets import load_mni152_brain_mask
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.imaging.transforms import from_itk, to_itk
from physgnn.io.medical.images.formats import write_image
from physgnn.stages.patient.preoperative.segmentation import mesh_segmentation

LABELS = "brain=1,tumour=4,ventricle=6"
TUMOUR, TUMOUR_MM = (33.0, 5.0, 48.0), 11.0
VENTRICLES, VENTRICLE_MM = ((-12.0, -10.0, 18.0), (12.0, -10.0, 18.0)), (6.0, 24.0, 8.0)


def paint(data: FloatArray, grid: ImageGrid) -> LabelVolume:
    """Put a tumour and two ventricles into a brain of label 1."""
    index = np.stack(np.indices(data.shape), -1).reshape(-1, 3)
    x = grid.to_world(index).reshape(*data.shape, 3)
    labels = data.astype(np.int32)
    for centre in VENTRICLES:
        labels[(((x - centre) / VENTRICLE_MM) ** 2).sum(-1) <= 1] = 6
    labels[(np.linalg.norm(x - TUMOUR, axis=-1) <= TUMOUR_MM) & (labels > 0)] = 4
    return LabelVolume(labels, grid.affine)


def mni152() -> LabelVolume:
    """Return the template at 1 mm."""
    image = load_mni152_brain_mask(resolution=1)
    mask = np.asarray(image.dataobj) > 0
    return paint(mask, ImageGrid(mask.shape, image.affine))


def thick_slices() -> LabelVolume:
    """Return the same as an oblique scan of 1 by 1 by 4 mm, LPS, would have it."""
    whole = mni152()
    turn = Rotation.from_euler("zyx", [12, -8, 15], degrees=True).as_matrix()
    shape, size = (220, 260, 60), np.array([1.0, 1.0, 4.0])
    affine = np.eye(4)
    affine[:3, :3] = turn @ np.diag([-1.0, -1.0, 1.0]) @ np.diag(size)
    middle = whole.grid.to_world(np.argwhere(whole.data > 0)).mean(axis=0)
    affine[:3, 3] = middle - affine[:3, :3] @ (np.array(shape) - 1) / 2
    wanted = to_itk(LabelVolume(np.ones(shape, dtype=np.int32), affine))
    moved = sitk.Resample(
        to_itk(whole), wanted, sitk.Transform(), sitk.sitkNearestNeighbor
    )
    return LabelVolume(from_itk(moved).data, affine)  # type: ignore[arg-type]


def ellipsoid() -> LabelVolume:
    """Return a brain of 1.6 litres whose shape is known, LPS, 1.5 mm."""
    affine = np.diag([-1.5, -1.5, 1.5, 1.0])
    affine[:3, 3] = 95.0, 95.0, -85.0
    grid = ImageGrid((128, 128, 128), affine)
    index = np.stack(np.indices(grid.shape), -1).reshape(-1, 3)
    x = (grid.to_world(index) - [0.0, 0.0, 10.0]).reshape(*grid.shape, 3)
    return paint((((x / [68.0, 85.0, 66.0]) ** 2).sum(-1) <= 1) * 1.0, grid)


CASES: dict[str, Callable[[], LabelVolume]] = {
    "MNI152, 1 mm": mni152,
    "MNI152, oblique, 1 by 1 by 4 mm": thick_slices,
    "ellipsoid, LPS, 1.5 mm": ellipsoid,
}
REGIONS = {"brain": (0, 1), "tumour": (1, 4), "ventricles": (2, 6)}


def measure(labels: LabelVolume, target: int) -> Iterator[str]:
    """Mesh one label map and yield a row for its size and one for every tissue."""
    said: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "labels.nii"
        write_image(path, labels)
        start = time.perf_counter()
        mesh = mesh_segmentation(path, LABELS, target_points=target, log=said.append)
        seconds = time.perf_counter() - start
    yield f"{mesh.n_points} points, {mesh.n_cells} cells, {seconds:.1f} s"
    for name, (region, label) in REGIONS.items():
        volume = mesh.cell_volumes[mesh.region == region].sum()
        wanted = (labels.data == label).sum() * labels.grid.voxel_volume_mm3
        yield f"{name:<12}{volume / 1000:9.2f} ml  {volume / wanted - 1:+.2%} of labels"
    yield from (line for line in said if "apart on average" in line)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    sizes = [5000, 10_000, 100_000]
    parser.add_argument("--target-points", type=int, nargs="+", default=sizes)
    parser.add_argument("--case", choices=CASES, nargs="+", default=list(CASES))
    arguments = parser.parse_args()
    for name in arguments.case:
        labels = CASES[name]()
        for target in arguments.target_points:
            print(f"\n{name}, {target} points wanted", flush=True)
            for line in measure(labels, target):
                print("   ", line, flush=True)


if __name__ == "__main__":
    main()
