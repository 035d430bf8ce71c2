"""What a module of 3D Slicer is described by.

Names and rules are those of the Slicer Execution Model, after the schema
ctkCmdLineModule.xsd of CTK.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from physgnn.progress import Log, Progress

RETURNED = 1000  # the schema's index for what is no argument but a result


@dataclass(frozen=True)
class Parameter:
    """One line of a form.

    Attributes
    ----------
    tag : str
        Its kind: image, pointfile, geometry, transform, file, directory, double, …
    name : str
        Of the flag; also the stage's argument unless the module says otherwise.
    label, description : str
        For people.
    default : str
        What the form begins with.
    is_output : bool
        Whether the module writes it.
    extensions : tuple of str
        Of files; Slicer writes its temporary files with the first.
    elements : tuple of str
        Of an enumeration.
    attributes : mapping
        More of the tag, such as ``type="label"``.
    is_advanced : bool
        Whether the form hides it at first.
    """

    tag: str
    name: str
    label: str
    description: str
    default: str = ""
    is_output: bool = False
    extensions: tuple[str, ...] = ()
    elements: tuple[str, ...] = ()
    attributes: Mapping[str, str] | None = None
    is_advanced: bool = False

    @property
    def flag(self) -> str:
        """The option that Slicer passes it by."""
        return f"--{self.name}"

    def value(self, text: str) -> Any:
        """Return what Slicer passed as a stage takes it."""
        if self.tag == "boolean":
            return text in ("true", "1")
        return KINDS.get(self.tag, str)(text)


KINDS: Mapping[str, Callable[[str], Any]] = {
    "double": float,
    "integer": int,
    "double-vector": lambda text: [float(part) for part in text.split(",")],
}


@dataclass(frozen=True)
class ReturnedValue:
    """A line of the file of return parameters; Slicer shows it in the form.

    Attributes
    ----------
    name, label : str
    """

    name: str
    label: str


@dataclass(frozen=True)
class Job:
    """What a module is asked to do.

    Attributes
    ----------
    values : mapping
        Parameter → value; those that were not given are left out.
    log : callable
        Called with a line on what was found.
    progress : callable
        Called with parts done, parts in all, and what comes next.
    """

    values: Mapping[str, Any]
    log: Log
    progress: Progress


@dataclass(frozen=True)
class Module:
    """A module: a row of the table.

    Attributes
    ----------
    name : str
        Of the executable; on Linux and macOS Slicer wants no dot in it.
    command : str
        The stage; the module is there if the stage is.
    title, description : str
        For people.
    parameters : tuple of Parameter
    results : tuple of ReturnedValue
    run : callable
        Does a job and returns the values of `results`.
    """

    name: str
    command: str
    title: str
    description: str
    parameters: tuple[Parameter, ...]
    results: tuple[ReturnedValue, ...]
    run: Callable[[Job], Mapping[str, Any]]

    @property
    def outputs(self) -> tuple[Parameter, ...]:
        """What it may be asked to write."""
        return tuple(p for p in self.parameters if p.is_output)
