"""One HTML file about a registration: no network, no other files."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from physgnn.evaluation.registration_page.case import RegisteredCase
from physgnn.evaluation.registration_page.figures import draw_registration
from physgnn.evaluation.registration_page.places import MeasuredPlace
from physgnn.evaluation.report.formats import duration, mm, percent
from physgnn.evaluation.report.page import Parts, environment
from physgnn.evaluation.report.plots.panels import Picture
from physgnn.evaluation.report.tables import Table
from physgnn.io.integrity.atomic import write_whole
from physgnn.scratch import scratch_folder

MOST_ROWS = 60
# Dots of the table: within twice the noise of each coordinate, and beyond.
NEAR, FAR = "#0f9d7e", "#d4477e"
FAR_FROM = 2.0 * np.sqrt(3.0)
FOOTER = (
    "Distances and displacements in mm, RAS. Left and right are the patient's. Not a "
    "medical device: for research."
)


def write_registration_page(case: RegisteredCase, path: Path) -> None:
    """Write the page, whole or not at all.

    Raises
    ------
    InputError
        If mesh and image do not meet, or the file cannot be written.
    """
    with scratch_folder("page") as folder:
        pictures = draw_registration(case, Path(folder))
        write_whole(path, registration_html(case, pictures))


def registration_html(case: RegisteredCase, pictures: Sequence[Picture]) -> str:
    """Return the page, with its pictures inside."""
    far = FAR_FROM * case.noise_mm
    return (
        environment()
        .get_template("report.html")
        .render(
            title=f"Registration: {case.prediction.status}",
            tested="",
            key_numbers=_key_numbers(case),
            sections=_sections(case, {one.name: one for one in pictures}),
            footer=FOOTER,
            wins=case.prediction.status.usable,
            warning=None,
            alert=not case.prediction.status.usable,
            colours={
                place.name: FAR if place.after_mm > far else NEAR
                for place in case.places
            },
        )
    )


def _key_numbers(case: RegisteredCase) -> list[tuple[str, str, str]]:
    """Return names, values and details of what the page shows first."""
    found, bound = case.prediction, case.prediction.error_estimate_mm
    n = len(found.reasons)
    why = (
        f"{n} reason{'s' if n > 1 else ''}, below" if n else "nothing speaks against it"
    )
    numbers = [("Status", str(found.status), why)]
    if bound is not None:
        numbers.append(
            (
                "Error, at most",
                f"{mm(bound.max_mm)} mm",
                f"{mm(bound.mean_mm)} mm on average; holds in {bound.coverage:.0%}",
            )
        )
    largest = float(np.linalg.norm(case.displacement, axis=1).max())
    return [
        *numbers,
        ("Largest displacement", f"{mm(largest)} mm", ""),
        (
            "Misfit",
            f"{mm(case.misfit_mm)} mm",
            f"of points held out {mm(case.held_out_mm)} mm",
        ),
    ]


def _sections(
    case: RegisteredCase, pictures: dict[str, Picture]
) -> Iterator[tuple[str, Parts]]:
    """Yield the sections in their order."""
    found = case.prediction
    remedy = found.status.remedy_for("register")
    status: Parts = [("aside", f"{str(found.status).capitalize()}: {remedy}.")]
    if found.reasons:
        status.append(("lines", found.reasons))
    yield "Status", status
    yield "Before and after", [("picture", pictures["slices"])]
    yield (
        "How far to trust it",
        [
            ("picture", pictures["deviation"]),
            ("picture", pictures["wrong"]),
            (
                "text",
                "The error of each point is taken for Gaussian, with the covariance of "
                "the posterior, widened by what simulated shifts say of the model's "
                "own error.",
            ),
        ],
    )
    yield (
        "What was measured",
        [("picture", pictures["misfit"]), ("table", misfit_table(case))],
    )
    yield "Where the numbers come from", [("facts", _facts(case))]


def misfit_table(case: RegisteredCase) -> Table:
    """Return a row a measured place, the farthest first."""
    ordered = sorted(case.places, key=lambda place: -place.after_mm)
    shown = ordered[:MOST_ROWS]
    few = (
        f"The {len(shown)} farthest of {len(ordered)}. "
        if len(shown) < len(ordered)
        else ""
    )
    noted = any(place.note for place in shown)
    return Table(
        title="Misfit by point",
        columns=(
            "place",
            "x",
            "y",
            "z",
            "before",
            "after",
            *(["note"] if noted else []),
        ),
        rows=tuple(_row(place)[: 7 if noted else 6] for place in shown),
        note=f"{few}Position now, RAS; distance from the brain before and after "
        f"registration, mm. A red dot is more than {mm(FAR_FROM * case.noise_mm)} mm "
        "away: twice the stated noise in each coordinate.",
    )


def _row(place: MeasuredPlace) -> tuple[str, ...]:
    position = (f"{x:.1f}" for x in place.position_mm)
    return (place.name, *position, mm(place.before_mm), mm(place.after_mm), place.note)


def _facts(case: RegisteredCase) -> dict[str, str]:
    deviation = case.deviation_mm
    return {
        **case.facts,
        "mesh": f"{case.mesh.n_points} points, {len(case.mesh.cells)} tetrahedra",
        "measured places": str(len(case.places)),
        "stated noise": f"{case.noise_mm:g} mm in each coordinate",
        "standard deviation": f"{mm(float(deviation.mean()))} mm on average, "
        f"{mm(float(deviation.max()))} mm at most; above {case.wrong_mm:g} mm at "
        f"{percent(float((deviation > case.wrong_mm).mean()))} of the mesh's points",
        "time": duration(case.prediction.seconds),
    }
