"""The figures of a registration, each for a light and for a dark page."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from physgnn.evaluation.registration_page.case import RegisteredCase
from physgnn.evaluation.registration_page.places import MeasuredPlace
from physgnn.evaluation.report.plots.panels import Picture, save_picture
from physgnn.evaluation.report.style import SPARE_COLOURS, colour
from physgnn.geometry.image import Image
from physgnn.imaging import before_after, deformed_labels, grid_around, inverse_field
from physgnn.imaging import warp as warped
from physgnn.imaging.slices import LABEL_MM, Overlay, middle_of_shift, overlaid
from physgnn.imaging.voxel_fields import rasterize
from physgnn.prediction.wrong_position import probability_beyond

MOST_BARS = 40
LATER, EARLIER = colour("lifted"), SPARE_COLOURS[0]


def draw_registration(case: RegisteredCase, folder: Path) -> tuple[Picture, ...]:
    """Draw everything into a folder that exists."""
    before, after = _images(case)
    centre = middle_of_shift(case.mesh, case.displacement)
    deviation, wrong = _overlays(case, after)
    what = "The scan" if case.image is not None else "The tissues of the mesh"
    return (
        save_picture(
            "slices",
            f"{what} before, after, and as a checkerboard of both, in three planes "
            "through where the brain moved most. The patient's right is on the right.",
            lambda: before_after(before, after, centre),
            folder,
        ),
        save_picture(
            "deviation",
            "Standard deviation of the displacement, over the brain as it is now.",
            lambda: overlaid(after, deviation, centre),
            folder,
        ),
        save_picture(
            "wrong",
            f"Probability that a position is wrong by more than {case.wrong_mm:g} mm, "
            "over the brain as it is now.",
            lambda: overlaid(after, wrong, centre),
            folder,
        ),
        save_picture(
            "misfit",
            "Distance of the measured places from the brain, before registration and "
            "after it.",
            lambda: misfit_chart(case.places, case.noise_mm),
            folder,
        ),
    )


def misfit_chart(places: Sequence[MeasuredPlace], noise_mm: float) -> Figure:
    """Draw distances before and after: a bar a place, or of many how they spread."""
    figure = Figure(figsize=(9.6, 3.8), layout="constrained")
    axes = figure.subplots()
    before, after = (
        np.array([getattr(place, name) for place in places])
        for name in ("before_mm", "after_mm")
    )
    series = ((before, "before", EARLIER), (after, "after", LATER))
    if len(places) <= MOST_BARS:
        x = np.arange(len(places))
        for shift, (values, name, paint) in zip((-0.2, 0.2), series, strict=True):
            axes.bar(x + shift, values, 0.4, label=name, color=paint)
        axes.set_xticks(x, [place.name for place in places], fontsize=8)
        axes.set(xlabel="measured place", ylabel="distance, mm")
        axes.axhline(noise_mm, ls="--", lw=1, color="#8b929c", label="stated noise")
        axes.grid(axis="x", visible=False)
    else:
        most = max(float(before.max()), float(after.max()), 1e-6)
        edges = np.linspace(0.0, most, 41).tolist()
        for values, name, paint in series:
            axes.hist(values, edges, label=name, color=paint, alpha=0.6)
        axes.set(xlabel="distance, mm", ylabel="measured places")
        axes.axvline(noise_mm, ls="--", lw=1, color="#8b929c", label="stated noise")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
    return figure


def _images(case: RegisteredCase) -> tuple[Image, Image]:
    """Return the scan before and after; without one, the tissues."""
    mesh, u = case.mesh, case.displacement
    if case.image is not None:
        inverse = inverse_field(mesh, u, case.image.grid)
        return case.image, warped(case.image, inverse)
    grid = grid_around(mesh, spacing_mm=LABEL_MM, margin_mm=10.0)
    return deformed_labels(mesh, np.zeros_like(u), grid), deformed_labels(mesh, u, grid)


def _overlays(case: RegisteredCase, after: Image) -> tuple[Overlay, Overlay]:
    chance = probability_beyond(case.covariance_mm2, case.wrong_mm)
    values = np.stack([case.deviation_mm, chance], axis=1)
    points = case.mesh.points + case.displacement
    fields, cell = rasterize(points, case.mesh.cells, values, after.grid)
    most = max(float(case.deviation_mm.max()), 1e-6)
    return (
        Overlay(
            fields[..., 0], cell >= 0, (0.0, most), "viridis", "standard deviation, mm"
        ),
        Overlay(
            fields[..., 1], cell >= 0, (0.0, 1.0), "YlOrRd", "probability", fades=True
        ),
    )
