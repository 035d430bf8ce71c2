"""The load paths of a store, as they lie on disk."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.load_records import from_record
from physgnn.dataset.storage.reader import StoreReader
from physgnn.mechanics.loads.paths import Load, LoadPath


@dataclass(frozen=True)
class StoredPaths:
    """Every load path's loads, in tables with a row a path.

    Parameters
    ----------
    nodes : (n_paths, n_most) int array
        Loaded points, -1 beyond a path's last.
    forces : (n_paths, n_most, 3) array
        Nodal forces at factor 1, N.
    more : list of Load
        All loads beside nodal forces.
    more_of_path : (n_paths, n) int array
        Which of them every path has, -1 beyond the last.
    load_factors : (n_levels,) array
        Those of all paths.
    """

    nodes: IntArray
    forces: FloatArray
    more: list[Load]
    more_of_path: NDArray[np.int32]
    load_factors: FloatArray

    @classmethod
    def read(cls, reader: StoreReader, load_factors: FloatArray) -> Self:
        """Read the tables of a store; InputError if they are damaged."""
        nodes, forces = reader.part("loads/nodes"), reader.part("loads/forces")
        records = reader.attributes.more_loads
        of_path = np.empty((len(nodes), 0), dtype=np.int32)
        if records:
            of_path = reader.part("loads/more_of_path")
        with reader.making("loads/more"):
            more = [
                from_record(record, reader.parts(f"loads/more/{k}"))
                for k, record in enumerate(records)
            ]
        return cls(nodes, forces, more, of_path, load_factors)

    def __getitem__(self, i: int) -> LoadPath:
        used = self.nodes[i] >= 0
        more = tuple(self.more[k] for k in self.more_of_path[i] if k >= 0)
        return LoadPath(
            self.nodes[i][used], self.forces[i][used], self.load_factors, more
        )
