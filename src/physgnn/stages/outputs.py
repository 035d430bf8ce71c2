"""What a stage may write, and where: asked of all alike, before any work.

A stage says which of its arguments name what it writes. Every other argument that may
be a path is read: no output may be one of these, or lie among the files of one.
"""

import inspect
import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from physgnn.errors import InputError

P = ParamSpec("P")
R = TypeVar("R")
Paths = Mapping[str, tuple[Path, ...]]
# A series in a folder of DICOM is read as FOLDER/UID, which is no file.
UID = re.compile(r"\d+(\.\d+)+")


@dataclass(frozen=True)
class Output:
    """What an argument that names an output may name.

    Attributes
    ----------
    suffixes : tuple of str
        How the names of its files end; by default the stage itself says.
    is_folder : bool
        Whether it is a folder, which may be there already, or is made.
    folder_with : str
        An argument with which it is a folder instead of a file.
    like : str
        The argument that is the image or plan whose format a name without suffix gets.
    may_be_labels : bool
        Whether it can be a label map, which alone some formats hold.
    of_plans : bool
        Whether there is one where that argument is a plan; if not, the stage says so.
    beside : str
        The output beside which its file goes where it is not named: by the same name,
        but for the suffix.
    inside : tuple of str
        Arguments that are read, in whose folders it may lie nevertheless: whoever reads
        them minds no further files.
    """

    suffixes: tuple[str, ...] = ()
    is_folder: bool = False
    folder_with: str = ""
    like: str = ""
    may_be_labels: bool = True
    of_plans: bool = True
    beside: str = ""
    inside: tuple[str, ...] = ()


FILE, FOLDER = Output(), Output(is_folder=True)


def writes(**outputs: Output) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return a decorator for a stage that writes what these arguments name.

    The stage raises InputError before any work if an output cannot be written where it
    is to be, or would be written over what is read.
    """

    def decorate(stage: Callable[P, R]) -> Callable[P, R]:
        signature = inspect.signature(stage)
        paths = [
            name
            for name, parameter in signature.parameters.items()
            if "Path" in str(parameter.annotation)
        ]

        @wraps(stage)
        def checked(*args: P.args, **options: P.kwargs) -> R:
            bound = signature.bind(*args, **options)
            bound.apply_defaults()
            given = {name: _all(bound.arguments[name]) for name in paths}
            check_outputs(given, outputs)
            return stage(*args, **options)

        checked.__dict__["outputs"] = outputs
        return checked

    return decorate


def check_outputs(given: Paths, outputs: Mapping[str, Output]) -> None:
    """Raise InputError unless outputs can be written, and apart from what is read.

    Links are followed, so that a file cannot be named in two ways.

    Parameters
    ----------
    given : mapping of str to paths
        What each argument names.
    outputs : mapping of str to Output
        The arguments that name what is written.
    """
    read = [
        (name, _read_at(path))
        for name, paths in given.items()
        if name not in outputs
        for path in paths
    ]
    taken: dict[str, str] = {}
    for name, output in outputs.items():
        for path in _named(given, name, outputs):
            option = f"--{name.replace('_', '-')}"
            _check_apart(option, path, read, output)
            if given.get(output.folder_with):
                _check_folder(option, path)
            else:
                _check_kind(option, path, output)
            # names that differ in case alone are one file on some systems
            place = str(path.resolve()).casefold()
            if place in taken:
                raise InputError(
                    f"{option} {path} would be written over {taken[place]}, the same "
                    "file: name another"
                )
            taken[place] = option


def _all(value: Any) -> tuple[Path, ...]:
    """Return the paths of an argument that is one, several or none."""
    if value is None:
        return ()
    several = isinstance(value, list | tuple)
    return tuple(Path(one) for one in (value if several else [value]))


def beside(path: Path, suffix: str) -> Path:
    """Return the place of a file beside another, by its name but for the suffix."""
    from physgnn.io.medical.images.formats import suffix_of

    length = len(path.name) - len(suffix_of(path))
    return path.with_name(path.name[:length] + suffix)


def _read_at(path: Path) -> Path:
    """Return what there is to be read where a path names a series in a folder."""
    is_series = not path.exists() and UID.fullmatch(path.name)
    return path.parent if is_series and path.parent.is_dir() else path


def _named(given: Paths, name: str, outputs: Mapping[str, Output]) -> Iterator[Path]:
    """Yield the places of an output, with the suffixes that they get."""
    from physgnn.io.medical.images.formats import WRITTEN, named_like, suffix_of
    from physgnn.io.plans.formats import plan_named_like, plan_suffix

    output = outputs[name]
    if output.beside and not given[name]:
        for path in _named(given, output.beside, outputs):
            yield beside(path, output.suffixes[0])
    for path in given[name]:
        if not output.like:
            yield path
            continue
        (like,) = given[output.like]
        if plan_suffix(like):
            yield plan_named_like(path, like) if output.of_plans else path
            continue
        if not (like.is_dir() or suffix_of(like)):
            yield path  # neither plan nor image: the stage says what it takes
            continue
        named = named_like(path, like, labels=output.may_be_labels)
        _check_suffix("an image", named, WRITTEN, named.name.lower())
        yield named


def _check_apart(
    option: str, path: Path, read: list[tuple[str, Path]], output: Output
) -> None:
    """Raise InputError if a path is one that is read, or lies in such a folder."""
    parents = path.resolve().parents
    for name, source in read:
        said = name.replace("_", " ")
        if path.exists() and source.exists() and path.samefile(source):
            raise InputError(
                f"{option} {path} would be written over {said}, the same file: name "
                "another"
            )
        inside = source.is_dir() and source.resolve() in parents
        if inside and name not in output.inside:
            raise InputError(
                f"{option} {path} would be written among the files of {said}, "
                f"{source}, which are read: name a place outside of that folder"
            )


def _check_kind(option: str, path: Path, output: Output) -> None:
    """Raise InputError unless a file or folder can be made here, of a known kind."""
    if output.is_folder:
        _check_folder(option, path)
        return
    if output.suffixes:
        _check_suffix(option, path, output.suffixes, path.name)
    if path.is_dir():
        raise InputError(f"{option} must be a file (got {path}, a folder): name a file")
    if path.exists() and not path.is_file():
        raise InputError(f"{option} must be a file (got {path}, a device): name a file")
    if not path.parent.is_dir():
        what = "is a file" if path.parent.exists() else "is not there"
        raise InputError(
            f"cannot write {path}: the folder {path.parent} {what}: make it, or name "
            "another"
        )
    _check_writable(path.parent, f"cannot write {path}")


def _check_suffix(what: str, path: Path, suffixes: tuple[str, ...], name: str) -> None:
    if not name.endswith(suffixes):
        raise InputError(
            f"{path}: {what} is written as {' or '.join(suffixes)} (got '{path.name}')"
        )


def _check_folder(option: str, path: Path) -> None:
    there = next(one for one in (path, *path.absolute().parents) if one.exists())
    if not there.is_dir():
        raise InputError(
            f"{option} must be a folder (got {path}, but {there} is a file): name "
            "another folder"
        )
    _check_writable(there, f"cannot make files in {path}")


def _check_writable(folder: Path, what: str) -> None:
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(
            f"{what}: the folder {folder} may not be written to: name another, or ask "
            "for the right to write there"
        )
