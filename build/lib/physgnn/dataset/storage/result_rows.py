"""What a store keeps of a solved load path: one row in each of these arrays."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.io.integrity.digest import digest_of
from physgnn.mechanics.equilibrium.solution import Solution, Status

ResultRow = Mapping[str, Any]
MESSAGE_BYTES = 256
CONTENT = ("displacement", "status")
"""What a path's digest covers: the same whoever solved it."""
SEALED = ("digest", "residual", "seconds", "reached", "message")
"""What its seal covers, beside the store and the path's number."""


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
        "seal": ((32,), "uint8", 0),
        "status": ((n_levels,), "int8", int(Status.NOT_SOLVED)),
    }


def path_identity(definition_hash: str, i: int) -> str:
    """Return what tells load path `i` of a store from all others."""
    return f"{definition_hash} path {i}"


def digest_row(row: ResultRow) -> NDArray[np.uint8]:
    """Return the SHA-256 of what was found for a path, (32,)."""
    return _as_row(digest_of(*(row[name] for name in CONTENT)))


def seal_row(row: ResultRow, identity: str) -> NDArray[np.uint8]:
    """Return the SHA-256 of all rows of a path and of its place, (32,).

    Rows that changed places, or came from another store, do not have it.

    Parameters
    ----------
    row : mapping
        The row of every array, the digest among them.
    identity : str
        See `path_identity`.
    """
    return _as_row(digest_of(identity, *(row[name] for name in SEALED)))


def encoded(solution: Solution, identity: str) -> ResultRow:
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
    row["digest"] = digest_row(row)
    row["seal"] = seal_row(row, identity)
    return {name: row[name] for name in arrays}


def _as_row(digest: str) -> NDArray[np.uint8]:
    return np.frombuffer(bytes.fromhex(digest), "u1")
