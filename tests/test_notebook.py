"""The notebook runs from top to bottom, and is kept without its outputs."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physgnn.geometry.meshing import tetgen_process
from physgnn.io.medical.images.formats import read_image

NOTEBOOK = Path(__file__).parents[1] / "examples" / "scan_to_scan.ipynb"


def code_cells() -> list[dict[str, Any]]:
    cells = json.loads(NOTEBOOK.read_text("utf-8"))["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


def test_it_is_kept_without_outputs() -> None:
    for cell in code_cells():
        assert cell["outputs"] == [] and cell["execution_count"] is None


@pytest.mark.skipif(not tetgen_process.available(), reason="needs the tetgen extra")
def test_it_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for cell in code_cells():
        exec(compile("".join(cell["source"]), str(NOTEBOOK), "exec"), names)
    # the cortex went where it was measured, and the skull stayed
    depth = names["after"] - names["before"]
    u = names["displacement"][names["near"]]
    assert np.linalg.norm(u - depth, axis=1).mean() < 1.5
    assert (names["displacement"][names["mesh"].point_set("fixed")] == 0).all()
    before, after = (
        read_image(tmp_path / "scan_to_scan" / name).data.astype(float)
        for name in ("t1.nii.gz", "t1-deformed.nii.gz")
    )
    assert np.abs(after - before).max() > 0.3 * before.max()
    assert names["from_surface"].prediction.error_estimate_mm.mean_mm > 0.1
