"""Equilibrium along a path: mathematics, FEBio's answers, and honest failure."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import (
    LoadPath,
    NeoHookean,
    PrescribedDisplacement,
    RestState,
    Solver,
    SolverOptions,
    Status,
    solve,
)
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import (
    ELEMENTS,
    internal_force,
    make_elements,
    strain_energy,
)
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.linear.direct_solver import make_linear_solver

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
FACTORS = np.arange(1, 11) / 10
TIGHT = SolverOptions(tolerance_mm=1e-9)


def pull(mesh: TetMesh, total_n: float, factors=FACTORS) -> LoadPath:
    """The top of the block pulled up and sideways, unevenly."""
    nodes = mesh.point_set("loaded")
    forces = np.tile([0.3, 0.1, 1.0], (len(nodes), 1)) * total_n / len(nodes)
    forces *= np.linspace(0.5, 1.5, len(nodes))[:, None]
    return LoadPath(nodes, forces, factors)


@pytest.fixture(scope="module")
def pulled(block):
    path = pull(block, 0.2)
    return path, solve(block, path, materials=MATERIALS, options=TIGHT)


def test_every_level_is_in_equilibrium(block, pulled):
    path, solution = pulled
    assert solution.converged and solution.reached == 1.0
    assert solution.residual.max() < 1e-8
    elements = make_elements(block, MATERIALS)
    fixed = block.point_set("fixed")
    for level, u in enumerate(solution.displacement):
        assert not u[fixed].any()
        force, _ = internal_force(elements, u)
        load = path.case(level).on_points(block.n_points)
        reactions = (force - load)[fixed].sum(axis=0)
        np.testing.assert_allclose(reactions, -load.sum(axis=0), atol=1e-9)


def test_paths_side_by_side(block, pulled):
    """Each with the bits that it has alone, and as near to equilibrium as ever."""
    body = Body(block, MATERIALS)
    paths = [pull(block, total) for total in (0.2, 0.1, 0.15, 0.05, 0.12)]
    together = Solver(body, options=TIGHT, side_by_side=True)
    with ThreadPoolExecutor(len(paths)) as threads:
        found = list(threads.map(together.solve, paths))
    reference = np.abs(found[0].displacement - pulled[1].displacement).max()
    assert reference < 1e-8
    for path, solution in zip(paths, found, strict=True):
        alone = Solver(body, options=TIGHT, side_by_side=True).solve(path)
        assert solution.converged
        assert np.array_equal(solution.displacement, alone.displacement)
        assert solution.counts == alone.counts
        assert solution.seconds > 0.0


@pytest.mark.parametrize("element", ELEMENTS)
def test_paths_of_every_element_side_by_side(block, element):
    body = Body(block, MATERIALS, element=element)
    paths = [pull(block, total) for total in (0.1, 0.15, 0.05)]
    together = Solver(body, side_by_side=True)
    with ThreadPoolExecutor(len(paths)) as threads:
        found = list(threads.map(together.solve, paths))
    for path, solution in zip(paths, found, strict=True):
        alone = Solver(body, side_by_side=True).solve(path)
        assert solution.converged
        assert np.array_equal(solution.displacement, alone.displacement)
        plain = Solver(body).solve(path)
        gap = np.abs(solution.displacement - plain.displacement).max()
        assert gap < 1e-4


def test_paths_side_by_side_that_hold_other_points(block):
    body = Body(block, MATERIALS)
    top = block.point_set("loaded")
    paths = [
        LoadPath.of(FACTORS[:3] / 10, PrescribedDisplacement(top[:n], np.ones((n, 3))))
        for n in (3, 5, 3, 4)
    ]
    together = Solver(body, side_by_side=True)
    with ThreadPoolExecutor(len(paths)) as threads:
        found = list(threads.map(together.solve, paths))
    for path, solution in zip(paths, found, strict=True):
        alone = Solver(body).solve(path)
        assert solution.converged
        gap = np.abs(solution.displacement - alone.displacement).max()
        assert gap < 1e-4


def test_stretch_is_large_enough_to_mean_something(pulled):
    _, solution = pulled
    assert np.abs(solution.displacement[-1]).max() > 3.0, "of a 10 mm block"


def test_work_of_the_load_is_stored_as_energy(block):
    factors = np.arange(1, 101) / 100
    path = pull(block, 0.2, factors)
    solution = solve(block, path, materials=MATERIALS, options=TIGHT)
    along = np.einsum("lnc,nc->l", solution.displacement[:, path.nodes], path.forces)
    along, factors = np.append(0.0, along), np.append(0.0, factors)
    work = np.trapezoid(factors, along)
    stored = strain_energy(make_elements(block, MATERIALS), solution.displacement[-1])
    assert work == pytest.approx(stored, rel=1e-4)


def test_small_loads_converge_to_the_linear_solution(block):
    rest = RestState(Body(block, MATERIALS))
    gaps = []
    for total in (1e-3, 1e-4):
        path = pull(block, total, np.array([1.0]))
        u = solve(block, path, materials=MATERIALS, options=TIGHT).displacement[0]
        linear = rest.solve(path.case(0).on_points(block.n_points))
        gaps.append(np.abs(u - linear).max() / np.abs(linear).max())
    assert gaps[1] == pytest.approx(gaps[0] / 10, rel=0.1)


def test_levels_do_not_depend_on_each_other(block, pulled):
    path, solution = pulled
    few = LoadPath(path.nodes, path.forces, FACTORS[[3, 9]])
    other = solve(block, few, materials=MATERIALS, options=TIGHT)
    np.testing.assert_allclose(
        other.displacement, solution.displacement[[3, 9]], atol=1e-7
    )


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_the_tolerance_is_kept(block, pulled, tolerance):
    path, exact = pulled
    options = SolverOptions(tolerance_mm=tolerance)
    loose = solve(block, path, materials=MATERIALS, options=options)
    error = np.linalg.norm(loose.displacement - exact.displacement, axis=2).max()
    assert error < tolerance


def test_one_and_two_threads_agree(block, pulled):
    path, _ = pulled
    one, two = (
        solve(
            block,
            path,
            materials=MATERIALS,
            options=SolverOptions(tolerance_mm=1e-10, threads=threads),
        ).displacement
        for threads in (1, 2)
    )
    np.testing.assert_allclose(one, two, atol=1e-9 * np.abs(one).max())


def test_a_solver_serves_many_paths(block, pulled):
    path, solution = pulled
    solver = Solver(Body(block, MATERIALS), options=TIGHT)
    solver.solve(pull(block, 0.1))
    again = solver.solve(path)
    np.testing.assert_array_equal(again.displacement, solution.displacement)


def test_rotating_mesh_and_load_rotates_the_displacement(block, pulled):
    path, solution = pulled
    Q = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = TetMesh(block.points @ Q.T, block.cells, block.region, block.point_sets)
    other = solve(
        turned,
        LoadPath(path.nodes, path.forces @ Q.T, path.load_factors),
        materials=MATERIALS,
        options=TIGHT,
    )
    np.testing.assert_allclose(
        other.displacement, solution.displacement @ Q.T, atol=1e-7
    )


def test_refinement_converges_to_a_uniform_stretch():
    """Uniform traction on a free-sliding-like tall block: error falls with h."""
    tips = []
    for n in (2, 4, 8):
        mesh = block_mesh(n)
        path = uniform_pull(mesh, 0.05)
        u = solve(
            mesh, path, materials={0: NeoHookean(3e3, 0.3), 1: NeoHookean(3e3, 0.3)}
        ).displacement[-1]
        tips.append(float(np.einsum("nc,nc", u[path.nodes], path.forces)))
    coarse, fine = tips[1] - tips[0], tips[2] - tips[1]
    assert coarse > fine > 0, "compliance grows as the mesh is refined"
    assert 1.4 < coarse / fine < 4.5, "at a rate between h^½ (corners) and h²"


def uniform_pull(mesh: TetMesh, total_n: float) -> LoadPath:
    """The top face pulled up by consistent nodal forces."""
    nodes = mesh.point_set("loaded")
    x = mesh.points[nodes, :2]
    edge = ((x == 0) | (x == 10)).sum(axis=1)
    weight = 0.5**edge
    forces = np.outer(weight / weight.sum() * total_n, [0.0, 0.0, 1.0])
    return LoadPath(nodes, forces, np.array([1.0]))


def test_a_path_that_fails_keeps_its_good_levels_and_says_why(block):
    """Pushing one point far into the block must collapse its elements."""
    node = block.point_set("loaded")[5]
    path = LoadPath(np.array([node]), np.array([[0.0, 0.0, -2.0]]), FACTORS)
    solution = solve(block, path, materials=MATERIALS)
    good = solution.status == Status.CONVERGED
    assert not solution.converged
    assert not np.isnan(solution.displacement).any()
    n_good = int(good.sum())
    assert (solution.status[n_good + 1 :] == Status.NOT_REACHED).all()
    assert not solution.displacement[n_good:].any()
    assert np.isnan(solution.residual[n_good:]).all()
    assert f"{solution.reached:.4f}" in solution.message
    assert Status(solution.status[n_good]).remedy in solution.message


def test_wrong_options_are_refused():
    with pytest.raises(InputError, match="tolerance_mm must be > 0"):
        SolverOptions(tolerance_mm=0.0)


@pytest.mark.parametrize("case", ["ds1_path0", "ds2_path1"])
def test_febio_agrees_at_every_node_and_level(shared, case):
    stored = np.load(shared / "febio" / f"febio_{case}.npz")
    mesh = TetMesh(
        stored["points"], stored["cells"], stored["region"], {"fixed": stored["fixed"]}
    )
    path = LoadPath(stored["load_nodes"], stored["load_vectors"], np.arange(1, 31) / 30)
    solution = solve(mesh, path, materials=MATERIALS)
    assert solution.converged
    ours = solution.displacement[stored["levels"] - 1]
    difference = np.linalg.norm(ours - stored["displacement"], axis=2)
    assert difference.max() < 2e-4, "the issue asks for 1e-3 mm"


def test_a_path_that_turns_back_falls_to_the_next_stable_equilibrium():
    """A point force draws its cells out; past a limit point they give way at once."""
    mesh = block_mesh(4)
    force = 0.15 * np.array([0.552, -0.006, -0.834])
    path = LoadPath(np.array([64]), force[None], np.arange(1, 31) / 30)
    solution = solve(mesh, path, materials=MATERIALS)
    assert solution.converged and solution.reached == 1.0
    assert solution.message.startswith("snapped through at load factor 0.9")
    moved = np.linalg.norm(np.diff(solution.displacement, axis=0), axis=2).max(axis=1)
    assert moved[26] > 5 * moved[25], "between levels 27 and 28"
    newton, elements = Newton(Body(mesh, MATERIALS)), make_elements(mesh, MATERIALS)
    pattern = make_pattern(mesh.cells, mesh.n_points, mesh.point_set("fixed"))
    for level in (26, 27, 29):
        found = solution.displacement[level]
        assert newton.distance(path.case(level), found) < 1e-4
        tangent, _ = assemble_tangent(elements, pattern, found)
        assert make_linear_solver(pattern).factorize(tangent), "stable"
