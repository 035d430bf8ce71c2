"""What a lifted prediction is made of."""

from _boxes import arrow, box, canvas
from _common import GREY, ORANGE, PURPLE, TEAL, save

figure, axes = canvas(9.0, 3.3)
box(axes, 0.9, 1.9, "load f", GREY, 1.2)
box(axes, 2.9, 1.9, "nearest\nreference state ū", ORANGE)
box(axes, 5.0, 2.7, "u₁ = K(ū)⁻¹ (f − f_int(ū))\none product", ORANGE, 2.2)
box(axes, 5.0, 1.9, "u₂, u₃: one back-solve,\none Poisson solve", ORANGE, 2.2)
box(axes, 5.0, 0.9, "network near the load,\nwhose forces reach further", PURPLE, 2.2)
box(axes, 8.0, 1.9, "u = ū + u₁ + u₂ + u₃\n+ ‖u₂‖ · correction", TEAL, 1.9, 0.9)
arrow(axes, (1.5, 1.9), (2.12, 1.9))
for y in (2.7, 1.9):
    arrow(axes, (3.68, 1.95 if y > 2 else 1.9), (3.87, y))
    arrow(axes, (6.12, y), (7.02, 1.95 if y > 2 else 1.9))
arrow(axes, (5.0, 1.53), (5.0, 1.28), "")
arrow(axes, (6.12, 0.9), (7.02, 1.75), "")
axes.text(5.0, 0.25, "mechanics (orange) is exact and cheap; only what is left is learnt (purple)",
          ha="center", fontsize=8, color="#555b64")  # fmt: skip
save(figure, "lifted")
