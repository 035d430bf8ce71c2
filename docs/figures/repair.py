"""How a prediction is brought within a tolerance."""

from _boxes import arrow, box, canvas
from _common import GREY, ORANGE, PURPLE, TEAL, save

figure, axes = canvas(9.2, 3.4)
box(axes, 0.9, 2.5, "prediction", PURPLE, 1.4)
box(axes, 3.0, 2.5, "physical estimate:\neight descent steps", ORANGE, 1.8)
box(axes, 5.6, 2.5, "below half\nthe tolerance?", GREY, 1.5)
box(axes, 8.2, 2.5, "ok", TEAL, 1.2)
box(axes, 5.6, 1.1, "factorise K here and\ndescend in energy", ORANGE, 1.9)
box(axes, 8.2, 1.1, "repaired:\nstable, error small", TEAL, 1.6)
box(axes, 2.6, 1.1, "deeper than 1.2 edges,\nor led far away?", GREY, 1.9)
box(axes, 2.6, 0.25, "follow the load from a fraction of it: solved", TEAL, 3.6, 0.4)
arrow(axes, (1.62, 2.5), (2.07, 2.5))
arrow(axes, (3.92, 2.5), (4.83, 2.5))
arrow(axes, (6.37, 2.5), (7.58, 2.5), "yes")
arrow(axes, (5.6, 2.13), (5.6, 1.48), "")
axes.text(5.75, 1.8, "no", fontsize=7.5, color="#555b64")
arrow(axes, (6.57, 1.1), (7.38, 1.1))
arrow(axes, (4.63, 1.1), (3.57, 1.1))
arrow(axes, (2.6, 0.73), (2.6, 0.47))
axes.text(2.75, 0.58, "yes", fontsize=7.5, color="#555b64")
save(figure, "repair")
