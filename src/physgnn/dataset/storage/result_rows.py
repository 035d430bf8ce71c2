"""What a store keeps of a solved load path: one row in each of these arrays."""

from typing import Any

import numpy as np

from physgnn.io.digest import digest_of
from physgnn.mechanics.equilibrium.solution import Solution, Status

MESSAGE_BYTES = 256


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


def encoded(solution: Solution) -> dict[str, Any]:
    """Return a solution's row of every array, in the order of writing."""
    displacement = solution.displacement.astype(np.float32)
    status = solution.status.astype(np.int8)
    message = solution.message.encode()[:MESSAGE_BYTES]
    message = message.decode(errors="ignore").encode()  # no half character
    digest = bytes.fromhex(digest_of(displacement, status))
    row: dict[str, Any] = {
        "displacement": displacement,
        "residual": solution.residual,
        "seconds": solution.seconds,
        "reached": solution.reached,
        "message": np.frombuffer(message.ljust(MESSAGE_BYTES, b"\0"), "u1"),
        "digest": np.frombuffer(digest, "u1"),
        "status": status,
    }
    return {name: row[name] for name in result_arrays(*displacement.shape[:2])}
