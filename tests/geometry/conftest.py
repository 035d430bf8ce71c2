"""Surfaces that more than one test module uses."""

from collections.abc import Callable

import numpy as np
import pytest
import pyvista as pv

from physgnn.geometry import Surface

MakeSphere = Callable[..., Surface]


@pytest.fixture(scope="session")
def sphere() -> MakeSphere:
    """From radius and centre in mm to a sphere of 162 points."""

    def make(
        radius: float = 10.0,
        centre: tuple[float, float, float] = (0.0, 0.0, 0.0),
        refinements: int = 2,
    ) -> Surface:
        body = pv.Icosphere(radius=radius, center=centre, nsub=refinements)
        points = np.asarray(body.points, dtype=np.float64)
        return Surface(points, body.regular_faces.astype(np.int32))

    return make
