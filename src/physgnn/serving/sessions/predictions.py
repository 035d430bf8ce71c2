"""From a message of the page to the frames sent back."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.regions import TUMOUR, region_name
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.serving.protocol.frames import encode
from physgnn.serving.protocol.messages import MAX_RADIUS_MM, PatchLoad
from physgnn.serving.protocol.patient_messages import (
    MAX_FILE_BYTES,
    MAX_TOTAL_BYTES,
    MOST_FILES,
    RADIUS_MM,
)
from physgnn.serving.scene.colours import FIELDS, SolvedLoad
from physgnn.serving.scene.patch_load import Exposed, spread_force
from physgnn.serving.scene.section import AXES, Section
from physgnn.serving.sessions.engine import Engine


def load_case(engine: Engine, message: PatchLoad) -> LoadCase:
    """Return the nodal forces a patch load means."""
    point, force = np.array(message.point), np.array(message.force_n)
    return spread_force(engine.viewed.exposed, point, force, message.radius_mm)


def scene_frame(engine: Engine) -> bytes:
    """Return everything the page draws that does not depend on a load."""
    viewed, shown = engine.viewed, engine.shown
    exposed = viewed.exposed
    on_surface = np.isin(shown.nodes, exposed.nodes)
    nodes = _tumour_nodes(engine)
    tumour = None if nodes is None else viewed.body.mesh.points[nodes]
    header = {
        "kind": "scene",
        "title": viewed.title,
        "predictors": list(viewed.predictors),
        "fields": {
            name: row.describe(viewed)
            for name, row in FIELDS.items()
            if engine.desk is not None or not row.registered
        },
        "patient": _patient(engine),
        "coverage": viewed.calibration.coverage if viewed.calibration else None,
        "n_points": viewed.body.mesh.n_points,
        "n_cells": viewed.body.mesh.n_cells,
        "image": engine.image is not None,
        "normal": exposed.normals.mean(axis=0).tolist(),
        "tumour_centre": None if tumour is None else tumour.mean(axis=0).tolist(),
        **_limits(engine),
    }
    arrays: dict[str, NDArray[Any]] = {
        "points": viewed.body.mesh.points[shown.nodes],
        "exposed": on_surface.astype(np.uint8),
        **{f"faces:{name}": faces for name, faces in shown.faces.items()},
    }
    return encode(header, arrays)


def prediction_frame(
    engine: Engine, message: PatchLoad, solved: SolvedLoad, section: Section | None
) -> bytes:
    """Return one predictor's displacement under a patch load, at the points drawn."""
    header = {
        "kind": "prediction",
        "id": message.id,
        **described(engine, message.field, solved),
        "loaded_nodes": 0 if solved.case is None else len(solved.case.nodes),
    }
    return encode(header, drawn_arrays(engine, message.field, solved, section))


def described(engine: Engine, field: str, solved: SolvedLoad) -> dict[str, Any]:
    """Return what the page says of a displacement."""
    prediction = solved.prediction
    length = np.linalg.norm(prediction.displacement, axis=1)
    estimate, status = prediction.error_estimate_mm, prediction.status
    return {
        "predictor": solved.by,
        "field": field,
        "status": str(status),
        "usable": status.usable,
        "remedy": status.remedy,
        "reasons": list(prediction.reasons),
        "error": None
        if estimate is None
        else {
            "mean_mm": estimate.mean_mm,
            "max_mm": estimate.max_mm,
            "coverage": estimate.coverage,
        },
        "seconds": prediction.seconds,
        "largest_mm": float(length.max()),
        "tumour_mm": _tumour_shift(engine, prediction.displacement),
    }


def drawn_arrays(
    engine: Engine, field: str, solved: SolvedLoad, section: Section | None
) -> dict[str, NDArray[Any]]:
    """Return a displacement and a scalar at the points drawn."""
    displacement = solved.prediction.displacement
    arrays: dict[str, NDArray[Any]] = {"displacement": displacement[engine.shown.nodes]}
    if section is not None:
        arrays["section_displacement"] = section.at(displacement)
    measure = FIELDS[field].measure
    values = None if measure is None else measure(engine.viewed, solved)
    if values is not None:
        arrays["field"] = values[engine.shown.nodes]
        if section is not None:
            arrays["section_field"] = section.at(values)
    return arrays


def section_frame(engine: Engine, axis: str, offset_mm: float, made: Section) -> bytes:
    """Return a section at rest, and the image on it if there is one."""
    points = engine.viewed.body.mesh.points
    arrays: dict[str, NDArray[Any]] = {"points": made.at(points), "faces": made.faces}
    arrays["region"] = made.region
    low, high = points.min(axis=0), points.max(axis=0)
    if engine.image is not None:
        arrays["image"] = engine.image.slice(axis, offset_mm, low, high)
    header = {
        "kind": "section",
        "axis": AXES[axis],
        "offset_mm": offset_mm,
        "low": low.tolist(),
        "high": high.tolist(),
    }
    return encode(header, arrays)


def _patient(engine: Engine) -> dict[str, Any] | None:
    """Return what can be done for the patient on show."""
    desk = engine.desk
    if desk is None:
        return None
    return {
        "note": desk.note,
        "saves": desk.saves,
        "adapts": desk.adapts,
        "roles": dict(desk.roles),
        "suffixes": list(desk.suffixes),
        "menus": {
            name: {
                "title": menu.title,
                "values": dict(menu.values),
                "roles": list(menu.roles),
            }
            for name, menu in desk.menus.items()
        },
        "radius_mm": RADIUS_MM,
        "most_bytes": MAX_FILE_BYTES,
        "most_files": MOST_FILES,
        "most_total_bytes": MAX_TOTAL_BYTES,
    }


def _tumour_shift(engine: Engine, displacement: FloatArray) -> float | None:
    """Return the mean displacement of the tumour's surface, as a length, mm."""
    nodes = _tumour_nodes(engine)
    if nodes is None:
        return None
    return float(np.linalg.norm(displacement[nodes].mean(axis=0)))


def _tumour_nodes(engine: Engine) -> IntArray | None:
    faces = engine.shown.faces.get(region_name(TUMOUR))
    return None if faces is None else engine.shown.nodes[np.unique(faces)]


def _limits(engine: Engine) -> dict[str, float]:
    """Return where the page's sliders start and end."""
    viewed, exposed = engine.viewed, engine.viewed.exposed
    usual = len(exposed.nodes) // 4
    if viewed.calibration is not None:
        usual = max(usual, viewed.calibration.trained_range.fewest_nodes)
    radius, force = _radius_of(exposed, usual), viewed.usual_force_n
    return {
        "force_n": force / 3,
        "max_force_n": 1.25 * force,
        "radius_mm": radius,
        "max_radius_mm": min(2 * radius, MAX_RADIUS_MM),
    }


def _radius_of(exposed: Exposed, n_nodes: int) -> float:
    """Return the radius that holds so many nodes about the middle of the surface."""
    centre = exposed.points.mean(axis=0)
    middle = exposed.points[np.linalg.norm(exposed.points - centre, axis=1).argmin()]
    distance = np.sort(np.linalg.norm(exposed.points - middle, axis=1))
    reach = distance[min(max(n_nodes, 1), len(distance)) - 1]
    return float(np.ceil(1.1 * max(reach, 3.0)))
