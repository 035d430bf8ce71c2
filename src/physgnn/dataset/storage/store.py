"""The dataset: one mesh, many load paths, and the displacement along each."""

import os
from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage import layout
from physgnn.dataset.storage.definition import Definition
from physgnn.dataset.storage.load_records import kind_of
from physgnn.dataset.storage.result_rows import encoded
from physgnn.dataset.storage.stored_paths import StoredPaths
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.atomic import whole_folder
from physgnn.io.digest import digest_of
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.linear.factor_cache import FACTORS
from physgnn.mechanics.loads.paths import LoadCase, LoadPath
from physgnn.mechanics.materials import Material, material_from_config


class Store:
    """A dataset on disk, read lazily and written a load path at a time.

    Make one with `create` or `open`. Different paths may be written by different
    processes at the same time; a path is done once its status is on disk.

    Parameters
    ----------
    path : path-like
        The store's folder.
    cache_bytes : int
        How much of the displacement to keep in memory, bytes.

    Raises
    ------
    InputError
        If it is not a store, is of another version, or is damaged. Every method that
        reads raises this for a damaged chunk.
    """

    def __init__(
        self, path: str | os.PathLike[str], *, cache_bytes: int = 512 * 2**20
    ) -> None:
        self.path = Path(path)
        self._group = layout.open_group(self.path)
        self._attributes: dict[str, Any] = dict(self._group.attrs)
        self.load_factors: FloatArray = self._read("load_factors")
        self.load_factors.flags.writeable = False
        self.n_levels = len(self.load_factors)
        self.n_paths = int(self._attributes["n_paths"])
        path_bytes = 12 * self.n_levels * int(self._attributes["n_points"])
        # All entries have the same size, so a bound on their number bounds the bytes.
        self._cached = lru_cache(maxsize=max(cache_bytes // path_bytes, 1))(
            self._read_displacement
        )

    @classmethod
    def open(cls, path: str | os.PathLike[str], **options: int) -> Self:
        """Open an existing store; options as the class takes them."""
        return cls(path, **options)

    @classmethod
    def create(
        cls,
        path: str | os.PathLike[str],
        mesh: TetMesh,
        paths: Sequence[LoadPath],
        *,
        materials: Mapping[int, Material],
        fixed: IntArray,
        provenance: Mapping[str, Any],
        element: str = DEFAULT_ELEMENT,
    ) -> Self:
        """Make a store in which every path is pending.

        Parameters
        ----------
        path : path-like
            A folder that does not exist yet.
        mesh : TetMesh
            The mesh of all samples.
        paths : sequence of LoadPath
            All with the same load factors.
        materials : mapping of region to material
            One for every region of the mesh; others are left out.
        fixed : (n_fixed,) integer array
            Points held at zero displacement.
        provenance : mapping
            Anything JSON can hold: how the dataset came about.
        element : str
            As in `physgnn.mechanics.SolverOptions`.

        Raises
        ------
        InputError
            If the folder exists, a path does not fit, a region has no material, or
            the element is unknown.
        """
        target = Path(path)
        if target.exists():
            raise InputError(f"{target} exists already: open it, or name another")
        asked = Definition(mesh, paths, materials, fixed, element)
        with whole_folder(target) as part:
            asked.write(part, provenance)
        return cls(target)

    @classmethod
    def resume(
        cls,
        path: str | os.PathLike[str],
        mesh: TetMesh,
        paths: Sequence[LoadPath],
        *,
        provenance: Mapping[str, Any],
        **body: Any,
    ) -> Self:
        """Open the store if there is one that asks just this, or make it.

        Parameters are those of `create`.

        Raises
        ------
        InputError
            If the folder holds something else, or a store that asks something else.
        """
        if not Path(path).exists():
            return cls.create(path, mesh, paths, provenance=provenance, **body)
        store = cls(path)
        if store.definition_hash != Definition(mesh, paths, **body).digest:
            raise InputError(
                f"store {path} was made for another mesh, load, material or element: "
                "name another, or delete it"
            )
        return store

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path,)

    def _read(self, name: str, row: int | None = None) -> np.ndarray[Any, Any]:
        return layout.read(self._group, name, row)

    @cached_property
    def mesh(self) -> TetMesh:
        """The mesh, with its point sets."""
        mesh = TetMesh(
            points=self._read("mesh/points"),
            cells=self._read("mesh/cells"),
            region=self._read("mesh/region"),
            point_sets={
                name: self._read(f"mesh/point_sets/{name}")
                for name in self._attributes["point_sets"]
            },
        )
        if mesh.content_hash != self._attributes["mesh_hash"]:
            reason = "not the mesh the store was made with"
            raise InputError(layout.damaged(self._group, "mesh", None, reason))
        return mesh

    @cached_property
    def fixed(self) -> IntArray:
        """Points held at zero displacement."""
        return self._read("fixed")

    @cached_property
    def materials(self) -> dict[int, Material]:
        """Material of every region."""
        records = self._attributes["materials"]
        return {int(region): material_from_config(r) for region, r in records.items()}

    @property
    def element(self) -> str:
        """The finite element, as in `physgnn.mechanics.SolverOptions`."""
        return str(self._attributes.get("element", DEFAULT_ELEMENT))

    @cached_property
    def body(self) -> Body:
        """The finite-element problem; a large one's factors are kept beside it."""
        return Body(
            self.mesh,
            self.materials,
            self.fixed,
            element=self.element,
            factors=self.path.with_suffix(FACTORS),
        )

    @property
    def provenance(self) -> dict[str, Any]:
        """How the dataset came about, as given to `create`."""
        return dict(self._attributes["provenance"])

    @cached_property
    def _load_paths(self) -> StoredPaths:
        return StoredPaths.read(self._group, self.load_factors)

    def load_path(self, i: int) -> LoadPath:
        """Return load path ``i`` with all its loads."""
        return self._load_paths[i]

    def load_case(self, i: int, level: int) -> LoadCase:
        """Return the load case of path ``i`` at a 0-based level.

        Raises
        ------
        InputError
            If the path has more than nodal forces, which a load case cannot carry.
        """
        path = self.load_path(i)
        if path.more:
            kinds = ", ".join(sorted({kind_of(load) for load in path.more}))
            raise InputError(
                f"store {self.path}: load path {i} has other loads than nodal forces "
                f"({kinds}), and networks take nodal forces alone: use a dataset "
                "without them"
            )
        return path.case(level)

    def displacement(self, i: int) -> NDArray[np.float32]:
        """Return path ``i``'s displacement, (n_levels, n_points, 3), mm, read-only.

        Raises
        ------
        InputError
            If the path is pending or its chunk is damaged.
        """
        return self._cached(i)

    def _read_displacement(self, i: int) -> NDArray[np.float32]:
        if self.is_pending(i):
            raise InputError(
                f"store {self.path}: load path {i} has no result yet; run "
                "'physgnn simulate' again to resume"
            )
        values: NDArray[np.float32] = self._read("result/displacement", i)
        if np.isnan(values).any():  # what Zarr gives for a chunk that is not there
            name = "result/displacement"
            raise InputError(layout.damaged(self._group, name, i, "chunk missing"))
        values.flags.writeable = False
        return values

    @property
    def status(self) -> NDArray[np.int8]:
        """`Status` of every level, (n_paths, n_levels), read afresh every time."""
        return self._read("result/status")

    @property
    def residual(self) -> NDArray[np.float32]:
        """Relative residual of every level, (n_paths, n_levels); NaN if pending."""
        return self._read("result/residual")

    @property
    def seconds(self) -> FloatArray:
        """Time each path took to solve, (n_paths,), s; NaN if pending."""
        return self._read("result/seconds")

    @property
    def reached(self) -> FloatArray:
        """Highest load factor in equilibrium, (n_paths,); NaN if pending."""
        return self._read("result/reached")

    def message(self, i: int) -> str:
        """Return what there is to say of path ``i``, as `Solution.message`."""
        return bytes(self._read("result/message", i)).rstrip(b"\0").decode()

    def messages(self) -> dict[int, str]:
        """Return what there is to say of any path, by path."""
        said = self._read("result/message").any(axis=1)
        return {i: self.message(i) for i in np.flatnonzero(said).tolist()}

    def write(self, i: int, solution: Solution) -> None:
        """Store the solution of path ``i``; its status goes last."""
        for name, row in encoded(solution).items():
            self._group[f"result/{name}"][i] = row  # type: ignore[index]

    def pending(self) -> IntArray:
        """Return the paths without a result."""
        return np.flatnonzero((self.status == Status.NOT_SOLVED).all(axis=1))

    def is_pending(self, i: int) -> bool:
        """Return whether path ``i`` has no result."""
        return bool((self._read("result/status", i) == Status.NOT_SOLVED).all())

    def samples(self) -> IntArray:
        """Return (path, level) of every converged sample, path by path, (n, 2)."""
        return np.argwhere(self.status == Status.CONVERGED)

    @property
    def definition_hash(self) -> str:
        """SHA-256 of mesh, materials, fixed points and load paths: what is asked."""
        return str(self._attributes["definition_hash"])

    def content_hash(self) -> str:
        """SHA-256 of what is asked and of all answers so far; times do not count."""
        return digest_of(self.definition_hash, self._read("result/digest"))
