"""A run is evaluated on what it has not seen, into one self-contained report."""

import re
from collections import defaultdict
from dataclasses import asdict
from html.parser import HTMLParser
from pathlib import Path

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from physgnn.dataset.splits.samples import split_path, split_published
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.measure.result import Report
from physgnn.evaluation.report.page import report_html
from physgnn.evaluation.run_evaluation import Comparison, evaluate_run, evaluate_runs
from physgnn.learning.models import build_model
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.record import new_record, with_result
from physgnn.learning.training.config import TrainingConfig
from physgnn.prediction.error_bounds.run_calibration import calibrate_run

VOID = {"meta", "img", "source", "br", "hr", "link"}


class Tags(HTMLParser):
    """Collects tags and checks that each is closed by its own end."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[tuple[str, dict[str, str | None]]] = []
        self.text: dict[str, list[str]] = defaultdict(list)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_data(self, data: str) -> None:
        if self.open:
            self.text[self.open[-1]].append(data)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def untrained(store: Store, folder: Path, seed: int) -> Path:
    """A run folder of a network as it is before training."""
    split = split_path(store)
    config = TrainingConfig(options={"width": 8}, seed=seed)
    torch.manual_seed(seed)
    model = build_model(config.model, store.body, **config.options)
    model.fit(store, split.train)
    spent = {"wall": 0.7, "processor": 0.5}
    record = with_result(
        new_record([(store, split)], asdict(config)), loss=1.0, spent=spent
    )
    Checkpoint(model, record).save(folder)
    return folder


@pytest.fixture(scope="module")
def run(store: Store, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One of them, calibrated."""
    folder = untrained(store, tmp_path_factory.mktemp("run"), seed=0)
    calibrate_run(folder, store, split_path(store))
    return folder


@pytest.fixture(scope="module")
def report(run: Path, store: Store) -> Report:
    return evaluate_run(run, store.path, command="physgnn evaluate <run> & more")


@pytest.fixture(scope="module")
def page(run: Path, report: Report) -> str:
    assert report.split == "path"
    return (run / "evaluation-path" / "report.html").read_text("utf-8")


def test_what_it_writes(run: Path, report: Report, page: str) -> None:
    folder = run / "evaluation-path"
    assert Report.read(folder / "metrics.json") == report
    names = {path.name for path in folder.iterdir()}
    files = {"metrics.json", "error-bars.json", "report.html"}
    assert names == files | {"figures", "rows"}
    assert len(list((folder / "figures").glob("*.png"))) == 2 * page.count("<figure>")


def test_page_needs_nothing_else(page: str) -> None:
    text = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", page)
    assert not re.search(r"https?:|//[a-z]|<script|<link|@import|url\(", text)
    tags = Tags()
    tags.feed(page)
    assert tags.open == []
    sources = [a.get("src") or a.get("srcset") for _, a in tags.seen]
    used = [source for source in sources if source]
    assert len(used) >= 10
    assert all(source.startswith("data:image/png;base64,") for source in used)


def test_page_is_accessible(page: str) -> None:
    tags = Tags()
    tags.feed(page)
    assert ("html", {"lang": "en"}) in tags.seen
    assert all(attrs.get("alt") for tag, attrs in tags.seen if tag == "img")
    assert all(attrs.get("scope") for tag, attrs in tags.seen if tag == "th")
    assert [tag for tag, _ in tags.seen].count("h1") == 1


def test_page_says_what_the_report_says(page: str, report: Report) -> None:
    assert report.models[-1].name == "physgnn"
    assert "Published test set" in page
    assert "Whole load paths are held out" in page
    assert "physgnn evaluate &lt;run&gt; &amp; more" in page
    assert page.count("PhysGNN</th>") == 5


@settings(max_examples=30, deadline=None)
@given(st.text("<>&\"'{}%# ab/", min_size=1))
def test_whatever_a_fact_says_is_shown_and_never_run(report: Report, text: str) -> None:
    shown = Tags()
    shown.feed(report_html(report.with_facts(case={"said": text}), ()))
    assert shown.open == []
    assert text in shown.text["dd"]


def test_samples_of_the_training_set_are_refused(run: Path, store: Store) -> None:
    with pytest.raises(InputError, match="trained with split 'path', on"):
        evaluate_run(run, store.path, split_published(store))


def test_unknown_split_names_those_there_are(run: Path, store: Store) -> None:
    with pytest.raises(InputError, match="mesh, node, path, published"):
        evaluate_run(run, store.path, "random")


def test_seeds_of_one_model_are_one_row_beside_a_tolerance(
    run: Path, store: Store, tmp_path: Path
) -> None:
    other = untrained(store, tmp_path / "run-1", seed=1)
    comparison = Comparison("zero, pod_network", tolerance_mm=0.5)
    report = evaluate_runs(
        [run, other], store.path, comparison=comparison, out=tmp_path / "both"
    )
    kinds = [[(m.name, m.seed) for m in seeds] for seeds in report.groups]
    assert kinds == [
        [("zero", None)],
        [("pod-network", 0), ("pod-network", 1)],
        [("certified", 0)],
        [("physgnn", 0), ("physgnn", 1)],
    ]
    assert report.model("certified").tolerance_mm == 0.5
    assert report.model("physgnn").minutes == 0.5
    page = (tmp_path / "both" / "report.html").read_text("utf-8")
    assert "Repaired to 0.5 mm" in page
    assert "Predictions made to keep a tolerance" in page


def test_a_trained_mesh_is_not_an_unseen_one(run: Path, store: Store) -> None:
    with pytest.raises(InputError, match="trained on the mesh of"):
        evaluate_run(run, store.path, "mesh")
