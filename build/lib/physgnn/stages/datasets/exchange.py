"""To and from other programs."""

from collections.abc import Sequence
from pathlib import Path

from physgnn.config import read_materials, read_preset
from physgnn.dataset import Store
from physgnn.dataset.exchange import importing
from physgnn.dataset.exchange.exporting import (
    export_arrays,
    export_febio,
    export_series,
)
from physgnn.errors import InputError
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.progress import Progress
from physgnn.stages.outputs import FOLDER, Output, writes


@writes(
    febio=Output((".feb",)),
    arrays=Output((".npz",)),
    series=FOLDER,
    onnx=Output((".onnx",), inside=("source",)),
)
def export(
    source: str | Path,
    *,
    febio: str | Path | None = None,
    arrays: str | Path | None = None,
    series: str | Path | None = None,
    onnx: str | Path | None = None,
    preset: str | None = None,
    loads: str | Path | None = None,
    path: int = 0,
) -> Path:
    """Write a load path for FEBio, or results or a network for other programs.

    Parameters
    ----------
    source : path
        A mesh or a dataset for FEBio, a dataset for arrays or a series, a run for ONNX.
    febio : path, optional
        FEBio 4 model, .feb, of one load path; or else `arrays`, `series` or `onnx`.
    arrays : path, optional
        NumPy arrays, .npz, of all load paths.
    series : path, optional
        Folder of VTU files, one a level of one load path.
    onnx : path, optional
        The network of a run, .onnx.
    preset : str, optional
        The loads of a mesh, a row of ``PRESETS``; a dataset has its own.
    loads : path, optional
        The loads of a mesh in TOML, as for `simulate`.
    path : int
        Which load path, from 0.

    Returns
    -------
    Path
        What was written.

    Raises
    ------
    InputError
        If not exactly one target is given, or the source cannot be written so.
    """
    if sum(target is not None for target in (febio, arrays, series, onnx)) != 1:
        raise InputError("give one of --febio, --arrays, --series and --onnx")
    if onnx is not None:
        from physgnn.learning.runs.onnx import export_onnx

        export_onnx(source, onnx)
        return Path(onnx)
    if febio is not None:
        chosen = preset if loads is None else read_preset(loads)
        export_febio(source, febio, preset=chosen, path=path)
        return Path(febio)
    if arrays is not None:
        export_arrays(source, arrays)
        return Path(arrays)
    assert series is not None
    export_series(source, series, path=path)
    return Path(series)


@writes(out=FOLDER)
def import_results(
    sources: Sequence[str | Path],
    out: str | Path,
    *,
    materials: str | Path | None = None,
    element: str = DEFAULT_ELEMENT,
    progress: Progress | None = None,
) -> Store:
    """Make a dataset of another solver's results.

    Parameters
    ----------
    sources : sequence of paths
        FEBio models (.feb, beside their logs), .npz files, or folders of VTU files.
    out : path
        The dataset, a folder that does not exist yet.
    materials : path, optional
        TOML with ``[materials.<region>]`` tables, for sources that do not name theirs.
    element : str
        The finite element that the results stand for.
    progress : callable, optional
        Called with the load paths done, in all, and where the last came from.

    Returns
    -------
    Store
        The new dataset.

    Raises
    ------
    InputError
        If a source is wrong or does not fit the first one. No dataset is left then.
    """
    return importing.import_results(
        sources,
        out,
        materials=read_materials(materials),
        element=element,
        progress=progress,
    )
