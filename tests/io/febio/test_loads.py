"""Gravity, pressure and prescribed displacement in a FEBio model, out and back."""

import xml.etree.ElementTree as ET
from collections.abc import Callable
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
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import Load, LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure, faces_within
from physgnn.mechanics.materials import MooneyRivlin, NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
MESH = block_mesh(2)
TOP = MESH.point_set("loaded")
FACES = faces_within(MESH, "loaded")
FACTORS = np.array([0.4, 1.0])


def write(
    file: Path, *more: Load, force: bool = False, factors: np.ndarray = FACTORS
) -> None:
    free = np.flatnonzero((MESH.points[:, 2] > 0) & (MESH.points[:, 2] < 10))
    nodes, forces = free[:2], np.array([[1.0, 2.0, 3.0], [0.1, 0.2, 0.3]])
    path = (
        LoadPath(nodes, forces, factors, more) if force else LoadPath.of(factors, *more)
    )
    write_febio(file, Body(MESH, MATERIALS, MESH.point_set("fixed")), path)


def xml(file: Path) -> ET.Element:
    return ET.parse(file).getroot()


def numbers(element: ET.Element | None) -> list[float]:
    assert element is not None
    return [float(value) for value in (element.text or "").split(",")]


def test_gravity_is_minus_the_acceleration_and_a_density(tmp_path: Path) -> None:
    write(tmp_path / "a.feb", Gravity((0.0, 0.0, -1.0), 1040.0))
    root = xml(tmp_path / "a.feb")
    (load,) = root.findall("Loads/*")
    assert (load.tag, load.get("type")) == ("body_load", "body force")
    force = load.find("force")
    assert force is not None and force.get("lc") == "1"
    assert np.allclose(numbers(force), [0.0, 0.0, 9806.65], rtol=1e-15)
    densities = [m.findtext("density") for m in root.findall("Material/material")]
    assert [float(d or "nan") for d in densities] == [1.04e-9] * 2  # t/mm³
    assert root.findtext("Control/solver/symmetric_stiffness") == "symmetric"
    assert [s.get("name") for s in root.findall("Mesh/NodeSet")] == ["fixed"]


def test_pressure_follows_the_surface(tmp_path: Path) -> None:
    write(tmp_path / "a.feb", SurfacePressure(FACES, 300.0))
    root = xml(tmp_path / "a.feb")
    (load,) = root.findall("Loads/*")
    assert (load.tag, load.get("type")) == ("surface_load", "pressure")
    assert [(c.tag, c.get("lc")) for c in load] == [
        ("pressure", "1"),
        ("linear", None),
        ("symmetric_stiffness", None),
    ]
    texts = [float(child.text or "nan") for child in load]
    assert texts == [3e-4, 0.0, 0.0]  # MPa, positive pushes in
    surface = root.find("Mesh/Surface")
    assert surface is not None and surface.get("name") == load.get("surface")
    assert [face.tag for face in surface] == ["tri3"] * len(FACES)
    assert np.array_equal([numbers(face) for face in surface], FACES + 1)
    assert root.findtext("Control/solver/symmetric_stiffness") == "non-symmetric"


def test_prescribed_displacement_counts_from_rest(tmp_path: Path) -> None:
    places = np.array([[0.5, 0.0, -1.0], [0.5, 0.25, -1.0]])
    write(tmp_path / "a.feb", PrescribedDisplacement(TOP[:2], places))
    root = xml(tmp_path / "a.feb")
    conditions = root.findall("Boundary/bc[@type='prescribed displacement']")
    assert [bc.findtext("dof") for bc in conditions] == ["x", "y", "z"]
    assert {bc.findtext("relative") for bc in conditions} == {"0"}
    x, y, z = (bc.find("value") for bc in conditions)
    assert numbers(x) == [0.5] and numbers(z) == [-1.0]
    assert y is not None and (y.get("lc"), y.get("type")) == ("1", "map")
    data = root.find(f"MeshData/NodeData[@name='{y.text}']")
    assert data is not None and data.get("node_set") == conditions[1].get("node_set")
    assert [(n.get("lid"), n.text) for n in data] == [("1", "0.0"), ("2", "0.25")]
    nodes = root.find("Mesh/NodeSet[@name='prescribed-1']")
    assert numbers(nodes) == (TOP[:2] + 1).tolist()
    assert root.findall("Loads/*") == []


