"""One HTML file with everything an evaluation found: no network, no other files."""

import base64
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from physgnn.evaluation import published, tables
from physgnn.evaluation.figures import Picture
from physgnn.evaluation.formats import duration, mm, percent
from physgnn.evaluation.result import ModelErrors, Report
from physgnn.evaluation.style import colour, label
from physgnn.evaluation.tables import Table, group_label
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
    part = path.with_name(path.name + ".part")
    part.write_text(report_html(report, pictures), "utf-8")
    part.replace(path)


def report_html(report: Report, pictures: Iterable[Picture]) -> str:
    """Return the report as one self-contained HTML page."""
    tested = label(report.models[-1].name)
    shown = {picture.name: _figure(picture) for picture in pictures}
    body = "".join(
        _section(title, parts) for title, parts in _sections(_Page(report, shown))
    )
    title = f"{tested} {SPLIT_TITLE.get(report.split, 'on held-out samples')}"
    style = files("physgnn.evaluation").joinpath("report.css").read_text("utf-8")
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{style}</style></head><body>"
        f"<header><h1>{escape(title)}</h1>{_key_numbers(report)}</header>"
        f"<main>{body}</main>"
        "<footer>Displacements and errors in mm. The same numbers, every sample "
        "included, are in metrics.json beside this file.</footer></body></html>\n"
    )


@dataclass(frozen=True)
class _Page:
    """What a section is put together from, each part as HTML or None."""

    report: Report
    pictures: Mapping[str, str]

    def pictured(self, *names: str) -> list[str | None]:
        return [self.pictures.get(name) for name in names]

    def facts(self, *names: str) -> list[str | None]:
        found = [self.report.facts.get(name) for name in names]
        return [_facts(f) if isinstance(f, Mapping) else None for f in found]

    def table(self, made: Table | None) -> str | None:
        if made is None:
            return None
        names = {group_label(seeds): seeds[0].name for seeds in self.report.groups}
        return _table(made, names, label(self.report.models[-1].name))


def _sections(page: _Page) -> Iterator[tuple[str, list[str | None]]]:
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
    beside = (published.protocol_table, published.extremes_table)
    yield "Beside the publication", [page.table(of(report, preset)) for of in beside]
    yield "Time", page.facts("time")
    yield "Where the numbers come from", page.facts("model", "provenance")


def _accuracy(page: _Page) -> list[str | None]:
    meaning = SPLIT_MEANING.get(page.report.split, "")
    return [
        f'<p class="aside">{escape(meaning)}</p>',
        page.table(tables.accuracy_table(page.report)),
        *page.pictured("error_over_level"),
        page.table(tables.level_table(page.report)),
        *page.pictured("error_histogram"),
    ]


def _error_bounds(page: _Page) -> list[str | None]:
    return [
        _bounds(page.report.models[-1]),
        *page.facts("bounds"),
        *page.pictured("error_bound", "error_bars"),
        *page.facts("error_bars"),
        page.table(tables.tolerance_table(page.report)),
    ]


def _key_numbers(report: Report) -> str:
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
    cards = (
        f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd>"
        f"<dd>{escape(detail)}</dd></div>"
        for name, value, detail in numbers
    )
    return f'<dl class="key">{"".join(cards)}</dl>'


def _section(title: str, parts: Iterable[str | None]) -> str:
    content = "".join(part for part in parts if part)
    return f"<section><h2>{escape(title)}</h2>{content}</section>" if content else ""


def _figure(picture: Picture) -> str:
    """Embed a picture: its dark form where the page is dark."""
    light, dark = (
        "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()
        for file in picture.files
    )
    caption = escape(picture.caption)
    return (
        f'<figure><picture><source srcset="{dark}" '
        f'media="screen and (prefers-color-scheme: dark)">'
        f'<img src="{light}" alt="{caption}"></picture>'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _table(made: Table, names: Mapping[str, str], tested: str) -> str:
    head = "".join(f'<th scope="col">{escape(c)}</th>' for c in made.columns)
    rows = "".join(_row(row, names, tested) for row in made.rows)
    note = f'<p class="note">{escape(made.note)}</p>' if made.note else ""
    return (
        f'<h3>{escape(made.title)}</h3><div class="wide" tabindex="0" role="region" '
        f'aria-label="{escape(made.title)}"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>{note}"
    )


def _row(row: tuple[str, ...], names: Mapping[str, str], tested: str) -> str:
    name = row[0]
    if name not in names:
        kind, dot = "published", ""
    else:
        kind = "tested" if name == tested else ""
        dot = f'<span class="dot" style="background:{colour(names[name])}"></span>'
    cells = "".join(f"<td>{escape(cell)}</td>" for cell in row[1:])
    return f'<tr class="{kind}"><th scope="row">{dot}{escape(name)}</th>{cells}</tr>'


def _bounds(model: ModelErrors) -> str:
    """Say what the error bounds promised and how often they held."""
    estimated = [s for s in model.samples if s.estimate_largest is not None]
    if not estimated:
        return "<p>This model has not been calibrated: it gives no error bounds.</p>"
    inside = [s for s in estimated if s.status == PredictionStatus.OK.name]
    held = sum(s.largest <= (s.estimate_largest or 0.0) for s in inside)
    kept = (
        f"inside, the bound on the largest error held in {percent(held / len(inside))} "
        f"of {len(inside)}"
        if inside
        else "so the promise was not put to the test"
    )
    return (
        "<p>Every prediction carries a bound on its mean and its largest error, "
        "calibrated on validation samples, and says whether its load lies outside the "
        f"trained range, where nothing is promised. {len(estimated) - len(inside)} of "
        f"{len(estimated)} test samples lay outside; {kept}.</p>"
    )


def _facts(values: Mapping[str, Any]) -> str:
    rows = (
        f"<dt>{escape(name.replace('_', ' '))}</dt><dd>{escape(str(value))}</dd>"
        for name, value in values.items()
    )
    return f'<dl class="facts">{"".join(rows)}</dl>'
