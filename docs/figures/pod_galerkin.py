"""How many modes a displacement needs, and what the linear solution leaves."""

import numpy as np
from _common import ORANGE, TEAL, plt, save
from _dataset import N_LEVELS, dataset, linear_parts

store, linear = dataset(), linear_parts()
u = np.stack([store.displacement(i) for i in range(store.n_paths)]).astype(float)
factors = (np.arange(1, N_LEVELS + 1) / N_LEVELS)[:, None, None]
rest = u - linear[:, None] * factors
n_train = store.n_paths * 3 // 4
figure, axes = plt.subplots(figsize=(6.0, 3.8))
for fields, label, colour in (
    (u, "displacement u", ORANGE),
    (rest, "what the linear solution leaves", TEAL),
):
    train = fields[:n_train].reshape(n_train * N_LEVELS, -1)
    test = fields[n_train:].reshape(-1, train.shape[1])
    modes = np.linalg.svd(train, full_matrices=False)[2]
    sizes = [1, 2, 4, 8, 16, 32, 64, 128]
    error = []
    for r in sizes:
        left = test - test @ modes[:r].T @ modes[:r]
        error.append(np.linalg.norm(left.reshape(-1, 3), axis=1).mean())
    axes.loglog(sizes, error, "o-", c=colour, label=label)
axes.set(
    xlabel="POD modes", ylabel="mean projection error, unseen paths, mm", xticks=sizes
)
axes.set_xticklabels(sizes)
axes.minorticks_off()
axes.legend()
save(figure, "pod_galerkin")
