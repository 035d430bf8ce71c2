"""A trained surrogate on a body it never saw: nothing is learnt there."""

from physgnn.arrays import FloatArray
from physgnn.learning.models import build_model
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.record import trained_meshes
from physgnn.mechanics.body import Body

# Written anew by `Checkpoint.save`.
OF_THE_BODY = ("mesh_hash", "element", "materials", "format_version")


def adapt(checkpoint: Checkpoint, body: Body, forces: FloatArray) -> Checkpoint:
    """Return a trained surrogate for another body.

    Parameters
    ----------
    checkpoint : Checkpoint
        Of a network whose weights serve any body, such as a lifted one without POD
        modes: all that it learnt is local and physical.
    body : Body
        Any.
    forces : (n_loads, n_points, 3) array
        Loads like those to come on it, each at its strongest, N; the equilibria to
        expand about are found near them.

    Raises
    ------
    InputError
        If the network belongs to its body.
    """
    config = checkpoint.record["config"]
    model = build_model(config["model"], body, **config["options"])
    model.transfer(checkpoint.model, forces)
    record = {k: v for k, v in checkpoint.record.items() if k not in OF_THE_BODY}
    data = {**record["data"], "meshes": trained_meshes(checkpoint.record)}
    data.pop("stores", None)  # they lie where the other run says
    model.prepare()
    return Checkpoint(model, {**record, "data": data})