size = st.floats(-1e4, 1e4).filter(lambda x: abs(x) > 1e-3)
gravities = st.builds(
    Gravity, st.tuples(size, size, size), st.floats(1.0, 3e3), st.none()
)
pressures = st.builds(
    lambda n, p: SurfacePressure(FACES[:n], p), st.integers(1, 8), size
)
places = st.lists(st.tuples(size, size, size), min_size=3, max_size=3).map(
    lambda rows: PrescribedDisplacement(TOP[:3], np.array(rows))
)
others = st.lists(st.one_of(gravities, pressures), min_size=0, max_size=4)


@settings(max_examples=40)
@given(
    others,
    st.none() | places,
    st.booleans(),
    st.lists(st.floats(1e-6, 1.0), min_size=1, max_size=5, unique=True),
)
def test_round_trip(more, prescribed, force, factors) -> None:
    """What comes back loads every state of the body as what was written."""
    loads = [*more, *([] if prescribed is None else [prescribed])]
    if not loads:
        loads, force = [Gravity((0, 0, -1))], True
    with TemporaryDirectory() as folder:
        file = Path(folder) / "a.feb"
        write(file, *loads, force=force, factors=np.sort(factors))
        path = read_febio(file).load_path
    assert np.array_equal(path.load_factors, np.sort(factors))
    assert len(path.nodes) == (2 if force else 0)
    found = sorted(path.more, key=lambda m: type(m).__name__)
    for ours, theirs in zip(
        sorted(loads, key=lambda m: type(m).__name__), found, strict=True
    ):
        match ours:
            case Gravity():
                assert np.allclose(theirs.direction, ours.direction, rtol=1e-14)
                assert np.isclose(
                    theirs.density_kg_m3, ours.density_kg_m3, rtol=1e-14, atol=0
                )
            case SurfacePressure():
                assert np.array_equal(theirs.faces, ours.faces)
                assert theirs.pressure_pa == ours.pressure_pa
            case PrescribedDisplacement():
                assert np.array_equal(theirs.nodes, ours.nodes)
                assert np.array_equal(theirs.displacement, ours.displacement)


def test_a_curve_above_one_scales_the_loads(tmp_path: Path) -> None:
    """Load factors end at 1 with us: what FEBio scales by 2 is twice the load."""
    file = tmp_path / "a.feb"
    write(file, Gravity((0, 0, -1), 1000.0), SurfacePressure(FACES, 300.0))
    text = file.read_text()
    file.write_text(text.replace("<pt>2,1.0</pt>", "<pt>2,2.0</pt>"))
    path = read_febio(file).load_path
    gravity, pressure = path.more
    assert path.load_factors.tolist() == [0.2, 1.0]
    assert isinstance(gravity, Gravity) and isinstance(pressure, SurfacePressure)
    assert np.isclose(gravity.density_kg_m3, 2000.0, rtol=1e-14)
    assert pressure.pressure_pa == 600.0


def test_a_curve_that_ends_before_the_last_step(tmp_path: Path) -> None:
    """Beyond its last point FEBio goes on as the curve says."""
    file = tmp_path / "a.feb"
    write(file, Gravity((0, 0, -1), 1000.0))
    text = file.read_text().replace("<pt>2,1.0</pt>", "")
    said = "LINEAR</interpolate><extend>EXTRAPOLATE</extend>"
    file.write_text(text.replace("LINEAR</interpolate>", said))
    with pytest.raises(InputError, match=r"must be CONSTANT \(got EXTRAPOLATE\)"):
        read_febio(file)


