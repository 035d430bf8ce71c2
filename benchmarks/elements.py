"""Locking and its cure: convergence rates, a compressed block, Cook's membrane.

Run ``python benchmarks/elements.py``; prints the tables of docs/results/elements.md.
"""

import numpy as np

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import (
    LoadPath,
    NeoHookean,
    PrescribedDisplacement,
    Solver,
    SolverOptions,
)
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.cell_kinematics import deformation_gradient
from physgnn.mechanics.elements.tet4 import (
    ELEMENTS,
    internal_force,
)

SIDE = 10.0  # mm
# A rule of degree 2 on the tetrahedron (Keast 1986): four points of equal weight.
NEAR, FAR = (5 - 5**0.5) / 20, (5 + 3 * 5**0.5) / 20
RULE = np.full((4, 4), NEAR) + (FAR - NEAR) * np.eye(4)


def box(shape: tuple[int, int, int]) -> TetMesh:
    """Cut the unit cube into shape cells a side, six tetrahedra each."""
    axes = [np.linspace(0, 1, n + 1) for n in shape]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange(len(points)).reshape([n + 1 for n in shape])
    corner, steps = index[:-1, :-1, :-1].ravel(), np.array(index.strides) // 8
    cells = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (2, 1, 0), (0, 2, 1)):
        chain = corner[:, None] + np.append(0, np.cumsum(steps[list(order)]))
        even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        cells.append(chain if even else chain[:, [0, 2, 1, 3]])
    all_cells = np.concatenate(cells)
    return TetMesh(points, all_cells, np.zeros(len(all_cells)))


def with_points(mesh: TetMesh, points: np.ndarray, fixed: np.ndarray) -> TetMesh:
    """Move the cells to other points."""
    sets = {"fixed": np.flatnonzero(fixed)}
    return TetMesh(points, mesh.cells, mesh.region, sets)


