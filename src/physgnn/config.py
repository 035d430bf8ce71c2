"""Settings from TOML files: every key checked, every mistake one clear line.

What to simulate (``physgnn simulate --loads``)::

    [point_sets.fixed]            # rules: physgnn.geometry.point_sets; a set that is
    kind = "half_space"           # left out must be in the mesh file
    rotation_deg = [20, 0]
    offset_mm = [80, 90, 120]
    keep = "<"
    limit_mm = 265

    [point_sets.loaded]
    kind = "nearest"
    point_mm = [62, 129, 150]
    count = 60

    [materials.brain]             # or tumour, ventricle, or a region's number; by
    youngs_modulus_pa = 3000      # default the published brain and tumour
    poissons_ratio = 0.49

    [loads]                       # see Loads
    total_force_n = 5.0

How to train (``physgnn train --config``): the fields of
`physgnn.learning.TrainingConfig`, and a table ``[options]`` for the model's own.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from functools import partial
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Any,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from physgnn.dataset.presets import BRAIN_AND_TUMOUR, Preset
from physgnn.errors import InputError
from physgnn.geometry.point_sets import Rule, rule_from_table
from physgnn.mechanics.load_paths import cone_paths
from physgnn.mechanics.materials import Material, material_from_config

if TYPE_CHECKING:
    from physgnn.learning.training_config import TrainingConfig

REGIONS = {"brain": 0, "tumour": 1, "ventricle": 2}
POINT_SETS = ("fixed", "loaded")

T = TypeVar("T")


@dataclass(frozen=True)
class Loads:
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


def read_preset(path: str | Path) -> Preset:
    """Read what to simulate from a TOML file.

    Raises
    ------
    InputError
        If the file cannot be read, or a key or value is wrong.
    """
    tables = read_toml(path)
    check_keys(tables, ("point_sets", "materials", "loads"), str(path))
    if "loads" not in tables:
        raise InputError(f"{path} needs a table [loads] with total_force_n")
    loads = asdict(from_table(Loads, tables["loads"], f"[loads] in {path}"))
    rules = _rules(tables.get("point_sets", {}), path)
    check_keys(rules, POINT_SETS, f"[point_sets] of {path}")
    return Preset(
        materials={**BRAIN_AND_TUMOUR, **_materials(tables.get("materials", {}), path)},
        paths=partial(
            cone_paths,
            n_paths=loads.pop("paths"),
            n_levels=loads.pop("levels"),
            **loads,
        ),
        **{name: rules.get(name) for name in POINT_SETS},
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
        If the file cannot be read, or a material is wrong.
    """
    table = {} if path is None else read_toml(path).get("materials", {})
    return {**BRAIN_AND_TUMOUR, **_materials(table, path)}


def read_training(path: str | Path | None, **changes: Any) -> "TrainingConfig":
    """Read a training configuration; `changes` that are not None win over the file.

    Raises
    ------
    InputError
        If the file cannot be read, or a key or value is wrong.
    """
    # torch takes seconds to import, and simulating does not need it
    from physgnn.learning.training_config import TrainingConfig

    values = {} if path is None else read_toml(path)
    options = {**values.pop("options", {}), **changes.pop("options", {})}
    given = {name: value for name, value in changes.items() if value is not None}
    where = "the training configuration" if path is None else str(path)
    return from_table(TrainingConfig, {**values, **given, "options": options}, where)


def read_toml(path: str | Path) -> dict[str, Any]:
    """Return the tables of a TOML file; InputError says where it is broken."""
    try:
        return tomllib.loads(Path(path).read_text("utf-8"))
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from error
    except ValueError as error:  # TOML or UTF-8
        raise InputError(f"{path} is not a TOML file: {error}") from error


def from_table(cls: type[T], table: Any, where: str) -> T:
    """Make a dataclass of a table, its keys and the types of its values checked.

    Raises
    ------
    InputError
        If a key is unknown or missing, or a value has another type.
    """
    if not isinstance(table, Mapping):
        raise InputError(f"{where} must be a table (got {table!r})")
    known = fields(cls)  # type: ignore[arg-type]
    check_keys(table, [field.name for field in known], where)
    for field in known:
        required = field.default is MISSING and field.default_factory is MISSING
        if required and field.name not in table:
            raise InputError(f"{where} needs the key '{field.name}'")
    types = get_type_hints(cls)
    for name, value in table.items():
        _check_type(name, value, types[name], where)
    return cls(**table)


def check_keys(table: Mapping[str, Any], allowed: Any, where: str) -> None:
    """Raise InputError for the first key that is not among those allowed."""
    for key in table:
        if key not in allowed:
            raise InputError(
                f"unknown key '{key}' in {where} (its keys: {', '.join(allowed)})"
            )


def _check_type(name: str, value: Any, expected: Any, where: str) -> None:
    union = get_origin(expected) in (Union, UnionType)
    choices = get_args(expected) if union else (expected,)
    scalars = tuple(choice for choice in choices if choice in (int, float, str, bool))
    if not scalars:
        return
    accepted = (*scalars, *((int,) if float in scalars else ()))
    wrong_bool = isinstance(value, bool) and bool not in scalars
    optional = value is None and NoneType in choices
    if not optional and (wrong_bool or not isinstance(value, accepted)):
        words = " or ".join(choice.__name__ for choice in scalars)
        raise InputError(f"{name} in {where} must be {words} (got {value!r})")


def _rules(table: Any, path: str | Path) -> dict[str, Rule]:
    if not isinstance(table, Mapping):
        raise InputError(f"point_sets in {path} must be tables (got {table!r})")
    return {name: rule_from_table(rule) for name, rule in table.items()}


def _materials(table: Any, path: str | Path | None) -> dict[int, Material]:
    if not isinstance(table, Mapping):
        raise InputError(f"materials in {path} must be tables (got {table!r})")
    materials = {}
    for name, values in table.items():
        if name not in REGIONS and not name.isdecimal():
            raise InputError(
                f"unknown region '{name}' in [materials] of {path} (use "
                f"{', '.join(REGIONS)} or the region's number)"
            )
        if not isinstance(values, Mapping):
            raise InputError(f"[materials.{name}] in {path} must be a table")
        region = REGIONS[name] if name in REGIONS else int(name)
        materials[region] = material_from_config(values)
    return materials
