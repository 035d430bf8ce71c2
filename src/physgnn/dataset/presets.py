"""What to simulate on a mesh, and presets of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from physgnn.arrays import IntArray
from physgnn.dataset.load_rules import Further, Paths, drawn_further
from physgnn.dataset.membranes import Membranes
from physgnn.dataset.size_bound import check_dataset_size
from physgnn.errors import InputError
from physgnn.geometry import point_sets
from physgnn.geometry.point_sets import HalfSpace, Nearest, Rule
from physgnn.geometry.regions import BRAIN, REGIONS, TUMOUR
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.loads.patch_sampling import patch_load_paths
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import (
    all_node_paths,
    further_all_node_paths,
    further_single_node_paths,
    single_node_paths,
    traction_paths,
)
from physgnn.mechanics.materials import TISSUES, Material
from physgnn.mechanics.resection import remove_region


@dataclass(frozen=True)
class Preset:
    """Where a body is held, where and how it is loaded, and what it is made of.

    Attributes
    ----------
    materials : mapping of region label to Material
        May name regions the mesh does not have.
    paths : callable
        From mesh and loaded nodes to load paths.
    further : callable, optional
        From these and a number to so many further ones of the same kind.
    fixed, loaded : rule or None
        Points held and points loaded; None takes the mesh's point set of that name.
    others : mapping of str to rule
        More point sets, which loads of other kinds act on.
    has_forces : bool
        False if the paths have no nodal forces: then nothing need be loaded.
    element : str
        As in `physgnn.mechanics.SolverOptions`.
    removed : int or None
        Region taken out before all else; its walls are then outer surface.
    membranes : Membranes
        How falx and tentorium act.
    """

    materials: Mapping[int, Material]
    paths: Paths
    further: Further | None = None
    fixed: Rule | None = None
    loaded: Rule | None = None
    others: Mapping[str, Rule] = field(default_factory=dict)
    has_forces: bool = True
    element: str = DEFAULT_ELEMENT
    removed: int | None = None
    membranes: Membranes = field(default_factory=Membranes)

    def on(
        self, mesh: TetMesh, training_paths: int = 0
    ) -> tuple[TetMesh, list[LoadPath]]:
        """Return the mesh to be solved on, with its point sets, and the load paths.

        Parameters
        ----------
        mesh : TetMesh
            The mesh.
        training_paths : int
            So many further paths, of another draw, come after the others.

        Raises
        ------
        InputError
            If a rule selects nothing, the mesh lacks a set that has no rule, a load
            does not fit it, or further paths are asked for and none can be drawn.
        """
        if self.removed is not None:
            mesh, _ = remove_region(mesh, self.removed)
        rules = {"fixed": self.fixed, "loaded": self.loaded, **self.others}
        sets = {
            name: mesh.point_set(name)
            if rule is None
            else point_sets.select(mesh, rule)
            for name, rule in rules.items()
            if name != "loaded" or rule is not None or self.has_forces
        }
        mesh = self.membranes.holding(mesh.with_point_sets(**sets))
        none = np.empty(0, dtype=np.int64)
        loaded = mesh.point_set("loaded") if "loaded" in sets else none
        paths = self.paths(mesh, loaded)
        if training_paths:
            paths = [*paths, *self._further(mesh, loaded, paths, training_paths)]
        return mesh, self.membranes.on(mesh, paths)

    def _further(
        self, mesh: TetMesh, loaded: IntArray, paths: list[LoadPath], count: int
    ) -> list[LoadPath]:
        """Return so many paths beyond these."""
        if self.further is None:
            raise InputError(
                "further load paths for training need forces that are drawn, without "
                "loads of other kinds: leave out --training-paths"
            )
        check_dataset_size(len(paths) + count, paths[0].n_levels, mesh.n_points)
        return self.further(mesh, loaded, count)


BRAIN_AND_TUMOUR: Mapping[int, Material] = {
    region: TISSUES[REGIONS[region]].material for region in (BRAIN, TUMOUR)
}
"""The published materials: brain, tumour."""

PUBLISHED_FIXED = HalfSpace((20.0, 0.0), (80.0, 90.0, 120.0), "<", 265.0)

DEMO_LOADS = partial(
    patch_load_paths,
    radius_mm=(10.0, 45.0),
    force_n=(2.0, 4.0),
    nodal_force_n=0.3,
    cone_deg=35.0,
    n_levels=10,
)
FAMILY_LOADS = partial(traction_paths, traction_pa=2200.0, n_levels=10)

PRESETS: Mapping[str, Preset] = {
    "paper-1": Preset(
        BRAIN_AND_TUMOUR,
        partial(single_node_paths, force_n=1.35, n_levels=30),
        further=partial(further_single_node_paths, force_n=1.35, n_levels=30),
        fixed=PUBLISHED_FIXED,
        loaded=HalfSpace((15.0, 20.0), (80.0, 110.0, 130.0), ">", 275.5),
    ),
    "paper-2": Preset(
        BRAIN_AND_TUMOUR,
        partial(all_node_paths, total_force_n=20.0, n_levels=30, n_paths=165),
        further=partial(further_all_node_paths, total_force_n=20.0, n_levels=30),
        fixed=PUBLISHED_FIXED,
        loaded=HalfSpace((200.0, 0.0), (80.0, 110.0, 130.0), "<=", -32.4),
    ),
    # A craniotomy over the tumour of the bundled MNI152 case; skull over the rest. The
    # smallest patches are one node.
    "demo": Preset(
        BRAIN_AND_TUMOUR,
        partial(DEMO_LOADS, n_paths=64),
        further=partial(drawn_further, rule=DEMO_LOADS),
        fixed=HalfSpace((23.0, -35.0), (0.0, 0.0, 0.0), "<", 30.0),
        loaded=Nearest((39.7, 8.8, 62.5), 60),
    ),
    # Loads as strong as the second published set's, on whatever the mesh lays open.
    "family": Preset(
        BRAIN_AND_TUMOUR,
        partial(FAMILY_LOADS, n_paths=6),
        further=partial(drawn_further, rule=FAMILY_LOADS),
    ),
}
"""The published datasets, the demonstration, and synthetic patients.

The demonstration's patch loads give 5 to 30 mm at the most displaced point; every level
converges.
"""


def find_preset(name: str) -> Preset:
    """Return a row of ``PRESETS``; InputError names those there are."""
    if name not in PRESETS:
        raise InputError(f"no preset '{name}' (there are: {', '.join(PRESETS)})")
    return PRESETS[name]
