"""How volumes change, and whether anything folds."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.geometry.image import Image, ImageGrid
from physgnn.geometry.tetmesh import TetMesh, signed_volumes
from physgnn.imaging.field import DisplacementField
from physgnn.imaging.transforms import vectors_to_itk
from physgnn.imaging.voxel_fields import rasterize


def cell_jacobians(mesh: TetMesh, displacement: FloatArray) -> FloatArray:
    """Return det F of every cell: its deformed volume over its volume at rest."""
    deformed = signed_volumes(mesh.points + displacement, mesh.cells)
    ratio: FloatArray = deformed / mesh.cell_volumes
    return ratio


def jacobian_image(mesh: TetMesh, displacement: FloatArray, grid: ImageGrid) -> Image:
    """Return det F at the voxels of the rest state, float32; 1 outside of the mesh.

    Parameters
    ----------
    mesh : TetMesh
        The rest state; mm.
    displacement : (n_points, 3) array
        u of each point of the mesh, mm.
    grid : ImageGrid
        Voxels to sample at, RAS.

    Returns
    -------
    Image
        det F, without a unit of measure.
    """
    _, cell = rasterize(mesh.points, mesh.cells, np.empty((mesh.n_points, 0)), grid)
    values = np.append(cell_jacobians(mesh, displacement), 1.0)
    return Image(values[cell].astype(np.float32), grid.affine)


@dataclass(frozen=True)
class Folding:
    """Where a deformation turns space inside out; all zero is as it should be.

    Attributes
    ----------
    cells : int
        Cells with det F ≤ 0.
    voxels_inside, voxels_outside : int
        Voxels of the inverse field with a Jacobian determinant ≤ 0, within the brain
        and in the extension around it.
    smallest, largest : float
        det F of the mesh.
    """

    cells: int
    voxels_inside: int
    voxels_outside: int
    smallest: float
    largest: float

    def __str__(self) -> str:
        where = (
            "nothing folds"
            if self.cells + self.voxels_inside + self.voxels_outside == 0
            else f"FOLDED: {self.cells} cells, {self.voxels_inside} voxels of brain, "
            f"{self.voxels_outside} around it"
        )
        return f"det F {self.smallest:.3f} to {self.largest:.3f}; {where}"


def folding(
    mesh: TetMesh, displacement: FloatArray, inverse: DisplacementField
) -> Folding:
    """Look for folds in the mesh and in the inverse field (central differences).

    Parameters
    ----------
    mesh : TetMesh
        The mesh; lengths in mm.
    displacement : (n_points, 3) array
        u of each point of the mesh, mm.
    inverse : DisplacementField
        Of the same displacement; see `inverse_field`.

    Returns
    -------
    Folding
        How many cells and voxels fold, which is where the determinant is 0 or less.
    """
    import SimpleITK as sitk

    jacobian = cell_jacobians(mesh, displacement)
    image = sitk.DisplacementFieldJacobianDeterminant(vectors_to_itk(inverse))
    folded = sitk.GetArrayViewFromImage(image).T <= 0
    return Folding(
        cells=int((jacobian <= 0).sum()),
        voxels_inside=int((folded & inverse.inside).sum()),
        voxels_outside=int((folded & ~inverse.inside).sum()),
        smallest=float(jacobian.min()),
        largest=float(jacobian.max()),
    )
