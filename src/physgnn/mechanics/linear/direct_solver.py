"""Direct solution of K x = b for the symmetric tangent, one interface.

MKL Pardiso where it is to be had (x86-64), SciPy's SuperLU elsewhere. The symbolic
analysis is done once a pattern; factors may be in single precision, which
halves time and memory where they only precondition an iteration whose residuals
are computed in double.
"""

import ctypes
import weakref
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.linear.mkl import mkl_library
from physgnn.mechanics.linear.protocols import DirectSolver, UpperTriangle

FactorPrecision = Literal["single", "double"]

_ANALYSE, _FACTORISE, _SOLVE, _RELEASE = 11, 22, 33, -1
_POSITIVE_DEFINITE, _INDEFINITE = 2, -2
_NOT_POSITIVE = -4
_FACTORISATION, _CLASSIC, _TWO_LEVEL = 23, 0, 1  # index in iparm, and its values
_KILOBYTES = [15, 16]  # index in iparm: permanent memory of both phases
_PERTURBATION, _PERTURBED, _NEGATIVE = 9, 13, 22  # index in iparm: of pivots
FACTOR_FILE = "handle.pds"  # as pardiso_handle_store names it


def make_linear_solver(
    pattern: UpperTriangle,
    *,
    precision: FactorPrecision = "double",
    threads: int = 1,
    storable: bool = False,
) -> DirectSolver:
    """Return the fastest solver this machine has.

    Parameters
    ----------
    pattern : UpperTriangle
        Of the matrices to come.
    precision : str
        Of the factor: "double" or "single".
    threads : int
        For factorisations and back-solves.
    storable : bool
        Whether the factor is to be written to disk
        (`physgnn.mechanics.linear.factor_cache`), which costs some speed.
    """
    if mkl_library() is None:
        return SuperLUSolver(pattern)
    return PardisoSolver(
        pattern, precision=precision, threads=threads, storable=storable
    )


def factorized(
    body: Body,
    displacement: FloatArray,
    *,
    precision: FactorPrecision = "double",
    threads: int = 1,
) -> DirectSolver | None:
    """Return a solver that holds the factor of K(u), u (n_points, 3) in mm.

    None if a cell is inverted or K(u) is not positive definite.
    """
    data, inverted = assemble_tangent(body.elements, body.pattern, displacement)
    solver = make_linear_solver(body.pattern, precision=precision, threads=threads)
    return solver if inverted < 0 and solver.factorize(data) else None


