import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.serving.scene.patch_load import Exposed, spread_force

FORCE = np.array([0.3, -0.2, -1.0])


@pytest.fixture(scope="module")
def exposed(body: Body) -> Exposed:
    return Exposed.of(body, body.mesh.point_set("loaded"))


@given(
    x=st.floats(0, 10), y=st.floats(0, 10), radius=st.floats(0.1, 30)
)  # the block's top is 10 × 10 mm
def test_nodal_forces_add_up_and_stay_within_the_radius(exposed, x, y, radius) -> None:
    point = np.array([x, y, 10.0])
    case = spread_force(exposed, point, FORCE, radius)
    np.testing.assert_allclose(case.forces.sum(axis=0), FORCE, rtol=1e-12)
    share = case.forces @ FORCE / (FORCE @ FORCE)
    assert (share > 0).all()
    if len(case.nodes) > 1:
        places = exposed.points[np.searchsorted(exposed.nodes, case.nodes)]
        distance = np.linalg.norm(places - point, axis=1)
        assert (distance < radius).all()
        nearest_first = np.argsort(distance)
        assert (np.diff(share[nearest_first]) <= 1e-12).all()


def test_the_load_moves_smoothly_with_the_point(exposed: Exposed) -> None:
    def field(x: float) -> np.ndarray:
        case = spread_force(exposed, np.array([x, 5.0, 10.0]), FORCE, 6.0)
        return case.on_points(int(exposed.nodes.max()) + 1)

    steps = [np.abs(field(3 + h) - field(3)).max() / h for h in (1e-2, 1e-3, 1e-4)]
    np.testing.assert_allclose(steps, steps[-1], rtol=0.2)


def test_where_no_node_is_near_the_nearest_takes_all(exposed: Exposed) -> None:
    case = spread_force(exposed, exposed.points[4] + 0.3, FORCE, 0.01)
    assert case.nodes.tolist() == [exposed.nodes[4]]


def test_a_point_off_the_surface_is_refused(exposed: Exposed) -> None:
    with pytest.raises(InputError, match="it is 50 mm away"):
        spread_force(exposed, np.array([0.0, 0.0, 60.0]), FORCE, 5.0)


def test_fixed_and_inner_nodes_are_never_exposed(body: Body, block: TetMesh) -> None:
    exposed = Exposed.of(body)
    assert not np.isin(exposed.nodes, body.fixed).any()
    on_side = (block.points[exposed.nodes] % 10 == 0).any(axis=1)
    assert on_side.all()
    outward = block.points[exposed.nodes] - 5.0
    assert (np.einsum("ij,ij->i", outward, exposed.normals) > 0).all()
    with pytest.raises(InputError, match="no node can be loaded"):
        Exposed.of(body, body.fixed)
