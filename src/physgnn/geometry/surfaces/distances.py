"""How far points lie from a closed surface, and on which side."""

import numpy as np
import pyvista as pv

from physgnn.arrays import FloatArray
from physgnn.geometry.surface import FaceArray


def signed_distance(
    points: FloatArray, faces: FaceArray, targets: FloatArray
) -> FloatArray:
    """Return the distance of each target from a surface, negative inside, (n,), mm.

    Parameters
    ----------
    points, faces
        Of a closed surface, outward; points of no face may be among them.
    targets : (n, 3) array
        mm.
    """
    surface = pv.PolyData.from_regular_faces(points, faces.astype(int))
    places = pv.PolyData(np.ascontiguousarray(targets))
    found = places.compute_implicit_distance(surface)
    return np.asarray(found["implicit_distance"], dtype=np.float64)
