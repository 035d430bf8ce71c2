"""Which release of a package is installed, for records of where numbers come from."""


def release(package: str) -> str:
    """Return the release of an installed package, without the mark of its build.

    PyTorch from PyPI calls itself 2.13.0 in its metadata and 2.13.0+cu130 when it is
    imported, and its CPU build is 2.13.0+cpu. All are release 2.13.0.

    Parameters
    ----------
    package : str
        The name of its distribution.

    Returns
    -------
    str
        Such as ``"2.13.0"``.

    Raises
    ------
    importlib.metadata.PackageNotFoundError
        If it is not installed.
    """
    from importlib.metadata import version  # takes longer than any help

    return version(package).partition("+")[0]
