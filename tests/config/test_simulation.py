"""What to simulate: what is read, and one clear line for each mistake."""

from pathlib import Path

import numpy as np
import pytest

from physgnn.config import read_materials, read_point_sets, read_preset
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.materials import TISSUES, NeoHookean, Ogden

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


def test_further_paths_are_of_another_draw(tmp_path: Path, block: TetMesh) -> None:
    preset = read_preset(write(tmp_path, WHOLE))
    _, own = preset.on(block)
    _, paths = preset.on(block, 4)
    assert len(paths) == 11
    assert all(p.n_levels == 3 and len(p.nodes) == 2 for p in paths)
    drawn = {p.forces.tobytes() for p in own}
    assert not drawn & {p.forces.tobytes() for p in paths[7:]}
    text = WHOLE + '[[loads.more]]\nkind = "gravity"\ndirection = [0, 1, 0]\n'
    with pytest.raises(InputError, match="--training-paths"):
        read_preset(write(tmp_path, text)).on(block, 4)


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
            r"unknown key 'load' in .*'loads'.* element, remove_region, point_sets",
        ),
        (
            ("cone_deg", "cone_degrees"),
            r"unknown key 'cone_degrees' in \[loads\].*seed",
        ),
        (("total_force_n = 0.02", ""), "needs the key 'total_force_n'"),
        (("paths = 7", "paths = 7.5"), r"paths in \[loads\].* must be int \(got 7.5\)"),
        (("paths = 7", "paths = true"), "paths .* must be int"),
        (("paths = 7", "paths = 0"), "paths in .* must be > 0"),
        (("nodes_per_path = 2", "nodes_per_path = 0"), "nodes_per_path .* must be > 0"),
        (("seed = 4", "seed = -1"), "seed in .* must be ≥ 0"),
        (("= 0.02", '= "strong"'), "total_force_n .* must be float"),
        (("[point_sets.loaded]", "[point_sets.laoded]"), "unknown key 'laoded'"),
        (("[materials.tumour]", "[materials.tumor]"), "unknown region 'tumor'.*brain"),
        (
            ("poissons_ratio = 0.4", "nu = 0.4"),
            "unknown key 'nu' in .*materials.tumour.*youngs_modulus_pa, poiss",
        ),
        (("poissons_ratio = 0.4", "poissons_ratio = 0.5"), r"in \(-1, 0.5\)"),
        (('kind = "nearest"', 'kind = "closest"'), "kind = one of half_space"),
        (("count = 4", "number = 4"), "unknown key 'number'"),
        (("[loads]", "[loads"), "expected a TOML file"),
    ],
)
def test_mistakes(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    path = write(tmp_path, WHOLE.replace(*change))
    with pytest.raises(InputError, match=message) as raised:
        read_preset(path)
    assert "\n" not in str(raised.value)


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nothing\.toml: cannot be read"):
        read_preset(tmp_path / "nothing.toml")
    (tmp_path / "latin.toml").write_bytes(b"[loads] # \xe9\n")
    with pytest.raises(InputError, match="must be in UTF-8"):
        read_preset(tmp_path / "latin.toml")
    with pytest.raises(InputError, match="needs the key 'loads'"):
        read_preset(write(tmp_path, ""))


MORE = """
element = "tet4-averaged"
remove_region = 1

[point_sets.patch]
kind = "sphere"
centre_mm = [5, 5, 5]
radius_mm = 6.5

[materials.brain]
tissue = "brain-ogden"

[materials.7]
law = "ogden"
coefficients_pa = [1000, -200.5]
exponents = [2, -4]
bulk_modulus_pa = 2e4

[loads]
levels = 2

[[loads.more]]
kind = "pressure"
points = "patch"
pressure_pa = 20

[[loads.more]]
kind = "gravity"
direction = [0, 0, -1]
fluid_level_mm = 2.5

[[loads.more]]
kind = "measured"
file = "measured.csv"
snap_mm = 2.0
"""


def write_more(folder: Path, text: str = MORE) -> Path:
    np.savetxt(folder / "measured.csv", np.eye(3, 6, 3) + 3, delimiter=",")
    return write(folder, text)


def test_all_kinds_of_loads_without_forces(tmp_path: Path, block: TetMesh) -> None:
    preset = read_preset(write_more(tmp_path))
    assert (preset.element, preset.removed) == ("tet4-averaged", 1)
    assert preset.materials[0] == TISSUES["brain-ogden"].material
    assert preset.materials[7] == Ogden((1000, -200.5), (2, -4), 2e4)
    bare = TetMesh(block.points, block.cells, block.region)
    mesh, [path] = preset.on(bare.with_point_sets(fixed=block.point_set("fixed")))
    assert mesh.n_cells == (block.region == 0).sum()
    assert sorted(mesh.point_sets) == ["fixed", "patch"]
    assert path.load_factors.tolist() == [0.5, 1.0]
    assert len(path.nodes) == 0
    pressure, gravity, measured = path.more
    assert (pressure.pressure_pa, gravity.fluid_level_mm) == (20, 2.5)
    assert len(measured.nodes) >= 1


def test_more_loads_beside_forces(tmp_path: Path, block: TetMesh) -> None:
    text = WHOLE + '[[loads.more]]\nkind = "gravity"\ndirection = [0, 1, 0]\n'
    _, paths = read_preset(write(tmp_path, text)).on(block)
    _, without = read_preset(write(tmp_path, WHOLE)).on(block)
    assert [path.more for path in paths] == 7 * [(Gravity((0, 1, 0)),)]
    for path, other in zip(paths, without, strict=True):
        assert np.array_equal(path.forces, other.forces)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('"tet4-averaged"', '"hex8"'), "element must be one of tet4, tet4-averaged"),
        (("remove_region = 1", 'remove_region = "skull"'), "unknown region 'skull'"),
        (("levels = 2", "levels = 2\ncone_deg = 9"), "needs the key 'total_force_n'"),
        (("levels = 2", "levels = 0"), "levels in .* must be > 0"),
        (("[[loads.more]]", "[loads.more]"), "TOML|must be tables"),
        (('"pressure"', '"suction"'), r"number 1 .* kind = one of pressure, gravity"),
        (("pressure_pa = 20", "pressure = 20"), "'pressure' .* points, pressure_pa"),
        (("pressure_pa = 20", 'pressure_pa = "20"'), "pressure_pa .* must be float"),
        (("pressure_pa = 20", "pressure_pa = 0"), "finite and not 0"),
        (('points = "patch"', 'points = "brim"'), "unknown key 'patch'.*loaded, brim"),
        (("[0, 0, -1]", "[0, -1]"), "direction .* must be a list of 3 numbers"),
        (("[0, 0, -1]", '["z"]'), "direction .* must be a list of 3 numbers"),
        (
            ("fluid_level_mm", "csf_level_mm"),
            r"'csf_level_mm' in .*number 2.*fluid_lev",
        ),
        (('"measured.csv"', "7"), "file .* must be str"),
        (('"brain-ogden"', '"liver"'), "tissue .* must be one of brain, tumour"),
        (('"brain-ogden"', '"brain"\npoissons_ratio = 0.3'), r"its keys: tissue"),
        (('law = "ogden"', 'law = "fung"'), "law = one of neo-hookean, mooney"),
        (("exponents = [2, -4]", "exponents = 2"), "exponents .* list of numbers"),
        (("exponents = [2, -4]", "exponents = [2]"), r"pairs \(got 2 and 1"),
        (("exponents = [2, -4]\n", ""), "needs the key 'exponents'"),
    ],
)
def test_mistakes_beyond_forces(
    tmp_path: Path, block: TetMesh, change: tuple[str, str], message: str
) -> None:
    assert change[0] in MORE
    path = write_more(tmp_path, MORE.replace(*change))
    with pytest.raises(InputError, match=message) as raised:
        read_preset(path).on(block)
    assert "\n" not in str(raised.value)


def test_a_file_of_materials_must_name_some(tmp_path: Path) -> None:
    (tmp_path / "loads.toml").write_text("[loads]\npaths = 3\n")
    with pytest.raises(InputError, match=r"expected a table \[materials\] \(got loads"):
        read_materials(tmp_path / "loads.toml")
    assert read_materials(None)[0] == NeoHookean(3000.0, 0.49)
