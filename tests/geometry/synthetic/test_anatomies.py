"""Synthetic patients: drawn alike by the same seed, never folded, fit to be loaded."""

from dataclasses import replace

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_surface
from physgnn.geometry.synthetic.anatomies import _changed, build_anatomy, draw_anatomy

pytest.importorskip("tetgen", reason="meshing needs tetgen")


def test_a_seed_is_a_patient() -> None:
    assert draw_anatomy(3) == draw_anatomy(3)
    assert draw_anatomy(3) != draw_anatomy(4)


@pytest.mark.parametrize("seed", range(40))
def test_no_patient_is_folded(seed: int) -> None:
    anatomy = draw_anatomy(seed)
    grid = np.stack(np.meshgrid(*[np.arange(-80.0, 81.0, 8.0)] * 3), -1).reshape(-1, 3)
    h = 1e-3
    steps = np.concatenate([grid, *(grid + h * axis for axis in np.eye(3))])
    moved = _changed(steps, anatomy, np.random.default_rng(1))
    here, *ahead = moved.reshape(4, -1, 3)
    jacobian = np.stack([(one - here) / h for one in ahead], axis=-1)
    assert np.linalg.det(jacobian).min() > 0


def test_bends_that_may_fold_are_refused() -> None:
    with pytest.raises(InputError, match="may fold"):
        replace(draw_anatomy(0), bends_mm=20.0, bend_width_mm=30.0)


def test_a_patient_has_a_tumour_a_craniotomy_and_a_skull() -> None:
    anatomy = replace(draw_anatomy(2), surface_points=450, points=2000)
    mesh = build_anatomy(anatomy)
    surface = np.unique(boundary_surface(mesh).faces)
    fixed, loaded = mesh.point_set("fixed"), mesh.point_set("loaded")
    assert set(np.unique(mesh.region)) == {0, 1}
    assert len(np.intersect1d(fixed, loaded)) == 0
    assert np.isin(np.concatenate([fixed, loaded]), surface).all()
    assert len(loaded) > 10
    assert abs(len(fixed) / len(surface) - anatomy.held) < 0.02
    tumour = mesh.cell_volumes[mesh.region == 1].sum()
    assert tumour == pytest.approx(4 / 3 * np.pi * anatomy.tumour_radius_mm**3, rel=0.1)
