"""The bundled T1, for meshes that were made from it."""

import numpy as np

from physgnn.geometry.image import Image
from physgnn.geometry.tetmesh import TetMesh

# A brain's volume; the template is not even loaded for blocks and balls.
LITRES = 1.0, 3.0
# The bundled mesh has its sulci closed, which the template's mask has not.
FRACTION_INSIDE = 0.9


def bundled_t1(mesh: TetMesh) -> Image | None:
    """Return the MNI152 T1 at 1 mm if a mesh lies where its brain is, else None.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    """
    litres = mesh.cell_volumes.sum() / 1e6
    if not LITRES[0] < litres < LITRES[1]:
        return None
    # nilearn takes seconds to import: only this function needs it
    from nilearn.datasets import load_mni152_brain_mask, load_mni152_template

    mask = load_mni152_brain_mask(resolution=2)
    brain = Image(np.asarray(mask.dataobj) > 0, mask.affine)
    centres = brain.grid.to_index(mesh.points[mesh.cells].mean(axis=1)).round()
    index = np.clip(centres, 0, np.array(brain.data.shape) - 1).astype(int)
    inside = brain.data[tuple(index.T)] & (index == centres).all(axis=1)
    covered = litres * 1e6 / (brain.data.sum() * brain.grid.voxel_volume_mm3)
    inside_fraction = np.average(inside, weights=mesh.cell_volumes)
    if (
        inside_fraction < FRACTION_INSIDE
        or not FRACTION_INSIDE < covered < 1 / FRACTION_INSIDE**2
    ):
        return None
    template = load_mni152_template(resolution=1)
    return Image(np.asarray(template.dataobj), template.affine)
