"""Every tissue over the stress measured in human brain (Budday et al. 2017).

The curves are not part of the project: name the folder that holds them, with
budday2017_cortex.dat and budday2017_corona_radiata.dat, as the second argument.
``python docs/figures/tissue.py docs/images DATA``; with ``--table`` behind it, the
table of docs/results/tissue.md is printed too.
"""

import sys
from io import BytesIO
from pathlib import Path

import numpy as np
from _common import GREY, OUT, plt
from PIL import Image

from physgnn.io.stress_curves import read_stress_curves
from physgnn.mechanics import TISSUES
from physgnn.mechanics.materials.stress_curves import KINDS, StressCurve

SAMPLES = {
    "cortex": "budday2017_cortex.dat",
    "corona radiata": "budday2017_corona_radiata.dat",
}
DASHED = ("tumour", "stiff-tumour", "tumour-ogden", "ventricle", "ventricle-ogden")
WIDE = ("brain", "cortex", "corona-radiata")


def draw(axes: plt.Axes, curve: StressCurve) -> None:
    """Draw one curve as dots and every tissue as a line."""
    amount = np.linspace(curve.amount.min(), curve.amount.max(), 101)
    for number, (name, tissue) in enumerate(TISSUES.items()):
        stress = KINDS[curve.kind](tissue.material, amount) / 1e3
        axes.plot(
            amount,
            stress,
            "--" if name in DASHED else "-",
            c=f"C{number}",
            lw=2.4 if name in WIDE else 1.2,
            label=name,
        )
    axes.plot(
        curve.amount, curve.stress_pa / 1e3, "o", ms=3.5, c=GREY, label="measured"
    )
    low, high = sorted(
        (0.0, 1.4e-3 * curve.stress_pa[np.abs(curve.stress_pa).argmax()])
    )
    margin = 0.05 * (high - low)
    axes.set_ylim(low - margin, high + margin)


def print_table(measured: dict[str, list[StressCurve]]) -> None:
    """Print the errors of every tissue as the page has them."""
    for name, tissue in TISSUES.items():
        cells = [
            " / ".join(f"{100 * c.relative_error(tissue.material):.0f}" for c in curves)
            for curves in measured.values()
        ]
        print(f"| `{name}` | {' | '.join(cells)} |")


if len(sys.argv) < 3:
    sys.exit("name the folder of the pictures, and that of Budday's curves")
folder = Path(sys.argv[2])
found = {name: read_stress_curves(folder / file) for name, file in SAMPLES.items()}
figure, grid = plt.subplots(len(found), len(KINDS), figsize=(10.5, 6.6))
for row, (tissue_name, curves) in zip(grid, found.items(), strict=True):
    for panel, measured_curve in zip(row, curves, strict=True):
        draw(panel, measured_curve)
        shear = measured_curve.kind == "shear"
        panel.set_xlabel("amount of shear" if shear else "stretch")
        panel.set_title(f"{tissue_name}, {measured_curve.kind}", fontsize=10)
    row[0].set_ylabel("nominal stress, kPa")
handles, labels = grid[0, 0].get_legend_handles_labels()
figure.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=9)
drawn = BytesIO()
figure.savefig(drawn, dpi=130, facecolor="white")
Image.open(drawn).convert("RGB").quantize(64).save(OUT / "tissue.png", optimize=True)
if "--table" in sys.argv:
    print_table(found)
