"""What a command reads is there afterwards."""

import inspect
from pathlib import Path

import pytest

from physgnn.cli.app import MODULES
from physgnn.cli.outputs import WRITTEN, check_apart, guarded
from physgnn.errors import InputError
from physgnn.io.medical.images.formats import named_like

READ = {
    "brain", "brain_mask", "case", "config", "craniotomy", "curves", "data",
    "dataset_1", "dataset_2", "golden", "image", "initial_transform", "landmarks",
    "landmarks_target", "load", "loads", "materials", "mesh", "path", "patients",
    "points", "prediction", "run", "runs", "scan", "segmentation", "sets", "source",
    "sources", "start", "store", "surface", "target", "tumour", "ventricles", "weights",
    "whole_surface",
}  # fmt: skip
EITHER = {"series"}  # of export a file to write, of warp and mesh a UID


def test_every_path_of_every_command_is_known_to_be_read_or_written() -> None:
    named = {
        parameter.name
        for module in MODULES
        for function in vars(module).values()
        if inspect.isfunction(function) and function.__module__ == module.__name__
        for parameter in inspect.signature(function).parameters.values()
        if "Path" in str(parameter.annotation) and function.__name__[0] != "_"
    }
    assert named == READ | set(WRITTEN) | EITHER


@pytest.mark.parametrize("link", [False, True])
def test_an_output_that_is_an_input_is_refused_before_any_work(
    tmp_path: Path, link: bool
) -> None:
    scan = tmp_path / "scan.nii"
    scan.write_text("kept")
    out = tmp_path / "link.nii" if link else tmp_path / "." / "scan.nii"
    if link:
        out.symlink_to(scan)

    @guarded
    def command(scan: Path, out: Path) -> None:
        out.write_text(scan.read_text() and "lost")

    with pytest.raises(InputError, match=r"--out .* over scan, the same file"):
        command(scan, out=out)
    assert scan.read_text() == "kept"
    command(scan, out=tmp_path / "other.nii")


def test_two_outputs_must_be_two_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"--jacobian .* over --out"):
        check_apart({"out": tmp_path / "a.nii", "jacobian": tmp_path / "a.nii"})
    with pytest.raises(InputError, match="--field"):
        check_apart({"points": tmp_path, "field": [tmp_path / "b.h5", tmp_path]})


def test_a_folder_beside_and_files_not_yet_there_are_no_trouble(tmp_path: Path) -> None:
    check_apart({"case": tmp_path / "none.vtu", "out": tmp_path / "none.vtu"})
    check_apart({"runs": [tmp_path], "out": tmp_path / "evaluation", "image": None})


def test_a_result_named_without_suffix_is_not_the_image_either(tmp_path: Path) -> None:
    image = tmp_path / "t1.nii.gz"
    with pytest.raises(InputError, match="over the image it is made of"):
        named_like(tmp_path / "t1", image)
    assert named_like(tmp_path / "t2", image).name == "t2.nii.gz"
