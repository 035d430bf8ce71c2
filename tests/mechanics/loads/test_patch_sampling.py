"""Pushes on patches: of every size in range, never harder on a node than allowed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.mechanics.loads.patch_sampling import (
    patch_load_fractions,
    patch_load_paths,
)
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import inward_normals

RANGES = {
    "radius_mm": (1.0, 40.0),
    "force_n": (1.0, 3.0),
    "nodal_force_n": 0.5,
    "cone_deg": 30.0,
}


def paths(n_paths: int = 40, **changes: object) -> list[LoadPath]:
    mesh = block_mesh(4)
    loaded = mesh.point_set("loaded")
    ranges = {**RANGES, **changes}
    return patch_load_paths(mesh, loaded, n_levels=5, n_paths=n_paths, **ranges)


@given(
    st.lists(st.floats(0.0, 3.0), min_size=1, max_size=30),
    st.floats(0.1, 2.0),
)
def test_fractions_add_up_and_fall_outwards(
    distances: list[float], step: float
) -> None:
    distance = np.sort(distances) * step
    fraction = patch_load_fractions(
        distance, np.tile([0.0, 0.0, 1.0], (len(distance), 1)), 0
    )
    assert fraction.sum() == pytest.approx(1.0)
    assert (np.diff(fraction) <= 0).all()
    assert (fraction[1:][distance[1:] >= 1] == 0).all()


def test_nodes_that_face_another_way_are_no_part_of_a_patch() -> None:
    normals = np.array([[0, 0, 1.0], [0, 0, -1.0], [0, 0.6, 0.8]])
    fraction = patch_load_fractions(np.zeros(3), normals, 0)
    np.testing.assert_allclose(fraction, [0.5, 0, 0.5])


def test_forces_stay_within_their_ranges() -> None:
    drawn = paths()
    sizes = [np.linalg.norm(path.forces, axis=1) for path in drawn]
    totals = np.array([size.sum() for size in sizes])
    assert max(size.max() for size in sizes) <= RANGES["nodal_force_n"] * (1 + 1e-12)
    assert totals.max() <= RANGES["force_n"][1] * (1 + 1e-12)
    gentle = totals < RANGES["force_n"][0]  # only where nodes carry all they may
    largest = [size.max() for size, few in zip(sizes, gentle, strict=True) if few]
    np.testing.assert_allclose(largest, RANGES["nodal_force_n"])
    assert len({len(path.nodes) for path in drawn}) > 3


def test_directions_are_within_the_cone() -> None:
    mesh = block_mesh(4)
    for path in paths(cone_deg=20.0):
        direction = path.forces.sum(axis=0) / np.linalg.norm(path.forces.sum(axis=0))
        cosine = inward_normals(mesh, path.nodes) @ direction
        assert cosine.max() >= np.cos(np.deg2rad(20.0)) - 1e-9


def test_the_seed_decides() -> None:
    one, same, other = paths(seed=1), paths(seed=1), paths(seed=2)
    np.testing.assert_array_equal(one[0].forces, same[0].forces)
    assert any(
        not np.array_equal(a.nodes, b.nodes) for a, b in zip(one, other, strict=True)
    )


@pytest.mark.parametrize(
    "wrong",
    [
        {"radius_mm": (0.0, 3.0)},
        {"radius_mm": (4.0, 3.0)},
        {"force_n": (-1.0, 3.0)},
        {"nodal_force_n": 0.0},
        {"cone_deg": 181.0},
    ],
)
def test_what_makes_no_sense_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        paths(**wrong)