class PardisoSolver:
    """MKL Pardiso, Cholesky (L Lᵀ), or L D Lᵀ where there are pressures.

    Settings (iparm, oneMKL reference, "pardiso iparm parameter"): METIS ordering, no
    iterative refinement, no matching or scaling (K is positive definite), two-level
    factorisation unless the factor is to be stored, zero-based indices, single or
    double factors.

    On 28,000 unknowns and one thread, the two-level factorisation takes 9 % less time
    than the classic one in single precision and 14 % in double, its back-solves 10 %
    and 12 %; on 2,000 it is 5 % and 27 %; on 144 there is no
    difference. With more threads, only its back-solves use them. But
    `pardiso_handle_store` crashes on its factors (MKL 2026.2).

    With pressures the matrix is indefinite, yet needs no pivoting: at rest it is
    quasi-definite, and so has an L D Lᵀ in any order (Vanderbei 1995, SIAM J. Optim. 5,
    100–113). Pivots below 1e-8 of its norm are none; where there are any, or a negative
    one too many, K is not positive definite.
    """

    def __init__(
        self,
        pattern: UpperTriangle,
        *,
        precision: FactorPrecision = "double",
        threads: int = 1,
        storable: bool = False,
    ) -> None:
        self.storable = storable
        self._dtype = np.float32 if precision == "single" else np.float64
        self._n = len(pattern.indptr) - 1
        self._pressures = slice(pattern.n_unknowns, self._n)
        pressures = self._n > pattern.n_unknowns
        self._kind = _INDEFINITE if pressures else _POSITIVE_DEFINITE
        self._indptr, self._indices = pattern.indptr, pattern.indices
        self._data = np.zeros(len(pattern.indices), dtype=self._dtype)
        self._threads = threads
        self._handle = np.zeros(64, dtype=np.int64)
        self._iparm = np.zeros(64, dtype=np.int32)
        self._iparm[[0, 1, 34]] = 1, 2, 1
        self._iparm[_FACTORISATION] = _CLASSIC if storable else _TWO_LEVEL
        self._iparm[27] = 1 if precision == "single" else 0
        self._iparm[_PERTURBATION] = 8 if pressures else 0
        self._analysed = self._factorised = False
        arguments = (self._kind, self._handle, self._n, self._iparm)
        weakref.finalize(self, _release, *arguments)

    def factorize(self, data: FloatArray) -> bool:
        """Factorise K, unless it is that of the last time; False if not positive."""
        data = data.astype(self._dtype)
        if self._factorised and np.array_equal(data, self._data):
            return True
        self._data[:] = data
        empty = np.zeros(1, dtype=self._dtype)
        if not self._analysed:
            self._call(_ANALYSE, empty, empty, 1)
            self._analysed = True
        error = self._call(_FACTORISE, empty, empty, 1)
        self._factorised = error == 0 and self._positive()
        return self._factorised

    def _positive(self) -> bool:
        """Whether K is positive definite, by the pivots of the factor with pressures.

        Block elimination keeps the signs of eigenvalues: as many are negative as
        pressures have a negative diagonal, and those of K.
        """
        if self._kind == _POSITIVE_DEFINITE:
            return True  # or Cholesky would have failed
        own = self._data[self._indptr[self._pressures]]
        expected = np.count_nonzero(np.signbit(own))
        negative, perturbed = self._iparm[[_NEGATIVE, _PERTURBED]].tolist()
        return bool(perturbed == 0 and negative == expected)

    def solve(self, right: FloatArray) -> FloatArray:
        """Return K⁻¹ b for b of shape (n,) or (n_right, n)."""
        b = np.ascontiguousarray(_all_rows(right, self._n), dtype=self._dtype)
        x = np.zeros_like(b)
        self._call(_SOLVE, b, x, b.size // self._n)
        return x[..., : right.shape[-1]].astype(np.float64)

    @property
    def n_bytes(self) -> int:
        """Memory of analysis and factor (iparm 16 and 17 count it in KB)."""
        return 1024 * int(self._iparm[_KILOBYTES].sum())

    def store(self, folder: Path) -> None:
        """Write a storable factor into a folder, as ``FACTOR_FILE``.

        Raises
        ------
        OSError
            If that fails.
        """
        assert self.storable
        error = self._on_disk("pardiso_handle_store", folder)
        if error:
            raise OSError(f"Pardiso could not write its factor (error {error})")

    def restore(self, folder: Path, data: FloatArray) -> bool:
        """Read back the factor of a matrix; False if there is none to be read."""
        self._data[:] = data
        restored = self._on_disk("pardiso_handle_restore", folder) == 0
        self._analysed, self._factorised = restored, False  # it may be another
        return restored

    def _on_disk(self, function: str, folder: Path) -> int:
        error = ctypes.c_int32(0)
        name = str(folder).encode()
        getattr(mkl_library(), function)(
            _pointer(self._handle), name, ctypes.byref(error)
        )
        return error.value

    def _call(self, phase: int, b: NDArray[Any], x: NDArray[Any], n_right: int) -> int:
        mkl = mkl_library()
        mkl.MKL_Set_Num_Threads_Local(self._threads)
        error = _pardiso(
            mkl,
            (self._kind, self._handle, self._n, self._iparm),
            phase,
            (self._data, self._indptr, self._indices),
            (b, x, n_right),
        )
        if error not in (0, _NOT_POSITIVE):
            raise MemoryError(f"Pardiso failed in phase {phase} with error {error}")
        return error


def _pointer(array: NDArray[Any] | None) -> Any:
    return None if array is None else array.ctypes.data_as(ctypes.c_void_p)


def _pardiso(
    mkl: Any,
    state: tuple[int, NDArray[Any], int, NDArray[Any]],
    phase: int,
    matrix: tuple[NDArray[Any] | None, ...],
    vectors: tuple[NDArray[Any] | None, NDArray[Any] | None, int],
) -> int:
    """Call MKL's ``pardiso`` (oneMKL C reference) and return its error code."""
    kind, handle, n, iparm = state
    right, solution, n_right = vectors
    data, indptr, indices = matrix
    error = ctypes.c_int32(0)

    def number(value: int) -> Any:
        return ctypes.byref(ctypes.c_int32(value))

    mkl.pardiso(
        _pointer(handle),
        number(1),
        number(1),
        number(kind),
        number(phase),
        number(n),
        _pointer(data),
        _pointer(indptr),
        _pointer(indices),
        None,
        number(n_right),
        _pointer(iparm),
        number(0),
        _pointer(right),
        _pointer(solution),
        ctypes.byref(error),
    )
    return error.value


def _release(kind: int, handle: NDArray[Any], n: int, iparm: NDArray[Any]) -> None:
    state, nothing = (kind, handle, n, iparm), (None, None, None)
    _pardiso(mkl_library(), state, _RELEASE, nothing, (None, None, 1))


def _all_rows(right: NDArray[Any], n: int) -> NDArray[Any]:
    """Return right-hand sides with zeros in the rows of pressures, (…, n)."""
    if right.shape[-1] == n:
        return right
    b = np.zeros((*right.shape[:-1], n), dtype=right.dtype)
    b[..., : right.shape[-1]] = right
    return b


class SuperLUSolver:
    """SciPy's SuperLU in symmetric mode: the same interface where MKL is not."""

    def __init__(self, pattern: UpperTriangle) -> None:
        self._n = len(pattern.indptr) - 1
        self._pressures = slice(pattern.n_unknowns, self._n)
        self._indptr, self._indices = pattern.indptr, pattern.indices
        self._factor: Any = None

    def factorize(self, data: FloatArray) -> bool:
        """Factorise K; False if it is not positive definite."""
        import scipy.sparse as sp
        from scipy.sparse.linalg import splu

        upper = sp.csr_matrix((data, self._indices, self._indptr), shape=(self._n,) * 2)
        full = (upper + sp.triu(upper, 1).T).tocsc()
        try:
            self._factor = splu(
                full,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError:
            return False
        # Without pivoting, U's diagonal holds the pivots: as many are negative as those
        # of the pressures are, and no more if K is positive definite.
        expected = np.count_nonzero(data[self._indptr[self._pressures]] < 0)
        return bool(np.count_nonzero(self._factor.U.diagonal() <= 0) == expected)

    def solve(self, right: FloatArray) -> FloatArray:
        """Return K⁻¹ b for b of shape (n,) or (n_right, n)."""
        x = self._factor.solve(_all_rows(right, self._n).T).T
        return np.ascontiguousarray(x[..., : right.shape[-1]])

    @property
    def n_bytes(self) -> int:
        """Memory of the factors' values and row numbers."""
        return 0 if self._factor is None else 12 * int(self._factor.nnz)
