"""Ventricles found in a T1: Dice where the truth is known, volume, depth and balance.

    python benchmarks/ventricles.py --labels freesurfer_labels_02.nii.gz \
        --t1 glioma_t1_brain.nii.gz --tumour glioma_segmentation.nii.gz

The bundled template is always looked at. Of a label map by FreeSurfer's numbers with
labels for the rest of the head (501 to 532), as SynthSeg is trained on, T1s of three
contrasts are made, blurred and with noise, each from another seed; the map is the
truth. Of a patient, the skull-stripped T1 and the tumour are given. Depth: how much of
what was found lies within 12 mm of the surface of the brain.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from nilearn.datasets import load_mni152_brain_mask, load_mni152_template
from scipy import ndimage

from physgnn.arrays import BoolArray
from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.segmentation.labels.label_tables import LABEL_TABLES
from physgnn.io.medical.images.formats import read_image, read_segmentation
from physgnn.segmentation.orientation import mask_on, upright
from physgnn.segmentation.stripped import dice, one_piece
from physgnn.segmentation.ventricles import find_ventricles

SHALLOW_MM = 12.0
# Fluid, grey and white matter; standard deviation of the noise.
CONTRASTS, NOISE = ((32, 80, 110), (25, 70, 105), (45, 85, 108)), 5.0
WHITE = (2, 7, 16, 28, 41, 46, 60, 77, 85)
# Other tissues, in parts of white matter; lesions are darker than it.
OTHER = {25: 0.6, 57: 0.6, 30: 0.55, 62: 0.55, 509: 0.8, 511: 1.2, 515: 0.2, 516: 1.3}
FLUID = (24, 502, 506, 507, 508, 512, 514, 530)


def template() -> tuple[Image, BoolArray]:
    """Return the bundled T1 without its skull, and the brain."""
    t1, mask = (f(resolution=1) for f in (load_mni152_template, load_mni152_brain_mask))
    inside = one_piece(np.asarray(mask.dataobj) > 0)
    return Image(np.where(inside, t1.dataobj, 0.0), t1.affine), inside


def made(labels: LabelVolume, seed: int) -> tuple[Image, BoolArray, BoolArray]:
    """Return a T1 as labels would show it, the brain, and its ventricles."""
    fluid, grey, white = CONTRASTS[seed]
    table = LABEL_TABLES["freesurfer"]
    values = np.zeros(int(labels.data.max()) + 1)
    for ids, value in (
        (FLUID, fluid),
        (table.labels["brain"], grey),
        (WHITE, white),
        (table.labels["ventricle"], fluid),
        *(((n,), part * white) for n, part in OTHER.items()),
    ):
        values[[n for n in ids if n < len(values)]] = value
    noise = np.random.default_rng(seed).normal(0.0, NOISE, labels.data.shape)
    data = ndimage.gaussian_filter(values[np.maximum(labels.data, 0)], 0.6) + noise
    truth = labels.mask(table.labels["ventricle"])
    # a mask of the brain takes the fluid of its fissures in (24)
    brain = one_piece(labels.mask((*table.labels["brain"], 24)) | truth)
    return Image(data.astype(np.float32), labels.affine), brain, truth


def cases(
    options: argparse.Namespace,
) -> Iterator[tuple[str, Image, BoolArray, BoolArray | None, BoolArray | None]]:
    """Yield a name, the T1, the brain, where no ventricle is, and the truth."""
    yield "template", *template(), None, None
    if options.labels is not None:
        labels = read_segmentation(options.labels)
        for seed in range(len(CONTRASTS)):
            scan, brain, truth = made(labels, seed)
            yield f"made {CONTRASTS[seed]}", scan, brain, None, truth
    if options.t1 is not None:
        scan = read_image(options.t1)
        brain = one_piece(np.asarray(scan.data) != 0)
        yield "patient", scan, brain, read_segmentation(options.tumour).data > 0, None


def main() -> None:
    """Print a row for each case."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("labels", "t1", "tumour"):
        parser.add_argument(f"--{name}", type=Path)
    options = parser.parse_args()
    print("| scan | ml | Dice | truth, ml | left : right | within 12 mm | seconds |")
    print("|---|---|---|---|---|---|---|")
    for name, scan, brain, but, truth in cases(options):
        start = time.process_time()
        cubes = upright(scan)
        inside = mask_on(cubes.grid, brain, scan.affine)
        none = np.zeros_like(inside)
        apart = none if but is None else mask_on(cubes.grid, but, scan.affine)
        found = find_ventricles(cubes, inside, but=apart)
        seconds = time.process_time() - start
        if found.reason:
            print(f"| {name} | {found.reason} |")
            continue
        ml = found.mask.sum() * cubes.grid.voxel_volume_mm3 / 1000.0
        middle = np.argwhere(inside)[:, 0].mean()
        left = float((np.argwhere(found.mask)[:, 0] < middle).mean())
        depth = ndimage.distance_transform_edt(inside, sampling=cubes.grid.voxel_mm)
        shallow = float((depth[found.mask] < SHALLOW_MM).mean())
        known = "none | none"
        if truth is not None:
            on_scan = mask_on(scan.grid, found.mask, cubes.affine)
            true_ml = truth.sum() * scan.grid.voxel_volume_mm3 / 1000.0
            known = f"{dice(on_scan, truth):.3f} | {true_ml:.1f}"
        print(
            f"| {name} | {ml:.1f} | {known} | {left:.2f} : {1 - left:.2f} | "
            f"{shallow:.1%} | {seconds:.1f} |"
        )


if __name__ == "__main__":
    main()
