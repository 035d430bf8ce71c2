"""deepbet: a network for T1 scans, whose wheel of 10 MB carries the weights.

Source: Fisch et al., Computers in Biology and Medicine 179 (2024) 108845; MIT licence.
It was trained on T1 scans of healthy adults. Its graphical interface is not imported;
its weights are TorchScript, which runs no Python of the file's.
"""

import warnings
from importlib.util import find_spec

import nibabel as nib
import numpy as np

from physgnn.arrays import BoolArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image


def available() -> bool:
    """Return whether the package is installed."""
    return find_spec("deepbet") is not None


def brain(image: Image) -> BoolArray:
    """Return the brain's mask on the voxels of an upright image.

    Raises
    ------
    InputError
        If the network finds no brain.
    """
    from deepbet.bet import BrainExtraction

    scan = nib.Nifti1Image(np.asarray(image.data, np.float32), image.affine)
    try:
        with warnings.catch_warnings():  # torch is to replace what loads TorchScript
            warnings.simplefilter("ignore", DeprecationWarning)
            _, mask, _ = BrainExtraction(no_gpu=True).run(scan)
    except (AssertionError, ValueError) as error:  # too few voxels of foreground
        raise InputError(
            "deepbet finds no brain in the scan: check that it is a T1 of a head, or "
            "take another --backend"
        ) from error
    return np.asarray(mask.dataobj) > 0
