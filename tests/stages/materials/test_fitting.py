"""A fit becomes a table that `simulate --loads` takes, and a picture; or nothing."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import physgnn as pg
from physgnn.config import read_materials, read_preset
from physgnn.errors import InputError
from physgnn.mechanics.materials import NeoHookean, Ogden
from physgnn.mechanics.materials.stress_curves import KINDS

BRAIN = Ogden((1260.0,), (-24.0,), 63_000.0)


@pytest.fixture
def curves(tmp_path: Path) -> Path:
    """What a machine would measure of a known material, in kPa."""
    stretch = np.linspace(0, 0.1, 12)
    amounts = {"tension": 1 + stretch, "compression": 1 - stretch, "shear": 2 * stretch}
    columns = {
        f"{kind}_{'amount' if kind == 'shear' else 'stretch'},{kind}_stress_kpa": (
            np.stack([amount, KINDS[kind](BRAIN, amount) / 1e3], axis=1)
        )
        for kind, amount in amounts.items()
    }
    file = tmp_path / "curves.csv"
    table = np.concatenate(list(columns.values()), axis=1)
    np.savetxt(file, table, delimiter=",", header=",".join(columns), comments="")
    return file


def test_the_table_is_what_simulate_takes(curves: Path, tmp_path: Path) -> None:
    out, chart = tmp_path / "tumour.toml", tmp_path / "fit.png"
    fitted = pg.fit_material(
        curves, bulk_modulus_pa=63_000.0, region="tumour", out=out, chart=chart
    )
    assert fitted.table == out.read_text("utf-8")
    assert read_materials(out)[1] == fitted.material
    assert isinstance(fitted.material, Ogden)
    assert np.allclose(fitted.material.coefficients_pa, BRAIN.coefficients_pa, 1e-4)
    assert np.allclose(fitted.material.exponents, BRAIN.exponents, 1e-4)
    loads = tmp_path / "loads.toml"
    loads.write_text(fitted.table + "\n[loads]\ntotal_force_n = 1.0\n", "utf-8")
    assert read_preset(loads).materials[1] == fitted.material
    comment = fitted.table.splitlines()[1]
    assert comment.startswith("# RMS error over RMS stress: tension 0.0 %, compression")
    assert chart.read_bytes().startswith(b"\x89PNG")
    assert {p.name for p in tmp_path.iterdir()} == {
        *("curves.csv", "tumour.toml", "fit.png", "loads.toml")
    }


@pytest.mark.parametrize("law", ["neo-hookean", "mooney-rivlin", "ogden"])
def test_every_law_has_a_table(curves: Path, law: str) -> None:
    fitted = pg.fit_material(curves, law=law)
    table = tomllib.loads(fitted.table)["materials"]["brain"]
    assert table["law"] == law
    assert 0 < max(fitted.errors.values()) < 1


def test_poissons_ratio_is_0_49_unless_told(curves: Path) -> None:
    usual = pg.fit_material(curves, law="neo-hookean").material
    other = pg.fit_material(curves, law="neo-hookean", poissons_ratio=0.4).material
    assert isinstance(usual, NeoHookean) and isinstance(other, NeoHookean)
    assert np.isclose(usual.poissons_ratio, 0.49, rtol=1e-10)
    assert np.isclose(other.poissons_ratio, 0.4, rtol=1e-10)


def test_units_change_the_moduli_alone(curves: Path) -> None:
    kpa = pg.fit_material(curves)
    curves.write_text(curves.read_text().replace("_kpa", ""))
    pa = pg.fit_material(curves, unit="pa")
    assert np.isclose(kpa.material.mu, 1e3 * pa.material.mu, rtol=1e-5)
    assert kpa.errors == pytest.approx(pa.errors, abs=1e-5)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"out": "a.txt"}, r"is written as \.toml \(got 'a\.txt'\)"),
        ({"chart": "a.pdf"}, r"is written as \.png"),
        ({"chart": "nowhere/a.png"}, "the folder .*nowhere is not there"),
        ({"poissons_ratio": 0.5}, r"must be in \[0, 0\.5\)"),
        ({"bulk_modulus_pa": -1.0}, "must be > 0 Pa"),
        ({"poissons_ratio": 0.4, "bulk_modulus_pa": 1e5}, "not both"),
        ({"region": "skull"}, "unknown region 'skull'"),
        ({"terms": 3}, "must be in 1…2"),
    ],
)
def test_mistakes_leave_no_file(
    curves: Path, tmp_path: Path, options: dict, message: str
) -> None:
    targets = {"out": "fit.toml", "chart": "fit.png"} | options
    paths = {name: tmp_path / str(targets.pop(name)) for name in ("out", "chart")}
    with pytest.raises(InputError, match=message):
        pg.fit_material(curves, **paths, **targets)
    assert list(tmp_path.iterdir()) == [curves]
