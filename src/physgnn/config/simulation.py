"""What to simulate (``physgnn simulate --loads``).

A file with everything in it::

element = "tet4-averaged"     # "tet4", as published, if left out
remove_region = "tumour"      # resected before all else; by default nothing is

[point_sets.fixed]            # rules: physgnn.geometry.point_sets; a set that is
kind = "half_space"           # left out must be in the mesh file
rotation_deg = [20, 0]
offset_mm = [80, 90, 120]
keep = "<"
limit_mm = 265

[point_sets.loaded]           # takes the forces
kind = "nearest"
point_mm = [62, 129, 150]
count = 60

[materials.brain]             # or tumour, ventricle, or a region's number; by
tissue = "brain-ogden"        # default the published brain and tumour

[materials.tumour]            # or a law: docs/reference/materials.md
law = "mooney-rivlin"
c1_pa = 1000
c2_pa = 250
bulk_modulus_pa = 120_000

[loads]                       # forces drawn at random, see Forces
total_force_n = 5.0           # without it there is one path, of levels steps

[[loads.more]]                # more loads, on every path: see MORE_LOADS
kind = "gravity"
direction = [0, 0, -1]
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

from physgnn.config.tables import check_keys, from_table, named, read_toml
from physgnn.dataset.definition import DEFAULT_ELEMENT
from physgnn.dataset.load_rules import (
    LoadRule,
    MeasuredPlaces,
    Paths,
    PressureOn,
    Shift,
    with_more,
    without_forces,
)
from physgnn.dataset.presets import BRAIN_AND_TUMOUR, Preset
from physgnn.errors import InputError
from physgnn.geometry.point_sets import Rule, rule_from_table
from physgnn.mechanics.gravity import Gravity
from physgnn.mechanics.load_paths import cone_paths
from physgnn.mechanics.materials import TISSUES, Material
from physgnn.mechanics.materials.table import LAWS
from physgnn.mechanics.solver import SolverOptions

REGIONS = {"brain": 0, "tumour": 1, "ventricle": 2}
POINT_SETS = ("fixed", "loaded")
KEYS = ("element", "remove_region", "point_sets", "materials", "loads")
MORE_LOADS: Mapping[str, type[LoadRule]] = {
    "pressure": PressureOn,
    "gravity": Gravity,
    "displacement": Shift,
    "measured": MeasuredPlaces,
}


@dataclass(frozen=True)
class Forces:
    """The ``[loads]`` table: see `physgnn.mechanics.load_paths.cone_paths`.

    Attributes
    ----------
    total_force_n : float
        Force on the loaded patch at the last level, N.
    cone_deg : float
        Half-angle of the cone of directions about the inward normal, degrees.
    paths, levels : int
        Load paths, and equal load steps on each.
    nodes_per_path : int or None
        Nodes of a patch; by default all loaded ones.
    seed : int
        Of the directions and patches.
    """

    total_force_n: float
    cone_deg: float = 30.0
    paths: int = 100
    levels: int = 10
    nodes_per_path: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("total_force_n", "paths", "levels"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} must be > 0 (got {getattr(self, name)})")


@dataclass(frozen=True)
class NoForces:
    """The ``[loads]`` table without forces: one path.

    Attributes
    ----------
    levels : int
        Equal load steps.
    """

    levels: int = 10

    def __post_init__(self) -> None:
        if not self.levels > 0:
            raise InputError(f"levels must be > 0 (got {self.levels})")


def read_preset(path: str | Path) -> Preset:
    """Read what to simulate from a TOML file.

    Raises
    ------
    InputError
        If the file cannot be read, or a key or value is wrong.
    """
    tables = read_toml(path)
    check_keys(tables, KEYS, str(path))
    if not isinstance(tables.get("loads"), Mapping):
        raise InputError(f"{path} needs a table [loads] with total_force_n")
    loads = dict(tables["loads"])
    more = _more_loads(loads.pop("more", []), Path(path))
    rules = _rules(tables.get("point_sets", {}), path)
    acted_on = [rule.points for rule in more if isinstance(rule, PressureOn | Shift)]
    allowed = list(dict.fromkeys([*POINT_SETS, *acted_on]))
    check_keys(rules, allowed, f"[point_sets] of {path}")
    has_forces = not more or any(key != "levels" for key in loads)
    sets = {name: rules.pop(name, None) for name in POINT_SETS}
    return Preset(
        materials={**BRAIN_AND_TUMOUR, **_materials(tables.get("materials", {}), path)},
        paths=_paths(loads, more, has_forces, path),
        **sets,
        others=rules,
        has_forces=has_forces,
        element=_element(tables.get("element", DEFAULT_ELEMENT), path),
        removed=_removed(tables.get("remove_region"), path),
    )


def read_point_sets(path: str | Path) -> dict[str, Rule]:
    """Read only the rules of the point sets of a TOML file; other tables may be there.

    Raises
    ------
    InputError
        If the file cannot be read, or a rule is wrong.
    """
    return _rules(read_toml(path).get("point_sets", {}), path)


def read_materials(path: str | Path | None) -> dict[int, Material]:
    """Read only the materials of a TOML file, by region; other tables may be there.

    Regions it does not name, or all if there is no file, have the published materials.

    Raises
    ------
    InputError
        If the file cannot be read, has no [materials], or one is wrong.
    """
    if path is None:
        return dict(BRAIN_AND_TUMOUR)
    file = read_toml(path)
    if "materials" not in file:
        raise InputError(
            f"{path}: expected a table [materials] (got {', '.join(file)})"
        )
    return {**BRAIN_AND_TUMOUR, **_materials(file["materials"], path)}


def _paths(
    table: Mapping[str, Any],
    more: list[LoadRule],
    has_forces: bool,
    path: str | Path,
) -> Paths:
    where = f"[loads] in {path}"
    if not has_forces:
        levels = from_table(NoForces, table, where).levels
        return partial(without_forces, n_levels=levels, more=more)
    loads = asdict(from_table(Forces, table, where))
    forces = partial(
        cone_paths, n_paths=loads.pop("paths"), n_levels=loads.pop("levels"), **loads
    )
    return partial(with_more, paths=forces, more=more) if more else forces


def _more_loads(tables: Any, path: Path) -> list[LoadRule]:
    if not isinstance(tables, list):
        raise InputError(f"more loads in {path} must be tables [[loads.more]]")
    rules = []
    for number, table in enumerate(tables, 1):
        where = f"[[loads.more]] number {number} in {path}"
        rule = named(table, "kind", MORE_LOADS, where)
        values = {key: value for key, value in table.items() if key != "kind"}
        made = from_table(rule, values, where)
        if isinstance(made, MeasuredPlaces):
            made = replace(made, file=str(path.parent / made.file))
        rules.append(made)
    return rules


def _element(name: Any, path: str | Path) -> str:
    try:
        return SolverOptions(element=name).element
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _removed(name: Any, path: str | Path) -> int | None:
    return None if name is None else _region(str(name), f"remove_region of {path}")


def _region(name: str, where: str) -> int:
    if name not in REGIONS and not name.isdecimal():
        raise InputError(
            f"unknown region '{name}' in {where} (use {', '.join(REGIONS)} or the "
            "region's number)"
        )
    return REGIONS[name] if name in REGIONS else int(name)


def _rules(table: Any, path: str | Path) -> dict[str, Rule]:
    if not isinstance(table, Mapping):
        raise InputError(f"point_sets in {path} must be tables (got {table!r})")
    return {name: rule_from_table(rule) for name, rule in table.items()}


def _materials(table: Any, path: str | Path | None) -> dict[int, Material]:
    if not isinstance(table, Mapping):
        raise InputError(f"materials in {path} must be tables (got {table!r})")
    return {
        _region(name, f"[materials] of {path}"): _material(
            values, f"[materials.{name}] in {path}"
        )
        for name, values in table.items()
    }


def _material(values: Any, where: str) -> Material:
    """Make a material of a law's name and parameters, or of a tissue's name."""
    if not isinstance(values, Mapping):
        raise InputError(f"{where} must be a table")
    if "tissue" in values:
        check_keys(values, ("tissue",), where)
        return named(values, "tissue", TISSUES, where).material
    material = {"law": "neo-hookean", **values}
    law = named(material, "law", LAWS, where)
    del material["law"]
    known = [field.name for field in fields(law)]
    if sorted(material) != sorted(known):
        raise InputError(
            f"{where}: law '{law.law}' takes {', '.join(known)}; or give tissue alone "  # type: ignore[attr-defined]
            f"(got {', '.join(material) or 'nothing'})"
        )
    made: Material = from_table(law, material, where)
    return made
