"""Some of a body's cells."""

from dataclasses import replace

import numpy as np

from physgnn.arrays import BoolArray
from physgnn.mechanics.elements.tet4 import Elements


def some_cells(elements: Elements, cells: BoolArray) -> Elements:
    """Return some of the cells; points keep their numbers.

    Parameters
    ----------
    elements : Elements
        Of averaged ones, what follows from the cells' own deformation stays right, and
        stress does not: groups lose cells.
    cells : (n_cells,) boolean array
    """
    return replace(
        elements,
        cells=np.ascontiguousarray(elements.cells[cells]),
        gradients=elements.gradients[cells],
        rest=elements.rest[cells],
        volumes=elements.volumes[cells],
        law=elements.law[cells],
        constants=elements.constants[cells],
    )
