"""Cells whose stress-free state has another volume: F = F_e F_g with F_g = θ^⅓ I.

Only F_e strains the tissue, so that a cell's energy is θ V W(F_e) with V its volume at
rest and θ the ratio of volumes. With g = θ^⅓ that is the energy of a cell of volume
θ V and shape gradients ∇N/g, whose F is I/g where nothing has moved: the kernels are
the same.

Source: Rodriguez, Hoger & McCulloch, "Stress-dependent finite growth in soft elastic
tissues", Journal of Biomechanics 27, 1994, 455–467.
"""

from dataclasses import replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.elements.averaged_pressure import Averaging, group_volumes
from physgnn.mechanics.elements.tet4 import Elements, internal_force

STEP = 1e-4  # in θ, of the difference: it is right to 1e-8


def grown(elements: Elements, volume_ratio: FloatArray) -> Elements:
    """Return the elements with stress-free states of other volumes.

    Parameters
    ----------
    elements : Elements
        Before growth.
    volume_ratio : (n_cells,) array
        θ > 0 of every cell; 1 leaves it as it was.
    """
    g = np.cbrt(volume_ratio)
    volumes = volume_ratio * elements.volumes
    return replace(
        elements,
        gradients=elements.gradients / g[:, None, None],
        rest=elements.rest / g,
        volumes=volumes,
        averaging=_regrouped(elements.averaging, volumes),
    )


def growth_force(
    elements: Elements, volume_ratio: FloatArray, change: FloatArray, u: FloatArray
) -> FloatArray:
    """Return how the internal force changes as cells grow, ∂f_int/∂s at θ + s·change.

    Parameters
    ----------
    elements : Elements
        Before growth.
    volume_ratio : (n_cells,) array
        θ.
    change : (n_cells,) array
        Of θ, for s = 1.
    u : (n_points, 3) array
        The state, mm; no cell may be inverted.

    Returns
    -------
    (n_points, 3) array
        N; a central difference.
    """
    step = STEP / float(np.abs(change).max())
    after, before = (
        internal_force(grown(elements, volume_ratio + s * step * change), u)[0]
        for s in (1.0, -1.0)
    )
    slope: FloatArray = (after - before) / (2 * step)
    return slope


def _regrouped(averaging: Averaging | None, volumes: FloatArray) -> Averaging | None:
    if averaging is None:
        return None
    return replace(averaging, volumes=group_volumes(averaging.groups, volumes))
