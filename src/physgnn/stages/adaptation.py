"""A trained network made ready for a patient it never saw."""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.dataset.presets import Preset, find_preset
from physgnn.errors import InputError
from physgnn.geometry import TetMesh


@dataclass(frozen=True)
class Adapted:
    """What making ready took.

    Attributes
    ----------
    n_points : int
        Of the new mesh.
    seconds : float
        To find the equilibria to expand about and write the run.
    coverage : float or None
        What the error bounds promise; None if the run has none for new patients.
    """

    n_points: int
    seconds: float
    coverage: float | None


def adapt_run(
    run: str | Path, mesh: TetMesh, preset: str | Preset, out: str | Path
) -> Adapted:
    """Write a run folder that predicts on another mesh; nothing is trained.

    Parameters
    ----------
    run : path
        Folder of a lifted network trained with modes = 0, best on several bodies.
    mesh : TetMesh
        The new patient's.
    preset : str or Preset
        Where it's held and loaded, and what it's made of. Its load paths say what
        loads to expect; they are not solved, but for a path under their mean.
    out : path
        Folder for the new run.

    Raises
    ------
    InputError
        If the network belongs to its mesh, the preset doesn't fit the mesh, or the
        folder holds a run already.
    """
    from physgnn.learning.adaptation import adapt
    from physgnn.learning.checkpoint import RECORD, Checkpoint
    from physgnn.mechanics.body import Body
    from physgnn.prediction.calibration import Calibration
    from physgnn.prediction.predictor import CALIBRATION_FILE, RELAXATION_FILE
    from physgnn.prediction.run_calibration import on_new_loads
    from physgnn.prediction.trained_range import TrainedRange

    run, out = Path(run), Path(out)
    if (out / RECORD).exists():
        raise InputError(f"{out} holds a run already: name another folder")
    trained = Checkpoint.load(run)
    is_family = len(trained.record["data"].get("meshes", ())) > 1
    start = time.perf_counter()
    preset = find_preset(preset) if isinstance(preset, str) else preset
    mesh, paths = preset.on(mesh)
    body = Body(mesh, preset.materials, element=preset.element)
    cases = [path.case(path.n_levels - 1) for path in paths]
    forces = np.stack([case.on_points(mesh.n_points) for case in cases])
    adapt(trained, body, forces).save(out)
    coverage, loads = None, TrainedRange.from_cases(cases)
    for file in (CALIBRATION_FILE, RELAXATION_FILE):
        if is_family and (run / file).is_file():
            calibration = on_new_loads(Calibration.read(run / file), loads)
            calibration.write(out / file)
            coverage = calibration.coverage
    return Adapted(mesh.n_points, time.perf_counter() - start, coverage)