@pytest.fixture
def all_kinds(tmp_path: Path) -> Path:
    file = tmp_path / "a.feb"
    moved = PrescribedDisplacement(TOP[:1], np.array([[0.5, 0.0, -1.0]]))
    write(file, Gravity((0, 0, -1)), SurfacePressure(FACES, 300.0), moved)
    return file


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("<linear>0", "<linear>1", "must follow the surface: <linear> must be 0"),
        ("<relative>0", "<relative>1", "<relative> must be 0"),
        ('type="body force"', 'type="const"', "must be nodal_load, body_load 'body"),
        ('type="body force"', 'type="body force" elem_set="a"', "on the whole body"),
        ("<density>1.0000E-9</density>", "", "the same <density> in every material"),
        ("<density>1.0000E-9", "<density>2E-9", "the same <density> in every"),
        ('surface="pressure-2"', 'surface="it\'s"', "no surface 'it's'"),
        ("tri3", "quad4", "surface 'pressure-2' must be of tri3"),
        ("<dof>z</dof>", "<dof>y</dof>", "has its y prescribed twice"),
        ('<force lc="1">', '<force lc="2">', "must share one load curve (got 2)"),
        ('<pressure lc="1">', '<push lc="1">', "expected a FEBio model"),
        ("0.0003000</pressure>", "soft</pressure>", "'soft' is no number"),
        ("0.0,0.0,9806.65<", "0,0,0<", "needs a <force> of three numbers, not 0"),
        ("0.0,0.0,9806.65<", "0,0,9.8*t<", "string to float: '9.8*t'"),
        (">LINEAR<", ">STEP<", "<interpolate> must be LINEAR (got STEP)"),
        (">LINEAR<", ">SMOOTH STEP<", "must be LINEAR (got SMOOTH STEP)"),
        ("<dof>x</dof>", "<dof>u</dof>", "a <dof> that is x, y or z (got 'u')"),
    ],
)
def test_what_does_not_fit_is_named(
    all_kinds: Path, old: str, new: str, message: str
) -> None:
    text = all_kinds.read_text()
    assert old in text
    all_kinds.write_text(text.replace(old, new, -1 if old == "tri3" else 1))
    with pytest.raises(InputError, match=r"a\.feb") as error:
        read_febio(all_kinds)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def without_z(text: str) -> str:
    start = text.index('<bc name="prescribed-3-z"')
    return text[:start] + text[text.index("</bc>", start) + len("</bc>") :]


def with_lid_of_nobody(text: str) -> str:
    return text.replace('lid="2"', 'lid="3"', 1)


def test_a_component_that_is_free(all_kinds: Path) -> None:
    all_kinds.write_text(without_z(all_kinds.read_text()))
    with pytest.raises(InputError, match=r"x, y and z prescribed \(got x, y\)"):
        read_febio(all_kinds)


