"""The commands of the pages on plans, uncertainty and the cavity, run as shown."""

import json
import shlex
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import plan_files
from documented_pages import DOCS, blocks, command_lines
from meshes import block_mesh
from physgnn.cli import main
from physgnn.geometry.image import Image, LabelVolume
from physgnn.io import write_mesh, write_prediction
from physgnn.io.medical.images.formats import read_image, write_image
from physgnn.stages.patient.intraoperative.registration import register

BLOCK = block_mesh(4, side=80.0)
DEEP = np.abs(BLOCK.points[BLOCK.cells].mean(axis=1) - 40.0).max(axis=1) < 20.0
BODY = replace(BLOCK, region=DEEP.astype(np.int32))
TOP = BODY.points[BODY.point_set("loaded")]
AFFINE = np.diag([-4.0, 4.0, 4.0, 1.0])
AFFINE[:3, 3] = [90.0, -10.0, -10.0]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_mesh("case.vtu", BODY)
    # a dent: what moves as a whole is taken for an offset of the navigation
    depth = 6.0 * np.exp(-((TOP - [40.0, 40.0, 80.0]) ** 2).sum(1) / (2 * 25.0**2))
    down = TOP - depth[:, None] * [0.0, 0.0, 1.0]
    np.savetxt("measured.csv", np.hstack([TOP, down]), delimiter=",")
    register("case.vtu", "shift.vtu", points="measured.csv")
    for name, points in (("before", TOP), ("after", down)):
        controls = [
            {"label": str(i), "position": point}
            for i, point in enumerate(points.tolist())
        ]
        markup = {"coordinateSystem": "RAS", "controlPoints": controls}
        Path(f"{name}.mrk.json").write_text(json.dumps({"markups": [markup]}))
    data = np.zeros((25, 25, 25), np.int32)
    data[8:14, 9:15, 15:19] = 1
    for name in ("tumour", "cavity"):
        write_image(f"{name}.nii.gz", LabelVolume(data, AFFINE))
    write_image("t1.nii.gz", Image(data * 100.0, AFFINE))
    for name in ("plan", "biopsies"):
        plan_files.write_markups(Path(f"{name}.mrk.json"))
    for name in ("tumour", "cavity"):
        plan_files.write_stl(Path(f"{name}.stl"))
    plan_files.write_trk(Path("corticospinal.trk"))
    return tmp_path


@pytest.mark.parametrize("page", ["carry_plan", "uncertainty", "after_operation"])
@pytest.mark.usefixtures("folder")
def test_commands_of_the_page_run_and_write_what_they_say(
    page: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for block in blocks(DOCS / "howto" / f"{page}.md"):
        if block.language == "python":
            exec(compile(block.text, page, "exec"), {})
        if block.language != "bash":
            continue
        for words in command_lines(block):
            monkeypatch.setattr(sys, "argv", words)
            with pytest.raises(SystemExit) as end:
                main()
            assert end.value.code == 0, shlex.join(words)
            assert Path(words[words.index("-o") + 1]).stat().st_size > 100


def test_the_cavity_returns_to_where_it_was_cut(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Forward and back again is the same label map, but for its rim."""
    u = np.zeros_like(BODY.points)
    u[:, 2] = -6.0 * np.sin(np.pi * BODY.points[:, 2] / 80.0)
    write_prediction("shift.vtu", BODY, {"displacement_mm": u})
    for words in (
        "warp cavity.nii.gz shift.vtu --labels -o there.nii.gz",
        "warp there.nii.gz shift.vtu --back --labels -o back.nii.gz",
    ):
        monkeypatch.setattr(sys, "argv", ["physgnn", *words.split()])
        with pytest.raises(SystemExit) as end:
            main()
        assert end.value.code == 0
    before, there, back = (
        np.asarray(read_image(f"{name}.nii.gz").data) > 0
        for name in ("cavity", "there", "back")
    )

    def dice(other: np.ndarray) -> float:
        return float(2 * (before & other).sum() / (before.sum() + other.sum()))

    assert dice(back) > 0.9 > dice(there)
    assert (folder / "back.nii.gz").is_file()
