"""Wherever an image is read, the user can say which place of its header is meant."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import nibabel as nib
import numpy as np
import pytest

from physgnn import stages
from physgnn.errors import InputError
from physgnn.progress import no_log

READERS: dict[str, Callable[..., Any]] = {
    "predict": lambda image, **given: stages.predict(
        None, image.with_name("no.json"), image.with_name("u.nii.gz"),
        image=image, **given,
    ),
    "register": lambda image, **given: stages.register(
        image.with_name("no.vtu"), image.with_name("u.nii.gz"),
        points=image.with_name("no.csv"), image=image, **given,
    ),
    "view": lambda image, **given: stages.view(
        image.with_name("no.json"), port=0, image=image, log=no_log, **given
    ),
}  # fmt: skip


@pytest.fixture
def disagreeing(tmp_path: Path) -> Path:
    image = nib.Nifti1Image(np.zeros((8, 8, 8), np.float32), np.eye(4) * 2)
    image.set_qform(np.diag([2.0, 2.0, 2.0, 1.0]), 1)
    shifted = np.diag([2.0, 2.0, 2.0, 1.0])
    shifted[:3, 3] = 30.0
    image.set_sform(shifted, 1)
    nib.save(image, tmp_path / "t1.nii.gz")
    return tmp_path / "t1.nii.gz"


@pytest.mark.parametrize("name", READERS)
def test_two_places_are_refused_until_one_is_named(
    disagreeing: Path, name: str
) -> None:
    read = READERS[name]
    with pytest.raises(InputError, match="sform and qform must agree"):
        read(disagreeing)
    for form in ("sform", "qform"):  # goes on to the next file, which is missing
        with pytest.raises(InputError, match=r"no\.(json|vtu|csv)"):
            read(disagreeing, affine=form)


def test_every_stage_that_reads_an_image_takes_the_option() -> None:
    for name in stages.__all__:
        stage = getattr(stages, name)
        given = inspect.signature(stage).parameters if callable(stage) else {}
        assert "image" not in given or "affine" in given, name
