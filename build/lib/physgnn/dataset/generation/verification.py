"""Check a sample of the converged levels of a store against full Newton.

One level of every fifth load path, drawn by a seed, is solved again by Newton's method
in double precision from where it is, and the largest distance any point moves is
stored under ``verification``. It is no part of the store's content hash.
"""

from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.generation.work import Work, each
from physgnn.dataset.storage.store import Store
from physgnn.dataset.storage.verification_rows import make_rows, read_rows, write_row
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.progress import Progress

EVERY = 5  # paths
SEED = 0


@dataclass(frozen=True, eq=False)
class Verification:
    """How far checked levels are from equilibrium.

    Attributes
    ----------
    samples : (n, 2) integer array
        (path, level) of every checked level.
    distance_mm : (n,) array
        Largest distance of any point from its place by full Newton; infinite if that
        finds no equilibrium nearby.
    n_converged : int
        Levels that converged in the whole store.
    """

    samples: IntArray
    distance_mm: FloatArray
    n_converged: int

    @property
    def largest_mm(self) -> float:
        """The largest distance of all; 0 if none was checked."""
        return float(self.distance_mm.max(initial=0.0))

    def __str__(self) -> str:
        if not len(self.samples):
            return f"checked none of {self.n_converged} levels against full Newton"
        path, level = self.samples[self.distance_mm.argmax()]
        return (
            f"checked {len(self.samples)} of {self.n_converged} levels against full "
            f"Newton: largest difference {self.largest_mm:.1g} mm (load path {path}, "
            f"level {level})"
        )


def verify(
    store: Store,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Verification:
    """Check the sample's levels that were not checked yet.

    Parameters
    ----------
    store : Store
        The distances are stored in it.
    workers, scheduler
        See `physgnn.dataset.generation.work.each`.
    progress : callable, optional
        Called with the levels done, the levels to do, and how far off the last one
        was.

    Returns
    -------
    Verification
        Of all levels checked so far.
    """
    make_rows(store.reader)
    checked = read_rows(store.reader)[0][:, 0]
    unchecked = ~np.isin(np.arange(store.n_paths), checked)
    converged = (store.status == Status.CONVERGED).any(axis=1)
    drawn = np.arange(store.n_paths) % EVERY == 0
    paths = np.flatnonzero(drawn & unchecked & converged).tolist()
    where: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    with closing(each(CHECK, store, paths, **where)) as results:
        for done, (i, ended, error) in enumerate(results, 1):
            if progress:
                progress(done, len(paths), f"checking load path {i}: {error or ended}")
    return verification_of(store)


def verification_of(store: Store) -> Verification:
    """Return what a store says of the levels checked so far; nothing is computed.

    Parameters
    ----------
    store : Store
        The dataset.

    Returns
    -------
    Verification
        Which levels were checked, and how far each is from full Newton, mm.
    """
    samples, distance_mm = read_rows(store.reader)
    return Verification(samples, distance_mm, len(store.samples()))


def draw_level(store: Store, i: int) -> int:
    """Return the level of path `i` to check: the same whoever asks, and when."""
    levels = np.flatnonzero(store.status[i] == Status.CONVERGED)
    return int(np.random.default_rng([SEED, i]).choice(levels))


def _newton_of(store: Store) -> Newton:
    return Newton(store.body)


def _check_and_write(store: Store, newton: Newton, i: int) -> tuple[str, str]:
    level = draw_level(store, i)
    displacement = store.displacement(i)[level].astype(np.float64)
    factor = float(store.load_factors[level])
    distance = newton.distance(store.load_path(i), displacement, factor)
    write_row(store.reader, i, level, distance)
    return f"{distance:.1g} mm off", ""


CHECK = Work(_newton_of, _check_and_write)
