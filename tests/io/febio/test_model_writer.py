"""A FEBio model holds exactly what was asked, read by XML alone and by our reader."""

import xml.etree.ElementTree as ET
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.model_reader import read_febio
from physgnn.io.febio.model_writer import write_febio
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import Material, MooneyRivlin, NeoHookean, Ogden

PAPER = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.mark.parametrize("name", ["febio_ds1_path0", "febio_ds2_path1"])
def test_a_stored_case_reads_back_as_it_was_asked(
    shared: Path, tmp_path: Path, name: str
) -> None:
    """By XML alone, so that our reader cannot make up for our writer."""
    case = np.load(shared / "febio" / f"{name}.npz")
    mesh = TetMesh(case["points"], case["cells"], case["region"])
    load = LoadPath(case["load_nodes"], case["load_vectors"], np.arange(1, 31) / 30)
    file = tmp_path / "case.feb"
    write_febio(file, Body(mesh, PAPER, case["fixed"]), load)
    root = ET.parse(file).getroot()

    nodes = root.findall("Mesh/Nodes/node")
    assert [int(node.attrib["id"]) for node in nodes] == list(
        range(1, len(case["points"]) + 1)
    )
    assert np.array_equal([numbers(node) for node in nodes], case["points"])

    cells = np.zeros_like(case["cells"])
    region = np.full(len(cells), -1)
    for label, part in enumerate(root.findall("Mesh/Elements")):
        assert part.attrib["type"] == "tet4"
        for cell in part:
            cells[int(cell.attrib["id"]) - 1] = numbers(cell)
            region[int(cell.attrib["id"]) - 1] = label
    assert np.array_equal(cells - 1, case["cells"])
    assert np.array_equal(region, case["region"])

    sets = {s.attrib["name"]: numbers(s) for s in root.findall("Mesh/NodeSet")}
    assert np.array_equal(np.array(sets["fixed"]) - 1, case["fixed"])
    assert np.array_equal(np.array(sets["loaded"]) - 1, case["load_nodes"])
    assert np.array_equal(forces(root), case["load_vectors"])

    materials = root.findall("Material/material")
    assert [m.attrib["type"] for m in materials] == ["neo-Hookean"] * 2
    assert [float(m.findtext("E", "")) for m in materials] == [0.003, 0.0075]
    assert [float(m.findtext("v", "")) for m in materials] == [0.49, 0.49]
    points = [numbers(p) for p in root.findall("LoadData/load_controller/points/pt")]
    assert np.array_equal(points, [(i, i / 30) for i in range(31)])
    assert root.findtext("Control/time_steps") == "30"
    assert float(root.findtext("Control/solver/min_residual", "")) == 0


def numbers(element: ET.Element) -> list[float]:
    return [float(value) for value in (element.text or "").split(",")]


def forces(root: ET.Element) -> np.ndarray:
    columns = []
    for load, axis in zip(root.findall("Loads/nodal_load"), "xyz", strict=True):
        assert (load.findtext("dof"), load.attrib["node_set"]) == (axis, "loaded")
        data = root.find(f"MeshData/NodeData[@name='{load.findtext('scale')}']")
        assert data is not None
        assert [node.attrib["lid"] for node in data] == [
            str(i) for i in range(1, len(data) + 1)
        ]
        columns.append([float(node.text or "") for node in data])
    return np.array(columns).T


number = st.floats(-1e6, 1e6).filter(lambda x: x == 0 or abs(x) > 1e-300)
modulus = st.floats(1e-3, 1e9)
laws: st.SearchStrategy[Material] = st.one_of(
    st.builds(NeoHookean, modulus, st.floats(0, 0.499)),
    st.builds(MooneyRivlin, modulus, modulus, modulus),
    st.integers(1, 3).flatmap(
        lambda n: st.builds(
            Ogden,
            st.lists(modulus, min_size=n, max_size=n).map(tuple),
            st.lists(st.floats(0.5, 20), min_size=n, max_size=n).map(tuple),
            modulus,
        )
    ),
)


