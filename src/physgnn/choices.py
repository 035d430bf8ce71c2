"""What a user chooses from where the list is closed, by name and without its code.

The tables of functions behind these names have the members for keys. They stand here,
below everything, because the command line shows them in its help: importing the tables
would import torch and compiled kernels first.
"""

from enum import StrEnum


class PresetName(StrEnum):
    """Where a body is held and loaded: rows of `physgnn.dataset.PRESETS`."""

    PAPER_1 = "paper-1"
    PAPER_2 = "paper-2"
    DEMO = "demo"
    FAMILY = "family"


class Mesher(StrEnum):
    """What fills surfaces: rows of `physgnn.geometry.meshing.tetrahedra.MESHERS`."""

    TETWILD = "tetwild"
    TETGEN = "tetgen"


class MembraneSupport(StrEnum):
    """How falx and tentorium act: see `physgnn.dataset.membranes`."""

    HELD = "held"
    ELASTIC = "elastic"
    LEFT_OUT = "left-out"


class SolverName(StrEnum):
    """What solves load paths: rows of `physgnn.dataset.SOLVERS`."""

    PHYSGNN = "physgnn"
    FEBIO = "febio"


class Element(StrEnum):
    """Finite elements: rows of `physgnn.mechanics.elements.tet4.ELEMENTS`."""

    TET4 = "tet4"
    TET4_AVERAGED = "tet4-averaged"


class FittedLaw(StrEnum):
    """Laws that can be fitted.

    Rows of `physgnn.mechanics.materials.fitted_laws.FAMILIES`.
    """

    NEO_HOOKEAN = "neo-hookean"
    MOONEY_RIVLIN = "mooney-rivlin"
    OGDEN = "ogden"


class StressUnit(StrEnum):
    """Units of measured stress: rows of `physgnn.io.stress_curves.PA`."""

    KPA = "kpa"
    PA = "pa"


class SplitName(StrEnum):
    """Which samples are held out: rows of `physgnn.dataset.SPLITS`, and ``mesh``."""

    PUBLISHED = "published"
    PATH = "path"
    NODE = "node"
    MESH = "mesh"


class LossName(StrEnum):
    """What training minimises: rows of `learning.training.objective.losses.LOSSES`."""

    MEAN_EUCLIDEAN = "mean_euclidean"
    MEAN_SQUARE = "mean_square"
    MEAN_ABSOLUTE = "mean_absolute"
    ROOT_MEAN_SQUARE_SAMPLE = "root_mean_square_sample"
    RELATIVE_SAMPLE = "relative_sample"


class Schedule(StrEnum):
    """How the learning rate falls.

    Rows of `physgnn.learning.training.schedules.SCHEDULES`.
    """

    PLATEAU = "plateau"
    COSINE = "cosine"


class Clock(StrEnum):
    """What counts minutes: rows of `physgnn.learning.training.budget.CLOCKS`."""

    WALL = "wall"
    PROCESSOR = "processor"


class PrecisionName(StrEnum):
    """Of PhysGNN's LSTMs: rows of `physgnn.learning.physgnn.precision.PRECISIONS`."""

    FLOAT32 = "float32"
    BFLOAT16 = "bfloat16"


class Device(StrEnum):
    """Where a network is trained, as Lightning names it."""

    CPU = "cpu"
    CUDA = "cuda"
    GPU = "gpu"
    MPS = "mps"
    AUTO = "auto"


class Estimate(StrEnum):
    """How the error of a prediction is estimated by `physgnn.prediction.Predictor`."""

    PHYSICAL = "physical"
    QUICK = "quick"


class Skull(StrEnum):
    """How the skull holds a brain: rows of `physgnn.registration.skull.SUPPORTS`."""

    FIXED = "fixed"
    SLIDING = "sliding"


class AffineForm(StrEnum):
    """Of a NIfTI header: rows of `physgnn.io.medical.nifti_place.FORMS`."""

    SFORM = "sform"
    QFORM = "qform"


class Interpolation(StrEnum):
    """Between voxels: rows of `physgnn.imaging.image_warping.INTERPOLATIONS`."""

    LINEAR = "linear"
    NEAREST = "nearest"
    CUBIC = "cubic"
