"""The long forms of the tests of faults, by one command each.

python tests/faults/run.py mutants --count 100000
python tests/faults/run.py flips --count 3000
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import contextlib

from faults.file_formats import FORMATS, FileFormat, same
from faults.file_mutants import faults, flipped
from physgnn.errors import InputError
from physgnn.io.medical.images import itk
from physgnn.io.meshes import reader as meshes
from physgnn.io.vtk import isolated


def mutants(form: FileFormat, folder: Path, count: int, seed: int) -> int:
    """Read mutants of a format; return how many fail."""
    found = faults(form, folder, count=count, seed=seed)
    for i, wrong in found[:3]:
        print(f"{form.name}, mutant {i}: {wrong}")
    return len(found)


def flips(form: FileFormat, folder: Path, count: int, seed: int) -> int:
    """Flip single bits of a compressed format; return how many change the result."""
    if not form.compressed:
        return 0
    path = folder / form.name
    form.make(path)
    whole, right = path.read_bytes(), form.read(path)
    random, changed = np.random.default_rng(seed), 0
    for bit in random.integers(8 * len(whole), size=count):
        path.write_bytes(flipped(whole, int(bit)))
        with contextlib.suppress(InputError):
            changed += not same(form.read(path), right)
    return changed


KINDS = {"mutants": mutants, "flips": flips}


def main() -> int:
    """Run one kind over all formats; the exit code says whether anything failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--count", type=int, default=100_000, help="Of all formats.")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="Formats so named, in part.")
    parser.add_argument("--keep", type=Path, help="Where files that fail are left.")
    given = parser.parse_args()
    isolated._shared = isolated.VtkProcess(timeout_s=5.0)
    itk._READER.timeout_s = meshes._READER.timeout_s = 5.0
    forms = [form for name, form in FORMATS.items() if given.only in name]
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="physgnn-faults-") as temporary:
        folder = given.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for form in forms:
            started, count = time.monotonic(), -(-given.count // len(forms))
            failed = KINDS[given.kind](form, folder, count, given.seed)
            seconds = time.monotonic() - started
            print(f"{form.name}: {failed} of {count} wrong, {seconds:.0f} s")
            wrong += failed
    isolated._shared.close()
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
