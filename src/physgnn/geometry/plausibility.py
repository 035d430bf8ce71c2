"""Whether a body can be in millimetres, and whether it can be a brain.

Files say little about their units. A body in metres or in centimetres is a mesh like
any other, and its displacements are wrong by the cube of the factor. Every reader of
bodies and of measured points asks here.
"""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError

# The diagonal of a bounding box, mm: a small lesion to a large head, with room.
# Outside of it the file is in other units.
SMALLEST_DIAGONAL, LARGEST_DIAGONAL = 1.0, 2000.0
# Beyond it single precision, which headers and many meshes have, rounds to 0.01 mm.
FARTHEST_MM = 1e5
# Volumes in ml. Outside of POSSIBLE no human brain lies, the smallest newborn's and a
# large adult's with room; outside of USUAL no healthy adult's.
POSSIBLE_ML = (50.0, 2500.0)
USUAL_ML = (600.0, 2200.0)
UNITS = {"metres": 1000.0, "centimetres": 10.0, "inches": 25.4, "micrometres": 0.001}
"""Units that coordinates come in by mistake, and how many mm one is."""
# Measured points are taken for another unit if in it they lie this many times nearer
# to the body.
TIMES_NEARER = 3.0
LEAST_EXTENT, MOST_EXTENT = 0.02, 3.0  # of theirs, in parts of the body's


def check_millimetres(points: FloatArray, what: str) -> None:
    """Check that coordinates can be in mm, by their bounding box.

    Parameters
    ----------
    points : (n_points, 3) array
        What should be in mm.
    what : str
        What messages call it, such as ``"brain"`` or a path.

    Raises
    ------
    InputError
        If they are not finite, lie 100 m from the origin, or the diagonal is below 1
        or above 2000.
    """
    if not np.isfinite(points).all():
        raise InputError(f"{what}: coordinates must be finite (got NaN or infinity)")
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    farthest = float(np.abs(points).max())
    if farthest > FARTHEST_MM and diagonal <= LARGEST_DIAGONAL:
        raise InputError(
            f"{what}: coordinates must be at most {FARTHEST_MM:.0f} mm from the origin "
            f"(got {farthest:.3g}, where files round them): move it to the origin"
        )
    if SMALLEST_DIAGONAL <= diagonal <= LARGEST_DIAGONAL:
        return
    too_small = diagonal < SMALLEST_DIAGONAL
    unit, factor = ("metres", "1000") if too_small else ("micrometres", "0.001")
    raise InputError(
        f"{what}: coordinates must be in mm (its bounding box has a diagonal of "
        f"{diagonal:.3g}, which looks like {unit}): multiply them by {factor}"
    )


def check_volume_ml(
    volume_mm3: float, what: str, *, any_size: bool = False
) -> list[str]:
    """Check that a volume can be a brain's, and warn if it is unusual.

    Parameters
    ----------
    volume_mm3 : float
        What should be a brain, mm³.
    what : str
        What messages call it, such as ``"brain"`` or a path.
    any_size : bool
        Whether the user has said that the size is meant: a size that would be refused
        is then only warned of.

    Returns
    -------
    list of str
        A warning if the volume is unusual for an adult's brain, else nothing.

    Raises
    ------
    InputError
        If the volume lies outside 50–2500 ml. The message names the unit in which
        it would be a brain.
    """
    ml = volume_mm3 / 1000.0
    if _within(ml, USUAL_ML):
        return []
    low, high = USUAL_ML
    unusual = f"{what}: {ml:.4g} ml, where a brain has {low:.0f} to {high:.0f} ml"
    if any_size or _within(ml, POSSIBLE_ML):
        return [f"{unusual}: check that it is the whole brain, in mm"]
    low, high = POSSIBLE_ML
    for unit, mm in UNITS.items():
        if _within(ml * mm**3, USUAL_ML):
            raise InputError(
                f"{what}: a brain must have {low:.0f} to {high:.0f} ml (this has "
                f"{ml:.4g} ml; its coordinates look like {unit}): multiply them by "
                f"{mm:g}, or pass --any-size (any_size=True) if it is no brain"
            )
    looks = "a part of it or a phantom" if ml < low else "the head or the whole image"
    raise InputError(
        f"{what}: a brain must have {low:.0f} to {high:.0f} ml (this has {ml:.4g} ml, "
        f"which looks like {looks}): give the whole brain in mm, or pass --any-size "
        "(any_size=True) if it is meant"
    )


def other_unit(volume_mm3: float, what: str) -> list[str]:
    """Return a line if a body is as large as a brain in another unit than mm.

    It is no more than a warning: a cube of 1 cm is a body, too.

    Parameters
    ----------
    volume_mm3 : float
        Of the body, if its coordinates are in mm.
    what : str
        What messages call it, such as a path.
    """
    ml = volume_mm3 / 1000.0
    return [
        f"{what}: it has {ml:.3g} ml, and that of a brain if its coordinates are in "
        f"{unit}: if they are, multiply them by {mm:g}"
        for unit, mm in UNITS.items()
        if _within(ml * mm**3, USUAL_ML)
    ]


def check_same_units(points: FloatArray, body: FloatArray, what: str) -> None:
    """Check that measured points are in the unit of the body they were measured on.

    Points in another unit lie far from the body, and near to it once multiplied, with
    an extent that can be measured on it: what shrinks to a point fits anywhere.

    Parameters
    ----------
    points : (n, 3) array
        Measured points, which should be in mm.
    body : (n_points, 3) array
        Points of the body, mm: those of its boundary for a measured surface, all of
        them for landmarks inside of it.
    what : str
        What messages call the measured points.

    Raises
    ------
    InputError
        If they fit the body three times better in metres, centimetres, inches or
        micrometres.
    """
    from scipy.spatial import KDTree

    tree = KDTree(body)

    def distance(factor: float) -> float:
        return float(np.median(tree.query(points * factor)[0]))

    as_is = distance(1.0)
    far = {unit: distance(mm) for unit, mm in units_by_extent(points, body).items()}
    unit = min(far, key=far.__getitem__, default="mm")
    if unit in far and far[unit] * TIMES_NEARER < as_is:
        raise InputError(
            f"{what}: measured points must be in mm, in the place of the body (they "
            f"lie {as_is:.3g} mm from it, and {far[unit]:.3g} mm if they are in "
            f"{unit}): multiply them by {UNITS[unit]:g}"
        )


def units_by_extent(points: FloatArray, body: FloatArray) -> dict[str, float]:
    """Return units in which points have an extent that can be measured on a body.

    Parameters
    ----------
    points : (n, 3) array
        Measured points, which should be in mm.
    body : (n_points, 3) array
        Points of the body, mm.

    Returns
    -------
    dict
        Rows of `UNITS`: unit → how many mm one is.
    """
    extent, whole = (float(np.linalg.norm(np.ptp(x, axis=0))) for x in (points, body))
    limits = LEAST_EXTENT * whole, MOST_EXTENT * whole
    return {unit: mm for unit, mm in UNITS.items() if _within(extent * mm, limits)}


def _within(value: float, limits: tuple[float, float]) -> bool:
    return limits[0] <= value <= limits[1]
