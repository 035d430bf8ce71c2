"""From a load in a file to a displacement in a file."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.prediction.prediction import Prediction


def predict(
    run: str | Path,
    load: str | Path,
    out: str | Path,
    *,
    tolerance_mm: float | None = None,
    linear: bool = False,
) -> "Prediction":
    """Answer a load case from a JSON file and write the mesh with its displacement.

    Parameters
    ----------
    run : path
        Folder of a trained model.
    load, out : path
        JSON in, VTU out.
    tolerance_mm : float, optional
        See `physgnn.prediction.Predictor`.
    linear : bool
        Write the linear solution beside the prediction.
    """
    from physgnn.io import read_load_case, write_prediction
    from physgnn.prediction.linear import linear_answer
    from physgnn.prediction.predictor import Predictor

    predictor = Predictor.load(run)
    body = predictor.body
    case = read_load_case(load, body.mesh)
    prediction = predictor(case, tolerance_mm=tolerance_mm)
    fields = {"displacement_mm": prediction.displacement}
    if linear:
        fields["linear_displacement_mm"] = linear_answer(body)(case)
    fields["force_n"] = case.on_points(body.mesh.n_points)
    write_prediction(out, body.mesh, fields)
    return prediction
