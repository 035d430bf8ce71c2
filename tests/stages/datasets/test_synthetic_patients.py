"""The family's meshes: kept when they are there, replaced when they can't be made."""

from pathlib import Path

import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.synthetic.anatomies import Anatomy
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh
from physgnn.stages.datasets import synthetic_patients
from physgnn.stages.datasets.synthetic_patients import anatomies


def odd_fail(anatomy: Anatomy) -> TetMesh:
    if anatomy.seed % 2:
        raise InputError("the tumour reaches the cortex")
    return block_mesh(1, side=1.0 + anatomy.seed)


def test_patients_that_cannot_be_meshed_are_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(synthetic_patients, "build_anatomy", odd_fail)
    made = anatomies(tmp_path / "family", count=3, seed=4)
    assert [path.stem for path in made] == ["anatomy-004", "anatomy-006", "anatomy-008"]
    assert read_mesh(made[0]).points.max() == 5.0
    before = made[0].stat().st_mtime_ns
    assert anatomies(tmp_path / "family", count=3, seed=4) == made
    assert made[0].stat().st_mtime_ns == before


def test_too_many_failures_and_no_count_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: Anatomy) -> TetMesh:
        raise InputError("the tumour reaches the cortex")

    monkeypatch.setattr(synthetic_patients, "build_anatomy", fail)
    with pytest.raises(InputError, match=r"only 0 of 2 .* reaches the cortex"):
        anatomies(tmp_path, count=2)
    with pytest.raises(InputError, match="count must be"):
        anatomies(tmp_path, count=0)
