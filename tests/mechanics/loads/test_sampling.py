"""Load paths: the published draws to the digit, and cones that keep their promises."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.sampling import (
    MATLAB_SEED,
    all_node_paths,
    by_position,
    cone_paths,
    further_all_node_paths,
    further_single_node_paths,
    inward_normals,
    single_node_paths,
    traction_paths,
    uniform_directions,
    within_cone,
)

DIRECTIONS_924 = [
    [-0.687056467756, 0.362973022423, -0.629447372786],
    [-0.371291346412, 0.451081313398, -0.811583874151],
]


def test_the_published_stream_of_directions() -> None:
    # MATLAB's rng(0) gives 0.8147, 0.9058, 0.1270, … as the first uniform doubles.
    random = np.random.RandomState(MATLAB_SEED)
    first = random.random_sample(3)
    np.testing.assert_allclose(first, [0.814723686393179, 0.905791937, 0.126986816])
    directions = uniform_directions(np.random.RandomState(MATLAB_SEED), 924)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
    np.testing.assert_allclose(
        directions[:2],
        DIRECTIONS_924,
        atol=1e-12,
    )


def test_inward_normals_point_into_the_block(block: TetMesh) -> None:
    top = block.point_set("loaded")
    inside = top[(block.points[top, :2] % 10 != 0).all(axis=1)]
    expected = np.tile([0.0, 0.0, -1.0], (len(inside), 1))
    np.testing.assert_allclose(inward_normals(block, inside), expected, atol=1e-15)


def test_single_node_paths(block: TetMesh) -> None:
    top = block.point_set("loaded")[:11]
    paths = single_node_paths(block, top, force_n=1.35, n_levels=30)
    assert len(paths) == 165
    assert all(len(path.nodes) == 1 for path in paths)
    nodes = [int(path.nodes[0]) for path in paths]
    assert nodes == np.repeat(by_position(block, top), 15).tolist()
    force = np.concatenate([path.forces for path in paths])
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), 1.35)
    np.testing.assert_array_equal(paths[0].load_factors, np.arange(1, 31) / 30)
    with pytest.raises(InputError, match="at most 11 nodes"):
        single_node_paths(block, block.point_set("loaded"), force_n=1.0, n_levels=3)


def test_all_node_paths(block: TetMesh) -> None:
    top = block.point_set("loaded")
    paths = all_node_paths(block, top, total_force_n=20.0, n_levels=30, n_paths=165)
    assert len(paths) == 165
    normals = inward_normals(block, paths[0].nodes)
    np.testing.assert_allclose(paths[0].forces, normals * 20 / len(top))
    for path in paths:
        assert np.linalg.norm(path.forces, axis=1).sum() == pytest.approx(20.0)
        assert (path.forces[:, 2] * normals[:, 2] >= 0).all()


def test_nodes_go_by_x_then_y_then_z(block: TetMesh) -> None:
    ordered = by_position(block, block.point_set("loaded")[::-1])
    rows = block.points[ordered].tolist()
    assert rows == sorted(rows)


@settings(max_examples=50, deadline=None)
@given(
    axis=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1),
    half_angle=st.floats(0, 180),
    seed=st.integers(0, 2**32),
)
def test_within_cone_stays_within(
    axis: tuple[float, float, float], half_angle: float, seed: int
) -> None:
    direction = within_cone(np.random.default_rng(seed), np.array(axis), half_angle)
    cosine = direction @ axis / np.linalg.norm(axis)
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    assert cosine >= np.cos(np.deg2rad(half_angle)) - 1e-9


def test_within_cone_is_uniform() -> None:
    random = np.random.default_rng(0)
    axis = np.array([1.0, 2.0, -1.0]) / np.sqrt(6)
    drawn = np.array([within_cone(random, axis, 60.0) for _ in range(4000)])
    # On a cap the height is uniform: its mean is (1 + cos 60°) / 2.
    assert (drawn @ axis).mean() == pytest.approx(0.75, abs=0.01)
    np.testing.assert_allclose(drawn.mean(axis=0), 0.75 * axis, atol=0.03)


def test_cone_paths(block: TetMesh) -> None:
    top = block.point_set("loaded")
    options = {"total_force_n": 2.0, "n_levels": 4, "n_paths": 9, "cone_deg": 20.0}
    paths = cone_paths(block, top, **options, nodes_per_path=3, seed=5)
    for path in paths:
        assert set(path.nodes) <= set(top.tolist())
        total = path.forces.sum(axis=0)
        assert np.linalg.norm(total) == pytest.approx(2.0)
        axis = inward_normals(block, path.nodes).mean(axis=0)
        cosine = total @ axis / (2.0 * np.linalg.norm(axis))
        assert cosine >= np.cos(np.deg2rad(20.0)) - 1e-9
    again = cone_paths(block, top, **options, nodes_per_path=3, seed=5)
    other = cone_paths(block, top, **options, nodes_per_path=3, seed=6)
    forces = np.stack([path.forces for path in paths])
    assert np.array_equal(forces, [path.forces for path in again])
    assert not np.array_equal(forces, [path.forces for path in other])
    for wrong, message in (
        ({"nodes_per_path": 17}, "nodes_per_path must be in 1…16"),
        ({"cone_deg": -1.0}, "cone_deg must be in"),
        ({"n_levels": 0}, "levels must be 1 or more"),
    ):
        with pytest.raises(InputError, match=message):
            cone_paths(block, top, **{**options, **wrong})


def test_traction_paths_push_inward_with_the_traction_asked_for(
    block: TetMesh,
) -> None:
    top = block.point_set("loaded")
    paths = traction_paths(block, top, traction_pa=2e3, n_levels=4, n_paths=5, seed=1)
    inward = inward_normals(block, by_position(block, top))
    low, high = block.points[top].min(axis=0), block.points[top].max(axis=0)
    area = np.prod((high - low)[:2])
    assert len(paths) == 5
    for path in paths:
        size = np.linalg.norm(path.forces, axis=1)
        np.testing.assert_allclose(size, size[0])
        assert size.sum() == pytest.approx(2e-3 * area)
        assert ((path.forces * inward).sum(axis=1) >= 0).all()


def test_further_paths_are_of_the_same_kind_and_none_of_the_published(
    block: TetMesh,
) -> None:
    top = block.point_set("loaded")[:11]
    ordered = by_position(block, top)
    normals = inward_normals(block, ordered)
    single = {"force_n": 1.35, "n_levels": 30}
    published = single_node_paths(block, top, **single)
    further = further_single_node_paths(block, top, 30, **single)
    assert [int(path.nodes[0]) for path in further] == [
        ordered[i % 11] for i in range(30)
    ]
    drawn = np.concatenate([path.forces for path in further]) / 1.35
    np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), 1.0)
    assert (np.abs(drawn[:, :2]) < 0.6).all()
    assert ((np.abs(drawn[:, 2]) > 0.2) & (np.abs(drawn[:, 2]) < 0.9)).all()
    assert (np.sign(drawn) * normals[np.arange(30) % 11] >= 0).all()
    before = np.concatenate([path.forces for path in published]) / 1.35
    assert np.linalg.norm(drawn[:, None] - before, axis=2).min() > 1e-6

    every = {"total_force_n": 20.0, "n_levels": 30}
    published = all_node_paths(block, top, n_paths=12, **every)
    further = further_all_node_paths(block, top, 8, **every)
    forces = np.stack([path.forces for path in further])
    np.testing.assert_allclose(np.linalg.norm(forces, axis=2), 20.0 / 11)
    assert (forces[..., 2] * normals[:, 2] >= 0).all()
    before = np.stack([path.forces for path in published])
    assert np.linalg.norm(forces[:, None] - before, axis=(2, 3)).min() > 1.0
    again = further_all_node_paths(block, top, 8, **every)
    np.testing.assert_array_equal(forces, np.stack([p.forces for p in again]))