def test_a_map_of_other_nodes(tmp_path: Path) -> None:
    moved = PrescribedDisplacement(TOP[:2], np.array([[0.5, 0, 1], [1, 2, 3]]))
    write(tmp_path / "a.feb", moved)
    text = (tmp_path / "a.feb").read_text()
    (tmp_path / "a.feb").write_text(with_lid_of_nobody(text))
    with pytest.raises(InputError, match=r"lid must be in 1…2 \(got 3\)"):
        read_febio(tmp_path / "a.feb")


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (lambda: Gravity((0, 0, -1), fluid_level_mm=5.0), "with a level of fluid"),
        (lambda: SurfacePressure(FACES + 100, 1.0), "faces must index"),
        (
            lambda: PrescribedDisplacement(
                MESH.point_set("fixed")[:1], np.ones((1, 3))
            ),
            "is fixed",
        ),
    ],
)
def test_what_febio_cannot_be_asked(
    tmp_path: Path, more: Callable[[], Load], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        write(tmp_path / "a.feb", more())
    assert list(tmp_path.iterdir()) == []


def test_two_gravities_are_each_as_heavy_as_they_are(tmp_path: Path) -> None:
    """FEBio has one density a material: the other's acceleration makes up for it."""
    down, aside = Gravity((0, 0, -1), 1000.0), Gravity((1, 0, 0), 250.0)
    write(tmp_path / "a.feb", down, aside)
    root = xml(tmp_path / "a.feb")
    forces = [numbers(load.find("force")) for load in root.findall("Loads/body_load")]
    assert np.allclose(forces, [[0, 0, 9806.65], [-9806.65 / 4, 0, 0]], rtol=1e-15)
    mesh: TetMesh = read_febio(tmp_path / "a.feb").mesh
    found = read_febio(tmp_path / "a.feb").load_path.more
    u = np.zeros_like(mesh.points)
    for ours, theirs in zip((down, aside), found, strict=True):
        pulls = theirs.bind(mesh)(u, 1.0)
        assert np.allclose(pulls, ours.bind(mesh)(u, 1.0), rtol=1e-14, atol=0)


@pytest.mark.parametrize("force", [False, True])
def test_growth_comes_back_part_by_part(tmp_path: Path, force: bool) -> None:
    """A region with two ratios and cells that do not grow: four parts in all."""
    upper, lower = (np.flatnonzero(MESH.region == i) for i in (1, 0))
    ratio = np.where(np.arange(len(upper)) % 2, 1.1, 0.95)
    loads = [VolumeGrowth(upper, ratio), VolumeGrowth(lower[:5], 1.2)]
    write(tmp_path / "a.feb", *loads, force=force)
    root = xml(tmp_path / "a.feb")
    kinds = [m.get("type") for m in root.findall("Material/material")]
    assert sorted(kinds) == ["kinematic growth"] * 3 + ["neo-Hookean"]
    model = read_febio(tmp_path / "a.feb")
    assert np.array_equal(model.mesh.region, MESH.region)
    assert model.materials == MATERIALS
    np.testing.assert_allclose(model.load_path.load_factors, FACTORS, rtol=1e-12)
    for factor in FACTORS:
        ours, theirs = np.ones(MESH.n_cells), np.ones(MESH.n_cells)
        for of, many in ((ours, loads), (theirs, model.load_path.more)):
            for load in many:
                load.multiply(of, factor)
        np.testing.assert_allclose(theirs, ours, rtol=1e-12)


def test_the_stretch_follows_a_curve_of_its_own(tmp_path: Path) -> None:
    write(tmp_path / "a.feb", VolumeGrowth(np.flatnonzero(MESH.region == 1), 1.331))
    root = xml(tmp_path / "a.feb")
    growth = root.find("Material/material/growth")
    assert growth is not None and growth.get("type") == "volume growth"
    multiplier = growth.find("multiplier")
    assert multiplier is not None and multiplier.text == "1"
    curve = root.find(f"LoadData/load_controller[@id='{multiplier.get('lc')}']")
    assert curve is not None
    points = np.array([numbers(point) for point in curve.findall("points/pt")])
    swollen = np.cbrt([1.0, 1 + 0.4 * 0.331, 1.331])
    np.testing.assert_allclose(points, np.column_stack([[0, 1, 2], swollen]))


def test_growth_that_febio_has_not(tmp_path: Path) -> None:
    growth = VolumeGrowth(np.arange(3), 1.1)
    with pytest.raises(InputError, match="growth or gravity, not both"):
        write(tmp_path / "a.feb", growth, Gravity((0, 0, -1)))
    big = block_mesh(3)
    many = VolumeGrowth(np.arange(big.n_cells), np.linspace(0.9, 1.1, big.n_cells))
    with pytest.raises(InputError, match="100 parts at most"):
        write_febio(
            tmp_path / "a.feb", Body(big, MATERIALS), LoadPath.of(FACTORS, many)
        )
    stiff = {**MATERIALS, int(MESH.region[0]): MooneyRivlin(300.0, 100.0, 2e4)}
    with pytest.raises(InputError, match="only coupled materials grow"):
        write_febio(tmp_path / "a.feb", Body(MESH, stiff), LoadPath.of(FACTORS, growth))
    assert not (tmp_path / "a.feb").exists()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("volume growth", "area growth", "of type 'volume growth'"),
        ('<multiplier lc="2">', "<multiplier>", "a number with a load curve"),
        ("<pt>1,1.0", "<pt>1,1.2", "in proportion"),
    ],
)
def test_other_growth_is_named(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    file = tmp_path / "a.feb"
    write(file, VolumeGrowth(np.flatnonzero(MESH.region == 1), 1.1), force=True)
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=message):
        read_febio(file)
