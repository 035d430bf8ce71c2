"""A module as the XML that 3D Slicer makes a form of."""

from collections.abc import Iterable
from importlib.metadata import version
from xml.etree import ElementTree as ET

from physgnn.stages.slicer_modules.parameters import (
    RETURNED,
    Module,
    Parameter,
    ReturnedValue,
)

CATEGORY = "PhysGNN"
NOTICE = "For research; not a medical device."


def xml_of(module: Module) -> str:
    """Return a module's description, UTF-8 text."""
    root = ET.Element("executable")
    for tag, text in (
        ("category", CATEGORY),
        ("title", module.title),
        ("description", f"{module.description} {NOTICE}"),
        ("version", version("physgnn")),
        ("license", "BSD-3-Clause"),
        ("contributor", "The physgnn developers"),
    ):
        ET.SubElement(root, tag).text = text
    first = [p for p in module.parameters if not p.is_advanced and not p.is_output]
    later = [p for p in module.parameters if p.is_advanced]
    shown = [p for p in module.parameters if p.is_output and not p.is_advanced]
    _group(root, "Input", "What is given.", first)
    _group(root, "Output", "What is made.", shown, module.results)
    if later:
        _group(root, "More", "What need not be given.", later).set("advanced", "true")
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'


def _group(
    root: ET.Element,
    label: str,
    description: str,
    parameters: Iterable[Parameter],
    results: Iterable[ReturnedValue] = (),
) -> ET.Element:
    group = ET.SubElement(root, "parameters")
    ET.SubElement(group, "label").text = label
    ET.SubElement(group, "description").text = description
    for parameter in parameters:
        _parameter(group, parameter)
    for result in results:
        _result(group, result)
    return group


def _parameter(group: ET.Element, parameter: Parameter) -> None:
    made = ET.SubElement(group, parameter.tag, dict(parameter.attributes or {}))
    if parameter.extensions:
        made.set("fileExtensions", ",".join(parameter.extensions))
    ET.SubElement(made, "name").text = parameter.name
    ET.SubElement(made, "longflag").text = parameter.flag
    ET.SubElement(made, "label").text = parameter.label
    ET.SubElement(made, "description").text = parameter.description
    if parameter.default:
        ET.SubElement(made, "default").text = parameter.default
    if parameter.is_output or parameter.extensions or parameter.tag == "directory":
        channel = "output" if parameter.is_output else "input"
        ET.SubElement(made, "channel").text = channel
    for element in parameter.elements:
        ET.SubElement(made, "element").text = str(element)


def _result(group: ET.Element, result: ReturnedValue) -> None:
    made = ET.SubElement(group, "string")
    ET.SubElement(made, "name").text = result.name
    ET.SubElement(made, "label").text = result.label
    ET.SubElement(made, "description").text = f"{result.label}."
    ET.SubElement(made, "default").text = "-"
    ET.SubElement(made, "channel").text = "output"
    ET.SubElement(made, "index").text = str(RETURNED)
