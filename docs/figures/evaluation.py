"""Which samples two splits hold out, and what interpolation makes of each."""

import numpy as np
from _common import ORANGE, TEAL, plt, save
from _dataset import N_LEVELS, dataset, linear_parts
from matplotlib.colors import ListedColormap

from physgnn.dataset import split_path, split_published

store, linear = dataset(), linear_parts()
factors = np.arange(1, N_LEVELS + 1) / N_LEVELS
splits = {"published": split_published(store), "path": split_path(store)}
figure, panels = plt.subplots(1, 3, figsize=(9.4, 3.6), width_ratios=(1, 1, 1.1))
errors: dict[str, list[float]] = {}
for axes, (name, split) in zip(panels, splits.items(), strict=False):
    held = np.zeros((store.n_paths, N_LEVELS))
    held[tuple(split.validation.T)] = 1
    held[tuple(split.test.T)] = 2
    axes.imshow(
        held, cmap=ListedColormap(["#d9efe9", "#e6e0f4", ORANGE]), aspect="auto"
    )
    axes.set(title=f"split “{name}”", xlabel="level", ylabel="load path")
    axes.grid(visible=False)
    errors[name] = []
    for path, level in split.test:
        known = np.flatnonzero(held[path] == 0)
        u = store.displacement(path)
        below, above = known[known < level], known[known > level]
        if len(below) and len(above):
            a, b = below[-1], above[0]
            t = (factors[level] - factors[a]) / (factors[b] - factors[a])
            guess = (1 - t) * u[a] + t * u[b]
        else:  # nothing to interpolate between: the linear solution
            guess = factors[level] * linear[path]
        errors[name].append(np.linalg.norm(guess - u[level], axis=1).mean())
panels[0].set_xlabel("level (orange: test)")
bars = panels[2]
bars.bar(
    ["published", "path"], [np.mean(e) for e in errors.values()], color=[ORANGE, TEAL]
)
bars.set(
    yscale="log",
    ylim=(2e-3, 0.2),
    ylabel="mean error, mm",
    title="a guess without a model",
)
bars.grid(axis="x", visible=False)
bars.set_xlabel(
    "between known levels: interpolated,\nelse the linear solution", fontsize=8
)
save(figure, "evaluation")
