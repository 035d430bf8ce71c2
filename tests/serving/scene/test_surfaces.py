import numpy as np

from physgnn.geometry import Surface, boundary_points, volume
from physgnn.geometry.tetmesh import TetMesh
from physgnn.serving.scene.surfaces import Shown


def test_surfaces_are_closed_and_hold_their_regions(block: TetMesh) -> None:
    shown = Shown.of(block)
    assert list(shown.faces) == ["brain", "tumour"]
    points = block.points[shown.nodes]
    inside = block.cell_volumes[block.region == 1].sum()
    for name, wanted in (("brain", block.cell_volumes.sum()), ("tumour", inside)):
        surface = Surface(points, shown.faces[name].astype(np.int32))
        np.testing.assert_allclose(volume(surface), wanted)
    assert np.isin(boundary_points(block), shown.nodes).all()
