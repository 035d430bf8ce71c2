"""A T1 image deformed by a mesh's displacement: seconds and round trip.

    python benchmarks/warp.py --threads 2

The MNI152 template at 1 mm, 197 by 233 by 189 voxels, with the bundled brain as mesh
under a smooth indentation of 12 mm at the craniotomy. Prints the time of each step, the
error of the round trip through forward and inverse field, and what folds.
"""

import argparse
import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np
import SimpleITK as sitk
from nilearn.datasets import load_mni152_template

from physgnn.geometry import mni152_phantom, tetrahedralize
from physgnn.geometry.image import Image
from physgnn.imaging import (
    folding,
    forward_field,
    grid_around,
    inverse_field,
    round_trip_mm,
    warp,
)

LIMIT_S = 10.0
T = TypeVar("T")


def timed(name: str, function: Callable[[], T]) -> tuple[T, float]:
    start = time.perf_counter()
    result = function()
    seconds = time.perf_counter() - start
    print(f"{name:<28}{seconds:8.2f} s")
    return result, seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=2)
    sitk.ProcessObject.SetGlobalDefaultNumberOfThreads(parser.parse_args().threads)
    template = load_mni152_template(resolution=1)
    image = Image(np.asarray(template.dataobj), template.affine)
    phantom = mni152_phantom()
    mesh = tetrahedralize(phantom.brain, phantom.tumours, target_points=9000)
    offset = mesh.points - phantom.craniotomy_point
    inward = -np.mean(phantom.craniotomy_point - mesh.points, axis=0)
    inward /= np.linalg.norm(inward)
    u = 12.0 * np.exp(-((offset / 45.0) ** 2).sum(axis=1))[:, None] * inward
    inverse_field(mesh, u, grid_around(mesh, spacing_mm=10.0))  # compiles

    print(f"{image.data.shape} voxels, {mesh.n_points} points, {mesh.n_cells} cells")
    inverse, first = timed("inverse field", lambda: inverse_field(mesh, u, image.grid))
    _, second = timed("resampling", lambda: warp(image, inverse))
    print(f"{'together':<28}{first + second:8.2f} s (at most {LIMIT_S:g} wanted)")
    forward, _ = timed("forward field", lambda: forward_field(mesh, u, image.grid))
    error, _ = timed("round trip", lambda: round_trip_mm(forward, inverse))
    print(f"    {error.mean():.4f} mm mean, {error.max():.4f} mm at most")
    found, _ = timed("search for folds", lambda: folding(mesh, u, inverse))
    print(f"    {found}")


if __name__ == "__main__":
    main()
