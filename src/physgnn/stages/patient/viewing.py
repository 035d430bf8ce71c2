"""A body in the browser."""

from pathlib import Path

from physgnn.progress import Log

DEFAULT_PORT = 8750


def view(
    path: str | Path | None = None,
    *,
    port: int = DEFAULT_PORT,
    image: str | Path | None = None,
    affine: str | None = None,
    igtl: int | None = None,
    igtl_surfaces: bool = False,
    log: Log = print,
) -> None:
    """Show a body in the browser, to push it and see it follow, until interrupted.

    Parameters
    ----------
    path : path, optional
        A run folder or a mesh; by default the bundled model.
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
    log : callable
        Receives the addresses, a line each.

    Raises
    ------
    InputError
        If there is nothing to show at the path, or a port is taken.
    """
    from physgnn.serving import serve

    serve(
        path,
        port=port,
        image=image,
        affine=affine,
        igtl=igtl,
        igtl_surfaces=igtl_surfaces,
        log=log,
    )
