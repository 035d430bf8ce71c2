"""One flipped bit in what a checksum covers is noticed, or changes nothing."""

import contextlib
import shutil
from pathlib import Path

import numpy as np
import pytest

from faults.file_formats import FORMATS, same
from faults.file_mutants import flipped
from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.prediction.predictor import Predictor

COMPRESSED = [name for name, form in FORMATS.items() if form.compressed]
FLIPS = 300


@pytest.mark.parametrize("name", COMPRESSED)
def test_flips(name: str, tmp_path: Path) -> None:
    form, path = FORMATS[name], tmp_path / name
    form.make(path)
    whole, right = path.read_bytes(), form.read(path)
    bits = np.random.default_rng(3).integers(8 * len(whole), size=FLIPS)
    noticed = 0
    for bit in bits:
        path.write_bytes(flipped(whole, int(bit)))
        try:
            assert same(form.read(path), right), f"bit {bit} changes the result"
        except InputError:
            noticed += 1
    assert noticed > FLIPS / 2


@pytest.mark.parametrize("name", ["a.nrrd", "a.seg.nrrd", "layers.seg.nrrd", "a.mha"])
def test_flips_in_packed_voxels(name: str, tmp_path: Path) -> None:
    """The text before them has no checksum."""
    form, path = FORMATS[name], tmp_path / name
    form.make(path)
    whole, right = path.read_bytes(), form.read(path)
    mark = b"LOCAL\n" if name.endswith(".mha") else b"\n\n"
    # gzip has ten bytes before its stream, the time and the system among them
    start = whole.index(mark) + len(mark) + (2 if name.endswith(".mha") else 10)
    random = np.random.default_rng(5)
    for bit in random.integers(8 * start, 8 * len(whole), size=FLIPS):
        path.write_bytes(flipped(whole, int(bit)))
        with contextlib.suppress(InputError):
            assert same(form.read(path), right), f"bit {bit} changes the result"


def test_flips_in_compressed_blocks_of_vtu(tmp_path: Path) -> None:
    """Tags and headers have no checksum; the blocks of zlib have."""
    form, path = FORMATS["moved.vtu"], tmp_path / "moved.vtu"
    form.make(path)
    whole, right = path.read_bytes(), form.read(path)
    random = np.random.default_rng(4)
    inside = [
        (at, at + len(line.strip()))
        for line in whole.splitlines()
        if len(line.strip()) > 200 and b"<" not in line
        for at in [whole.index(line.strip())]
    ]
    assert len(inside) >= 2
    for _ in range(FLIPS):
        start, end = inside[random.integers(len(inside))]
        bit = int(random.integers(8 * (start + 32), 8 * end))
        path.write_bytes(flipped(whole, bit))
        with contextlib.suppress(InputError):
            assert same(form.read(path), right), f"bit {bit} changes the result"


FOR_PEOPLE = {"model_card.md"}  # nothing is computed from these
OF_THE_MODEL = sorted({file.name for file in BUNDLED_RUN.iterdir()} - FOR_PEOPLE)


@pytest.mark.parametrize("place", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("name", OF_THE_MODEL)
def test_flips_in_every_file_of_a_run_folder(
    name: str, place: float, tmp_path: Path
) -> None:
    """The bundled model has every kind of file that a prediction depends on."""
    run = shutil.copytree(BUNDLED_RUN, tmp_path / "run")
    whole = (run / name).read_bytes()
    bit = int(place * (8 * len(whole) - 1))
    (run / name).write_bytes(flipped(whole, bit))
    with pytest.raises(InputError, match=name):
        Predictor.load(run, warm=False)
