"""What holds for the forces of every element, whatever its law and its shape.

Each check takes the elements, the mesh they belong to, and a seed for a displacement.
"""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.spatial.transform import Rotation

from physgnn.geometry import TetMesh
from physgnn.mechanics.elements.tangent import Pattern, assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import Elements, internal_force, strain_energy


def wobble(mesh: TetMesh, seed: int, size: float = 0.2) -> np.ndarray:
    """A random displacement, by default small enough to invert no cell of a block."""
    return size * np.random.default_rng(seed).uniform(-1, 1, mesh.points.shape)


def check_forces_derive_from_energy(elements: Elements, mesh: TetMesh, seed: int):
    """Forces are the derivative of energy; they and their moments balance."""
    u, v = wobble(mesh, seed), wobble(mesh, seed + 1)
    force, _ = internal_force(elements, u)
    h = 1e-5
    ahead, behind = (strain_energy(elements, u + s * v) for s in (h, -h))
    assert (force * v).sum() == pytest.approx(
        (ahead - behind) / (2 * h), rel=1e-5, abs=1e-9
    )
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-12)
    moment = np.cross(mesh.points + u, force).sum(axis=0)
    np.testing.assert_allclose(moment, 0, atol=1e-11)


def check_objectivity(elements: Elements, mesh: TetMesh, seed: int):
    """Rotating the deformed body rotates the forces."""
    Q = Rotation.random(random_state=seed).as_matrix()
    u = wobble(mesh, seed)
    turned = (mesh.points + u) @ Q.T - mesh.points
    np.testing.assert_allclose(
        internal_force(elements, turned)[0],
        internal_force(elements, u)[0] @ Q.T,
        atol=1e-11,
    )


def condensed(pattern: Pattern, data: np.ndarray) -> np.ndarray:
    """The tangent of the unknowns, without pressures, all of it."""
    n = len(pattern.indptr) - 1
    upper = sp.csr_matrix((data, pattern.indices, pattern.indptr), shape=(n, n))
    assert sp.tril(upper, -1).nnz == 0
    assert upper.has_sorted_indices
    whole = upper.toarray() + sp.triu(upper, 1).T.toarray()
    moves, pressures = np.split(np.arange(n), [pattern.n_unknowns])
    coupling = whole[np.ix_(moves, pressures)]
    own = whole[np.ix_(pressures, pressures)]
    assert np.count_nonzero(own) == len(own)
    return whole[np.ix_(moves, moves)] - coupling / np.diag(own) @ coupling.T


def check_tangent(elements: Elements, mesh: TetMesh, seed: int, *, fixed=None):
    """The tangent is the derivative of force; its upper triangle is all of it."""
    fixed = mesh.point_set("fixed") if fixed is None else fixed
    pattern = make_pattern(mesh.cells, mesh.n_points, fixed, elements.averaging)
    u = wobble(mesh, seed)
    data, inverted = assemble_tangent(elements, pattern, u)
    assert inverted == -1
    tangent = condensed(pattern, data)
    step = np.zeros_like(u)
    step[pattern.free] = wobble(mesh, seed + 1)[pattern.free]
    h = 1e-6
    ahead, behind = (internal_force(elements, u + s * step)[0] for s in (h, -h))
    slope = (ahead - behind) / (2 * h)
    np.testing.assert_allclose(
        tangent @ step[pattern.free].ravel(),
        slope[pattern.free].ravel(),
        atol=1e-7 * np.abs(slope).max(),
    )
