"""A dataset that nobody can mean is refused before it is drawn, with its size."""

from pathlib import Path

import pytest

from physgnn.config import read_preset
from physgnn.dataset.size_bound import VARIABLE, check_dataset_size
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh


def test_the_published_sets_are_small() -> None:
    check_dataset_size(165, 30, 9118)
    check_dataset_size(2000, 30, 80_000)


@pytest.mark.parametrize(
    ("paths", "levels"), [(100_000_000, 10), (100, 10**12), (10**400, 1)]
)
def test_too_large(tmp_path: Path, block: TetMesh, paths: int, levels: int) -> None:
    loads = tmp_path / "loads.toml"
    loads.write_text(
        f"[loads]\ntotal_force_n = 1.0\npaths = {paths}\nlevels = {levels}"
    )
    with pytest.raises(InputError, match=rf"would take .* GB.* set {VARIABLE}="):
        read_preset(loads).on(block)


def test_the_user_can_raise_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "1e6")
    check_dataset_size(10**8, 10, 100)
    for text in ("many", "-1", "nan", "inf"):
        monkeypatch.setenv(VARIABLE, text)
        with pytest.raises(InputError, match=f"{VARIABLE} must be a number"):
            check_dataset_size(1, 1, 1)


@pytest.mark.parametrize(
    "line", ["paths = 1e2", "paths = true", "levels = 2.0", "total_force_n = inf"]
)
def test_numbers_of_another_kind(tmp_path: Path, line: str) -> None:
    loads = tmp_path / "loads.toml"
    force = "" if "force" in line else "total_force_n = 1.0\n"
    loads.write_text(f"[loads]\n{force}{line}")
    key = line.split()[0]
    with pytest.raises(InputError, match=f"{key} in .* must be (int|a finite number)"):
        read_preset(loads)