@settings(max_examples=30)
@given(
    st.permutations(range(9)),
    st.lists(st.tuples(number, number, number), min_size=4, max_size=4),
    st.lists(st.floats(1e-6, 1.0), min_size=1, max_size=6, unique=True),
    st.tuples(laws, laws),
    st.integers(0, 99),
)
def test_round_trip(order, vectors, factors, materials, seed) -> None:
    mesh = block_mesh(2, jitter=0.2)
    moved = mesh.points + np.random.default_rng(seed).uniform(-0.1, 0.1, (27, 3))
    mesh = TetMesh(moved, mesh.cells, 7 * mesh.region)
    nodes = 9 + np.array(order[:4])
    vectors = np.array(vectors) + [[1.0, 0.0, 0.0]] * 4
    load = LoadPath(nodes, vectors, np.sort(factors))
    fixed = np.array([8, 2, 0, 5])
    with TemporaryDirectory() as folder:
        file = Path(folder) / "case.feb"
        write_febio(
            file, Body(mesh, dict(zip((0, 7), materials, strict=True)), fixed), load
        )
        model = read_febio(file)
    assert model.mesh.content_hash == mesh.content_hash
    assert model.materials == dict(zip((0, 7), materials, strict=True))
    assert np.array_equal(model.fixed, np.sort(fixed))
    assert np.array_equal(model.load_path.nodes, load.nodes)
    assert np.array_equal(model.load_path.forces, load.forces)
    assert np.array_equal(model.load_path.load_factors, load.load_factors)
    assert np.array_equal(model.times, np.arange(1, load.n_levels + 1))
    assert model.log is not None and model.log.name == "case-displacement.log"


@pytest.fixture
def written(tmp_path: Path, block: TetMesh) -> Path:
    file = tmp_path / "case.feb"
    load = LoadPath(block.point_set("loaded")[:3], np.eye(3), [0.5, 1.0])
    write_febio(file, Body(block, PAPER, block.point_set("fixed")), load)
    return file


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('version="4.0"', 'version="2.5"', "expected febio_spec 4.0"),
        ("tet4", "hex8", "part 'region-0' must be of tet4"),
        ("neo-Hookean", "Fung", "material type 'Fung' is not one of"),
        ("<E>0.0030000</E>", "", "material 'region-0' needs a number <E>"),
        ("<x_dof>1", "<x_dof>0", "must be zero displacement in x, y and z"),
        ('type="nodal_load"', 'type="pressure"', "load 'force-x' must be nodal_load"),
        ('<scale lc="1"', '<scale lc="2"', "there is no load curve '2'"),
        ('name="force-y" node_set', 'name="f" node_set', "needs NodeData 'force-y'"),
        ('node id="9"', 'node id="999"', "node 9 is not among the nodes"),
        ("<Boundary>", "<Contact><contact/></Contact><Boundary>", "section <Contact>"),
        ("</Mesh>", "", "expected a FEBio model"),
        ("<time_steps>2", "<time_steps>two", "'two'"),
        ("<time_steps>2", "<time_steps>100000000", "time_steps must be in"),
        ("<dof>y</dof>", "<dof></dof>", "needs a <dof> that is x, y or z (got '')"),
        ("<dof>y</dof>", "<dof>xy</dof>", "(got 'xy')"),
        ('node lid="2"', 'node lid="0"', "lid must be in 1…3 (got 0)"),
        ('node id="9"', 'node id="8"', "two nodes have the same id"),
        ("<pt>1,", "<pt>nan,", "must hold finite numbers"),
        ("<pt>1,", "<pt>0,", "must increase"),
    ],
)
def test_what_does_not_fit_is_named(
    written: Path, old: str, new: str, message: str
) -> None:
    text = written.read_text()
    assert old in text
    count = -1 if old == '<scale lc="1"' else 1
    written.write_text(text.replace(old, new, count))
    with pytest.raises(InputError, match=r"case\.feb") as error:
        read_febio(written)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_refusals(tmp_path: Path, block: TetMesh) -> None:
    load = LoadPath(block.point_set("loaded")[:1], [[0, 0, 1.0]], [1.0])
    fixed = block.point_set("fixed")
    with pytest.raises(InputError, match=r"written as \.feb"):
        write_febio(tmp_path / "a.xml", Body(block, PAPER, fixed), load)
    with pytest.raises(InputError, match="region 1 has no material"):
        write_febio(tmp_path / "a.feb", Body(block, {0: PAPER[0]}, fixed), load)
    with pytest.raises(InputError, match="is fixed"):
        write_febio(tmp_path / "a.feb", Body(block, PAPER, load.nodes), load)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match="cannot be read"):
        read_febio(tmp_path / "no.feb")
