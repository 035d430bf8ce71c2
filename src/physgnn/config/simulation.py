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

[membranes]                   # sheets that a label map's mesh has; left out if not
falx = "held"                 # named: or "elastic", "left-out"
tentorium = "elastic"
stiffness_pa_per_mm = 1000    # of elastic ones

[loads]                       # forces drawn at random, see LoadsTable
total_force_n = 5.0           # without it there is one path, of levels steps

[[loads.more]]                # more loads, on every path: see MORE_LOADS
kind = "gravity"
direction = [0, 0, -1]
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    NonNegativeInt,
    PositiveInt,
    model_validator,
)
from pydantic_core import PydanticCustomError

from physgnn.choices import MembraneSupport
from physgnn.config.materials import MATERIALS, region_of
from physgnn.config.point_sets import RULES_BY_NAME
from physgnn.config.tables import ConfigTable, read_as, read_toml, variants
from physgnn.dataset.load_rules import (
    MORE_LOADS,
    Further,
    MeasuredPlaces,
    Paths,
    PressureOn,
    Shift,
    bounded,
    drawn_further,
    with_more,
    without_forces,
)
from physgnn.dataset.membranes import Membranes
from physgnn.dataset.presets import BRAIN_AND_TUMOUR, Preset
from physgnn.errors import InputError
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT, checked_element
from physgnn.mechanics.loads.growth_rules import GrowthIn
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import cone_paths

POINT_SETS = ("fixed", "loaded")


class LoadsTable(ConfigTable):
    """The ``[loads]`` table: see `physgnn.mechanics.loads.sampling.cone_paths`.

    Attributes
    ----------
    total_force_n : float
        Force on the loaded patch at the last level, N. It may be left out where there
        are more loads: then these are all.
    cone_deg : float
        Half-angle of the cone of directions about the inward normal, degrees.
    paths, levels : int
        Load paths, and equal load steps on each.
    nodes_per_path : int or None
        Nodes of a patch; by default all loaded ones.
    seed : int
        Of the directions and patches.
    more : tuple of load rules
        On every path beside the forces, each a table with the ``kind`` of a row of
        `physgnn.dataset.load_rules.MORE_LOADS`.
    """

    total_force_n: float | None = Field(default=None, gt=0)
    cone_deg: float = 30.0
    paths: PositiveInt = 100
    levels: PositiveInt = 10
    nodes_per_path: PositiveInt | None = None
    seed: NonNegativeInt = 0
    more: tuple[variants("kind", MORE_LOADS), ...] = ()  # type: ignore[valid-type]

    @property
    def has_forces(self) -> bool:
        """Whether nodal forces are drawn."""
        return not self.more or bool(self.model_fields_set - {"levels", "more"})

    @model_validator(mode="after")
    def _has_a_size(self) -> Self:
        if self.has_forces and self.total_force_n is None:
            raise PydanticCustomError("lacks_key", "{key}", {"key": "total_force_n"})
        return self

    def drawn(self, folder: Path) -> Paths:
        """Return what draws the paths; files are named from `folder`."""
        more = [
            replace(rule, file=str(folder / rule.file))
            if isinstance(rule, MeasuredPlaces)
            else rule
            for rule in self.more
        ]
        forces: Paths = partial(self._forces, n_paths=self.paths, seed=self.seed)
        n_paths, paths = self.paths, forces
        if not self.has_forces:
            n_paths = 1
            paths = partial(without_forces, n_levels=self.levels, more=more)
        elif more:
            paths = partial(with_more, paths=forces, more=more)
        return partial(bounded, paths=paths, n_paths=n_paths, n_levels=self.levels)

    @property
    def further(self) -> Further | None:
        """What draws further paths; None where there are loads of other kinds."""
        if self.more:
            return None
        return partial(drawn_further, rule=self._forces, seed=self.seed)

    @property
    def _forces(self) -> Callable[..., list[LoadPath]]:
        drawn = self.model_dump(exclude={"paths", "levels", "seed", "more"})
        return partial(cone_paths, n_levels=self.levels, **drawn)


def _support_of(value: Any) -> MembraneSupport:
    """Return the support of a name; a table's values are taken strictly."""
    if value not in list(MembraneSupport):
        raise InputError(f"must be one of {', '.join(MembraneSupport)} (got '{value}')")
    return MembraneSupport(value)


SUPPORT = Annotated[MembraneSupport, BeforeValidator(_support_of)]


class MembranesTable(ConfigTable):
    """The ``[membranes]`` table: see `physgnn.dataset.membranes.Membranes`."""

    falx: SUPPORT = MembraneSupport.LEFT_OUT
    tentorium: SUPPORT = MembraneSupport.LEFT_OUT
    stiffness_pa_per_mm: float = Field(default=1000.0, gt=0)


class SimulationTable(ConfigTable):
    """The whole file."""

    element: Annotated[str, AfterValidator(checked_element)] = DEFAULT_ELEMENT
    remove_region: Annotated[int, BeforeValidator(region_of)] | None = None
    point_sets: RULES_BY_NAME = Field(default_factory=dict)
    materials: MATERIALS = Field(default_factory=dict)
    membranes: MembranesTable = Field(default_factory=MembranesTable)
    loads: LoadsTable

    @model_validator(mode="after")
    def _uses_its_point_sets(self) -> Self:
        acted_on = [
            r.points
            for r in self.loads.more
            if isinstance(r, PressureOn | Shift | GrowthIn) and r.points is not None
        ]
        known = list(dict.fromkeys([*POINT_SETS, *acted_on]))
        for name in self.point_sets:
            if name not in known:
                raise InputError(
                    f"unknown key '{name}' in [point_sets] (its keys: "
                    f"{', '.join(known)})"
                )
        return self


def read_membranes(path: str | Path | None) -> Membranes:
    """Read only the table ``[membranes]`` of a TOML file; others may be there.

    Parameters
    ----------
    path : path or None
        The TOML file; None leaves all membranes out.

    Returns
    -------
    Membranes
        How falx and tentorium act.

    Raises
    ------
    InputError
        If the file cannot be read, has no [membranes], or a key or value is wrong.
    """
    if path is None:
        return Membranes()
    file = read_toml(path)
    if "membranes" not in file:
        raise InputError(
            f"{path}: expected a table [membranes] (got {', '.join(file)})"
        )
    at = ("membranes",)
    table: MembranesTable = read_as(MembranesTable, file["membranes"], path, at=at)
    return Membranes(**table.model_dump())


def read_preset(path: str | Path) -> Preset:
    """Read what to simulate from a TOML file.

    Parameters
    ----------
    path : path
        The TOML file.

    Returns
    -------
    Preset
        Point sets, materials, element and load paths.

    Raises
    ------
    InputError
        If the file cannot be read, or a key or value is wrong.
    """
    file: SimulationTable = read_as(SimulationTable, read_toml(path), path)
    rules: dict[str, Any] = dict(file.point_sets)
    sets = {name: rules.pop(name, None) for name in POINT_SETS}
    return Preset(
        materials={**BRAIN_AND_TUMOUR, **file.materials},
        paths=file.loads.drawn(Path(path).parent),
        further=file.loads.further,
        **sets,
        others=rules,
        has_forces=file.loads.has_forces,
        element=file.element,
        removed=file.remove_region,
        membranes=Membranes(**file.membranes.model_dump()),
    )
