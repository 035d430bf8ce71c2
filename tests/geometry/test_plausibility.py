import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.plausibility import (
    UNITS,
    check_millimetres,
    check_same_units,
    check_volume_ml,
    other_unit,
)

ADULT = 1.4e6  # mm³


@pytest.fixture
def sphere() -> np.ndarray:
    directions = np.random.default_rng(0).normal(size=(400, 3))
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    return 70.0 * unit + (5.0, -20.0, 15.0)


def test_an_adult_brain_passes_in_silence() -> None:
    assert check_volume_ml(ADULT, "brain") == []


@pytest.mark.parametrize(("volume_ml", "warned"), [(599, 1), (601, 0), (2250, 1)])
def test_unusual_brains_are_warned_of(volume_ml: float, warned: int) -> None:
    lines = check_volume_ml(volume_ml * 1000.0, "brain")
    assert len(lines) == warned
    assert all(f"{volume_ml} ml" in line for line in lines)


@pytest.mark.parametrize(("unit", "mm"), UNITS.items())
def test_a_brain_in_another_unit_is_refused_by_its_name(unit: str, mm: float) -> None:
    volume = ADULT / mm**3
    if 50e3 <= volume <= 2.5e6:  # inches: 85 ml, a newborn's brain
        assert check_volume_ml(volume, "brain")
        return
    with pytest.raises(InputError, match=rf"look like {unit}\): multiply .* {mm:g},"):
        check_volume_ml(volume, "brain")


@pytest.mark.parametrize(
    ("volume", "looks"), [(30e3, "a phantom"), (9e6, "the whole image")]
)
def test_other_sizes_need_to_be_meant(volume: float, looks: str) -> None:
    with pytest.raises(InputError, match=f"{looks}.*--any-size"):
        check_volume_ml(volume, "oedema")
    assert len(check_volume_ml(volume, "oedema", any_size=True)) == 1


def test_an_empty_volume_is_refused() -> None:
    with pytest.raises(InputError, match="50 to 2500 ml"):
        check_volume_ml(0.0, "brain")


@pytest.mark.parametrize(
    ("factor", "unit"), [(1e-3, "metres"), (1e3, "micrometres"), (0.0, "metres")]
)
def test_lengths_that_are_no_millimetres(
    sphere: np.ndarray, factor: float, unit: str
) -> None:
    check_millimetres(sphere, "brain")
    with pytest.raises(InputError, match=f"mm .*looks like {unit}"):
        check_millimetres(sphere * factor, "brain")


def test_places_that_files_round_or_do_not_know(sphere: np.ndarray) -> None:
    check_millimetres(sphere + 9e4, "brain")
    with pytest.raises(InputError, match=r"at most 100000 mm .*move it to the origin"):
        check_millimetres(sphere + 1e7, "brain")
    for wrong in (np.nan, np.inf):
        with pytest.raises(InputError, match="finite"):
            check_millimetres(np.vstack([sphere, np.full(3, wrong)]), "brain")


@pytest.mark.parametrize("unit", UNITS)
def test_measured_points_in_another_unit_are_refused(
    sphere: np.ndarray, unit: str
) -> None:
    patch = sphere[sphere[:, 2] > 60.0]
    shifted = patch - (0.0, 0.0, 15.0)
    check_same_units(shifted, sphere, "surface")
    with pytest.raises(InputError, match=unit):
        check_same_units(shifted / UNITS[unit], sphere, "surface")


def test_what_shrinks_to_a_point_is_in_no_other_unit(sphere: np.ndarray) -> None:
    """A body that reaches the origin is near to anything in micrometres."""
    body = sphere - sphere[0]
    check_same_units(body[sphere[:, 2] > 60.0] + (0.0, 0.0, 30.0), body, "surface")
    check_same_units(np.tile(body[:1] + 5.0, (10, 1)), body, "one point ten times")


@pytest.mark.parametrize(("unit", "mm"), UNITS.items())
def test_a_body_of_a_brain_s_size_in_another_unit_is_told(unit: str, mm: float) -> None:
    (line,) = other_unit(1.4e6 / mm**3, "case.vtu")
    assert unit in line
    assert f"multiply them by {mm:g}" in line
    assert other_unit(1.4e6, "case.vtu") == []
    assert other_unit(1e5, "phantom.vtu") == []
