"""Mesh from labels: a label map of brain, tumour and ventricle becomes tetrahedra.

    python examples/03_mesh_from_labels.py [folder]

The label map here is the bundled MNI152 brain with two balls in it, on 2 mm voxels.
Writes labels.nii.gz, case.vtu and picture.png.
"""

import sys
from pathlib import Path

import nibabel as nib
import numpy as np
import pyvista as pv
from nilearn.datasets import load_mni152_brain_mask

import physgnn as pg

BALLS = {4: ((35, 10, 45), 14.0), 3: ((0, 0, 15), 12.0)}  # label: centre, radius, mm
LABELS = "brain=1,ventricle=3,tumour=4"
REGIONS = {"brain": (0, 1), "tumour": (1, 4), "ventricle": (2, 3)}  # region, label


def main(folder: Path) -> dict[str, float]:
    """Mesh, and return how far each tissue's volume is from its labels', per cent."""
    folder.mkdir(parents=True, exist_ok=True)
    image = label_map()
    nib.save(image, folder / "labels.nii.gz")
    mesh = pg.mesh(
        folder / "case.vtu",
        segmentation=folder / "labels.nii.gz",
        labels=LABELS,
        target_points=5000,
    )
    draw(mesh, folder / "picture.png")
    voxel_mm3 = abs(np.linalg.det(image.affine[:3, :3]))
    volume = cell_volumes(mesh)
    found = {"points": float(mesh.n_points)}
    for tissue, (region, label) in REGIONS.items():
        labelled = (np.asarray(image.dataobj) == label).sum() * voxel_mm3
        meshed = volume[mesh.region == region].sum()
        found[f"{tissue}_percent"] = 100 * (meshed / labelled - 1)
    return found


def label_map() -> nib.Nifti1Image:
    """Return the brain of the template, label 1, with the balls in it."""
    mask = load_mni152_brain_mask(resolution=2)
    labels = np.asarray(mask.dataobj).astype(np.uint8)
    voxels = np.stack(np.meshgrid(*map(np.arange, labels.shape), indexing="ij"), -1)
    world = nib.affines.apply_affine(mask.affine, voxels)
    for label, (centre, radius) in BALLS.items():
        labels[np.linalg.norm(world - centre, axis=-1) < radius] = label
    return nib.Nifti1Image(labels, mask.affine)


def cell_volumes(mesh: pg.TetMesh) -> np.ndarray:
    """Return the volume of every tetrahedron, mm³."""
    a, b, c, d = np.moveaxis(mesh.points[mesh.cells], 1, 0)
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def draw(mesh: pg.TetMesh, file: Path) -> None:
    """Draw the left half of the brain, cut open, coloured by tissue."""
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    grid["region"] = mesh.region
    half = grid.extract_cells(mesh.points[mesh.cells].mean(axis=1)[:, 1] < 3)
    plotter = pv.Plotter(off_screen=True, window_size=(600, 450))
    colours = ["#d8c3b4", "#b3202c", "#3e7fbf"]
    plotter.add_mesh(half, cmap=colours, show_edges=True, show_scalar_bar=False)
    legend = [[tissue, colour] for tissue, colour in zip(REGIONS, colours, strict=True)]
    plotter.add_legend(legend, bcolor=None, size=(0.3, 0.3), loc="upper right")
    plotter.camera_position = [(100, 330, 100), (-25, -20, 10), (0, 0, 1)]
    plotter.screenshot(file)
    plotter.close()


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")).items():
        print(f"{name}: {value:.2f}")
