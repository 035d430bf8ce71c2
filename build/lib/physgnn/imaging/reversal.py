"""The same motion the other way: from where the brain is to where it was."""

from dataclasses import replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.field import checked_displacement


def reverse(mesh: TetMesh, displacement: FloatArray) -> tuple[TetMesh, FloatArray]:
    """Return the deformed body as a rest state, and the displacement back.

    What is forward for one motion is inverse for the other, so whatever moves images
    and points one way moves them the other way with these two.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    displacement : (n_points, 3) array
        u, mm.

    Raises
    ------
    InputError
        If a cell is turned inside out: then two places of the rest state are in one.
    """
    u = checked_displacement(mesh, displacement)
    moved = mesh.points + u
    edges = moved[mesh.cells[:, 1:]] - moved[mesh.cells[:, :1]]
    n = int((np.linalg.det(edges) <= 0).sum())
    if n:
        raise InputError(
            f"the displacement has no way back: it turns {n} of {len(mesh.cells)} "
            "cells inside out; lower the load, or look at the measured points"
        )
    return replace(mesh, points=moved), -u
