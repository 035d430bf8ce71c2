"""A bound on what a dataset may take, before anything is drawn or written."""

from physgnn.errors import InputError
from physgnn.memory_limits import GB, gigabytes

VARIABLE = "PHYSGNN_DATASET_LIMIT_GB"
LIMIT_GB = 100.0
LARGEST_NUMBER = 10**300  # a file may hold integers beyond any float
# Nine small files of a path, each a block of the file system.
BYTES_BESIDE = 9 * 4096
BYTES_OF_NUMBERS = 12  # a float32 in three directions


def check_dataset_size(n_paths: int, n_levels: int, n_points: int) -> None:
    """Check that a dataset is no larger than the user can mean.

    Parameters
    ----------
    n_paths, n_levels, n_points : int
        Load paths, levels of each, points of the mesh.

    Raises
    ------
    InputError
        If it would take more than `LIMIT_GB`, or than the environment variable
        ``PHYSGNN_DATASET_LIMIT_GB`` allows.
    """
    n_bytes = n_paths * (BYTES_OF_NUMBERS * n_levels * n_points + BYTES_BESIDE)
    size = min(n_bytes, LARGEST_NUMBER) / GB
    limit = gigabytes(VARIABLE, LIMIT_GB)
    if size > limit:
        raise InputError(
            f"{n_paths} load paths of {n_levels} levels on {n_points} points would "
            f"take {size:.3g} GB on disk, and may take {limit:g} GB: ask for fewer, or "
            f"set {VARIABLE}={size * 1.01:.3g} if so many are meant"
        )
