"""What a module of 3D Slicer runs: ``python -m physgnn.cli.slicer_launcher NAME …``.

Slicer asks for the description by ``--xml``, passes a flag for each parameter, follows
the progress by tags on standard output, and reads what a module found from the file of
``--returnparameterfile``. It drops all results of a module that does not exit with 0:
so whatever a displacement's status, once it is written the code is 0, and the status is
among the results.
"""

import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

from physgnn.cli.console import say
from physgnn.cli.door import command
from physgnn.errors import InputError

if TYPE_CHECKING:
    from physgnn.stages.slicer_modules.parameters import Module

FAILED = "failed"
RESULTS = "--returnparameterfile"


def run() -> int:
    """Run the module that the first argument names with the others.

    Raises
    ------
    InputError
        If there is no such module, or it cannot do what is asked.
    """
    from physgnn.stages.slicer_modules.description import xml_of
    from physgnn.stages.slicer_modules.module_table import modules

    name, *arguments = sys.argv[1:] or [""]
    there = {module.name: module for module in modules()}
    if name not in there:
        raise InputError(f"no module '{name}' (there are: {', '.join(there)})")
    module = there[name]
    if "--xml" in arguments:
        print(xml_of(module), end="")
        return 0
    given = _given(module, arguments)
    results_file = given.pop(RESULTS, None)
    try:
        results = _done(module, _values(module, given))
    except InputError as error:
        _write_results(results_file, {"status": f"{FAILED}: {error}"})
        raise
    _write_results(results_file, results)
    for label, value in results.items():
        say(f"{label}: {value}")
    return 0


def _done(module: "Module", values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Do what a module does, with its progress in Slicer's tags."""
    from physgnn.stages.slicer_modules.parameters import Job

    start = time.perf_counter()
    _tags(f"<filter-start>{_about(module, '')}</filter-start>")
    _progress(0, 1, module.title)
    results = module.run(Job(values, say, _progress))
    _progress(1, 1, "")
    seconds = f"<filter-time>{time.perf_counter() - start:.1f}</filter-time>"
    name = f"<filter-name>{escape(module.title)}</filter-name>"
    _tags(f"<filter-end>{name}{seconds}</filter-end>")
    return results


def _about(module: "Module", comment: str) -> str:
    return (
        f"<filter-name>{escape(module.title)}</filter-name>"
        f"<filter-comment>{escape(comment or module.description)}</filter-comment>"
    )


def _progress(done: int, total: int, text: str) -> None:
    if text:
        _tags(f"<filter-comment>{escape(text)}</filter-comment>")
    _tags(f"<filter-progress>{done / max(total, 1):.3f}</filter-progress>")


def _tags(text: str) -> None:
    print(text, flush=True)


def _given(module: "Module", words: Sequence[str]) -> dict[str, str]:
    """Return what follows each flag.

    A value may begin with a dash, as a force to the left does, which argparse would
    take for another flag.

    Raises
    ------
    InputError
        If a flag is unknown, or has no value.
    """
    switches = {p.flag for p in module.parameters if p.tag == "boolean"}
    flags = {RESULTS, *(p.flag for p in module.parameters)}
    given, left = {}, list(words)
    while left:
        flag, equals, value = left.pop(0).partition("=")
        if flag not in flags:
            known = ", ".join(sorted(flags))
            raise InputError(f"{module.name} has no {flag} (there are: {known})")
        if flag in switches:
            value = value or "true"
        elif not equals:
            if not left:
                raise InputError(f"{module.name}: nothing follows {flag}")
            value = left.pop(0)
        given[flag] = value
    return given


def _values(module: "Module", given: Mapping[str, str]) -> dict[str, Any]:
    """Return what was given, as the stages take it; what is empty is not given."""
    values: dict[str, Any] = {}
    for parameter in module.parameters:
        text = given.get(parameter.flag, parameter.default).strip()
        if not text:
            continue
        if parameter.elements and text not in parameter.elements:
            known = ", ".join(parameter.elements)
            raise InputError(f"{parameter.flag} must be one of {known} (got '{text}')")
        try:
            values[parameter.name] = parameter.value(text)
        except ValueError as error:
            raise InputError(
                f"{parameter.flag} must be {parameter.tag} (got '{text}')"
            ) from error
    return values


def _write_results(file: str | None, results: Mapping[str, Any]) -> None:
    """Write return parameters, a line each: ``name = value``."""
    if file is None:
        return
    from physgnn.io.integrity.atomic import write_whole

    lines = [f"{k} = {' '.join(str(value).split())}\n" for k, value in results.items()]
    write_whole(Path(file), "".join(lines))


if __name__ == "__main__":
    command("physgnn.cli.slicer_launcher")
