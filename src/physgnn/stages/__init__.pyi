"""The commands: the one table of their functions, exported by ``physgnn`` too."""

from .cohort.batching import batch as batch
from .datasets.exchange import export as export
from .datasets.exchange import import_results as import_results
from .datasets.simulation import simulate as simulate
from .datasets.synthetic_patients import anatomies as anatomies
from .experiments.ablation import ablate as ablate
from .experiments.benchmarking import benchmark as benchmark
from .experiments.bundling import bundle as bundle
from .experiments.demonstration import demo as demo
from .experiments.installation import selftest as selftest
from .experiments.reproduction import reproduce as reproduce
from .materials.fitting import fit_material as fit_material
from .networks.evaluation import evaluate as evaluate
from .networks.published_weights import published as published
from .networks.training import train as train
from .patient.adaptation import adapt as adapt
from .patient.case_file import init as init
from .patient.meshing import mesh as mesh
from .patient.prediction import predict as predict
from .patient.registration import register as register
from .patient.segmenting import segment as segment
from .patient.uncertainty_images import uncertainty as uncertainty
from .patient.viewing import view as view
from .patient.warping import warp as warp
from .slicer_modules.launchers import slicer as slicer

__all__: list[str]
