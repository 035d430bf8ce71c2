"""A result is a file that is whole, says what it follows from, and draws the page."""

import gc
import json
import mmap
import platform
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from physgnn.errors import InputError
from physgnn.evaluation.benchmark.chart import draw_benchmark
from physgnn.evaluation.benchmark.methods import (
    SHIFTS_ONLY,
    Method,
    method_names,
    named_methods,
)
from physgnn.evaluation.benchmark.peak_memory import PeakMemory
from physgnn.evaluation.benchmark.result import (
    BenchmarkResult,
    Errors,
    Identity,
    read_results,
)
from physgnn.evaluation.benchmark.table import (
    _prose,
    by_task,
    page,
)
from physgnn.evaluation.benchmark.tasks import TASKS, named_tasks
from physgnn.evaluation.measure.distribution import Distribution
from physgnn.learning.models import MODELS


def identity(method: str, task: str = "dataset-2-paths") -> Identity:
    return Identity(
        task=task,
        version=TASKS[task].version,
        size="tiny",
        method=method,
        options={},
        origin="",
        data={"hash": "d" * 64, "points": 800, "train": 56, "test": 8},
        split={"name": "path", "hash": "s" * 64},
        seed=0,
        processor_minutes=0.1,
    )


def result(method: str, mean: float, **fields: Any) -> BenchmarkResult:
    errors = Distribution(mean, mean, mean, 2 * mean, 3 * mean, 9 * mean, 0.9)
    tumour = Distribution(7.0, 0.0, 7.0, 7.0, 7.0, 7.0, 0.0)
    return BenchmarkResult(
        identity(method, fields.pop("task", "dataset-2-paths")),
        "measured",
        errors=Errors(errors, errors, tumour, 5 * mean, 0.1, 8),
        processor_minutes=0.1,
        milliseconds=2.0,
        memory_mb=12.0,
        versions={"physgnn": "0.1.0"},
        machine={"cores": 2, "threads": 1},
        **fields,
    )


def one_line(text: str) -> str:
    return " ".join(text.split())


def test_it_comes_back_from_its_file_as_it_was(tmp_path: Path) -> None:
    made = result("physgnn", 0.3, curve=((0.05, 1.0), (0.1, 0.4)))
    file = made.write(tmp_path)
    assert file == made.identity.file(tmp_path)
    assert BenchmarkResult.read(file) == made
    assert read_results(tmp_path) == [made]


def test_every_part_of_what_it_follows_from_has_another_key() -> None:
    one = identity("lifted")
    others = [
        replace(one, method="physgnn"),
        replace(one, task="dataset-1-paths"),
        replace(one, version=one.version + 1),
        replace(one, size="full"),
        replace(one, options={"width": 3}),
        replace(one, origin="x"),
        replace(one, data={**one.data, "hash": "e"}),
        replace(one, split={**one.split, "hash": "e"}),
        replace(one, seed=1),
        replace(one, processor_minutes=0.2),
    ]
    assert len({one.key, *(other.key for other in others)}) == 1 + len(others)
    assert replace(one).key == one.key


def test_a_name_from_outside_stays_inside_the_folder(tmp_path: Path) -> None:
    file = identity("../../my.module:Class").file(tmp_path)
    assert file.parent == tmp_path / "dataset-2-paths-tiny"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: {**r, "format": "other"}, "expected physgnn-benchmark version 1"),
        (lambda r: {**r, "version": 9}, "version 9"),
        (lambda r: {**r, "extra": 1}, "no field 'extra'"),
        (lambda r: {**r, "errors": None}, "must say so by its errors"),
        (lambda r: {**r, "status": "splendid"}, "status"),
        (lambda r: {**r, "milliseconds": "soon"}, "milliseconds"),
        (lambda r: {**r, "milliseconds": float("nan")}, "finite"),
        (lambda r: {**r, "curve": [[1.0]]}, "curve"),
        (lambda r: [r], "cannot be read"),
    ],
)
def test_a_file_that_is_no_result_is_named(
    tmp_path: Path, change: Any, message: str
) -> None:
    file = result("linear", 0.2).write(tmp_path)
    file.write_text(json.dumps(change(json.loads(file.read_text()))))
    with pytest.raises(InputError, match=message) as error:
        read_results(tmp_path)
    assert str(file) in str(error.value)
    file.write_bytes(b'{"format": "phys')
    with pytest.raises(InputError, match=r"cannot be read.*"):
        BenchmarkResult.read(file)


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(InputError, match="holds no results"):
            read_results(folder)


def test_the_page_says_first_where_networks_lose() -> None:
    curve = ((0.1, 0.4),)
    rows = [
        result("linear", 0.2),
        result("reduced", 0.01),
        result("physgnn", 0.3, curve=curve),
        result("lifted", 0.1, curve=curve),
        result("mlp", 0.5),
        result("svr", 0.6),  # no network
        result("repaired", 0.3, curve=curve),
        BenchmarkResult(identity("gpr"), "failed", reason="it burst"),
    ]
    text = page(rows, "benchmark.svg", "physgnn benchmark --report r -o p")
    loses, tables = text.split("## dataset-2-paths")
    assert "behind the linear solution (0.200 mm): PhysGNN (0.300)" in one_line(loses)
    behind = one_line(loses.split("behind the reduced model")[1])
    assert "PhysGNN (0.300)" in behind
    assert "Network per node (0.500)" in behind
    assert "Repaired" not in behind
    assert "Support" not in behind
    assert "Lifted network (0.100)" in behind
    order = [
        line.split("|")[1].strip() for line in tables.splitlines() if "ms |" in line
    ]
    assert order == [
        "Reduced model", "Lifted network", "Linear solution", "PhysGNN", "Repaired",
        "Network per node", "Support vector regression",
    ]  # fmt: skip
    assert "Gaussian process: failed, it burst." in tables
    for task in TASKS:
        assert (f"- {task}: " in tables) == (task != "dataset-2-paths")
    assert all(len(x) <= 120 or x.startswith("|") for x in text.splitlines())


