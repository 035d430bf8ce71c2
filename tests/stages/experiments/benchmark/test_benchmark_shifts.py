"""Simulated shifts are kept in files, and made anew for another body."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.evaluation.in_silico.cases import Case
from physgnn.geometry.measured import (
    BonePoints,
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.stages.experiments.benchmark.benchmark_shifts import _case


class Shifted:
    """Stands for a body whose shifts take long to simulate."""

    def __init__(self, side: float) -> None:
        self.mesh = block_mesh(1, side)
        self.simulated: list[int] = []

    def case(self, seed: int) -> Case:
        self.simulated.append(seed)
        rng = np.random.default_rng(seed)
        one, other = rng.normal(size=(2, 12, 3))
        faces = np.array([[0, 1, 2], [2, 1, 3]])
        return Case(
            PointPairs(one, other),
            SurfacePoints(other),
            rng.normal(size=self.mesh.points.shape),
            Landmarks(one[:2], other[:2]),
            WholeSurface(one, faces),
            BonePoints(one[:6], other[:6]),
        )


def arrays_of(case: Case) -> list[Any]:
    parts = [getattr(case, each.name) for each in fields(case)]
    return [
        value
        for part in parts
        for value in ([part] if isinstance(part, np.ndarray) else vars(part).values())
    ]


def test_a_shift_is_simulated_once_and_read_back_as_it_was(tmp_path: Path) -> None:
    body: Any = Shifted(10.0)
    made = _case(body, 3, tmp_path / "shifts")
    read = _case(body, 3, tmp_path / "shifts")
    assert body.simulated == [3]
    for one, other in zip(arrays_of(made), arrays_of(read), strict=True):
        np.testing.assert_array_equal(one, other)


def test_the_shift_of_another_body_is_made_anew(tmp_path: Path) -> None:
    body: Any = Shifted(10.0)
    other: Any = Shifted(11.0)
    _case(body, 3, tmp_path)
    _case(other, 3, tmp_path)
    assert other.simulated == [3]


def test_another_file_in_its_place_is_refused(tmp_path: Path) -> None:
    body: Any = Shifted(10.0)
    np.savez(tmp_path / "shift-003.npz", displacement=np.zeros((8, 3)))
    with pytest.raises(InputError, match=r"shift-003\.npz is no shift .*: delete it"):
        _case(body, 3, tmp_path)
    assert not body.simulated


def test_a_damaged_shift_says_what_makes_it_anew(tmp_path: Path) -> None:
    body: Any = Shifted(10.0)
    _case(body, 3, tmp_path)
    whole = (tmp_path / "shift-003.npz").read_bytes()
    (tmp_path / "shift-003.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match=r"shift-003\.npz .*delete it, and it is"):
        _case(body, 3, tmp_path)
