"""Swelling and contraction: tissue whose stress-free volume has become another.

Oedema takes up water and mannitol draws it out; neither pushes from outside. The
stress-free state of the cells changes, by F_g = θ^⅓ I (`physgnn.mechanics.elements.
growth`), and the neighbours resist.
"""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices, checked_numbers
from physgnn.geometry.tetmesh import TetMesh

# Tissue of water content w holds 1 − w of all else, which stays: θ = (1 − w₀)/(1 − w).
# From 70 %, that of white matter, to 80 %, that of grey matter, where oedema may take
# it, θ is 1.5. What is farther than a factor of 2 is a mistake.
LEAST_RATIO, MOST_RATIO = 0.5, 2.0


@dataclass(frozen=True, eq=False)
class VolumeGrowth:
    """Cells that swell or contract in proportion: θ = 1 + load factor · (ratio − 1).

    Parameters
    ----------
    cells : (n,) integer array
        Cells of the mesh, each named once.
    volume_ratio : float or (n,) array
        Stress-free volume over that at rest, at load factor 1, of each: above 1 swells.

    Raises
    ------
    InputError
        If there are no cells, one comes twice, or a ratio is outside of 0.5…2.
    """

    cells: IntArray
    volume_ratio: FloatArray

    def __post_init__(self) -> None:
        cells = checked_indices(self.cells, None, "cells")
        ratio = checked_numbers(self.volume_ratio, "volume_ratio")
        if cells.size == 0 or len(np.unique(cells)) < len(cells):
            raise InputError("growth needs one cell or more, each named once")
        if ratio.shape not in ((), cells.shape):
            raise InputError(
                f"volume_ratio must be one number or one a cell, {len(cells)} (got "
                f"shape {ratio.shape})"
            )
        check_volume_ratio(ratio)
        object.__setattr__(self, "cells", cells)
        object.__setattr__(
            self, "volume_ratio", np.broadcast_to(ratio, cells.shape).copy()
        )

    def check_against(self, mesh: TetMesh) -> None:
        """Raise InputError if a cell is missing from the mesh."""
        checked_indices(self.cells, mesh.n_cells, "cells that grow")

    def multiply(self, volume_ratio: FloatArray, load_factor: float) -> None:
        """Multiply the volume ratios of all cells by this growth, in place."""
        volume_ratio[self.cells] *= 1.0 + load_factor * (self.volume_ratio - 1.0)


def check_volume_ratio(ratio: FloatArray | float) -> None:
    """Raise InputError if a volume ratio is none that tissue can have."""
    values = np.asarray(ratio, dtype=np.float64)
    fits = (values >= LEAST_RATIO) & (values <= MOST_RATIO)
    if not fits.all():
        raise InputError(
            f"volume_ratio must be in {LEAST_RATIO:g}…{MOST_RATIO:g}, the volume over "
            f"that at rest: 1.05 swells by 5 % (got {values[~fits].flat[0]:g})"
        )
