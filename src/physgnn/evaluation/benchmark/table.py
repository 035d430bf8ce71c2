"""Results as a page of Markdown: who loses first, then a table a task."""

import textwrap
from collections.abc import Iterator, Sequence

from physgnn.evaluation.benchmark.methods import MINUTES, REPAIRED, TOLD_MORE
from physgnn.evaluation.benchmark.result import (
    FAILED,
    MEASURED,
    NOT_APPLICABLE,
    BenchmarkResult,
)
from physgnn.evaluation.benchmark.tasks import TASKS
from physgnn.evaluation.measure.distribution import Distribution
from physgnn.evaluation.report.formats import NONE, duration, minutes, mm, percent
from physgnn.evaluation.report.style import label

WIDTH = 110
WITHOUT_TRAINING = ("linear", "reduced", "register")  # what a network has to beat
FITTED_NETWORKS = ("mlp", "pod-network")  # beside those that have epochs
REGISTERED = "register"
HEAD = (
    "method", "mean", "median", "95 %", "99 %", "largest", "≤ 1 mm", "loaded region",
    "tumour", "training", "a prediction", "memory",
)  # fmt: skip


def page(results: Sequence[BenchmarkResult], chart: str, command: str) -> str:
    """Return the page of a benchmark.

    Parameters
    ----------
    results : sequence of BenchmarkResult
        Of any tasks and sizes.
    chart : str
        The name of the figure's file, beside the page.
    command : str
        What draws the page anew.
    """
    groups = by_task(results)
    parts = [
        "# Benchmark",
        _prose(
            "Every method on the same tasks, with the same samples held out. Errors "
            "are Euclidean distances in mm over nodes and test samples. Training is in "
            "minutes of processor time, all threads together. A prediction is the "
            "median by the wall clock, of one load at a time. Memory is how far the "
            "process grew, at most, beyond what methods before it had left. Other work "
            "on the machine makes its times longer: the load average is said where it "
            "is known. This page is made by a command from the files of the results, "
            "and nothing on it is typed by hand."
        ),
        _commands(groups, command),
        "## Where networks and registration lose",
        "\n".join(_losses(groups)) or "Nowhere in these results.",
        f"![Error over the time of a prediction and over training]({chart})",
        *(_section(*key, rows) for key, rows in groups.items()),
        "## Not run",
        "\n".join(_not_run({task for task, _ in groups})) or "Every task was run.",
    ]
    return "\n\n".join(parts) + "\n"


def by_task(
    results: Sequence[BenchmarkResult],
) -> dict[tuple[str, str], list[BenchmarkResult]]:
    """Return the results of the present versions, a list for each task and size."""
    known = [
        r
        for r in results
        if r.identity.task in TASKS
        and r.identity.version == TASKS[r.identity.task].version
    ]
    sizes = ("full", "tiny")
    keys = [(task, size) for size in sizes for task in TASKS]
    groups = {
        key: [r for r in known if (r.identity.task, r.identity.size) == key]
        for key in keys
    }
    return {key: rows for key, rows in groups.items() if rows}


def ranked(
    rows: Sequence[BenchmarkResult],
) -> list[tuple[BenchmarkResult, Distribution]]:
    """Return the measured results with the errors that rank them, the best first."""
    found = [
        (row, row.errors.over(TASKS[row.identity.task].over))
        for row in rows
        if row.errors is not None
    ]
    return sorted(found, key=lambda each: each[1].mean)


def _commands(
    groups: dict[tuple[str, str], list[BenchmarkResult]], command: str
) -> str:
    lines = [
        f"physgnn benchmark --task {task} --method all --size {size}"
        f"{' --data data/' if size == 'full' else ''}{_budget(rows)} -o results/"
        for (task, size), rows in groups.items()
    ]
    return "\n".join(["```bash", *lines, command, "```"])


def _budget(rows: Sequence[BenchmarkResult]) -> str:
    """Return the option that gives networks their minutes; empty if by default."""
    others = _minutes_allowed(rows) - {MINUTES[rows[0].identity.size]}
    return f" --minutes {max(others):g}" if others else ""


def _minutes_allowed(rows: Sequence[BenchmarkResult]) -> set[float]:
    """Return what networks that were trained might train, processor minutes."""
    return {
        row.identity.processor_minutes
        for row in rows
        if row.status == MEASURED and row.identity.processor_minutes is not None
    }


def _losses(groups: dict[tuple[str, str], list[BenchmarkResult]]) -> Iterator[str]:
    """Yield a line for each task and method that networks or registration lose to."""
    for (task, size), rows in groups.items():
        found = ranked(rows)
        mean = {row.identity.method: errors.mean for row, errors in found}
        should_win = {
            r.identity.method: e.mean
            for r, e in found
            if r.curve or r.identity.method in (*FITTED_NETWORKS, REGISTERED)
        }
        should_win.pop(REPAIRED, None)  # a solver has the last word there
        for name in WITHOUT_TRAINING:
            others = {k: v for k, v in should_win.items() if k != name}
            behind = [k for k, v in others.items() if name in mean and v >= mean[name]]
            if behind:
                names = ", ".join(f"{label(k)} ({mm(should_win[k])})" for k in behind)
                yield _prose(
                    f"- **{task}, {size}**: behind the "
                    f"{label(name).lower()} ({mm(mean[name])} mm): {names}.",
                    "  ",
                )


