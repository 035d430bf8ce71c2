"""Register and warp: forty measured points move the whole brain, and its T1 with it.

    python examples/06_register_and_warp.py [folder]

The bundled brain sinks by 8 mm under a craniotomy. Forty points of its surface are
measured with 0.7 mm of noise. Writes shift.vtu, t1-deformed.nii.gz, slices.png and
picture.png.
"""

import sys
from pathlib import Path

import matplotlib as mpl
import nibabel as nib
import numpy as np
from nilearn.datasets import load_mni152_template

import physgnn as pg
from physgnn.geometry import boundary_points

mpl.use("Agg")
import matplotlib.pyplot as plt

CRANIOTOMY = np.array([39.7, 8.8, 62.5])  # mm
SETS = """
[point_sets.fixed]
kind = "complement"
of = { kind = "sphere", centre_mm = [39.7, 8.8, 62.5], radius_mm = 70 }
"""


def main(folder: Path) -> dict[str, float]:
    """Return the error at surface points that were not measured, and the bound, mm."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "sets.toml").write_text(SETS)
    mesh = pg.mesh(
        folder / "case.vtu",
        mni152=True,
        target_points=2000,
        sets=folder / "sets.toml",
    )
    nib.save(load_mni152_template(resolution=2), folder / "t1.nii.gz")
    measured, others = np.split(near_craniotomy(mesh), [40])
    before = mesh.points[measured]
    noise = np.random.default_rng(0).normal(scale=0.7, size=before.shape)
    rows = np.hstack([before, before + sinking(before) + noise])
    np.savetxt(folder / "measured.csv", rows, delimiter=",")

    found = pg.register(
        folder / "case.vtu",
        folder / "shift.vtu",
        points=folder / "measured.csv",
        noise_mm=0.7,
    )
    pg.warp(
        folder / "t1.nii.gz",
        folder / "shift.vtu",
        folder / "t1-deformed.nii.gz",
        slices=folder / "slices.png",
    )
    draw(folder)
    u = found.prediction.displacement
    truth = sinking(mesh.points[others])
    bound = found.prediction.error_estimate_mm
    assert bound is not None
    return {
        "error_mm": float(np.linalg.norm(u[others] - truth, axis=1).mean()),
        "doing_nothing_mm": float(np.linalg.norm(truth, axis=1).mean()),
        "bound_on_mean_mm": float(bound.mean_mm),
    }


def near_craniotomy(mesh: pg.TetMesh) -> np.ndarray:
    """Return the 80 free surface points nearest to the craniotomy, in random order."""
    free = np.setdiff1d(boundary_points(mesh), mesh.point_set("fixed"))
    away = np.linalg.norm(mesh.points[free] - CRANIOTOMY, axis=1)
    return np.random.default_rng(1).permutation(free[np.argsort(away)[:80]])


def sinking(points: np.ndarray) -> np.ndarray:
    """Return where the surface went: up to 8 mm inwards, less far away, mm."""
    squared = ((points - CRANIOTOMY) ** 2).sum(axis=1)
    depth = 8.0 * np.exp(-squared / (2 * 35.0**2))
    return depth[:, None] * np.array([-0.5, -0.3, -0.8])


def draw(folder: Path) -> None:
    """Draw a coronal slice through the craniotomy before and after, right is right."""
    figure, both = plt.subplots(1, 2, figsize=(4, 3), layout="constrained")
    names = {"before": "t1.nii.gz", "after": "t1-deformed.nii.gz"}
    for axes, (title, name) in zip(both, names.items(), strict=True):
        image = nib.load(folder / name)
        j = round(np.linalg.solve(image.affine, [*CRANIOTOMY, 1.0])[1])
        axes.imshow(image.get_fdata()[:, j].T, cmap="gray", origin="lower")
        axes.set_title(title)
        axes.axis("off")
    figure.savefig(folder / "picture.png", dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    found = main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    print(
        f"mean error at points not measured: {found['error_mm']:.2f} mm, doing nothing "
        f"{found['doing_nothing_mm']:.2f} mm"
    )
