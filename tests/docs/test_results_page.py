"""The page of the benchmark is what its command makes of the results beside it."""

from pathlib import Path

from documented_pages import DOCS
from physgnn.evaluation.benchmark.result import read_results
from physgnn.stages.experiments.benchmark.benchmarking import benchmark

RESULTS = DOCS / "results"


def test_the_page_follows_from_the_files(tmp_path: Path) -> None:
    drawn = benchmark(tmp_path, report=RESULTS / "benchmark").page
    assert drawn is not None
    page = (RESULTS / "benchmark.md").read_text("utf-8")
    assert drawn.read_text("utf-8") == page, (
        "run: physgnn benchmark --report docs/results/benchmark -o docs/results"
    )


def test_no_method_failed() -> None:
    found = read_results(RESULTS / "benchmark")
    assert not [r.identity.method for r in found if r.status == "failed"]
