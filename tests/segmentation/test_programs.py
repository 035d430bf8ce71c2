"""Programs on the PATH are called as their pages say, and what they write is read.

None of them is here: a script that checks its arguments stands in for each.
"""

from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.segmentation.backends import chosen
from physgnn.segmentation.backends.programs import FLUID_OUTSIDE

CALLS = {
    "mri_synthstrip": ("-i scan.nii.gz -m out.nii.gz", "out.nii.gz"),
    "mri_synthseg": ("--i scan.nii.gz --o out.nii.gz --robust --cpu", "out.nii.gz"),
    "hd-bet": (
        "-i scan.nii.gz -o out.nii.gz -device cpu --disable_tta --save_bet_mask "
        "--no_bet_image",
        "out_bet.nii.gz",
    ),
}


def stand_in(folder: Path, name: str, script: str) -> None:
    program = folder / name
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    return tmp_path


def scan() -> Image:
    """A scan that is its own mask: the stand-ins write what they get."""
    data = np.zeros((12, 10, 8), np.float32)
    data[3:9, 2:8, 2:6] = 3.0
    data[3, 2:8, 2:6] = FLUID_OUTSIDE
    return Image(data, np.diag([2.0, 2.0, 2.0, 1.0]))


@pytest.mark.parametrize("name", CALLS)
def test_a_program_gets_its_arguments_and_its_mask_is_read(
    name: str, path: Path
) -> None:
    arguments, writes = CALLS[name]
    wrong = 'echo "arguments: $*" >&2; exit 3'
    stand_in(
        path,
        name,
        f'[ "$*" = "{arguments}" ] || {{ {wrong}; }}\ncp scan.nii.gz {writes}',
    )
    _, backend = chosen(name, "flair")
    image = scan()
    inside = (image.data != 0) & (image.data != FLUID_OUTSIDE)
    np.testing.assert_array_equal(backend.brain(image), inside)


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("echo out of memory >&2; exit 3", r"exit code 3 \(out of memory\)"),
        ("exit 0", "wrote no mask"),
    ],
)
def test_a_program_that_fails_is_one_line(
    script: str, message: str, path: Path
) -> None:
    stand_in(path, "mri_synthstrip", script)
    _, backend = chosen("mri_synthstrip", "t2")
    with pytest.raises(InputError, match=message) as caught:
        backend.brain(scan())
    assert "\n" not in str(caught.value) and "--backend" in str(caught.value)
