"""From a load in a file to a displacement in a file."""

from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.progress import Log, no_log
from physgnn.stages.outputs import Output, writes

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.mechanics.body import Body
    from physgnn.mechanics.loads.paths import LoadPath
    from physgnn.prediction.prediction import Prediction


@writes(out=Output(inside=("run",)))
def predict(
    run: str | Path | None,
    load: str | Path,
    out: str | Path,
    *,
    form: str | None = None,
    image: str | Path | None = None,
    tolerance_mm: float | None = None,
    linear: bool = False,
    precision: str = "float32",
    estimate: str = "physical",
    affine: str | None = None,
    log: Log = no_log,
) -> "Prediction":
    """Predict the displacement under a load case from a JSON file and write it.

    It is written whatever its status is, with the status and the reasons for it inside.

    Parameters
    ----------
    run : path or None
        Folder of a trained model; None takes the bundled one.
    load : path
        JSON.
    out : path
        Where the displacement goes; its suffix decides in what form.
    form : str, optional
        A row of `physgnn.io.displacement_files.FORMS`, where the suffix leaves a
        choice.
    image : path, optional
        NIfTI whose voxels a field on voxels has; by default 2 mm around the body.
    tolerance_mm : float, optional
        See `physgnn.prediction.Predictor`.
    linear : bool
        Write the linear solution beside the prediction.
    precision : {"float32", "bfloat16"}
        See `physgnn.prediction.Predictor`.
    estimate : {"physical", "quick"}
        How the error is estimated; see `physgnn.prediction.Predictor`.
    affine : {"sform", "qform"}, optional
        Which of two places in the image's header is meant, where they disagree.
    log : callable
        Called with what the image's header leaves open.

    Returns
    -------
    Prediction
        The displacement that was written, mm, with its status and error bound.

    Raises
    ------
    InputError
        If a file cannot be used, or the displacement not be written so.
    """
    from physgnn.io.displacement_files import FORMS, DisplacementFields, form_of

    written = form_of(out, form)  # before what takes seconds to import
    written.check_image(out, image)
    if linear and written is not FORMS["rest"]:
        raise InputError(
            f"{out}: --linear writes the linear solution beside the other, in a .vtu "
            "of the rest state: leave it out, or write that"
        )
    from physgnn.io import read_load_path
    from physgnn.io.medical.images.formats import read_image
    from physgnn.learning.models import build_model
    from physgnn.prediction.predictor import Predictor

    grid = None if image is None else read_image(image, affine=affine, log=log).grid
    predictor = Predictor.load(run or BUNDLED_RUN, precision=precision, warm=False)
    body = predictor.body
    path = read_load_path(load, body.mesh)
    beside = {}
    if path.more:
        prediction = _of_any_load(body, path, load, tolerance_mm, linear=linear)
    else:
        case = path.case(0)
        prediction = predictor(case, tolerance_mm=tolerance_mm, estimate=estimate)
        if linear:
            solution = build_model("linear", body)
            beside["linear_displacement_mm"] = solution.predict(case)
        beside["force_n"] = case.on_points(body.mesh.n_points)
    fields = {"displacement_mm": prediction.displacement, **beside}
    said = str(prediction.status), prediction.reasons
    written.write(Path(out), DisplacementFields(body.mesh, fields, grid, *said))
    return prediction


def _of_any_load(
    body: "Body",
    path: "LoadPath",
    load: str | Path,
    tolerance_mm: float | None,
    *,
    linear: bool,
) -> "Prediction":
    """Solve a load that no network was trained on, if a tolerance asks for it."""
    from physgnn.prediction.finite_element import solve_by_finite_elements

    if tolerance_mm is None or linear:
        raise InputError(
            f"{load}: networks were trained on nodal forces alone, and this load holds "
            "growth: give --tolerance-mm, without --linear, and finite elements solve "
            "it"
        )
    return solve_by_finite_elements(body, path, tolerance_mm=tolerance_mm)
