"""The published presets give the published sets and loads."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset import PRESETS, Preset
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.paths import LoadPath

FIRST_1 = [
    [0.63853322909, -0.258185990891, -0.724993316836],
    [0.371291346412, -0.451081313398, -0.811583874151],
    [0.026340355905, -0.561949990565, -0.826751712278],
    [0.527736220375, -0.076583331851, -0.845948860739],
    [0.00594829175, -0.901151154096, -0.433464203016],
]
FIRST_2 = [
    [0.805820622193, -0.261285495383, -0.531397228776],
    [-0.449590344111, -0.633770090312, -0.629447372786],
    [-0.443523586431, -0.380287317034, -0.811583874151],
]
LAST_2 = [-0.039171902715, 0.901029279474, -0.431985878899]

Published = tuple[TetMesh, list[LoadPath]]


@pytest.fixture(scope="module")
def paper_mesh(shared: Path) -> TetMesh:
    data = np.load(shared / "febio" / "febio_ds2_path1.npz")
    return TetMesh(data["points"], data["cells"], data["region"])


@pytest.fixture(scope="module")
def paper_1(paper_mesh: TetMesh) -> Published:
    return PRESETS["paper-1"].on(paper_mesh)


@pytest.fixture(scope="module")
def paper_2(paper_mesh: TetMesh) -> Published:
    return PRESETS["paper-2"].on(paper_mesh)


def test_counts(paper_1: Published, paper_2: Published) -> None:
    for (mesh, paths), n_loaded, width in ((paper_1, 11, 1), (paper_2, 100, 100)):
        assert len(mesh.point_set("fixed")) == 502
        assert len(mesh.point_set("loaded")) == n_loaded
        assert len(paths) == 165
        assert {len(path.nodes) for path in paths} == {width}
        assert {path.n_levels for path in paths} == {30}


def test_first_directions_of_dataset_1(paper_1: Published) -> None:
    forces = np.concatenate([path.forces for path in paper_1[1]]) / 1.35
    np.testing.assert_allclose(forces[[0, 1, 2, 15, 50]], FIRST_1, atol=1e-9)


def test_first_directions_of_dataset_2(paper_2: Published) -> None:
    forces = np.stack([path.forces for path in paper_2[1]]) / 0.2
    np.testing.assert_allclose(forces[[0, 1, 2], 0], FIRST_2, atol=1e-9)
    np.testing.assert_allclose(forces[164, 99], LAST_2, atol=1e-9)


@pytest.mark.parametrize(
    ("preset", "file", "path"),
    [("paper_1", "febio_ds1_path0.npz", 0), ("paper_2", "febio_ds2_path1.npz", 1)],
)
def test_loads_are_those_febio_was_given(
    preset: str, file: str, path: int, shared: Path, request: pytest.FixtureRequest
) -> None:
    mesh, paths = request.getfixturevalue(preset)
    given = np.load(shared / "febio" / file)
    assert np.array_equal(np.sort(given["fixed"]), mesh.point_set("fixed"))
    ours, theirs = np.argsort(paths[path].nodes), np.argsort(given["load_nodes"])
    assert np.array_equal(paths[path].nodes[ours], given["load_nodes"][theirs])
    np.testing.assert_allclose(
        paths[path].forces[ours], given["load_vectors"][theirs], rtol=0, atol=1e-12
    )


@pytest.mark.parametrize("number", [1, 2])
def test_loads_are_those_of_the_published_features(
    number: int, shared: Path, request: pytest.FixtureRequest
) -> None:
    """The published force columns, standardisation undone, and its statistics.

    The mean and deviation are over all paths, so they pin every one of them.
    """
    mesh, paths = request.getfixturevalue(f"paper_{number}")
    golden = np.load(shared / "paper" / "golden_forward.npz")
    mean = golden[f"feature_mean_{number}"][:3]
    deviation = golden[f"feature_std_{number}"][:3]
    path, level = golden[f"sample_{number}"]  # the level counts from 1
    forces = golden[f"x_{number}"][:, 1:4] * deviation + mean
    expected = paths[path].case(level - 1).on_points(mesh.n_points)
    np.testing.assert_allclose(forces, expected, rtol=0, atol=1e-6)

    factors = paths[0].load_factors
    total = sum(path.forces.sum(axis=0) for path in paths) * factors.sum()
    squares = sum((path.forces**2).sum(axis=0) for path in paths) * (factors**2).sum()
    n = mesh.n_points * len(paths) * len(factors)
    np.testing.assert_allclose(total / n, mean, rtol=1e-9)
    variance = (squares - total**2 / n) / (n - 1)
    np.testing.assert_allclose(np.sqrt(variance), deviation, rtol=1e-9)


def test_sets_of_the_mesh_serve_where_there_is_no_rule(block: TetMesh) -> None:
    preset = Preset(PRESETS["demo"].materials, paths=lambda *_: [])
    mesh, _ = preset.on(block)
    assert np.array_equal(mesh.point_set("fixed"), block.point_set("fixed"))
    bare = TetMesh(block.points, block.cells, block.region)
    with pytest.raises(InputError, match="no point set 'fixed'"):
        preset.on(bare)


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_further_paths_come_after_the_preset_s_own(name: str, block: TetMesh) -> None:
    preset = replace(PRESETS[name], fixed=None, loaded=None)
    few = block.point_set("loaded")[:11]
    body = block.with_point_sets(loaded=few)
    _, own = preset.on(body)
    _, more = preset.on(body, 5)
    assert len(more) == len(own) + 5
    for one, other in zip(own, more, strict=False):
        np.testing.assert_array_equal(one.forces, other.forces)
    drawn = {path.forces.tobytes() for path in more[len(own) :]}
    assert len(drawn) == 5 and not drawn & {path.forces.tobytes() for path in own}


def test_further_paths_need_a_rule_and_room(block: TetMesh) -> None:
    without = replace(PRESETS["demo"], fixed=None, loaded=None, further=None)
    with pytest.raises(InputError, match="--training-paths"):
        without.on(block, 1)
    with_rule = replace(PRESETS["demo"], fixed=None, loaded=None)
    with pytest.raises(InputError, match="PHYSGNN_DATASET_LIMIT_GB"):
        with_rule.on(block, 10**9)
