"""From a registration to the page that shows it."""

from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.geometry.image import Image
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.geometry.tetmesh import TetMesh

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.evaluation.registration_page.case import RegisteredCase
    from physgnn.registration.result import Registration

PAGE = "report.html"


def page_in(folder: str | Path) -> Path:
    """Return the page's file."""
    return Path(folder) / PAGE


def registered_case(
    mesh: TetMesh,
    found: "Registration",
    measured: Sequence[PointPairs | SurfacePoints],
    noise_mm: float,
    image: Image | None,
) -> "RegisteredCase":
    """Return what the page shows."""
    from physgnn.evaluation.registration_page.case import RegisteredCase
    from physgnn.evaluation.registration_page.places import measured_places

    u, offset = found.prediction.displacement, found.offset
    undone = offset.undone if offset.corrected else np.asarray
    places = measured_places(mesh, u, measured, undone)
    # of a large surface some points were used, which have no names
    if len(places) == len(found.misfits):
        places = tuple(
            replace(
                place,
                name=one.label,
                after_mm=one.distance_mm,
                note="outlier" if one.is_outlier else "",
            )
            for place, one in zip(places, found.misfits, strict=True)
        )
    return RegisteredCase(
        mesh=mesh,
        prediction=found.prediction,
        deviation_mm=found.deviation_mm,
        covariance_mm2=found.covariance_mm2,
        misfit_mm=found.misfit_mm,
        held_out_mm=found.held_out_mm,
        places=places,
        noise_mm=noise_mm,
        image=image,
        facts={
            "made by": f"physgnn {version('physgnn')}",
            "navigation": found.navigation,
        },
    )


def write_page(path: Path, case: "RegisteredCase") -> None:
    """Write the page into its folder, which is made if it is missing."""
    from physgnn.evaluation.registration_page.page import write_registration_page

    path.parent.mkdir(parents=True, exist_ok=True)
    write_registration_page(case, path)
