"""Hyperelastic materials: energy, stress and tangent as printed."""

from dataclasses import dataclass

from physgnn.errors import InputError


@dataclass(frozen=True)
class NeoHookean:
    """Compressible neo-Hookean solid, W = μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)².

    FEBio's "neo-Hookean" (FEBio User Manual, coupled materials).

    Parameters
    ----------
    youngs_modulus_pa : float
        Young's modulus of the rest state, Pa.
    poissons_ratio : float
        Poisson's ratio of the rest state, in (−1, 0.5).

    Raises
    ------
    InputError
        If either is out of range.
    """

    youngs_modulus_pa: float
    poissons_ratio: float

    def __post_init__(self) -> None:
        if not self.youngs_modulus_pa > 0:
            raise InputError(
                f"youngs_modulus_pa must be > 0 (got {self.youngs_modulus_pa})"
            )
        if not -1 < self.poissons_ratio < 0.5:
            raise InputError(
                f"poissons_ratio must be in (-1, 0.5) (got {self.poissons_ratio})"
            )

    @property
    def mu(self) -> float:
        """Shear modulus μ = E / (2 (1 + ν)), MPa."""
        return 1e-6 * self.youngs_modulus_pa / (2 * (1 + self.poissons_ratio))

    @property
    def lam(self) -> float:
        """Lamé's first parameter λ = E ν / ((1 + ν)(1 − 2ν)), MPa."""
        nu = self.poissons_ratio
        return 1e-6 * self.youngs_modulus_pa * nu / ((1 + nu) * (1 - 2 * nu))
