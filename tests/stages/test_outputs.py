"""What a stage reads is there afterwards, and what it writes can be written there."""

import inspect
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import physgnn
from physgnn import stages
from physgnn.errors import InputError
from physgnn.stages.outputs import FILE, FOLDER, Output, check_outputs, writes

READ = {
    "bone", "bone_target", "brain", "brain_mask", "case", "config", "craniotomy",
    "curves", "data", "dataset_1", "dataset_2", "golden", "image", "initial_transform",
    "intraoperative", "landmarks", "landmarks_target", "load", "loads", "materials",
    "membranes", "mesh", "path", "patients", "points", "prediction", "report", "run",
    "runs", "scan", "segmentation", "series", "sets", "source", "sources", "start",
    "store", "surface", "target", "tumour", "ventricles", "weights", "whole_surface",
}  # fmt: skip
WITHOUT = {"selftest"}  # stages that write nothing
SUFFIX = {"register": ".vtu", "predict": ".vtu"}


def parameters(stage: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    """The arguments that may be paths."""
    found = inspect.signature(stage).parameters
    return {name: p for name, p in found.items() if "Path" in str(p.annotation)}


def written(name: str) -> dict[str, Output]:
    return getattr(getattr(stages, name), "outputs", {})


def cases(*, is_folder: bool) -> list[tuple[str, str]]:
    return [
        (name, argument)
        for name in stages.__all__
        for argument, output in written(name).items()
        if output.is_folder == is_folder
    ]


def call(tmp_path: Path, name: str, argument: str, path: Path) -> None:
    """Call a stage with files of nonsense, so that whatever reads first complains."""
    stage, given = getattr(physgnn, name), {}
    for other, parameter in parameters(stage).items():
        output = written(name).get(other)
        if parameter.default is not inspect.Parameter.empty and output is None:
            continue
        file = tmp_path / f"{other}.nii"
        if output is None:
            file.write_text("nonsense")
        elif not output.is_folder:
            suffix = (*output.suffixes, SUFFIX.get(name, ".nii"))[0]
            file = tmp_path / "out" / f"{other}{suffix}"
        else:
            file = tmp_path / "out" / other
        given[other] = file
    (tmp_path / "out").mkdir()
    several = "Sequence" in str(parameters(stage)[argument].annotation)
    stage(**{**given, argument: [path] if several else path})


def test_every_path_of_every_stage_is_known_to_be_read_or_written() -> None:
    read = set()
    for name in stages.__all__:
        paths = set(parameters(getattr(stages, name)))
        assert bool(written(name)) != (name in WITHOUT), name
        assert set(written(name)) <= paths
        read |= paths - set(written(name))
    assert read == READ


@pytest.mark.parametrize(("name", "argument"), cases(is_folder=False))
def test_where_a_file_cannot_be_is_said_before_anything_is_read(
    tmp_path: Path, name: str, argument: str
) -> None:
    output = written(name)[argument]
    suffix = (*output.suffixes, SUFFIX.get(name, ".nii"))[0]
    folder = tmp_path / f"folder{suffix}"
    folder.mkdir()
    places = {
        folder: "must be a file .* a folder",
        tmp_path / "nowhere" / f"a{suffix}": "nowhere is not there: make it",
    }
    for place, says in places.items():
        (tmp_path / place.name).mkdir(exist_ok=True)
        with pytest.raises(InputError, match=says):
            call(tmp_path / place.name, name, argument, place)
        assert not any((tmp_path / place.name / "out").iterdir())


@pytest.mark.parametrize(("name", "argument"), cases(is_folder=False))
def test_a_suffix_that_is_not_written_is_said_before_anything_is_read(
    tmp_path: Path, name: str, argument: str
) -> None:
    with pytest.raises(InputError, match=r"a\.docx: .*written as .*\(got 'a\.docx'\)"):
        call(tmp_path, name, argument, tmp_path / "a.docx")


@pytest.mark.parametrize(("name", "argument"), cases(is_folder=True))
def test_a_file_in_the_place_of_a_folder_is_said_before_anything_is_read(
    tmp_path: Path, name: str, argument: str
) -> None:
    file = tmp_path / "ordinary_file"
    file.write_text("kept")
    for place in (file, file / "below"):
        (tmp_path / place.name).mkdir() if place != file else None
        where = tmp_path / ("a" if place == file else "b")
        where.mkdir()
        with pytest.raises(InputError, match=r"must be a folder .* is a file"):
            call(where, name, argument, place)
    assert file.read_text() == "kept"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written_to_is_refused_by_the_system_itself(
    tmp_path: Path,
) -> None:
    tmp_path.chmod(0o500)
    for output in (FILE, FOLDER):
        with pytest.raises(InputError, match="may not be written to"):
            check_outputs({"out": (tmp_path / "a",)}, {"out": output})


def test_a_folder_that_may_not_be_written_to_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)
    for output in (FILE, FOLDER):
        with pytest.raises(InputError, match="may not be written to"):
            check_outputs({"out": (tmp_path / "a",)}, {"out": output})


