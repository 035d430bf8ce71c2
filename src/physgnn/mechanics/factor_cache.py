"""Factors kept on disk: a large body is factorised once, not at every start."""

import hashlib
import shutil
import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.mechanics.assembly import Pattern
from physgnn.mechanics.linear_solver import LinearSolver, PardisoSolver

FloatArray = NDArray[np.float64]


def factorize_cached(
    solver: LinearSolver, pattern: Pattern, data: FloatArray, folder: Path
) -> bool:
    """Factorise K, or read its factor from a folder where an earlier run left it.

    The name of a factor is the digest of the matrix and of the library that made it, so
    a changed mesh, material or support never meets an old factor.

    Parameters
    ----------
    solver : LinearSolver
        Only MKL Pardiso can write its factors; others factorise as ever.
    pattern, data
        The matrix.
    folder : Path
        Made if it isn't there. May be deleted at any time.

    Returns
    -------
    bool
        False if K is not positive definite.
    """
    if not isinstance(solver, PardisoSolver):
        return solver.factorize(data)
    kept = folder / _digest(pattern, data)
    if kept.is_dir() and solver.restore(kept, data):
        return True
    if not solver.factorize(data):
        return False
    folder.mkdir(parents=True, exist_ok=True)
    part = Path(tempfile.mkdtemp(prefix="part-", dir=folder))
    solver.store(part)
    shutil.rmtree(kept, ignore_errors=True)  # it was there but couldn't be read
    try:
        part.replace(kept)
    except OSError:  # another process was first
        shutil.rmtree(part, ignore_errors=True)
    return True


def _digest(pattern: Pattern, data: FloatArray) -> str:
    try:
        library = version("mkl")
    except PackageNotFoundError:
        library = "unknown"
    digest = hashlib.sha256(library.encode())
    for array in (pattern.indptr, pattern.indices, data):
        digest.update(array.tobytes())
    return digest.hexdigest()[:32]
