"""What a store keeps of a solved load path: one row in each of these arrays."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.io.digest import digest_of
from physgnn.mechanics.equilibrium.solution import Solution, Status

MESSAGE_BYTES = 256
COVERED = ("displacement", "residual", "reached", "message", "status")
OLD_COVERED = ("displacement", "status")
"""What a path's digest covers, now and in stores of version 1."""


def result_arrays(
    n_levels: int, n_points: int
) -> dict[str, tuple[tuple[int, ...], str, float]]:
    """Return row shape, type and fill value of every array that has a row a path.

    The order is the order of writing: a path counts as done once its status row is
    there, so a run killed before that leaves the path pending.
    """
    return {
        "displacement": ((n_levels, n_points, 3), "float32", np.nan),
        "residual": ((n_levels,), "float32", np.nan),
        "seconds": ((), "float64", np.nan),
        "reached": ((), "float64", np.nan),
        "message": ((MESSAGE_BYTES,), "uint8", 0),
        "digest": ((32,), "uint8", 0),
        "status": ((n_levels,), "int8", int(Status.NOT_SOLVED)),
    }


def path_identity(definition_hash: str, i: int) -> str:
    """Return what tells load path `i` of a store from all others."""
    return f"{definition_hash} path {i}"


def row_digest(row: Mapping[str, Any], identity: str | None) -> NDArray[np.uint8]:
    """Return the SHA-256 of a path's rows, (32,) uint8; times do not count.

    Parameters
    ----------
    row : mapping
        The row of every array.
    identity : str or None
        See `path_identity`: rows that changed places are noticed by it. None for
        stores made before there was one: they have the digest of displacement and
        status alone.
    """
    parts = [row[name] for name in (OLD_COVERED if identity is None else COVERED)]
    digest = digest_of(*parts) if identity is None else digest_of(identity, *parts)
    return np.frombuffer(bytes.fromhex(digest), "u1")


def encoded(solution: Solution, identity: str | None) -> dict[str, Any]:
    """Return a solution's row of every array, in the order of writing."""
    message = solution.message.encode()[:MESSAGE_BYTES]
    message = message.decode(errors="ignore").encode()  # no half character
    values: dict[str, Any] = {
        "displacement": solution.displacement,
        "residual": solution.residual,
        "seconds": solution.seconds,
        "reached": solution.reached,
        "message": np.frombuffer(message.ljust(MESSAGE_BYTES, b"\0"), "u1"),
        "status": solution.status,
    }
    arrays = result_arrays(*solution.displacement.shape[:2])
    row = {k: np.asarray(v, dtype=arrays[k][1]) for k, v in values.items()}
    row["digest"] = row_digest(row, identity)
    return {name: row[name] for name in arrays}
