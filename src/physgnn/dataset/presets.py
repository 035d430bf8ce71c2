"""What to simulate on a mesh, and three ready-made answers to that."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry import point_sets
from physgnn.geometry.point_sets import HalfSpace, Nearest, Rule
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.load_paths import all_node_paths, cone_paths, single_node_paths
from physgnn.mechanics.loads import LoadPath
from physgnn.mechanics.materials import Material, NeoHookean

IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Preset:
    """Where a body is held, where and how it is loaded, and what it is made of.

    Attributes
    ----------
    materials : mapping of region label to Material
        May name regions the mesh does not have.
    paths : callable
        From mesh and loaded nodes to load paths.
    fixed, loaded : rule or None
        Points held and points loaded; None takes the mesh's point set of that name.
    """

    materials: Mapping[int, Material]
    paths: Callable[[TetMesh, IntArray], list[LoadPath]]
    fixed: Rule | None = None
    loaded: Rule | None = None

    def on(self, mesh: TetMesh) -> tuple[TetMesh, list[LoadPath]]:
        """Return the mesh with its sets "fixed" and "loaded", and the load paths.

        Raises
        ------
        InputError
            If a rule selects nothing, or the mesh lacks a set that has no rule.
        """
        rules = {"fixed": self.fixed, "loaded": self.loaded}
        sets = {
            name: mesh.point_set(name)
            if rule is None
            else point_sets.select(mesh, rule)
            for name, rule in rules.items()
        }
        mesh = mesh.with_point_sets(**sets)
        return mesh, self.paths(mesh, sets["loaded"])


BRAIN_AND_TUMOUR: Mapping[int, Material] = {
    0: NeoHookean(youngs_modulus_pa=3000.0, poissons_ratio=0.49),
    1: NeoHookean(youngs_modulus_pa=7500.0, poissons_ratio=0.49),
}
"""The published materials: brain, tumour."""

PUBLISHED_FIXED = HalfSpace((20.0, 0.0), (80.0, 90.0, 120.0), "<", 265.0)

PRESETS: Mapping[str, Preset] = {
    "paper-1": Preset(
        BRAIN_AND_TUMOUR,
        partial(single_node_paths, force_n=1.35, n_levels=30),
        fixed=PUBLISHED_FIXED,
        loaded=HalfSpace((15.0, 20.0), (80.0, 110.0, 130.0), ">", 275.5),
    ),
    "paper-2": Preset(
        BRAIN_AND_TUMOUR,
        partial(all_node_paths, total_force_n=20.0, n_levels=30, n_paths=165),
        fixed=PUBLISHED_FIXED,
        loaded=HalfSpace((200.0, 0.0), (80.0, 110.0, 130.0), "<=", -32.4),
    ),
    # A craniotomy over the tumour of the bundled MNI152 case; skull over the rest.
    "demo": Preset(
        BRAIN_AND_TUMOUR,
        partial(
            cone_paths,
            total_force_n=4.0,
            n_levels=10,
            n_paths=48,
            cone_deg=35.0,
            nodes_per_path=30,
        ),
        fixed=HalfSpace((23.0, -35.0), (0.0, 0.0, 0.0), "<", 30.0),
        loaded=Nearest((39.7, 8.8, 62.5), 60),
    ),
}
"""The published datasets, and the demonstration.

The demonstration's force gives 13 to 20 mm at the most displaced point; every level
converges.
"""


def find_preset(name: str) -> Preset:
    """Return a row of ``PRESETS``; InputError names those there are."""
    if name not in PRESETS:
        raise InputError(f"no preset '{name}' (there are: {', '.join(PRESETS)})")
    return PRESETS[name]
