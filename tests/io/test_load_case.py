import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.geometry import TetMesh, boundary_points
from physgnn.io import read_load_case, read_load_path, write_load_case
from physgnn.mechanics import LoadCase


def write(folder: Path, content: Any) -> Path:
    path = folder / "load.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


@given(seed=st.integers(0, 1000), count=st.integers(1, 20))
def test_round_trip_is_exact(
    tmp_path_factory: pytest.TempPathFactory, block: TetMesh, seed: int, count: int
) -> None:
    random = np.random.default_rng(seed)
    case = LoadCase(
        random.permutation(block.n_points)[:count], random.normal(size=(count, 3))
    )
    nodes, forces = case.nodes.copy(), case.forces.copy()
    path = tmp_path_factory.mktemp("load") / "load.json"
    write_load_case(path, case)
    again = read_load_case(path, block)
    for one in (case, again):
        np.testing.assert_array_equal(one.nodes, nodes)
        np.testing.assert_array_equal(one.forces, forces)


def test_points_go_to_the_nearest_surface_node_and_add_up(
    tmp_path: Path, block: TetMesh
) -> None:
    node = block.point_set("loaded")[5]
    place = block.points[node]
    path = write(
        tmp_path,
        {
            "points": [(place + np.array([0, 0, 1])).tolist(), place.tolist()],
            "forces_n": [[0, 0, -1], [0.5, 0, 0]],
        },
    )
    case = read_load_case(path, block)
    assert case.nodes.tolist() == [node]
    assert case.forces.tolist() == [[0.5, 0.0, -1.0]]


def test_points_never_snap_inside(tmp_path: Path, block: TetMesh) -> None:
    inside = np.setdiff1d(np.arange(block.n_points), boundary_points(block))[0]
    content = {"points": [block.points[inside].tolist()], "forces_n": [[0, 0, 1]]}
    case = read_load_case(write(tmp_path, content), block)
    assert np.isin(case.nodes, boundary_points(block)).all()
    with pytest.raises(InputError, match=r"must lie within 0\.1 mm of a surface node"):
        read_load_case(write(tmp_path, content), block, snap_mm=0.1)


FORCE = [[0.0, 0.0, 1.0]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{nodes: 3", "expected JSON"),
        ([1, 2], "a load case needs forces_n and either nodes or points"),
        ({"nodes": [1]}, "needs forces_n"),
        ({"forces_n": FORCE}, "either nodes or points"),
        ({"nodes": [1], "points": FORCE, "forces_n": FORCE}, "either nodes or points"),
        ({"nodes": [1], "forces": FORCE}, "got .*'forces'"),
        ({"nodes": [1], "forces_n": FORCE, "note": 1}, "got .*'note'"),
        ({"nodes": [1.5], "forces_n": FORCE}, "whole numbers"),
        ({"nodes": [True], "forces_n": FORCE}, "whole numbers"),
        ({"nodes": 1, "forces_n": FORCE}, "whole numbers"),
        ({"nodes": [1], "forces_n": [[0, 0]]}, "triples of finite numbers"),
        ({"nodes": [1], "forces_n": [[0, 0, "x"]]}, "triples of finite numbers"),
        ({"nodes": [1], "forces_n": [[0, 0, float("nan")]]}, "finite numbers"),
        ({"nodes": [1], "forces_n": [[0, 0, 0]]}, "must not all be zero"),
        ({"nodes": [1, 1], "forces_n": FORCE * 2}, "node 1 is repeated"),
        ({"nodes": [1, 2], "forces_n": FORCE}, r"\(n_loaded, 3\)"),
        ({"nodes": [64], "forces_n": FORCE}, "node 64 is not in the mesh"),
        ({"nodes": [-1], "forces_n": FORCE}, "node -1 is not in the mesh"),
        ({"points": [[0, 0, 90]], "forces_n": FORCE}, "80.0 mm away.*axes and units"),
        ({"points": [[0, 0, 9]] * 2, "forces_n": FORCE}, "1 forces for 2 points"),
        ({"points": [], "forces_n": []}, "triples of finite numbers"),
    ],
)
def test_wrong_load_cases_are_refused_in_one_line(
    tmp_path: Path, block: TetMesh, content: Any, message: str
) -> None:
    with pytest.raises(InputError, match=message) as caught:
        read_load_case(write(tmp_path, content), block)
    assert str(caught.value).startswith(str(tmp_path / "load.json"))
    assert "\n" not in str(caught.value)


def test_missing_and_binary_files(tmp_path: Path, block: TetMesh) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_load_case(tmp_path / "none.json", block)
    (tmp_path / "load.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="expected text in UTF-8"):
        read_load_case(tmp_path / "load.json", block)


def test_growth_stands_beside_forces_or_alone(tmp_path: Path, block: TetMesh) -> None:
    swells = {"growth": [{"region": "tumour", "volume_ratio": 1.1}]}
    alone = read_load_path(write(tmp_path, swells), block)
    assert len(alone.nodes) == 0
    assert np.array_equal(alone.more[0].cells, np.flatnonzero(block.region == 1))
    force = {"nodes": [block.n_points - 1], "forces_n": [[0, 0, -1e-3]]}
    both = write(tmp_path, {**force, **swells})
    path = read_load_path(both, block)
    assert len(path.nodes) == len(path.more) == 1
    with pytest.raises(InputError, match="holds growth"):
        read_load_case(both, block)


@pytest.mark.parametrize(
    ("growth", "said"),
    [
        ([], "list of one"),
        ([{"volume_ratio": 1.1}], "region, points or near"),
        ([{"region": "tumour"}], "needs volume_ratio"),
        ([{"region": "tumour", "volume_ratio": True}], "must be a number"),
        ([{"region": 1, "volume_ratio": 1.1}], "must be a name"),
        ([{"region": "tumour", "volume_ratio": 9.0}], r"0\.5…2"),
        ([{"ratio": 9.0}], "objects of volume_ratio, region"),
    ],
)
def test_growth_that_cannot_be_meant(
    tmp_path: Path, block: TetMesh, growth: Any, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        read_load_path(write(tmp_path, {"growth": growth}), block)
