import json
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from physgnn.errors import InputError
from physgnn.io.medical.measured_surface import read_surface_points
from physgnn.io.surfaces.formats import read_surface

POINTS = np.random.default_rng(0).normal(size=(12, 3)).round(3) * 10


def test_clouds_come_back_in_ras(tmp_path: Path) -> None:
    csv, markups = tmp_path / "a.csv", tmp_path / "a.mrk.json"
    np.savetxt(csv, POINTS, delimiter=",", header="x,y,z", comments="")
    lps = (POINTS * [-1, -1, 1]).tolist()
    points = [{"position": p} for p in lps]
    text = {"markups": [{"coordinateSystem": "LPS", "controlPoints": points}]}
    markups.write_text(json.dumps(text))
    for path in (csv, markups):
        np.testing.assert_allclose(read_surface_points(path).points, POINTS)


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".vtp"])
def test_models_of_3d_slicer_are_turned_from_lps(tmp_path: Path, suffix: str) -> None:
    ball = pv.Icosphere(radius=30.0, center=(10.0, 20.0, 30.0), nsub=1)
    plain, slicer = tmp_path / f"plain{suffix}", tmp_path / f"slicer{suffix}"
    ball.save(plain)
    ball.field_data["SPACE"] = ["LPS"]
    ball.save(slicer)
    data = slicer.read_bytes()
    if suffix == ".stl":  # as 3D Slicer fills the header
        slicer.write_bytes(b"3D Slicer output. SPACE=LPS".ljust(80) + data[80:])
    elif suffix == ".ply":
        slicer.write_bytes(
            data.replace(b"\nelement", b"\ncomment SPACE=LPS\nelement", 1)
        )
    np.testing.assert_allclose(
        read_surface(slicer).points.mean(axis=0), [-10, -20, 30], atol=1e-3
    )
    points = read_surface_points(plain).points
    np.testing.assert_allclose(points.mean(axis=0), [10, 20, 30], atol=1e-3)
    assert len(points) == ball.n_points + ball.n_cells


def test_what_is_no_surface_is_refused(tmp_path: Path) -> None:
    few = tmp_path / "few.csv"
    np.savetxt(few, POINTS[:4], delimiter=",")
    with pytest.raises(InputError, match=r"few\.csv: a measured surface needs 10"):
        read_surface_points(few)
    with pytest.raises(InputError, match="six columns, both ends"):
        pairs = tmp_path / "pairs.csv"
        np.savetxt(pairs, np.hstack([POINTS, POINTS]), delimiter=",")
        read_surface_points(pairs)
    with pytest.raises(InputError, match=r"measured surface must be \.stl"):
        read_surface_points(tmp_path / "a.txt")
