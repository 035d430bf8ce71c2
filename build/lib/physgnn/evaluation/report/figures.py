"""The figures of a report: which samples are shown, and what of them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from physgnn.arrays import FloatArray
from physgnn.choices import Estimate
from physgnn.dataset.storage.store import Store
from physgnn.evaluation.measure.coverage import BarSample
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.report.plots import scenes
from physgnn.evaluation.report.plots.charts import (
    estimate_chart,
    histogram_chart,
    level_chart,
)
from physgnn.evaluation.report.plots.coverage_chart import bars_chart
from physgnn.evaluation.report.plots.panels import (
    Picture,
    colour_bar,
    save_picture,
    side_by_side,
)
from physgnn.evaluation.report.plots.scenes import Pixels, View
from physgnn.evaluation.report.style import (
    BRAIN,
    DISPLACEMENT_MAP,
    ERROR_MAP,
    FIXED,
    LOADED,
    TUMOUR,
    label,
)
from physgnn.imaging import slices_of_shift
from physgnn.imaging.template import bundled_t1
from physgnn.prediction.prediction import Predict

SATURATED = 99.5  # percentile where colours end: a few loaded points move much more


def draw_figures(
    report: Report, store: Store, predict: Predict, folder: Path
) -> tuple[Picture, ...]:
    """Draw every figure of a report into a folder.

    Parameters
    ----------
    report : Report
        Its last model is the one under test.
    store : Store
        What was evaluated on.
    predict : callable
        The model under test, asked again for its worst case.
    folder : path
        Made if it is missing.
    """
    folder.mkdir(parents=True, exist_ok=True)
    model = report.models[-1]
    made = [
        _draw_case(store, model, folder),
        _draw_deformed(store, model, folder),
        _draw_slices(store, model, predict, folder),
        save_picture(
            "error_over_level",
            "Euclidean error over the load: the mean over nodes and samples on the "
            "left, the mean of the samples' largest on the right; logarithmic.",
            lambda: level_chart(report),
            folder,
        ),
        save_picture(
            "error_histogram",
            "How the Euclidean errors of all nodes and samples are distributed.",
            lambda: histogram_chart(report),
            folder,
        ),
    ]
    if any(sample.estimate_mean is not None for sample in model.samples):
        caption = (
            "The error bound each prediction carried over its true error; dots above "
            "the line are within the bound."
        )
        made.append(
            save_picture("error_bound", caption, lambda: estimate_chart(model), folder)
        )
    made.append(_draw_worst(store, model, predict, folder))
    return tuple(made)


def draw_bars(samples: Sequence[BarSample], folder: Path) -> Picture:
    """Draw how far error estimates and bounds can be trusted."""
    return save_picture(
        "error_bars",
        f"Error estimates and bounds beside the true error, {len(samples)} samples: "
        "the physical estimate over it (shaded: within a factor of two), how often "
        "bounds held (dashed: as promised), and how far above it they lie.",
        lambda: bars_chart(samples),
        folder,
    )


def _draw_case(store: Store, model: ModelErrors, folder: Path) -> Picture:
    mesh, sample = store.mesh, model.worst
    mesh = mesh.with_point_sets(fixed=store.fixed)
    path = store.load_path(sample.path)
    view = View.of(mesh, path.nodes)
    images = (
        scenes.render_case(mesh, path.case(store.n_levels - 1), view),
        scenes.render_cut(mesh, view),
    )

    def figure() -> Figure:
        made, _ = side_by_side(images, ("Fixed and loaded points", "Mesh, cut open"))
        kinds = (("fixed", FIXED), ("loaded, force", LOADED), ("tumour", TUMOUR))
        dots = [
            Line2D([], [], marker="o", linestyle="", color=paint, label=name)
            for name, paint in (("brain", BRAIN), *kinds)
        ]
        made.legend(handles=dots, loc="outside lower center", ncols=4)
        return made

    return save_picture(
        "case",
        f"The case: {mesh.n_points} points, {mesh.n_cells} tetrahedra, "
        f"{len(store.fixed)} fixed and {len(path.nodes)} loaded points.",
        figure,
        folder,
    )


def _draw_deformed(store: Store, model: ModelErrors, folder: Path) -> Picture:
    sample = max(model.samples, key=lambda s: s.largest_displacement)
    truth = store.displacement(sample.path)[sample.level].astype(np.float64)
    length = np.linalg.norm(truth, axis=1)
    limits = (0.0, float(np.percentile(length, SATURATED)))
    mesh, view = store.mesh, View.of(store.mesh, store.load_path(sample.path).nodes)
    colours = {"view": view, "limits": limits, "map": DISPLACEMENT_MAP}
    images = (
        scenes.render_surface(mesh, truth, length, **colours),
        scenes.render_deformed_cut(mesh, truth, length, **colours),
    )

    def figure() -> Figure:
        titles = ("Deformed surface", "Cut through the tumour; grey line: at rest")
        made, axes = side_by_side(images, titles)
        colour_bar(made, axes, DISPLACEMENT_MAP, limits, "displacement, mm")
        return made

    return save_picture(
        "deformed",
        f"The finite-element solution for load path {sample.path} at "
        f"{100 * sample.load_factor:.0f} % load, true to scale; it moves up to "
        f"{sample.largest_displacement:.1f} mm.",
        figure,
        folder,
    )


def _draw_slices(
    store: Store, model: ModelErrors, predict: Predict, folder: Path
) -> Picture:
    sample = max(model.samples, key=lambda s: s.largest_displacement)
    case = store.load_case(sample.path, sample.level)
    predicted = predict(case, estimate=Estimate.QUICK).displacement
    image = bundled_t1(store.mesh)
    shown = "The tissues" if image is None else "The T1-weighted image"
    return save_picture(
        "slices",
        f"{shown} before and after, as predicted for load path {sample.path} at "
        f"{100 * sample.load_factor:.0f} % load, and squares of each in turn: where "
        "nothing moves, lines run on from square to square.",
        lambda: slices_of_shift(store.mesh, predicted, image),
        folder,
    )


def _draw_worst(
    store: Store, model: ModelErrors, predict: Predict, folder: Path
) -> Picture:
    sample = model.worst
    case = store.load_case(sample.path, sample.level)
    truth = store.displacement(sample.path)[sample.level].astype(np.float64)
    predicted = predict(case, estimate=Estimate.QUICK).displacement
    error = np.linalg.norm(truth - predicted, axis=1)
    limits = (0.0, float(np.percentile(np.linalg.norm(truth, axis=1), SATURATED)))
    errors = (0.0, float(np.percentile(error, SATURATED)))
    view = View.of(store.mesh, case.nodes)

    def render(
        displacement: FloatArray,
        values: FloatArray,
        colours: Colormap,
        ends: tuple[float, float],
    ) -> Pixels:
        return scenes.render_surface(
            store.mesh, displacement, values, view=view, limits=ends, map=colours
        )

    images = (
        render(truth, np.linalg.norm(truth, axis=1), DISPLACEMENT_MAP, limits),
        render(predicted, np.linalg.norm(predicted, axis=1), DISPLACEMENT_MAP, limits),
        render(predicted, error, ERROR_MAP, errors),
    )

    def figure() -> Figure:
        titles = ("Finite elements", label(model.name), "Error of the prediction")
        made, axes = side_by_side(images, titles)
        colour_bar(made, axes[:2], DISPLACEMENT_MAP, limits, "displacement, mm")
        colour_bar(made, axes[2:], ERROR_MAP, errors, "error, mm")
        return made

    return save_picture(
        "worst_case",
        f"The worst case of {len(model.samples)}: load path {sample.path} at "
        f"{100 * sample.load_factor:.0f} % load. Mean error {sample.mean:.2g} mm, "
        f"largest {sample.largest:.2g} mm (colours end at {errors[1]:.2g} mm).",
        figure,
        folder,
    )
