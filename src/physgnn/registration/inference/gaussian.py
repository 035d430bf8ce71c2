"""Linear regression with Gaussian coefficients whose variances come from the data.

d = A w + ε, w ~ N(0, Λ), ε ~ N(0, σ² I); Λ has one variance for each family of
coefficients, chosen by marginal likelihood (Rasmussen & Williams, *Gaussian Processes
for Machine Learning*, 2006, sections 2.1, 5.4.1 and 5.4.2) with a log-normal prior
about the size of the data: without it, families that a few points need not be explained
by vanish, and with them the uncertainty far from the points.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import FloatArray, IntArray

Blocks = tuple[tuple[int, int], ...]

# Of the logarithm of a family's standard deviation: a factor of two, either way.
HYPER_DEVIATION = float(np.log(2.0))
# A step of the search for it may not leave this far: data that no coefficients explain
# would have it overflow.
FARTHEST = 10.0


@dataclass(frozen=True, eq=False)
class Posterior:
    """What the data say about the coefficients.

    Attributes
    ----------
    mean : (r,) array
        Of w given d.
    covariance : (r, r) array
        Of w given d.
    held_out : array of the shape of the data
        Residual of each datum when it is predicted from all rows but its own.
    surprise : float
        Root mean square of `held_out` over what was expected of it: 1 if noise and
        prior suit the data, more if the error bars are too short.
    leverage : array of the shape of the data
        Share of each datum in its own fit, the diagonal of H.
    misfit_ratio : float
        Squared misfit |d − A w|² over σ² times `freedom`, what it is on average.
    freedom : float
        Degrees of freedom that the fit leaves, tr(I − H), H the matrix from the data to
        their fit: so many squares of the noise are left on average.
    """

    mean: FloatArray
    covariance: FloatArray
    held_out: FloatArray
    surprise: float
    leverage: FloatArray
    misfit_ratio: float
    freedom: float


def choose_variances(
    A: FloatArray,
    d: FloatArray,
    family: IntArray,
    noise: float,
    *,
    typical: float | None = None,
    known: FloatArray | None = None,
    most: FloatArray | None = None,
) -> FloatArray:
    """Return the prior variance of every coefficient, equal within a family.

    Parameters
    ----------
    A : (m, r) array
        What each coefficient does to each datum.
    d : (m,) array
        The data.
    family : (r,) integer array
        The family of each coefficient, 0, 1, …
    noise : float
        σ, > 0, in the unit of d.
    typical : float, optional
        Middle of the prior of the standard deviations; by default the size of the data.
    known : (m, q) array, optional
        Further columns, whose coefficients have variance 1.
    most : (n_families,) array, optional
        Largest standard deviation of each family.
    """
    from scipy.optimize import minimize

    size = float(np.sqrt((d**2).mean())) if typical is None else typical
    middle = np.log(max(size, noise))
    further = np.empty((len(d), 0)) if known is None else known
    likelihood = _by_coefficients if len(d) > A.shape[1] else _by_data
    of_families = likelihood(A / noise, d / noise, family, further / noise)

    def cost(log_deviations: FloatArray) -> tuple[float, FloatArray]:
        """Return −log of the posterior up to a constant, and its gradient."""
        total, slope = of_families(np.exp(2 * log_deviations))
        far = (log_deviations - middle) / HYPER_DEVIATION
        return total + float(far @ far) / 2, slope + far / HYPER_DEVIATION

    highest = np.full(int(family.max()) + 1, middle + FARTHEST)
    if most is not None:
        highest = np.minimum(highest, np.log(most))
    lowest = np.minimum(middle - FARTHEST, highest)
    start = np.minimum(middle, highest)
    within = list(zip(lowest, highest, strict=True))
    found = minimize(cost, start, jac=True, method="L-BFGS-B", bounds=within)
    prior: FloatArray = np.exp(2 * found.x)[family]
    return prior


Likelihood = Callable[[FloatArray], tuple[float, FloatArray]]


def _by_data(
    A: FloatArray, d: FloatArray, family: IntArray, known: FloatArray
) -> Likelihood:
    """Return −log p(d) of families' variances, and its slope in half their logarithms.

    Up to a constant; with matrices as large as the data are many. The noise is 1.
    """
    columns = [A[:, family == i] for i in range(int(family.max()) + 1)]
    covariances = np.stack([part @ part.T for part in columns])
    rest = np.eye(len(d)) + known @ known.T

    def of_families(variances: FloatArray) -> tuple[float, FloatArray]:
        inverse = np.linalg.inv(np.tensordot(variances, covariances, 1) + rest)
        alpha = inverse @ d
        _, log_det = np.linalg.slogdet(inverse)
        slope = np.tensordot(covariances, inverse, 2) - (covariances @ alpha) @ alpha
        return float(d @ alpha - log_det) / 2, variances * slope

    return of_families


def _by_coefficients(
    A: FloatArray, d: FloatArray, family: IntArray, known: FloatArray
) -> Likelihood:
    """Return the same with matrices as large as the coefficients are many.

    With S = I + Λ½ Aᵀ A Λ½ the determinant of the data's covariance is that of S, and
    the slope of a family is the sum of 1 − (S⁻¹)ᵢᵢ − wᵢ² / Λᵢ over its coefficients, w
    the most probable ones (MacKay, "Bayesian interpolation", Neural Computation 4,
    1992, 415–447).
    """
    n = int(family.max()) + 1
    both = np.concatenate([A, known], axis=1)
    square, seen, total = both.T @ both, both.T @ d, float(d @ d)

    def of_families(variances: FloatArray) -> tuple[float, FloatArray]:
        root = np.concatenate([np.sqrt(variances)[family], np.ones(known.shape[1])])
        inverse = np.linalg.inv(_plus_one(square * root * root[:, None]))
        scaled = inverse @ (root * seen)
        _, log_det = np.linalg.slogdet(inverse)
        each = 1.0 - inverse.diagonal() - scaled**2
        slope = np.bincount(family, each[: len(family)], n).astype(np.float64)
        return (total - float((root * seen) @ scaled) - float(log_det)) / 2, slope

    return of_families


def condition(
    A: FloatArray, d: FloatArray, prior: FloatArray, noise: float
) -> Posterior:
    """Return the coefficients given the data.

    Parameters
    ----------
    A : (n k, r) array
        As in `choose_variances`.
    d : (n, k) array
        The data; a row is held out together, such as the components of a point.
    prior : (r,) array
        Variance of each coefficient.
    noise : float
        As in `choose_variances`.
    """
    found = condition_blocks(A, d.ravel(), prior, noise, (d.shape,))
    shaped = (found.held_out.reshape(d.shape), found.leverage.reshape(d.shape))
    return replace(found, held_out=shaped[0], leverage=shaped[1])


def condition_blocks(
    A: FloatArray, d: FloatArray, prior: FloatArray, noise: float, blocks: Blocks
) -> Posterior:
    """Return the coefficients given data of several kinds, one after the other.

    Parameters
    ----------
    A : (m, r) array
        As in `choose_variances`.
    d : (m,) array
        The data.
    prior, noise
        As in `condition`.
    blocks : tuple of (n, k)
        So many rows of so many data each, m in all; a row is held out together.
    """
    A, d = A / noise, d / noise
    if len(d) > len(prior):
        root = np.sqrt(prior)
        within = np.linalg.inv(_plus_one((A * root).T @ (A * root)))
        covariance = root[:, None] * within * root
        mean = covariance @ (A.T @ d)
    else:
        gain = prior[:, None] * np.linalg.solve(_plus_one((A * prior) @ A.T), A).T
        covariance = np.diag(prior) - gain @ (A * prior)
        mean = gain @ d
    # I − H = (I + A Λ Aᵀ)⁻¹ = I − A C Aᵀ, which takes the data to their misfit.
    spread = A @ covariance
    leverage = np.einsum("ij,ij->i", spread, A)
    misfit = d - A @ mean
    held_out = _held_out(A, spread, misfit, blocks)
    freedom = float((1.0 - leverage).sum())
    return Posterior(
        mean=mean,
        covariance=covariance,
        held_out=noise * held_out,
        surprise=float(np.sqrt(max((held_out * misfit).sum(), 0.0) / d.size)),
        leverage=leverage,
        misfit_ratio=float((misfit**2).sum()) / max(freedom, 1e-12),
        freedom=freedom,
    )


def _held_out(
    A: FloatArray, spread: FloatArray, misfit: FloatArray, blocks: Blocks
) -> FloatArray:
    """Return the residual of each place when it is predicted from all the others."""
    found, first = np.empty_like(misfit), 0
    for n, k in blocks:
        part = slice(first, first + n * k)
        own = np.eye(k) - np.einsum(
            "nir,njr->nij", spread[part].reshape(n, k, -1), A[part].reshape(n, k, -1)
        )
        left = np.linalg.solve(own, misfit[part].reshape(n, k, 1))
        found[part] = left.ravel()
        first += n * k
    return found


def log_evidence(
    A: FloatArray, d: FloatArray, prior: FloatArray, noise: float
) -> float:
    """Return log p(d), the coefficients integrated out.

    Equation 5.8 of Rasmussen & Williams.

    Parameters
    ----------
    A, d, prior, noise
        As in `condition_blocks`.
    """
    A, d, n = A * np.sqrt(prior) / noise, d / noise, len(d)
    if n > len(prior):
        seen = A.T @ d
        S = _plus_one(A.T @ A)
        square = float(d @ d) - float(seen @ np.linalg.solve(S, seen))
    else:
        S = _plus_one(A @ A.T)
        square = float(d @ np.linalg.solve(S, d))
    _, log_det = np.linalg.slogdet(S)
    return -(square + float(log_det) + n * float(np.log(2 * np.pi * noise**2))) / 2


def _plus_one(C: FloatArray) -> FloatArray:
    return C + np.eye(len(C))
