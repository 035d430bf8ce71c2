"""The commands: the one table of their functions, exported by ``physgnn`` too."""

from .cohort.batching import batch as batch
from .datasets.exchange import export as export
from .datasets.exchange import import_results as import_results
from .datasets.simulation import simulate as simulate
from .datasets.synthetic_patients import anatomies as anatomies
from .experiments.ablation import ablate as ablate
from .experiments.benchmark.benchmarking import benchmark as benchmark
from .experiments.bundling import bundle as bundle
from .experiments.demonstration import demo as demo
from .experiments.installation import selftest as selftest
from .experiments.reproduction import reproduce as reproduce
from .materials.fitting import fit_material as fit_material
from .networks.evaluation import evaluate as evaluate
from .networks.published_weights import published as published
from .networks.training import train as train
from .patient.images.uncertainty_images import uncertainty as uncertainty
from .patient.images.warping import warp as warp
from .patient.intraoperative.prediction import predict as predict
from .patient.intraoperative.registration import register as register
from .patient.live_view.viewing import view as view
from .patient.preoperative.adaptation import adapt as adapt
from .patient.preoperative.case_file import init as init
from .patient.preoperative.meshing import mesh as mesh
from .patient.preoperative.segmenting import segment as segment
from .slicer_modules.launchers import slicer as slicer
