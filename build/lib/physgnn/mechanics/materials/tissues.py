"""Tissues of the head: parameters from the literature, each with its source.

Moduli of living brain scatter by a factor of ten between laboratories, with the rate
of loading and with the patient; these are starting points, not constants of nature.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from physgnn.mechanics.materials.neo_hookean import NeoHookean
from physgnn.mechanics.materials.ogden import Ogden
from physgnn.mechanics.materials.table import Material

_SALEHI = (
    "Salehi & Giannacopoulos 2022 (PhysGNN, NeurIPS), after Tonutti et al. 2017, "
    "Artif. Intell. Med. 80"
)
_MILLER = (
    "Miller & Chinzei 2002, J. Biomech. 35: shear modulus 842 Pa, exponent -4.7; with "
    "the compressibility D of SlicerCBM's module BrainMaterialProperties"
)
_SLICER = (
    "SlicerCBM, module BrainMaterialProperties (Intelligent Systems for Medicine "
    "Laboratory, University of Western Australia)"
)
_BENNION = (
    "Bennion et al. 2022 (PMC9748497), identified in vivo from prone and supine MRI "
    "with FEBio: shear modulus 670 Pa, exponent -19, bulk modulus 148 kPa"
)
_BUDDAY = (
    "our fit of one Ogden term at Poisson's ratio 0.49 to tension, compression and "
    "shear of human {}: Budday et al. 2017, Acta Biomater. 48, as distributed with "
    "LivingMatterLab/CANN; RMS error over RMS stress {} / {} / {} %"
)


@dataclass(frozen=True)
class Tissue:
    """A material and where its figures come from."""

    material: Material
    source: str


def _ogden(mu_pa: float, alpha: float, bulk_modulus_pa: float) -> Ogden:
    """One term as papers on brain tissue write it, W̃ = 2μ/α² Σ (λ̃^α − 1)."""
    return Ogden((2 * mu_pa,), (alpha,), bulk_modulus_pa)


# Where a source gives Abaqus's D, k = 2 / D.
TISSUES: Mapping[str, Tissue] = {
    "brain": Tissue(NeoHookean(3000.0, 0.49), _SALEHI),
    "tumour": Tissue(NeoHookean(7500.0, 0.49), _SALEHI),
    "stiff-tumour": Tissue(NeoHookean(9000.0, 0.49), _SLICER),
    "ventricle": Tissue(NeoHookean(100.0, 0.10), _SLICER),
    "brain-ogden": Tissue(_ogden(842.0, -4.7, 2 / 4.78e-5), _MILLER),
    "tumour-ogden": Tissue(_ogden(3 * 842.0, -4.7, 2 / 1.59e-5), _SLICER),
    "ventricle-ogden": Tissue(_ogden(4.54, 2.0, 2 / 0.008), _SLICER),
    "brain-in-vivo": Tissue(_ogden(670.0, -19.0, 148_000.0), _BENNION),
    "cortex": Tissue(
        _ogden(1469.5, -19.11, 72_985.0), _BUDDAY.format("cortex", 15, 3, 10)
    ),
    "corona-radiata": Tissue(
        _ogden(634.6, -24.03, 31_518.0), _BUDDAY.format("corona radiata", 5, 15, 12)
    ),
}
