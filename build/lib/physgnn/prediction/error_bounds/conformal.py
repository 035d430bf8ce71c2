"""Split-conformal calibration: from past errors to a bound that keeps its promise."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray


def conformal_quantile(
    scores: FloatArray, groups: IntArray, coverage: float
) -> tuple[float, float]:
    """Return a bound on the score of one more sample from one more group.

    Samples of one group (the levels of a load path) resemble each other, so the
    groups are what is exchangeable: each gets the same weight 1 / (n_groups + 1), and
    the unseen group's weight sits at infinity.

    Parameters
    ----------
    scores : (n,) array
        True error / indicator of the calibration samples.
    groups : (n,) integer array
        The group of each.
    coverage : float
        Wanted probability that the bound holds, in (0, 1).

    Returns
    -------
    bound : float
        The smallest score that covers enough weight.
    coverage : float
        As wanted, or n_groups / (n_groups + 1) if so few groups cannot promise more.

    References
    ----------
    Lee, Barber & Willett (2023), "Distribution-free inference with hierarchical data",
    arXiv:2306.06342, section 3 (hierarchical conformal prediction).
    """
    _, inverse, counts = np.unique(groups, return_inverse=True, return_counts=True)
    n_groups = len(counts)
    reached = min(coverage, n_groups / (n_groups + 1))
    weights = 1.0 / ((n_groups + 1) * counts[inverse])
    order = np.argsort(scores)
    covered = np.cumsum(weights[order])
    # Weights such as 1/3 + 1/3 + 1/3 do not add up exactly: allow for rounding.
    first = int(np.searchsorted(covered, reached - 1e-12))
    return float(scores[order][min(first, len(scores) - 1)]), reached