def test_errors_over_the_tumour_rank_the_methods_of_tonutti() -> None:
    text = page([result("linear", 0.2, task="tonutti-2017")], "c.svg", "x")
    row = next(line for line in text.splitlines() if "| Linear solution" in line)
    assert row.split("|")[2].strip() == "7.00"
    assert "0.191 ± 0.201 mm" in text


def test_results_of_another_version_of_a_task_are_left_out() -> None:
    old = result("linear", 0.2)
    old = replace(old, identity=replace(old.identity, version=99))
    assert by_task([old]) == {}


def test_the_same_results_draw_the_same_figure(tmp_path: Path) -> None:
    rows = [result("linear", 0.2), result("lifted", 0.1, curve=((0.1, 0.4),))]
    files = tmp_path / "a.svg", tmp_path / "b.svg"
    for file in files:
        draw_benchmark(rows, file)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert b"<svg" in files[0].read_bytes()


def test_every_row_of_models_is_a_method_once() -> None:
    names = method_names()
    assert len(names) == len(set(names))
    assert set(names) == {*MODELS, "repaired", *SHIFTS_ONLY} - {"finite-element"}
    for name in names:
        for task in TASKS:
            for size in ("tiny", "full"):
                assert Method.of(name, task, size).options is not None


def test_the_methods_of_the_field_are_there() -> None:
    wanted = {
        "zero", "linear", "interpolation", "linear-regression", "decision-tree",
        "random-forest", "extra-trees", "svr", "gpr", "mlp", "pod-network", "rbf",
        "cnn", "meshgraphnet", "transolver", "physgnn", "lifted", "reduced", "galerkin",
        "repaired", "rigid", "spline", "register",
    }  # fmt: skip
    assert wanted == set(method_names())


def test_what_does_not_apply_is_named_once_a_reason() -> None:
    rows = [result("linear", 0.2)] + [
        BenchmarkResult(identity(name), "not applicable", reason=why)
        for name, why in (("svr", "too late"), ("gpr", "too late"), ("rbf", "too far"))
    ]
    text = one_line(page(rows, "c.svg", "x"))
    late = "too late: Support vector regression, Gaussian process."
    assert f"- Not applicable, {late} - Not applicable, too far: Radial" in text


def test_who_was_told_more_is_said_where_loads_are_given() -> None:
    for task, said in (("dataset-2-paths", True), ("registration-surface", False)):
        text = one_line(page([result("cnn", 0.2, task=task)], "c.svg", "x"))
        assert ("Convolutional network is told how the surface" in text) == said


def test_trivial_methods_are_always_beside() -> None:
    assert named_methods("lifted, svr") == ("zero", "linear", "lifted", "svr")
    assert named_methods("linear") == ("zero", "linear")
    assert named_methods("all") == method_names()


@pytest.mark.parametrize(
    "name", ["magic", "finite-element", "lifted,", "nowhere_at_all:Method"]
)
def test_what_is_no_method_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=r"no method|cannot be imported"):
        named_methods(name)


def test_what_is_no_task_is_refused() -> None:
    assert named_tasks("all") == tuple(TASKS)
    with pytest.raises(InputError, match="no task 'magic'"):
        named_tasks("magic")


def test_memory_taken_and_given_back_is_seen() -> None:
    # From the system itself: NumPy's allocator may take memory that is at hand.
    gc.collect()
    with PeakMemory() as memory, mmap.mmap(-1, 64_000_000) as block:
        block.write(b"1" * len(block))
        end = time.monotonic() + 60
        while memory.mb <= 50 and time.monotonic() < end:
            time.sleep(0.02)
    assert 50 < memory.mb < 1000


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="others keep nothing")
def test_memory_that_was_freed_before_counts_when_it_is_used_again() -> None:
    blocks = [bytearray(100_000) for _ in range(700)]  # too small for a map of its own
    kept = blocks[-1]  # ends the heap, so that the rest stays with the C library
    del blocks
    with PeakMemory() as memory:
        again = [bytearray(100_000) for _ in range(700)]
        end = time.monotonic() + 60
        while memory.mb <= 50 and time.monotonic() < end:
            time.sleep(0.02)
    assert len(kept) == len(again[0])
    assert 50 < memory.mb < 1000


def test_no_line_of_the_page_begins_with_a_plus_a_bullet() -> None:
    for length in range(200):
        text = f"- {'m' * length} POD + small network (1.08), Transolver (1.18)"
        lines = _prose(text, "  ").splitlines()
        assert not any(line.lstrip().startswith("+") for line in lines)
        assert " ".join(line.strip() for line in lines) == text


def test_the_page_says_the_command_with_the_minutes_that_networks_had() -> None:
    rows = [result("lifted", 0.1), result("physgnn", 0.2)]
    command = "physgnn benchmark --task dataset-2-paths --method all --size tiny"
    assert f"{command} -o results/" in page(rows, "c.svg", "")
    rows = [
        replace(row, identity=replace(row.identity, processor_minutes=2.5))
        for row in rows
    ]
    assert f"{command} --minutes 2.5 -o results/" in page(rows, "c.svg", "")
    assert "Networks may train 2.5 processor minutes" in one_line(page(rows, "", ""))
    none = [replace(row, status="not applicable", errors=None) for row in rows]
    assert f"{command} -o results/" in page(none, "c.svg", "")
    assert "Networks may train" not in one_line(page(none, "", ""))
