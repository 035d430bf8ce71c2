"""Split-conformal calibration of a bound, on whole load paths."""

import numpy as np
from _common import GREY, ORANGE, PURPLE, TEAL, plt, save
from _dataset import N_LEVELS, dataset, linear_parts

store, linear = dataset(), linear_parts()
factors = (np.arange(1, N_LEVELS + 1) / N_LEVELS)[:, None, None]
u = np.stack([store.displacement(i) for i in range(store.n_paths)])
error = np.linalg.norm(u - linear[:, None] * factors, axis=-1).mean(axis=-1)
# an indicator that needs no solution: the square of the linear solution's size
indicator = (np.linalg.norm(linear[:, None] * factors, axis=-1) ** 2).mean(axis=-1)
calibration, test = slice(0, 16), slice(16, None)
scores = np.sort((error / indicator)[calibration].ravel())
n_paths = 16
weight = np.full(len(scores), 1.0 / ((n_paths + 1) * N_LEVELS))
bound = scores[np.searchsorted(weight.cumsum(), 0.9)]
figure, (left, right) = plt.subplots(1, 2, figsize=(8.2, 3.5))
left.hist(scores, bins=24, color=TEAL, alpha=0.7)
left.axvline(bound, c=ORANGE, lw=2)
left.text(
    bound, left.get_ylim()[1] * 0.9, " 90 % of the weight", color=ORANGE, fontsize=8
)
left.set(xlabel="true error / indicator, calibration paths", ylabel="samples")
x = np.geomspace(indicator.min(), indicator.max(), 2)
right.loglog(indicator[test].ravel(), error[test].ravel(), "o", ms=4, c=PURPLE, alpha=0.6,
             label="unseen paths")  # fmt: skip
right.loglog(x, bound * x, c=ORANGE, lw=2, label="bound")
held = (error[test] <= bound * indicator[test]).mean()
right.set(
    xlabel="indicator, mm²", ylabel="true mean error, mm", title=f"held on {held:.0%}"
)
right.legend(fontsize=8)
right.grid(color=GREY, alpha=0.2)
save(figure, "error_bounds")
