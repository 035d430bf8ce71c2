"""Settings: what is read, and one clear line for each mistake."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from physgnn.config import from_table, read_point_sets, read_preset, read_training
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.materials import NeoHookean

WHOLE = """
[point_sets.fixed]
kind = "half_space"
rotation_deg = [0, 0]
offset_mm = [0, 0, 0]
keep = "<"
limit_mm = 0.1

[point_sets.loaded]
kind = "nearest"
point_mm = [5, 5, 10]
count = 4

[materials.tumour]
youngs_modulus_pa = 9000
poissons_ratio = 0.4

[loads]
total_force_n = 0.02
cone_deg = 20
paths = 7
levels = 3
nodes_per_path = 2
seed = 4
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "settings.toml"
    path.write_text(text, "utf-8")
    return path


def test_a_whole_file(tmp_path: Path, block: TetMesh) -> None:
    preset = read_preset(write(tmp_path, WHOLE))
    bare = TetMesh(block.points, block.cells, block.region)
    mesh, paths = preset.on(bare)
    assert np.array_equal(mesh.point_set("fixed"), block.point_set("fixed"))
    assert len(mesh.point_set("loaded")) == 4
    assert preset.materials[0] == NeoHookean(3000.0, 0.49)  # as published
    assert preset.materials[1] == NeoHookean(9000.0, 0.4)
    assert len(paths) == 7
    assert all(path.n_levels == 3 and len(path.nodes) == 2 for path in paths)
    assert np.linalg.norm(paths[0].forces.sum(axis=0)) == pytest.approx(0.02)


def test_sets_may_come_with_the_mesh(tmp_path: Path, block: TetMesh) -> None:
    preset = read_preset(write(tmp_path, "[loads]\ntotal_force_n = 1\n"))
    mesh, paths = preset.on(block)
    assert np.array_equal(mesh.point_set("loaded"), block.point_set("loaded"))
    assert len(paths) == 100
    assert len(paths[0].nodes) == len(block.point_set("loaded"))


def test_point_sets_alone(tmp_path: Path) -> None:
    assert sorted(read_point_sets(write(tmp_path, WHOLE))) == ["fixed", "loaded"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ("[loads]", "[load]"),
            r"unknown key 'load' in .* point_sets, materials, loads",
        ),
        (
            ("cone_deg", "cone_degrees"),
            r"unknown key 'cone_degrees' in \[loads\].*seed",
        ),
        (("total_force_n = 0.02", ""), "needs the key 'total_force_n'"),
        (("paths = 7", "paths = 7.5"), r"paths in \[loads\].* must be int \(got 7.5\)"),
        (("paths = 7", "paths = true"), "paths .* must be int"),
        (("paths = 7", "paths = 0"), "paths must be > 0"),
        (("= 0.02", '= "strong"'), "total_force_n .* must be float"),
        (("[point_sets.loaded]", "[point_sets.laoded]"), "unknown key 'laoded'"),
        (("[materials.tumour]", "[materials.tumor]"), "unknown region 'tumor'.*brain"),
        (("poissons_ratio = 0.4", "nu = 0.4"), "takes youngs_modulus_pa, poissons"),
        (("poissons_ratio = 0.4", "poissons_ratio = 0.5"), r"in \(-1, 0.5\)"),
        (('kind = "nearest"', 'kind = "closest"'), "kind = one of half_space"),
        (("count = 4", "number = 4"), "unknown key 'number'"),
        (("[loads]", "[loads"), "is not a TOML file"),
    ],
)
def test_mistakes(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    path = write(tmp_path, WHOLE.replace(*change))
    with pytest.raises(InputError, match=message) as raised:
        read_preset(path)
    assert "\n" not in str(raised.value)


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot read .*nothing.toml: No such file"):
        read_preset(tmp_path / "nothing.toml")
    (tmp_path / "latin.toml").write_bytes(b"[loads] # \xe9\n")
    with pytest.raises(InputError, match="is not a TOML file"):
        read_preset(tmp_path / "latin.toml")
    with pytest.raises(InputError, match=r"needs a table \[loads\]"):
        read_preset(write(tmp_path, ""))


def test_training(tmp_path: Path) -> None:
    file = write(tmp_path, "batch_size = 4\nseed = 3\n[options]\nconfiguration = 9\n")
    config = read_training(file, seed=5, max_epochs=None, options={"dataset": 1})
    assert (config.batch_size, config.seed) == (4, 5)
    assert config.max_epochs == read_training(None).max_epochs
    assert config.options == {"configuration": 9, "dataset": 1}
    with pytest.raises(InputError, match=r"unknown key 'batchsize'.*batch_size"):
        read_training(write(tmp_path, "batchsize = 4"))
    with pytest.raises(InputError, match=r"batch_size .* must be int"):
        read_training(write(tmp_path, 'batch_size = "4"'))


@dataclass(frozen=True)
class Mixed:
    name: str
    size: float = 1.0
    limit: int | None = None


def test_from_table_checks_types() -> None:
    assert from_table(Mixed, {"name": "a", "size": 2}, "here") == Mixed("a", 2)
    assert from_table(Mixed, {"name": "a", "limit": None}, "here").limit is None
    for table in ({"name": 1}, {"name": "a", "limit": 0.5}, {"name": "a", "size": "b"}):
        with pytest.raises(InputError, match="in here must be"):
            from_table(Mixed, table, "here")
    with pytest.raises(InputError, match="here must be a table"):
        from_table(Mixed, [1, 2], "here")
