"""A family of synthetic patients, for networks that are to serve a new one."""

from pathlib import Path

from physgnn.errors import InputError
from physgnn.geometry.synthetic.anatomies import build_anatomy, draw_anatomy
from physgnn.io import write_mesh
from physgnn.progress import Progress
from physgnn.stages.outputs import FOLDER, writes

MOST_SPARE = 10  # draws that may fail to mesh, before something else must be wrong


@writes(out=FOLDER)
def anatomies(
    out: str | Path,
    *,
    count: int = 12,
    seed: int = 0,
    progress: Progress | None = None,
) -> list[Path]:
    """Draw synthetic patients as meshes, ``anatomy-<seed>.vtu``.

    Those already there stay; a patient that cannot be meshed (its tumour may reach
    the cortex) is passed over for the next.

    Parameters
    ----------
    out : path
        Folder for the meshes.
    count : int
        How many.
    seed : int
        The seed of the first patient; the others have the seeds that follow. One
        that cannot be meshed is passed over.
    progress : callable, optional
        Called with (done, total, text) after every mesh.

    Returns
    -------
    list of paths
        The meshes, with point sets ``fixed`` and ``loaded``.

    Raises
    ------
    InputError
        If count is below 1 or the seed below 0, or too many patients cannot be meshed.
    """
    if count < 1:
        raise InputError(f"count must be ≥ 1 (got {count})")
    if seed < 0:
        raise InputError(f"seed must be ≥ 0 (got {seed})")
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    made: list[Path] = []
    last: InputError | None = None
    for number in range(seed, seed + count + MOST_SPARE):
        path = folder / f"anatomy-{number:03d}.vtu"
        try:
            if not path.exists():
                write_mesh(path, build_anatomy(draw_anatomy(number)))
            made.append(path)
        except InputError as error:
            last = error
        if progress is not None:
            progress(len(made), count, "meshing")
        if len(made) == count:
            return made
    raise InputError(f"only {len(made)} of {count} patients could be meshed: {last}")
