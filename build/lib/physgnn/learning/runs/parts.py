"""The files of a run folder that predictions depend on, written and read with digests.

Whenever the process ends, every file that the manifest lists is as the manifest says:

1. the new files are written beside their places;
2. the manifest is written with the digests they have and those they will have;
3. the new files take their places, in the order given;
4. files that belonged to what was replaced are removed;
5. the manifest is written with the digests they have now.
"""

import logging
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from functools import cache
from pathlib import Path

from physgnn.errors import InputError
from physgnn.io.integrity.atomic import whole_file, write_whole
from physgnn.io.integrity.digest import Manifest, digest_of_file, without_digest
from physgnn.learning.runs.folder import RunFolder

Writer = Callable[[Path], object]

REMEDY = "bring the run back from a copy, or train it again"


def read_manifest(run: Path) -> Manifest | None:
    """Return a run's manifest; None if there is none.

    Raises
    ------
    InputError
        If it is not as it was written.
    """
    return Manifest.read(RunFolder(run).manifest, REMEDY)


def write_parts(run: Path, parts: Mapping[Path, Writer], *drop: Path) -> None:
    """Replace files of a run folder, and list them in its manifest.

    Parameters
    ----------
    run : path
        The folder, which is there.
    parts : mapping
        From a file to what writes it, given the path to write to. The files take their
        places in this order.
    *drop : path
        Files that are removed, since they belong to what is replaced.
    """
    manifest, path = read_manifest(run) or Manifest(), RunFolder(run).manifest
    there = {
        file.name: digest_of_file(file)
        for file in parts
        if file.name not in manifest.parts and file.is_file()
    }
    gone = [file.name for file in drop]
    with ExitStack() as places:
        news = {}
        for file, write in reversed(
            [*parts.items()]
        ):  # the last entered is the first out
            beside = places.enter_context(whole_file(file))
            write(beside)
            news[file.name] = digest_of_file(beside)
        manifest.with_parts(there).with_either(news).write(path)
    for file in drop:
        file.unlink(missing_ok=True)
    manifest.with_parts(news).without(*gone).write(path)


def write_part(file: Path, text: str) -> None:
    """Write a text file of a run folder, whole or not at all.

    It is listed in the folder's manifest if there is one; a run that was made without
    gets none, since its other files cannot be vouched for.
    """
    if RunFolder(file.parent).manifest.is_file():
        write_parts(file.parent, {file: lambda part: part.write_text(text, "utf-8")})
    else:
        write_whole(file, text)


def check_part(file: Path) -> None:
    """Raise InputError if a file of a run folder is not as its manifest says.

    Without a manifest nothing is checked: `note_missing` tells the user.
    """
    manifest = read_manifest(file.parent)
    if manifest is not None:
        manifest.check(file.name, digest_of_file(file), file.parent, REMEDY)


def note_missing(run: Path) -> None:
    """Log, once a folder, that a run was made before there were digests."""
    if not RunFolder(run).manifest.is_file():
        _note(run.resolve())


@cache
def _note(run: Path) -> None:
    logging.getLogger(__name__).warning(without_digest(run))


def check_there(run: Path, *files: Path) -> None:
    """Raise InputError unless all these files of a run folder are there."""
    missing = [file.name for file in files if not file.is_file()]
    if missing:
        raise InputError(f"{run} is no finished run: it has no {', '.join(missing)}")
