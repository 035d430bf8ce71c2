"""One HTML file with everything an evaluation found: no network, no other files."""

import base64
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from physgnn.evaluation.measure.against_linear import beats_linear
from physgnn.evaluation.measure.gentle_loads import GENTLE_N
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.report import published, tables
from physgnn.evaluation.report.formats import duration, mm, percent
from physgnn.evaluation.report.plots.panels import Picture
from physgnn.evaluation.report.style import colour, label
from physgnn.evaluation.report.tables import Table, group_label
from physgnn.evaluation.report.verdict import linear_warning
from physgnn.io.integrity.atomic import write_whole
from physgnn.prediction.prediction import PredictionStatus

SPLIT_TITLE = {
    "published": "on the published split",
    "path": "on load paths it has never seen",
    "node": "on loaded nodes it has never seen",
    "mesh": "on a mesh it has never seen",
}
SPLIT_MEANING = {
    "published": "The published split: all samples shuffled, whatever their load path. "
    "A test sample's neighbours on its own path are almost always in the training set, "
    "so interpolating between two known levels, with no model at all, is a hundred "
    "times more accurate than the published network. The figures here say how well a "
    "model fills gaps, not how well it predicts.",
    "path": "Whole load paths are held out: no level of a tested path was seen in "
    "training or used to stop it. The same nodes are loaded, in other directions.",
    "node": "Loaded nodes are held out: no tested load path acts on a node that "
    "carried a force in training.",
    "mesh": "A whole mesh is held out: nothing that was simulated on it was seen in "
    "training.",
}

FOOTER = (
    "Displacements and errors in mm. The same numbers, every sample included, are in "
    "metrics.json beside this file."
)

Parts = list[tuple[str, Any]]
"""What stands in a section: how templates/report.html shows it, and what it is."""


def write_report(report: Report, pictures: Iterable[Picture], path: Path) -> None:
    """Write report.html, whole or not at all.

    Parameters
    ----------
    report : Report
        Its last model is the one under test; its `facts` are groups of name → value.
    pictures : iterable of Picture
        In the order of the page; embedded.
    path : path
        The file.
    """
    write_whole(path, report_html(report, pictures))


def report_html(report: Report, pictures: Iterable[Picture]) -> str:
    """Return the report as one self-contained HTML page."""
    tested = label(report.models[-1].name)
    page = _Page(report, {picture.name: picture for picture in pictures})
    return (
        environment()
        .get_template("report.html")
        .render(
            title=f"{tested} {SPLIT_TITLE.get(report.split, 'on held-out samples')}",
            tested=tested,
            wins=beats_linear(report) is True,
            warning=linear_warning(report),
            key_numbers=_key_numbers(report),
            sections=_sections(page),
            footer=FOOTER,
            alert=False,
            colours={group_label(s): colour(s[0].name) for s in report.groups},
        )
    )


@cache
def environment() -> Environment:
    """Return what renders the templates of pages."""
    made = Environment(
        loader=PackageLoader("physgnn.evaluation.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters["embedded"] = _embedded
    return made


def _embedded(file: Path) -> str:
    """Return a PNG file as a URL that holds it."""
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


@dataclass(frozen=True)
class _Page:
    """What a section is put together from: parts that are there."""

    report: Report
    pictures: Mapping[str, Picture]

    def pictured(self, *names: str) -> Parts:
        return [("picture", self.pictures[n]) for n in names if n in self.pictures]

    def facts(self, *names: str) -> Parts:
        found = [self.report.facts.get(name) for name in names]
        return [("facts", facts) for facts in found if isinstance(facts, Mapping)]

    def table(self, made: Table | None) -> Parts:
        return [] if made is None else [("table", made)]


def _sections(page: _Page) -> Iterator[tuple[str, Parts]]:
    """Yield the sections in their order: titles, and what stands below."""
    report = page.report
    yield (
        "The case",
        page.facts("case") + page.pictured("case", "deformed", "slices"),
    )
    yield "Accuracy", _accuracy(page)
    yield "Error bounds", _error_bounds(page)
    yield "The worst case", page.pictured("worst_case")
    preset = str(report.facts.get("case", {}).get("preset", ""))
    yield (
        "Beside the publication",
        page.table(published.protocol_table(report, preset))
        + page.table(published.extremes_table(report, preset)),
    )
    yield "Time", page.facts("time")
    yield "Where the numbers come from", page.facts("model", "provenance")


def _accuracy(page: _Page) -> Parts:
    return [
        ("aside", SPLIT_MEANING.get(page.report.split, "")),
        *page.table(tables.accuracy_table(page.report)),
        *page.pictured("error_over_level"),
        *page.table(tables.level_table(page.report)),
        *page.table(tables.gentle_table(page.report)),
        *_no_gentle_loads(page.report),
        *page.pictured("error_histogram"),
    ]


def _no_gentle_loads(report: Report) -> Parts:
    """Say so if no sample tells how large errors are at the forces of surgery."""
    loads = tables.gentle_loads(report)
    if loads is None or loads.samples:
        return []
    text = (
        f"No tested load is as gentle as seven in ten of those measured in surgery, at "
        f"most {GENTLE_N:g} N (Gan et al. 2015): the gentlest here has "
        f"{loads.gentlest_n:.3g} N in all."
    )
    return [("text", text)]


def _error_bounds(page: _Page) -> Parts:
    return [
        ("text", _bounds(page.report.models[-1])),
        *page.facts("bounds"),
        *page.pictured("error_bound", "error_bars"),
        *page.facts("error_bars"),
        *page.table(tables.tolerance_table(page.report)),
    ]


def _key_numbers(report: Report) -> list[tuple[str, str, str]]:
    """Return names, values and details of what the page shows first."""
    model = report.models[-1]
    n_paths = len({sample.path for sample in model.samples})
    seconds = report.facts.get("solver_seconds")
    solver = f"finite elements: {duration(seconds)}" if seconds else ""
    plural = "s" if n_paths > 1 else ""
    held = f"{model.summary.n_samples} samples of {n_paths} load path{plural}"
    numbers = [
        ("Mean error", f"{mm(model.euclidean.mean)} mm", held),
        ("Nodes within 1 mm", percent(model.euclidean.within_1mm), ""),
        ("A prediction takes", duration(model.summary.median_seconds), solver),
    ]
    linear = [m for m in report.models if m.name == "linear"]
    if linear:
        error = f"{mm(linear[0].euclidean.mean)} mm"
        numbers.insert(1, ("Linear solution's mean error", error, "the baseline"))
    return numbers


def _bounds(model: ModelErrors) -> str:
    """Say what the error bounds promised and how often they held."""
    estimated = [s for s in model.samples if s.estimate_largest is not None]
    if not estimated:
        return "This model has not been calibrated: it gives no error bounds."
    outside = PredictionStatus.OUTSIDE_TRAINED_RANGE.name
    inside = [s for s in estimated if s.status != outside]
    unsure = sum(not PredictionStatus[s.status].usable for s in inside)
    held = sum(s.largest <= (s.estimate_largest or 0.0) for s in inside)
    remark = (
        f"inside, the bound on the largest error held in {percent(held / len(inside))} "
        f"of {len(inside)}"
        if inside
        else "so the promise was not put to the test"
    )
    return (
        "Every prediction carries a bound on its mean and its largest error, "
        "calibrated on validation samples, and says whether its load lies outside the "
        f"trained range, where nothing is promised. {len(estimated) - len(inside)} of "
        f"{len(estimated)} test samples lay outside; {remark}. Of those inside, "
        f"{unsure} were flagged for another reason, such as a bound larger than the "
        "displacement."
    )
