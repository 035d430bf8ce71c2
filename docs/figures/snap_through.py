"""Snap-through of a shallow two-bar truss: one unknown, exact formulas."""

import numpy as np
from _common import GREY, ORANGE, TEAL, plt, save

H = 0.6  # height over half the span
w = np.linspace(0.0, 1.5, 400)  # how far the top has come down
length = lambda w: np.sqrt(1 + (H - w) ** 2)  # noqa: E731
energy = lambda w: (length(w) - length(0)) ** 2  # noqa: E731
force = 2 * (length(w) - length(0)) * -(H - w) / length(w)
limit = int(np.argmax(force[: len(w) // 2]))
after = limit + int(np.argmax(force[limit:] > force[limit]))
after = int(np.flatnonzero((force >= force[limit]) & (w > H))[0])

figure, (left, right) = plt.subplots(1, 2, figsize=(8.2, 3.4))
left.plot(w[: limit + 1], force[: limit + 1], c=TEAL, lw=2.5, label="stable")
left.plot(w[limit:after], force[limit:after], c=GREY, ls="--", label="passed over")
left.plot(w[after:], force[after:], c=TEAL, lw=2.5)
left.annotate(
    "",
    (w[after], force[limit]),
    (w[limit], force[limit]),
    arrowprops={"arrowstyle": "->", "color": ORANGE, "lw": 2},
)
left.plot(w[limit], force[limit], "o", c=ORANGE)
left.text(w[limit], force[limit] * 1.12, "limit point", ha="center", color=ORANGE)
left.set(xlabel="displacement", ylabel="load", ylim=(-0.25, 0.45))
left.legend(loc="lower right")
for share, colour in ((0.5, TEAL), (1.0, GREY), (1.15, ORANGE)):
    potential = energy(w) - share * force[limit] * w
    right.plot(w, potential, c=colour, label=f"{share:.0%} of the limit load")
right.set(xlabel="displacement", ylabel="potential energy")
right.legend(fontsize=8)
save(figure, "snap_through")