def wave(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displacement of a known solution and its gradient.

    Points slide along d by an amount that varies across d, so J = 1 everywhere: near
    incompressibility costs the exact solution nothing, and a locking element a lot.
    """
    d, e1, e2 = np.array([[1, 1, -2], [1, -1, 0], [1, 1, 1]]) / np.sqrt([[6], [2], [3]])
    k = np.pi / SIDE
    s, t = k * x @ e1, k * x @ e2
    height = 1.5 * np.sin(s) * np.sin(t)
    slope = (np.cos(s) * np.sin(t))[..., None] * e1
    slope = slope + (np.sin(s) * np.cos(t))[..., None] * e2
    return height[..., None] * d, 1.5 * k * d[:, None] * slope[..., None, :]


def manufactured_errors(n: int, nu: float, element: str) -> tuple[float, float]:
    """Relative L2 and H1 errors against the wave, whose forces are applied."""
    mesh = box((n, n, n))
    points = SIDE * mesh.points
    sides = ((mesh.points == 0) | (mesh.points == 1)).any(axis=1)
    still = sides & (np.abs(wave(points)[0]).max(axis=1) < 1e-12)
    mesh = with_points(mesh, points, still)
    material = NeoHookean(3000.0, nu)
    x = np.einsum("qa,eai->eqi", RULE, points[mesh.cells])
    u, gradient = wave(x)
    F = np.eye(3) + gradient
    H = np.linalg.inv(F).swapaxes(-1, -2)
    P = (
        material.mu * (F - H)
        + material.lam * np.log(np.linalg.det(F))[..., None, None] * H
    )
    body = Body(mesh, {0: material}, element=element)
    share = mesh.cell_volumes[:, None, None] * np.einsum(
        "eij,eaj->eai", P.mean(axis=1), body.elements.gradients
    )
    force = np.zeros_like(points)
    np.add.at(force, mesh.cells, share)
    inside, moved = np.flatnonzero(~sides), np.flatnonzero(sides & ~still)
    push = PrescribedDisplacement(moved, wave(points[moved])[0])
    path = LoadPath(inside, force[inside], np.arange(1, 5) / 4, (push,))
    solver = Solver(body, options=SolverOptions(tolerance_mm=1e-6))
    found = solver.solve(path).displacement[-1]
    weight = mesh.cell_volumes[:, None] / 4
    error = np.einsum("qa,eai->eqi", RULE, found[mesh.cells]) - u
    slope = deformation_gradient(mesh, found)[:, None] - F
    l2 = np.sqrt((weight * (error**2).sum(-1)).sum() / (weight * (u**2).sum(-1)).sum())
    h1 = np.sqrt(
        (weight * (slope**2).sum((-1, -2))).sum()
        / (weight * (gradient**2).sum((-1, -2))).sum()
    )
    return float(l2), float(h1)


def squeezed_block_force(n: int, nu: float, element: str) -> float:
    """Force to press a cube's top, glued to a plate, down by a fifth, N.

    NaN if the solver stops short of it.
    """
    mesh = box((n, n, n))
    mesh = with_points(mesh, SIDE * mesh.points, mesh.points[:, 2] == 0)
    top = np.flatnonzero(mesh.points[:, 2] == SIDE)
    push = PrescribedDisplacement(top, np.tile([0.0, 0.0, -0.2 * SIDE], (len(top), 1)))
    body = Body(mesh, {0: NeoHookean(3000.0, nu)}, element=element)
    path = LoadPath.of(np.arange(1, 6) / 5, push)
    solution = Solver(body).solve(path)
    if not solution.converged:
        return np.nan
    u = solution.displacement[-1]
    force, _ = internal_force(body.elements, u)
    return float(-force[top, 2].sum())


def cook_path(n: int, force_n: float = 0.005) -> tuple[TetMesh, LoadPath]:
    """Cook's tapered panel and the shear on its free end, in five levels.

    48 × 44/16 mm, 5 mm thick, n × n × n/4 boxes; the other end is fixed.
    """
    mesh = box((n, n, max(1, n // 4)))
    s, t, z = mesh.points.T
    points = np.stack([48 * s, t * (44 - 28 * s) + 44 * s, 5 * z], axis=1)
    end = np.flatnonzero(s == 1)
    edges = (mesh.points[end, 1:] % 1 == 0).sum(axis=1)
    forces = np.outer(0.5**edges / (0.5**edges).sum(), [0.0, force_n, 0.0])
    mesh = with_points(mesh, points, s == 0)
    return mesh, LoadPath(end, forces, np.arange(1, 6) / 5)


def cook_tip(n: int, nu: float, element: str, force_n: float = 0.005) -> float:
    """Rise of the panel's outer corner, mm; NaN if the solver stops short of it."""
    mesh, path = cook_path(n, force_n)
    body = Body(mesh, {0: NeoHookean(3000.0, nu)}, element=element)
    solution = Solver(body).solve(path)
    corner = np.argmax(mesh.points[:, 0] + mesh.points[:, 1])
    rise = float(solution.displacement[-1, corner, 1])
    return rise if solution.converged else np.nan


def main() -> None:
    for nu in (0.3, 0.4999):
        for element in ELEMENTS:
            errors = np.array([manufactured_errors(n, nu, element) for n in (4, 8, 16)])
            rates = np.log2(errors[:-1] / errors[1:])
            print(f"wave nu={nu} {element}: L2, H1 errors {errors.round(4).tolist()}")
            print(f"     rates {rates.round(2).tolist()}", flush=True)
    for nu in (0.3, 0.49, 0.499):
        for element in ELEMENTS:
            forces = [squeezed_block_force(n, nu, element) for n in (4, 8, 12)]
            print(
                f"block nu={nu} {element}: {np.round(forces, 5).tolist()}", flush=True
            )
    for nu in (0.3, 0.49, 0.499):
        for element in ELEMENTS:
            tips = [cook_tip(n, nu, element) for n in (4, 8, 12)]
            print(f"Cook nu={nu} {element}: {np.round(tips, 3).tolist()}", flush=True)
    for nu, sizes in ((0.49, (8, 16, 24)), (0.499, (8, 16))):
        tips = [cook_tip(n, nu, "tet4-averaged", 0.02) for n in sizes]
        print(
            f"Cook, 20 mN, nu={nu} averaged: {np.round(tips, 3).tolist()}", flush=True
        )


if __name__ == "__main__":
    main()
