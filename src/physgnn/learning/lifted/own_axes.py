"""A body's own axes, which turn with it."""

from dataclasses import replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body


def body_axes(mesh: TetMesh) -> FloatArray:
    """Return the body's own right-handed axes as rows, (3, 3).

    They are the principal axes of its points, each pointing to the side of the longer
    tail, so that they turn with the body.
    """
    centred = mesh.points - mesh.points.mean(axis=0)
    _, vectors = np.linalg.eigh(centred.T @ centred)
    axes = vectors.T
    tails = ((centred @ axes.T) ** 3).sum(axis=0)
    axes[tails < 0] *= -1.0
    axes[2] = np.cross(axes[0], axes[1])
    right_handed: FloatArray = axes
    return right_handed


def turned(body: Body, axes: FloatArray) -> Body:
    """Return a body as it lies in axes, given as rows."""
    return replace(
        body,
        mesh=TetMesh(
            body.mesh.points @ axes.T,
            body.mesh.cells,
            body.mesh.region,
            body.mesh.point_sets,
        ),
    )
