"""Damaged files give a valid result or one clear line: the short form.

The long form: ``python tests/faults/run.py mutants --count 100000``.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest

from faults.file_formats import FORMATS
from faults.file_mutants import faults
from physgnn.io.medical.images import itk
from physgnn.io.meshes import reader as meshes
from physgnn.io.vtk import isolated

MUTANTS, SEED = 2_000, 17


@pytest.fixture(autouse=True)
def _patient_for_five_seconds(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    process = isolated.VtkProcess(timeout_s=5.0)
    monkeypatch.setattr(isolated, "_shared", process)
    for reader in (itk._READER, meshes._READER):
        monkeypatch.setattr(reader, "timeout_s", 5.0)
    yield
    process.close()


@pytest.mark.parametrize("name", FORMATS)
def test_mutants(name: str, tmp_path: Path) -> None:
    count = -(-MUTANTS // len(FORMATS))
    found = faults(FORMATS[name], tmp_path, count=count, seed=SEED)
    assert not found, (
        f"{len(found)} faults; the first, mutant {found[0][0]}: " + (found[0][1])
    )
