from dataclasses import replace

import numpy as np

from meshes import block_mesh
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging import slices_of_shift
from physgnn.imaging.template import bundled_t1


def body_of_the_template() -> TetMesh:
    """A rough brain in the template's place: the cells of a block in an ellipsoid."""
    block = block_mesh(14, side=200.0)
    points = block.points - [100.0, 118.0, 86.0]
    x = points[block.cells].mean(axis=1) - [0.0, -18.0, 12.0]
    kept = ((x / [69.0, 87.0, 70.0]) ** 2).sum(axis=1) <= 1
    used, cells = np.unique(block.cells[kept], return_inverse=True)
    region = np.zeros(kept.sum(), dtype=np.int32)
    return TetMesh(points[used], cells.reshape(-1, 4), region)


def test_the_t1_is_found_for_a_brain_in_its_place_only() -> None:
    body = body_of_the_template()
    image = bundled_t1(body)
    assert image is not None and image.data.shape == (197, 233, 189)
    assert bundled_t1(replace(body, points=body.points + 60.0)) is None
    assert bundled_t1(block_mesh(3)) is None


def test_without_an_image_the_tissues_are_drawn() -> None:
    mesh = block_mesh(3, side=30.0)
    u = np.zeros_like(mesh.points)
    u[:, 2] = 0.2 * mesh.points[:, 2]
    figure = slices_of_shift(mesh, u)
    before, after = (axes.get_images()[0].get_array() for axes in figure.axes[:2])
    assert set(np.unique(before)) == {0, 1, 2}
    assert (after > 0).sum() > 1.1 * (before > 0).sum()
