"""A body in the browser."""

from contextlib import closing
from functools import partial
from pathlib import Path

from physgnn.errors import InputError
from physgnn.progress import Log
from physgnn.stages.outputs import FOLDER, writes
from physgnn.stages.patient.live_view.case_desk import CaseDesk

DEFAULT_PORT = 8750


@writes(save=FOLDER)
def view(
    path: str | Path | None = None,
    *,
    port: int = DEFAULT_PORT,
    image: str | Path | None = None,
    affine: str | None = None,
    igtl: int | None = None,
    igtl_surfaces: bool = False,
    save: str | Path | None = None,
    log: Log = print,
) -> None:
    """Show a body in the browser, to push it and see it follow, until interrupted.

    Parameters
    ----------
    path : path, optional
        A run folder or a case (a mesh, VTU); by default the bundled model. On a case
        the page places the craniotomy and registers measured files.
    port : int
        On 127.0.0.1; 0 takes a free one.
    image : path, optional
        Image for sections, or "mni152".
    affine : {"sform", "qform"}, optional
        Which of two places in the image's header is meant, where they disagree.
    igtl : int, optional
        Port to stream the deformation from by OpenIGTLink; 0 takes a free one.
    igtl_surfaces : bool
        Stream the deformed surfaces too.
    save : path, optional
        Folder that the page may keep case files and registrations of a case in.
    log : callable
        Receives the addresses, a line each.

    Raises
    ------
    InputError
        If there is nothing to show at the path, a port is taken, or there is a folder
        to save in but no case.
    """
    from physgnn.serving import serve

    show = partial(
        serve,
        path,
        port=port,
        image=image,
        affine=affine,
        igtl=igtl,
        igtl_surfaces=igtl_surfaces,
        log=log,
    )
    if path is None or Path(path).suffix.lower() != ".vtu":
        if save is not None:
            raise InputError(f"--save goes with a case, .vtu (got {path or 'none'})")
        show()
        return
    with closing(CaseDesk(path, save)) as desk:
        show(desk=desk)
