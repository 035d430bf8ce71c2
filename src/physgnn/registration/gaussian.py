"""Linear regression with Gaussian coefficients whose variances come from the data.

d = A w + ε, w ~ N(0, Λ), ε ~ N(0, σ² I); Λ has one variance for each family of
coefficients, chosen by marginal likelihood (Rasmussen & Williams, *Gaussian Processes
for Machine Learning*, 2006, sections 2.1, 5.4.1 and 5.4.2) with a log-normal prior
about the size of the data: without it, families that a few points need not be explained
by vanish, and with them the uncertainty far from the points.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from physgnn.arrays import FloatArray, IntArray

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
    held_out : (n, k) array
        Residual of each datum when it is predicted from all rows but its own.
    surprise : float
        Root mean square of `held_out` over what was expected of it: 1 if noise and
        prior suit the data, more if the error bars are too short.
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
    misfit_ratio: float
    freedom: float


def choose_variances(
    A: FloatArray, d: FloatArray, family: IntArray, noise: float
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
    """
    middle = np.log(max(float(np.sqrt((d**2).mean())), noise))
    members = [A[:, family == i] for i in range(int(family.max()) + 1)]
    shares = np.stack([part @ part.T for part in members])

    def cost(log_deviations: FloatArray) -> tuple[float, FloatArray]:
        """Return −log of the posterior up to a constant, and its gradient."""
        variances = np.exp(2 * log_deviations)
        inverse = np.linalg.inv(_with_noise(np.tensordot(variances, shares, 1), noise))
        alpha = inverse @ d
        _, log_det = np.linalg.slogdet(inverse)
        slope = np.einsum("ij,kij->k", inverse, shares)
        slope -= np.einsum("i,kij,j->k", alpha, shares, alpha)
        far = (log_deviations - middle) / HYPER_DEVIATION
        total = float(d @ alpha - log_det + far @ far) / 2
        return total, variances * slope + far / HYPER_DEVIATION

    start = np.full(len(shares), middle)
    within = [(middle - FARTHEST, middle + FARTHEST)] * len(shares)
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
    n, k = d.shape
    inverse = np.linalg.inv(_with_noise((A * prior) @ A.T, noise))
    gain = prior[:, None] * (A.T @ inverse)
    alpha = (inverse @ d.ravel()).reshape(n, k)
    each = np.arange(n)
    own = inverse.reshape(n, k, n, k)[each, :, each]
    held_out = np.linalg.solve(own, alpha[..., None])[..., 0]
    # I − H = σ² (A Λ Aᵀ + σ² I)⁻¹, so that the misfit is σ² times alpha.
    freedom = noise**2 * float(np.trace(inverse))
    return Posterior(
        mean=gain @ d.ravel(),
        covariance=np.diag(prior) - gain @ (A * prior),
        held_out=held_out,
        surprise=float(np.sqrt(max((held_out * alpha).sum(), 0.0) / d.size)),
        misfit_ratio=float(noise**2 * (alpha**2).sum()) / max(freedom, 1e-12),
        freedom=freedom,
    )


def _with_noise(C: FloatArray, noise: float) -> FloatArray:
    return C + noise**2 * np.eye(len(C))
