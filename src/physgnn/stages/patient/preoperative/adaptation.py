"""A trained network made ready for a patient it never saw."""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.bundled import BUNDLED_FAMILY, FAMILY_NAME
from physgnn.dataset.presets import Preset, find_preset
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.io import read_mesh
from physgnn.progress import Log, no_log
from physgnn.stages.datasets.chosen_loads import chosen_preset
from physgnn.stages.outputs import Output, writes


@dataclass(frozen=True)
class Adapted:
    """What making ready took.

    Attributes
    ----------
    n_points : int
        Points of the new mesh.
    seconds : float
        Time that finding the equilibria to expand about and writing the run took, s.
    coverage : float or None
        What the error bounds promise; None if the run has none for new patients.
    unlike : tuple of str
        Why the body is none of those that bounds of a family hold for: it gets none.
    """

    n_points: int
    seconds: float
    coverage: float | None
    unlike: tuple[str, ...] = ()


@writes(out=Output(is_folder=True, inside=("run",)))
def adapt(
    run: str | Path | None,
    case: str | Path,
    out: str | Path,
    *,
    preset: str | None = None,
    loads: str | Path | None = None,
    log: Log = no_log,
) -> Adapted:
    """Make a trained network ready for a patient it never saw, in seconds.

    Parameters
    ----------
    run : path or None
        Folder of a network whose weights serve any body, such as a lifted one without
        pod_modes, best trained on several; None, or ``bundled-family`` where there is
        no such folder, takes the one that comes with the package.
    case : path
        The new patient's mesh, VTU.
    out : path
        Folder for the new run.
    preset : str, optional
        A row of ``PRESETS``; or else `loads`. Its load paths say what loads to expect.
    loads : path, optional
        TOML with point sets, materials and loads: see `physgnn.config.simulation`.
    log : callable
        Called with a line if the mesh seems to be in another unit than mm.

    Returns
    -------
    Adapted
        The size of the mesh, the seconds it took, and what the bounds promise.

    Raises
    ------
    InputError
        If a file cannot be used, the network belongs to its mesh, the loads do not fit
        the mesh, or the folder holds a run already.
    """
    chosen = chosen_preset(preset, loads)
    return adapt_run(family_run(run), read_mesh(case, log=log), chosen, out)


def family_run(run: str | Path | None) -> Path:
    """Return the folder of a run to adapt, by default the bundled one."""
    if run is None or (str(run) == FAMILY_NAME and not Path(run).exists()):
        return BUNDLED_FAMILY
    return Path(run)


def adapt_run(
    run: str | Path, mesh: TetMesh, preset: str | Preset, out: str | Path
) -> Adapted:
    """Write a run folder that predicts on another mesh; nothing is trained.

    Parameters
    ----------
    run : path
        Folder of a network whose weights serve any body, such as a lifted one without
        pod_modes, best trained on several.
    mesh : TetMesh
        The new patient's.
    preset : str or Preset
        Where it's held and loaded, and what it's made of. Its load paths say what
        loads to expect; they are not solved, but for a path under their mean, or
        under each of their clusters.
    out : path
        Folder for the new run.

    Raises
    ------
    InputError
        If the network belongs to its mesh, the preset doesn't fit the mesh, or the
        folder holds a run already.
    """
    from physgnn.learning.runs.adaptation import adapt as adapted
    from physgnn.learning.runs.checkpoint import Checkpoint
    from physgnn.learning.runs.folder import RunFolder
    from physgnn.mechanics.body import Body
    from physgnn.prediction.error_bounds.calibration import Calibration
    from physgnn.prediction.error_bounds.likeness import reasons_unlike
    from physgnn.prediction.error_bounds.run_calibration import on_new_loads
    from physgnn.prediction.error_bounds.trained_range import TrainedRange

    run, out = Path(run), Path(out)
    if RunFolder(out).record.exists():
        raise InputError(f"{out} holds a run already: name another folder")
    trained = Checkpoint.load(run)
    is_family = len(trained.record["data"].get("meshes", ())) > 1
    start = time.perf_counter()
    preset = find_preset(preset) if isinstance(preset, str) else preset
    mesh, paths = preset.on(mesh)
    body = Body(mesh, preset.materials, element=preset.element)
    cases = [path.case(path.n_levels - 1) for path in paths]
    forces = np.stack([case.on_points(mesh.n_points) for case in cases])
    adapted(trained, body, forces).save(out)
    coverage, loads = None, TrainedRange.from_cases(cases)
    unlike = reasons_unlike(mesh, trained.model.body.mesh) if is_family else ()
    for file in RunFolder(run).calibrations:
        if is_family and not unlike and file.is_file():
            calibration = on_new_loads(Calibration.read(file), loads)
            calibration.write(out / file.name)
            coverage = calibration.coverage
    return Adapted(mesh.n_points, time.perf_counter() - start, coverage, unlike)