def _section(task: str, size: str, rows: Sequence[BenchmarkResult]) -> str:
    about, found = TASKS[task], ranked(rows)
    parts = [f"## {task}, version {about.version}, {size}", _prose(about.about)]
    if size == "tiny":
        parts.append(
            _prose(
                "Size tiny: a coarse mesh of the bundled brain, few load paths or "
                "shifts, small networks and seconds of training. It shows that all "
                "methods run, and says little about which is best."
            )
        )
    if about.published:
        parts.append(_prose(f"Published, on the data of size full: {about.published}."))
    parts.append(_table(found))
    if told := _told_more(task, found):
        parts.append(told)
    if missing := _without_errors(rows):
        parts.append(missing)
    parts.append(_provenance(rows))
    return "\n\n".join(parts)


def _told_more(task: str, found: Sequence[tuple[BenchmarkResult, Distribution]]) -> str:
    """Return what some methods were told that the others were not."""
    names = [row.identity.method for row, _ in found if not TASKS[task].measured]
    return " ".join(
        _prose(f"{label(name)} {TOLD_MORE[name]}.")
        for name in names
        if name in TOLD_MORE
    )


def _without_errors(rows: Sequence[BenchmarkResult]) -> str:
    """Return a line for each method that failed, and for each reason not to apply."""
    names: dict[str, list[str]] = {}
    for row in rows:
        if row.status == NOT_APPLICABLE:
            names.setdefault(row.reason, []).append(label(row.identity.method))
    lines = [
        f"- {label(row.identity.method)}: {row.status}, {row.reason}."
        for row in rows
        if row.status == FAILED
    ]
    lines += [f"- Not applicable, {why}: {', '.join(of)}." for why, of in names.items()]
    return "\n".join(_prose(line, "  ") for line in lines)


def _table(found: Sequence[tuple[BenchmarkResult, Distribution]]) -> str:
    lines = ["| " + " | ".join(HEAD) + " |", "|---" + "|---:" * (len(HEAD) - 1) + "|"]
    lines += ["| " + " | ".join(_cells(row, errors)) + " |" for row, errors in found]
    return "\n".join(lines)


def _cells(row: BenchmarkResult, errors: Distribution) -> list[str]:
    whole, seed = row.errors, row.identity.seed
    assert whole is not None  # ranked has the measured alone
    regions = (whole.loaded_region, whole.tumour)
    many = "" if seed in (None, 0) else f", seed {seed}"
    return [
        label(row.identity.method) + many,
        *(mm(v) for v in (errors.mean, errors.median, errors.percentile_95)),
        *(mm(v) for v in (errors.percentile_99, errors.largest)),
        percent(errors.within_1mm),
        *(NONE if region is None else mm(region.mean) for region in regions),
        NONE if row.processor_minutes is None else minutes(row.processor_minutes),
        NONE if row.milliseconds is None else duration(row.milliseconds / 1e3),
        NONE if row.memory_mb is None else f"{row.memory_mb:.0f} MB",
    ]


def _provenance(rows: Sequence[BenchmarkResult]) -> str:
    first = next((r for r in rows if r.status == MEASURED), rows[0])
    what, machine = first.identity, first.machine
    allowed = ", ".join(f"{v:g}" for v in sorted(_minutes_allowed(rows)))
    return _prose(
        f"Errors over {TASKS[what.task].over}. {what.data.get('points')} points, "
        f"{what.data.get('train')} training and {what.data.get('test')} test samples; "
        f"data {str(what.data.get('hash'))[:12]}, split {what.split.get('name')} "
        f"{str(what.split.get('hash'))[:12]}. "
        + (f"Networks may train {allowed} processor minutes. " if allowed else "")
        + f"{machine.get('cores')} cores, {machine.get('threads')} threads for networks"
        + (f", load average {load:.1f}" if (load := machine.get("load")) else "")
        + "; "
        + ", ".join(f"{name} {value}" for name, value in first.versions.items())
        + "."
    )


def _not_run(run: set[str]) -> Iterator[str]:
    for name in TASKS:
        if name not in run:
            yield _prose(f"- {name}: there are no results of it.", "  ")


def _prose(text: str, indent: str = "") -> str:
    # A line that begins with + is a bullet: it stays with the word before it.
    whole = textwrap.fill(
        text.replace(" + ", "\N{NO-BREAK SPACE}+ "), WIDTH, subsequent_indent=indent,
        break_on_hyphens=False, break_long_words=False,
    )  # fmt: skip
    return whole.replace("\N{NO-BREAK SPACE}", " ")
