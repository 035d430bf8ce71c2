"""A law of your own: Yeoh's solid, which stiffens, beside the neo-Hookean one.

    python examples/02_a_law_of_your_own.py [folder]

A law is an energy W(F), its stress P = ∂W/∂F and its tangent. This example writes W
and P, checks one against the other, and draws the curve that a test on a cube would
measure. docs/howto/add_law.md says how such a law enters the package.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from scipy.optimize import brentq

mpl.use("Agg")
import matplotlib.pyplot as plt

BULK_PA = 5e4  # κ: fifty times the shear modulus


@dataclass(frozen=True)
class Yeoh:
    """W = c₁ (Ī₁ − 3) + c₂ (Ī₁ − 3)² + κ/2 (ln J)², Ī₁ = J^(−2/3) tr(FᵀF).

    Yeoh 1993, Rubber Chemistry and Technology 66(5); with c₂ = 0 it is neo-Hookean.
    """

    c1_pa: float
    c2_pa: float

    def energy(self, F: np.ndarray) -> float:
        """Return W, Pa."""
        J = np.linalg.det(F)
        excess = J ** (-2 / 3) * (F**2).sum() - 3
        volume = BULK_PA / 2 * np.log(J) ** 2
        return float(self.c1_pa * excess + self.c2_pa * excess**2 + volume)

    def stress(self, F: np.ndarray) -> np.ndarray:
        """Return P, (3, 3), Pa."""
        J, H = np.linalg.det(F), np.linalg.inv(F).T
        first = J ** (-2 / 3) * (F**2).sum()
        slope = self.c1_pa + 2 * self.c2_pa * (first - 3)
        shape = 2 * J ** (-2 / 3) * F - 2 / 3 * first * H
        return slope * shape + BULK_PA * np.log(J) * H


def main(folder: Path) -> dict[str, float]:
    """Check P against W, draw the curves, and return the error and the stiffening."""
    folder.mkdir(parents=True, exist_ok=True)
    yeoh, neo = Yeoh(500.0, 400.0), Yeoh(500.0, 0.0)
    stretches = np.linspace(0.7, 1.3, 61)
    curves = {"Yeoh": nominal(yeoh, stretches), "neo-Hookean": nominal(neo, stretches)}
    figure, axes = plt.subplots(figsize=(4, 3), layout="constrained")
    for name, curve in curves.items():
        axes.plot(stretches, 1e-3 * curve, label=name)
    axes.set(xlabel="stretch", ylabel="nominal stress, kPa")
    axes.legend(frameon=False)
    figure.savefig(folder / "picture.png", dpi=150)
    plt.close(figure)
    ratio = curves["Yeoh"][0] / curves["neo-Hookean"][0]
    return {"derivative_error": derivative_error(yeoh), "stiffer_at_0.7": ratio}


def derivative_error(law: Yeoh) -> float:
    """Return the largest relative difference of P and central differences of W."""
    F = np.eye(3) + 0.2 * np.random.default_rng(0).normal(size=(3, 3))
    P, numeric, h = law.stress(F), np.empty((3, 3)), 1e-6
    for i, j in np.ndindex(3, 3):
        D = np.zeros((3, 3))
        D[i, j] = h
        numeric[i, j] = (law.energy(F + D) - law.energy(F - D)) / (2 * h)
    return float(abs(numeric - P).max() / abs(P).max())


def nominal(law: Yeoh, stretches: np.ndarray) -> np.ndarray:
    """Return the stress of a bar pulled or pressed to each stretch, its sides free."""

    def sideways(side: float, along: float) -> float:
        return float(law.stress(np.diag([side, side, along]))[0, 0])

    sides = [brentq(sideways, 0.5, 2.0, args=(along,)) for along in stretches]
    bars = (np.diag([s, s, a]) for s, a in zip(sides, stretches, strict=True))
    return np.array([law.stress(F)[2, 2] for F in bars])


if __name__ == "__main__":
    found = main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    print(
        f"P is dW/dF to {found['derivative_error']:.0e}; pressed to 0.7 the law is "
        f"{found['stiffer_at_0.7']:.2f} times as stiff as without c₂"
    )
