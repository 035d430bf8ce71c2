"""Programs on the PATH, run on files. They are not tested here: none comes with pip."""

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from physgnn.arrays import BoolArray
from physgnn.child_processes import ending_with_us
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io.medical.images.formats import read_image, write_image
from physgnn.scratch import scratch_folder
from physgnn.segmentation.orientation import mask_on

LONGEST_S = 1800.0
LONGEST_REASON = 200
SCAN, OUT = "scan.nii.gz", "out.nii.gz"
# FreeSurfer's label of fluid outside of the brain, which SynthSeg marks too.
FLUID_OUTSIDE = 24


@dataclass(frozen=True)
class Program:
    """A program that writes a mask, or labels, of the brain.

    Attributes
    ----------
    name : str
        On the PATH.
    arguments : tuple of str
        ``scan.nii.gz`` and ``out.nii.gz`` stand for the files.
    writes : str
        The file in the folder of ``out.nii.gz`` that holds the mask.
    """

    name: str
    arguments: tuple[str, ...]
    writes: str = OUT

    def available(self) -> bool:
        """Return whether the program is on the PATH."""
        return shutil.which(self.name) is not None

    def brain(self, image: Image) -> BoolArray:
        """Return the brain's mask on the voxels of an upright image.

        Raises
        ------
        InputError
            If the program fails, takes more than half an hour or writes no mask.
        """
        with scratch_folder("backend") as name:
            folder = Path(name)
            write_image(folder / SCAN, image)
            self._run(folder)
            if not (folder / self.writes).is_file():
                raise InputError(f"{self.name} wrote no mask: take another --backend")
            found = read_image(folder / self.writes)
        inside = (found.data != 0) & (found.data != FLUID_OUTSIDE)
        return mask_on(image.grid, inside, found.affine)

    def _run(self, folder: Path) -> None:
        path = shutil.which(self.name)
        assert path is not None
        try:
            done = subprocess.run(
                ending_with_us([path, *self.arguments]),
                cwd=folder,
                capture_output=True,
                timeout=LONGEST_S,
                check=False,
            )
        except subprocess.TimeoutExpired as error:
            raise InputError(
                f"{self.name} took more than {LONGEST_S / 60:.0f} minutes: take "
                "another --backend"
            ) from error
        except OSError as error:
            raise InputError(
                f"{self.name} cannot be run ({error.strerror}): take another --backend"
            ) from error
        if done.returncode != 0:
            said = " ".join(done.stderr.decode(errors="replace").split())
            raise InputError(
                f"{self.name} failed with exit code {done.returncode} "
                f"({said[-LONGEST_REASON:] or 'it said nothing'}): take another "
                "--backend"
            )


# https://surfer.nmr.mgh.harvard.edu/docs/synthstrip/
SYNTHSTRIP = Program("mri_synthstrip", ("-i", SCAN, "-m", OUT))
# https://surfer.nmr.mgh.harvard.edu/fswiki/SynthSeg
SYNTHSEG = Program("mri_synthseg", ("--i", SCAN, "--o", OUT, "--robust", "--cpu"))
# https://github.com/MIC-DKFZ/HD-BET, version 2
HD_BET = Program(
    "hd-bet",
    (
        *("-i", SCAN, "-o", OUT, "-device", "cpu", "--disable_tta"),
        *("--save_bet_mask", "--no_bet_image"),
    ),
    writes="out_bet.nii.gz",
)
