"""Linear regression with Gaussian coefficients whose variances come from the data.

d = A w + ε, w ~ N(0, Λ), ε ~ N(0, σ² I); Λ has one variance for each family of
coefficients, chosen by marginal likelihood (Rasmussen & Williams, *Gaussian Processes
for Machine Learning*, 2006, sections 2.1, 5.4.1 and 5.4.2) with a log-normal prior
about the size of the data: without it, families that a few points need not be explained
by vanish, and with them the uncertainty far from the points.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

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
    size = float(np.sqrt((d**2).mean())) if typical is None else typical
    middle = np.log(max(size, noise))
    rest = noise**2 * np.eye(len(d)) + (0.0 if known is None else known @ known.T)
    columns = [A[:, family == i] for i in range(int(family.max()) + 1)]
    covariances = np.stack([part @ part.T for part in columns])

    def cost(log_deviations: FloatArray) -> tuple[float, FloatArray]:
        """Return −log of the posterior up to a constant, and its gradient."""
        variances = np.exp(2 * log_deviations)
        inverse = np.linalg.inv(np.tensordot(variances, covariances, 1) + rest)
        alpha = inverse @ d
        _, log_det = np.linalg.slogdet(inverse)
        slope = np.tensordot(covariances, inverse, 2) - (covariances @ alpha) @ alpha
        far = (log_deviations - middle) / HYPER_DEVIATION
        total = float(d @ alpha - log_det + far @ far) / 2
        return total, variances * slope + far / HYPER_DEVIATION

    highest = np.full(len(covariances), middle + FARTHEST)
    if most is not None:
        highest = np.minimum(highest, np.log(most))
    lowest = np.minimum(middle - FARTHEST, highest)
    start = np.minimum(middle, highest)
    within = list(zip(lowest, highest, strict=True))
    found = minimize(cost, start, jac=True, method="L-BFGS-B", bounds=within)
    prior: FloatArray = np.exp(2 * found.x)[family]
    return prior


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
    inverse = np.linalg.inv(_with_noise((A * prior) @ A.T, noise))
    gain = prior[:, None] * (A.T @ inverse)
    alpha = inverse @ d
    held_out, first = np.empty_like(d), 0
    for n, k in blocks:
        part = slice(first, first + n * k)
        each = np.arange(n)
        own = inverse[part, part].reshape(n, k, n, k)[each, :, each]
        left = np.linalg.solve(own, alpha[part].reshape(n, k, 1))
        held_out[part] = left.ravel()
        first += n * k
    # I − H = σ² (A Λ Aᵀ + σ² I)⁻¹, so that the misfit is σ² times alpha.
    spared = noise**2 * inverse.diagonal()
    freedom = float(spared.sum())
    return Posterior(
        mean=gain @ d,
        covariance=np.diag(prior) - gain @ (A * prior),
        held_out=held_out,
        surprise=float(np.sqrt(max((held_out * alpha).sum(), 0.0) / d.size)),
        leverage=np.asarray(1.0 - spared, dtype=np.float64),
        misfit_ratio=float(noise**2 * (alpha**2).sum()) / max(freedom, 1e-12),
        freedom=freedom,
    )


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
    C = _with_noise((A * prior) @ A.T, noise)
    _, log_det = np.linalg.slogdet(C)
    square = float(d @ np.linalg.solve(C, d))
    return -(square + float(log_det) + len(d) * float(np.log(2 * np.pi))) / 2


def _with_noise(C: FloatArray, noise: float) -> FloatArray:
    return C + noise**2 * np.eye(len(C))
