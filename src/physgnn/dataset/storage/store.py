"""The dataset: one mesh, many load paths, and the displacement along each."""

import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.attributes import note_without_digests
from physgnn.dataset.storage.definition import Definition
from physgnn.dataset.storage.load_records import kind_of
from physgnn.dataset.storage.reader import StoreReader
from physgnn.dataset.storage.results import StoredResults
from physgnn.dataset.storage.stored_paths import StoredPaths
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.integrity.atomic import whole_folder
from physgnn.io.integrity.digest import digest_of
from physgnn.io.integrity.strays import clear_partial_chunks
from physgnn.mechanics.body import Body
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
        self.reader = StoreReader.open(self.path)
        self._attributes = self.reader.attributes
        self.load_factors: FloatArray = self.reader.part("load_factors")
        self.load_factors.flags.writeable = False
        self.n_levels = len(self.load_factors)
        self.n_paths = self._attributes.n_paths
        self.training_paths = self._attributes.training_paths
        self._results = StoredResults(self.reader, self.n_levels, cache_bytes)

    @classmethod
    def open(cls, path: str | os.PathLike[str], **options: int) -> Self:
        """Open an existing store; options as the class takes them.

        One made before stores had digests is opened with a note in the log.
        """
        store = cls(path, **options)
        if not store._attributes.has_digests:
            note_without_digests(store.path.resolve())
        return store

    @classmethod
    def create(
        cls,
        path: str | os.PathLike[str],
        body: Body,
        paths: Sequence[LoadPath],
        *,
        provenance: Mapping[str, Any],
        training_paths: int = 0,
    ) -> Self:
        """Make a store in which every path is pending.

        Parameters
        ----------
        path : path-like
            A folder that does not exist yet.
        body : Body
            What all samples are of; materials of regions that its mesh lacks are left
            out.
        paths : sequence of LoadPath
            All with the same load factors.
        provenance : mapping
            Anything JSON can hold: how the dataset came about.
        training_paths : int
            So many paths, the last, are for training alone: splits hold none out.

        Raises
        ------
        InputError
            If the folder exists, or a path does not fit or leaves a part of the body
            free to move.
        """
        target = Path(path)
        if target.exists():
            raise InputError(f"{target} exists already: open it, or name another")
        definition = Definition(body, paths, training_paths)
        with whole_folder(target) as part:
            definition.write(part, provenance)
        return cls(target)

    @classmethod
    def resume(
        cls,
        path: str | os.PathLike[str],
        body: Body,
        paths: Sequence[LoadPath],
        *,
        provenance: Mapping[str, Any],
        training_paths: int = 0,
    ) -> Self:
        """Open the store if there is one of just these problems, or make it.

        Parameters are those of `create`.

        Raises
        ------
        InputError
            If the folder holds something else, or a store of other problems.
        """
        if not Path(path).exists():
            return cls.create(
                path,
                body,
                paths,
                provenance=provenance,
                training_paths=training_paths,
            )
        store = cls.open(path)
        clear_partial_chunks(store.path)
        if store.definition_hash != Definition(body, paths, training_paths).digest:
            raise InputError(
                f"store {path} was made for another mesh, load, material or element: "
                "name another, or delete it"
            )
        return store

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path,)

    @cached_property
    def mesh(self) -> TetMesh:
        """The mesh, with its point sets."""
        part = self.reader.part
        sets = self._attributes.point_sets
        arrays = {name: part(f"mesh/{name}") for name in ("points", "cells", "region")}
        point_sets = {name: part(f"mesh/point_sets/{name}") for name in sets}
        with self.reader.making("mesh"):
            mesh = TetMesh(**arrays, point_sets=point_sets)
            if mesh.content_hash != self._attributes.mesh_hash:
                raise InputError("not the mesh the store was made with")
        return mesh

    @cached_property
    def fixed(self) -> IntArray:
        """Points held at zero displacement."""
        return self.reader.part("fixed")

    @cached_property
    def materials(self) -> dict[int, Material]:
        """Material of every region."""
        records = self._attributes.materials
        with self.reader.making("materials"):
            return {int(k): material_from_config(r) for k, r in records.items()}

    @property
    def element(self) -> str:
        """The finite element, as in `physgnn.mechanics.SolverOptions`."""
        return self._attributes.element

    @cached_property
    def body(self) -> Body:
        """The finite-element problem; a large one's factors are stored beside it."""
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
        return dict(self._attributes.provenance)

    @cached_property
    def _load_paths(self) -> StoredPaths:
        return StoredPaths.read(self.reader, self.load_factors)

    def load_path(self, i: int) -> LoadPath:
        """Return load path ``i`` with all its loads."""
        with self.reader.making(f"loads/nodes, row {i}"):
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
        return self._results.displacement(i)

    @property
    def status(self) -> NDArray[np.int8]:
        """`Status` of every level, (n_paths, n_levels), read afresh every time."""
        return self._results.row("status")

    @property
    def residual(self) -> NDArray[np.float32]:
        """Relative residual of every level, (n_paths, n_levels); NaN if pending."""
        return self._results.row("residual")

    @property
    def seconds(self) -> FloatArray:
        """Time each path took to solve, (n_paths,), s; NaN if pending."""
        return self._results.row("seconds")

    @property
    def reached(self) -> FloatArray:
        """Highest load factor in equilibrium, (n_paths,); NaN if pending."""
        return self._results.row("reached")

    def message(self, i: int) -> str:
        """Return what there is to say of path ``i``, as `Solution.message`."""
        return bytes(self._results.row("message", i)).rstrip(b"\0").decode()

    def messages(self) -> dict[int, str]:
        """Return what there is to say of any path, by path."""
        said = self._results.row("message").any(axis=1)
        return {i: self.message(i) for i in np.flatnonzero(said).tolist()}

    def write(self, i: int, solution: Solution) -> None:
        """Store the solution of path ``i``; its status goes last."""
        self._results.write(i, solution)

    def pending(self) -> IntArray:
        """Return the paths without a result."""
        return np.flatnonzero((self.status == Status.NOT_SOLVED).all(axis=1))

    def is_pending(self, i: int) -> bool:
        """Return whether path ``i`` has no result."""
        return self._results.is_pending(i)

    def samples(self) -> IntArray:
        """Return (path, level) of every converged sample, path by path, (n, 2)."""
        return np.argwhere(self.status == Status.CONVERGED)

    @property
    def definition_hash(self) -> str:
        """SHA-256 of mesh, element, materials, fixed points and load paths."""
        return self._attributes.definition_hash

    def content_hash(self) -> str:
        """SHA-256 of the definition and of all results so far; times do not count."""
        return digest_of(self.definition_hash, self._results.row("digest"))
