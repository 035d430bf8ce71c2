"""Factors cached on disk: a large body is factorised once, not at every start.

`RestState(cache=…)` uses it when asked. On the published brain (9444 points, one
thread) a factor is read in 0.3 s and made in 0.8; it takes 125 MB.
"""

import hashlib
import os
import shutil
import tempfile
import time
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from physgnn import scratch
from physgnn.arrays import FloatArray
from physgnn.mechanics.elements.tangent import Pattern
from physgnn.mechanics.linear.direct_solver import FACTOR_FILE, PardisoSolver
from physgnn.mechanics.linear.protocols import LinearSolver

FACTORS = ".factors"  # suffix of a folder of factors, beside mesh or store
MAX_BYTES = 8 * 2**30
CHECKSUM = "sha256"
MOST_RESIDUAL = 1e-6  # of the right-hand side; double precision leaves 1e-9 or less


def factorize_cached(
    solver: LinearSolver,
    pattern: Pattern,
    data: FloatArray,
    folder: Path,
    *,
    max_bytes: int = MAX_BYTES,
) -> bool:
    """Factorise K, or read its factor from a folder where an earlier run left it.

    The name of a factor is the digest of the matrix and of the library that made it, so
    a changed mesh, material or support never meets an old factor. What is read must be
    as it was written, and solve a system of the matrix; otherwise it is made again.

    Parameters
    ----------
    solver : LinearSolver
        Only MKL Pardiso can write its factors, and only if it was made to; others
        factorise as ever.
    pattern, data
        The matrix.
    folder : Path
        Made if it isn't there. May be deleted at any time.
    max_bytes : int
        What the folder may hold; the factors not used for longest go first.

    Returns
    -------
    bool
        False if K is not positive definite.
    """
    if not (isinstance(solver, PardisoSolver) and solver.storable):
        return solver.factorize(data)
    stored = folder / _digest(pattern, data)
    if (
        _whole(stored)
        and solver.restore(stored, data)
        and _solves(solver, pattern, data)
    ):
        _use(stored)
        return True
    if not solver.factorize(data):
        return False
    with suppress(OSError):  # read-only, full: the factor in memory serves as well
        _store(solver, stored)
        _forget_oldest(folder, max_bytes)
    return True


def _store(solver: PardisoSolver, stored: Path) -> None:
    folder = stored.parent
    folder.mkdir(parents=True, exist_ok=True)
    scratch.clear(folder)
    part = Path(tempfile.mkdtemp(prefix=scratch.prefix("factor"), dir=folder))
    try:
        solver.store(part)
        (part / CHECKSUM).write_text(_checksum(part))
        _use(part)
        shutil.rmtree(stored, ignore_errors=True)  # it was there but couldn't be read
        part.replace(stored)
    finally:  # another process was first, or the disk is full
        shutil.rmtree(part, ignore_errors=True)


def _whole(stored: Path) -> bool:
    """Whether a factor is there, and as it was written: Pardiso does not look."""
    try:
        return (stored / CHECKSUM).read_text() == _checksum(stored)
    except OSError:
        return False


def _solves(solver: PardisoSolver, pattern: Pattern, data: FloatArray) -> bool:
    """Whether a factor that was read is this matrix's: its name could be another's."""
    import scipy.sparse as sp

    n = len(pattern.indptr) - 1
    upper = sp.csr_array((data, pattern.indices, pattern.indptr), shape=(n, n))
    right = np.random.default_rng(0).standard_normal(n)
    x = solver.solve(right)
    product = upper @ x + upper.T @ x - upper.diagonal() * x
    residual = float(np.linalg.norm(product - right))
    return residual <= MOST_RESIDUAL * float(np.linalg.norm(right))


def _checksum(stored: Path) -> str:
    with (stored / FACTOR_FILE).open("rb") as file:
        return hashlib.file_digest(file, CHECKSUM).hexdigest()


def _use(stored: Path) -> None:
    """Note that a factor was used now; the file system's own clock ticks coarsely."""
    now = time.time_ns()
    os.utime(stored / CHECKSUM, ns=(now, now))


def _forget_oldest(folder: Path, max_bytes: int) -> None:
    total = 0
    factors = {
        file.parent: file.stat().st_mtime_ns for file in folder.glob(f"*/{CHECKSUM}")
    }
    for stored in sorted(factors, key=factors.__getitem__, reverse=True):
        total += sum(file.stat().st_size for file in stored.iterdir())
        if total > max_bytes:
            shutil.rmtree(stored, ignore_errors=True)


def _digest(pattern: Pattern, data: FloatArray) -> str:
    try:
        library = version("mkl")
    except PackageNotFoundError:
        library = "unknown"
    digest = hashlib.sha256(library.encode())
    for array in (pattern.indptr, pattern.indices, data):
        digest.update(array.tobytes())
    return digest.hexdigest()[:32]