def test_a_device_is_no_file() -> None:
    with pytest.raises(InputError, match="device"):
        check_outputs({"out": (Path(os.devnull),)}, {"out": FILE})


@pytest.mark.parametrize("how", ["same", "dot", "link", "hard link", "no suffix"])
def test_python_callers_cannot_write_over_what_is_read(
    tmp_path: Path, how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scan, other = tmp_path / "t1.nii.gz", tmp_path / "other.nii.gz"
    scan.write_text("kept")
    out = {
        "same": scan,
        "dot": tmp_path / "." / "t1.nii.gz",
        "no suffix": tmp_path / "t1",
    }.get(how, other)
    if how == "link":
        other.symlink_to(scan)
    elif how == "hard link":
        other.hardlink_to(scan)
    with pytest.raises(InputError, match="would be written over"):
        physgnn.segment(str(scan), str(out))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="would be written over"):
        physgnn.segment("t1.nii.gz", out.name)
    assert scan.read_text() == "kept"


def test_a_result_without_suffix_is_no_other_input_either(tmp_path: Path) -> None:
    """`named_like` knows the image alone; the tumour's label map was lost."""
    for name in ("t1.nii.gz", "seg.nii.gz"):
        (tmp_path / name).write_text("kept")
    tumour = tmp_path / "seg.nii.gz"
    with pytest.raises(InputError, match="over tumour, the same file"):
        physgnn.segment(tmp_path / "t1.nii.gz", tmp_path / "seg", tumour=tumour)
    assert tumour.read_text() == "kept"


def test_no_result_lands_among_files_that_are_read_as_a_whole(tmp_path: Path) -> None:
    """A file more in a folder of DICOM, or in a dataset, is part of it."""
    scan = tmp_path / "dicom"
    scan.mkdir()
    with pytest.raises(InputError, match=r"among the files of scan, .*outside"):
        physgnn.segment(scan, scan / "seg.nii.gz")
    with pytest.raises(InputError, match="among the files of source"):
        physgnn.export(scan, series=scan / "deep" / "series")
    run = {"run": (scan,), "out": (scan / "out.vtu",)}
    check_outputs(run, {"out": Output(inside=("run",))})


def test_a_series_is_read_from_its_folder(tmp_path: Path) -> None:
    """FOLDER/UID is no path that is there; what is read is the folder."""
    series = tmp_path / "1.2.840.3"
    with pytest.raises(InputError, match="among the files of scan"):
        physgnn.segment(series, tmp_path / "seg.nii.gz")
    with pytest.raises(InputError, match="among the files of image"):
        check_outputs({"image": (series,), "out": (tmp_path / "w",)}, {"out": FOLDER})
    named = {"image": (tmp_path / "t1.nii",), "out": (tmp_path / "w.nii",)}
    check_outputs(named, {"out": FILE})


def test_the_picture_that_nobody_named_is_checked_as_well(tmp_path: Path) -> None:
    scan, out = tmp_path / "t1.nii", tmp_path / "seg.nii.gz"
    scan.write_text("nonsense")
    (tmp_path / "seg.png").mkdir()
    with pytest.raises(InputError, match=r"--picture must be a file .*seg\.png"):
        physgnn.segment(scan, out)
    points = tmp_path / "other.png"
    points.write_text("kept")
    with pytest.raises(InputError, match=r"other\.png would be written over tumour"):
        physgnn.segment(scan, tmp_path / "other", tumour=points)


def test_two_outputs_are_two_files_on_every_system(tmp_path: Path) -> None:
    outputs = {"out": FILE, "jacobian": FILE}
    a = tmp_path / "a.nii"
    for other in (a, tmp_path / "A.nii"):
        with pytest.raises(InputError, match=r"--jacobian .* over --out, the same"):
            check_outputs({"out": (a,), "jacobian": (other,)}, outputs)
    with pytest.raises(InputError, match=r"--out .* over --out"):
        check_outputs({"out": (a, a)}, {"out": FILE})
    check_outputs({"out": (a,), "jacobian": (tmp_path / "b.nii",)}, outputs)


def test_folders_beside_and_files_not_yet_there_are_no_trouble(tmp_path: Path) -> None:
    absent, out = tmp_path / "none.vtu", {"out": FILE}
    check_outputs({"case": (absent,), "out": (absent,)}, out)
    check_outputs({"case": (absent,), "out": (tmp_path / "new",)}, {"out": FOLDER})
    absent.touch()
    check_outputs({"case": (absent,), "out": (tmp_path,)}, {"out": FOLDER})


def test_a_stage_stays_what_it_is() -> None:
    def stage(out: str | Path, *, n: int = 1) -> int:
        """Do it."""
        return n if out else 0

    checked = writes(out=FILE)(stage)
    assert inspect.signature(checked) == inspect.signature(stage)
    assert (checked.__doc__, checked("a", n=3)) == (stage.__doc__, 3)
