"""What is on show: a body, its predictors, and where it can be loaded."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.arrays import IntArray
from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.geometry.regions import REGIONS
from physgnn.learning.models import build_model
from physgnn.learning.surrogate import FromFunction
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear.factor_cache import FACTORS
from physgnn.mechanics.materials.tissues import TISSUES
from physgnn.prediction.error_bounds.calibration import Calibration
from physgnn.prediction.error_bounds.indicators import Indicator
from physgnn.prediction.prediction import Predict
from physgnn.prediction.predictor import Predictor
from physgnn.serving.scene.patch_load import Exposed

MATERIALS = {region: TISSUES[name].material for region, name in enumerate(REGIONS)}
DEFAULT_FORCE_N = 4.0
FINITE_ELEMENTS = "finite elements"  # what their solution is called on the page


@dataclass(frozen=True, eq=False)
class Viewed:
    """A body on show.

    Attributes
    ----------
    title : str
        Its name on the page.
    body : Body
        Mesh, materials and fixed points.
    predictors : mapping of str to predictor
        Those that follow the pointer: "network" if there is one, "linear" always.
    exposed : Exposed
        Where it can be loaded.
    calibration : Calibration or None
        Of the network.
    indicator : callable or None
        What the calibration scales.
    """

    title: str
    body: Body
    predictors: Mapping[str, Predict]
    exposed: Exposed
    calibration: Calibration | None = None
    indicator: Indicator | None = None

    @property
    def usual_force_n(self) -> float:
        """The greatest force in training, or a gentle one, N."""
        if self.calibration is None:
            return DEFAULT_FORCE_N
        return self.calibration.trained_range.total_force_n


def view(path: str | Path | None, mesh: TetMesh | None = None) -> Viewed:
    """Return what a path holds: a run folder, a mesh, or, for None, the bundled model.

    A mesh has linear elasticity and finite elements only, and the published materials.

    Parameters
    ----------
    path : path or None
        What to show.
    mesh : TetMesh, optional
        The mesh at the path, where it was read before.

    Raises
    ------
    InputError
        If it is neither, or the mesh has no point set "fixed".
    """
    if path is None:
        return view_run(BUNDLED_RUN, "MNI152 with a tumour")
    path = Path(path)
    if path.is_dir():
        return view_run(path, "/".join(path.resolve().parts[-2:]))
    if path.suffix.lower() != ".vtu":
        raise InputError(f"{path} must be a run folder or a mesh, .vtu")
    from physgnn.io import read_mesh

    mesh = read_mesh(path) if mesh is None else mesh
    return view_mesh(mesh, path.stem, factors=path.with_suffix(FACTORS))


def view_run(run: Path, title: str) -> Viewed:
    """Return a trained run: what was loaded in training is what is exposed."""
    network = Predictor.load(run, warm=False)  # the server does that meanwhile
    body, calibration = network.body, network.calibration
    trained = None if calibration is None else calibration.trained_range.nodes
    exposed = Exposed.of(body, _exposed_nodes(body.mesh, trained))
    linear = FromFunction(body, network.surrogate.linear)  # shares its factor
    return Viewed(
        title=title,
        body=body,
        predictors={"network": network, "linear": Predictor(linear)},
        exposed=exposed,
        calibration=calibration,
        indicator=network.indicate if calibration else None,
    )


def view_mesh(mesh: TetMesh, title: str, *, factors: Path | None = None) -> Viewed:
    """Return a mesh without a network, made of the published materials."""
    body = Body(mesh, MATERIALS, mesh.point_set("fixed"), factors=factors)
    exposed = Exposed.of(body, _exposed_nodes(mesh, None))
    linear = Predictor(build_model("linear", body))
    return Viewed(title, body, {"linear": linear}, exposed)


def _exposed_nodes(mesh: TetMesh, trained: tuple[int, ...] | None) -> IntArray | None:
    if trained is not None:
        return np.array(trained, dtype=np.int64)
    return mesh.point_sets.get("loaded")
