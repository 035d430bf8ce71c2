"""Every method on the same tasks: results in files, and a page drawn from them."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.progress import Log, Show, no_log, no_show
from physgnn.stages.experiments.benchmark.benchmark_data import (
    NotAtHandError,
    task_data,
)
from physgnn.stages.outputs import Output, writes

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.evaluation.benchmark.job import MethodOnTask, TaskData
    from physgnn.evaluation.benchmark.result import BenchmarkResult
    from physgnn.evaluation.benchmark.shift_data import ShiftData

DATA, RUNS = "data", "runs"  # beside the tasks' folders of results
PAGE, CHART = "benchmark.md", "benchmark.svg"


@dataclass
class BenchmarkOutcome:
    """What a benchmark did.

    Attributes
    ----------
    results : list of BenchmarkResult
        Of every method on every task that was run, those that were there included.
    not_run : mapping of task to reason
        Tasks whose data are not at hand.
    page : path or None
        The page that was drawn.
    """

    results: "list[BenchmarkResult]" = field(default_factory=list)
    not_run: dict[str, str] = field(default_factory=dict)
    page: Path | None = None

    @property
    def failed(self) -> "list[BenchmarkResult]":
        """The results of methods that failed."""
        return [result for result in self.results if result.status == "failed"]

    @property
    def of_no_use(self) -> list[str]:
        """Methods that apply to none of the tasks, by their names."""
        useful = {r.identity.method for r in self.results if r.status == "measured"}
        names = dict.fromkeys(result.identity.method for result in self.results)
        failed = {result.identity.method for result in self.failed}
        return [name for name in names if name not in useful | failed]

    def __str__(self) -> str:
        """Return what there is to say of it, a line each."""
        lines = [_line(result) for result in self.results]
        lines += [f"{task}: not run, {why}" for task, why in self.not_run.items()]
        return "\n".join([*lines, *([str(self.page)] if self.page else [])])


@writes(out=Output(is_folder=True, inside=("data", "report")))
def benchmark(
    out: str | Path,
    *,
    task: str = "all",
    method: str = "all",
    size: str = "tiny",
    data: str | Path | None = None,
    minutes: float | None = None,
    seed: int = 0,
    report: str | Path | None = None,
    show: Show = no_show,
    log: Log = no_log,
) -> BenchmarkOutcome:
    """Measure methods on tasks, a file a result; a second call does what is missing.

    A method that fails is named, and the others go on. The next call tries it again.

    Parameters
    ----------
    out : path
        Gets a folder of results for each task, ``data/`` and ``runs/``; with `report`,
        the page benchmark.md and its figure benchmark.svg.
    task : str
        A row of `physgnn.evaluation.benchmark.tasks.TASKS`, or ``all``.
    method : str
        A row of ``MODELS``, ``repaired``, ``rigid``, ``spline``, ``register``, names
        with commas, ``all``, or ``module:Class`` of one's own. ``zero`` and ``linear``
        are always among them.
    size : str
        ``tiny``: the bundled brain with few load paths; ``full``: the tasks' own data.
    data : path, optional
        The folder of data that size ``full`` needs. Tasks whose data are not there are
        named, not run.
    minutes : float, optional
        Processor minutes that every network may train; by default 0.1 or, of size
        ``full``, 30.
    seed : int
        Of whatever a method draws.
    report : path, optional
        A folder of results: draw the page of them, and measure nothing.
    show, log : callables
        See `physgnn.stages.experiments.pipeline.Pipeline`.

    Returns
    -------
    BenchmarkOutcome
        Results, tasks that were not run, and the page.

    Raises
    ------
    InputError
        If there is no such task, method or size, a dataset is another than the task's,
        or of no task the data are at hand.
    """
    if report is not None:
        return _drawn(Path(report), Path(out))
    from physgnn.evaluation.benchmark.methods import MINUTES, named_methods, trains
    from physgnn.evaluation.benchmark.tasks import SIZES, named_tasks

    if size not in SIZES:
        raise InputError(f"size must be one of {', '.join(SIZES)} (got {size})")
    if size == "tiny" and data is not None:
        raise InputError("--data is for size full: tiny tasks make their own data")
    allowed = MINUTES[size] if minutes is None else minutes
    if not 0 < allowed < float("inf"):
        raise InputError(f"minutes must be > 0 (got {minutes})")
    if seed < 0:
        raise InputError(f"seed must be ≥ 0 (got {seed})")
    tasks, methods = named_tasks(task), named_methods(method)
    if minutes is not None and not any(map(trains, methods)):
        raise InputError(
            f"--minutes is how long networks train: {method} has none: leave it out"
        )
    folder, outcome = Path(out), BenchmarkOutcome()
    given = None if data is None else Path(data)
    for name in tasks:
        try:
            with show(f"data of {name}") as progress:
                of_task = task_data(name, size, folder / DATA, given, progress=progress)
        except NotAtHandError as error:
            outcome.not_run[name] = str(error)
            continue
        for job in _jobs(of_task, methods, allowed, seed, folder):
            outcome.results.append(_result(job, folder, show, log))
    if not outcome.results:
        reasons = "; ".join(f"{name}: {why}" for name, why in outcome.not_run.items())
        raise InputError(f"no task can be run: {reasons}")
    return outcome


def _jobs(
    data: "TaskData | ShiftData",
    methods: tuple[str, ...],
    minutes: float,
    seed: int,
    folder: Path,
) -> "list[MethodOnTask]":
    from physgnn.evaluation.benchmark.job import MethodOnTask
    from physgnn.evaluation.benchmark.methods import Method

    return [
        MethodOnTask(
            Method.of(name, data.task, data.size), data, minutes, seed, folder / RUNS
        )
        for name in methods
    ]


def _result(
    job: "MethodOnTask", folder: Path, show: Show, log: Log
) -> "BenchmarkResult":
    """Return a result that is there, or make it."""
    from physgnn.evaluation.benchmark.result import BenchmarkResult
    from physgnn.evaluation.benchmark.running import run_job

    file = job.identity.file(folder)
    if file.exists() and (there := BenchmarkResult.read(file)).status != "failed":
        log(f"{file}: there already")
        return there
    with show(f"{job.data.task}, {job.method.name}") as progress:
        result = run_job(job, progress=progress)
    result.write(folder)
    return result


def _line(result: "BenchmarkResult") -> str:
    from physgnn.evaluation.benchmark.tasks import TASKS
    from physgnn.evaluation.report.formats import mm

    name = f"{result.identity.task}, {result.identity.method}"
    if result.errors is None:
        return f"{name}: {result.status}, {result.reason}"
    error = result.errors.over(TASKS[result.identity.task].over)
    return f"{name}: mean {mm(error.mean)} mm, largest {mm(error.largest)} mm"


def _drawn(results: Path, out: Path) -> BenchmarkOutcome:
    """Draw the page and the figure of a folder of results."""
    from physgnn.evaluation.benchmark.chart import draw_benchmark
    from physgnn.evaluation.benchmark.result import read_results
    from physgnn.evaluation.benchmark.table import page
    from physgnn.io.integrity.atomic import write_whole

    found = read_results(results)
    out.mkdir(parents=True, exist_ok=True)
    draw_benchmark(found, out / CHART)
    command = "physgnn benchmark --report results/ -o page/"
    write_whole(out / PAGE, page(found, CHART, command))
    return BenchmarkOutcome(page=out / PAGE)
