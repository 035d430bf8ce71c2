"""One table describes the modules: what 3D Slicer reads and what stages take agree."""

import inspect
import io
import logging
import xml.etree.ElementTree as ET

import pytest
from ctk_cli import CLIModule

from physgnn import stages
from physgnn.stages.slicer_modules.description import xml_of
from physgnn.stages.slicer_modules.module_table import ROWS, modules
from physgnn.stages.slicer_modules.parameters import Module, Parameter

TRANSLATED = {
    "PhysGNNMesh": {"craniotomy", "radius_mm", "mesh", "surfaces"},
    "PhysGNNRegister": {"shift", "transform", "surfaces"},
    "PhysGNNWarp": {"deformed", "transform"},
    "PhysGNNPredict": {"points", "force_n", "shift", "transform", "surfaces"},
}
THERE = pytest.mark.parametrize("module", modules(), ids=lambda module: module.name)


def test_a_module_is_there_if_its_stage_is(monkeypatch: pytest.MonkeyPatch) -> None:
    commands = {module.command for module in modules()}
    assert commands >= {"mesh", "register", "warp", "predict"}
    assert ("segment" in commands) == ("segment" in stages.__all__)
    monkeypatch.setattr(stages, "__all__", ["segment"])
    assert [module.name for module in modules()] == ["PhysGNNSegment"]
    assert len({row.name for row in ROWS}) == len(ROWS)
    assert all("." not in row.name for row in ROWS)  # or Slicer would not run it


@THERE
def test_parameters_are_arguments_of_the_stage(module: Module) -> None:
    if module.name not in TRANSLATED:
        pytest.skip("its job translates all")
    told = inspect.signature(getattr(stages, module.command)).parameters
    names = {parameter.name for parameter in module.parameters}
    assert len(names) == len(module.parameters)
    assert names - TRANSLATED[module.name] <= set(told)
    for parameter in module.parameters:
        if parameter.name in told and parameter.name not in TRANSLATED[module.name]:
            default = told[parameter.name].default
            if default not in (None, inspect.Parameter.empty, (), False):
                assert parameter.default == str(default), parameter.name


@THERE
def test_ctk_reads_the_description(
    module: Module, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        read = CLIModule(stream=io.StringIO(xml_of(module)))
    assert caplog.messages == []
    assert read.title == module.title
    arguments, options, results = read.classifyParameters()
    assert arguments == []
    assert [option.longflag for option in options if option.typ != "boolean"]
    assert {option.name for option in options} == {p.name for p in module.parameters}
    assert [result.name for result in results] == [r.name for r in module.results]
    by_name = {option.name: option for option in options}
    for parameter in module.parameters:
        option = by_name[parameter.name]
        assert option.typ == parameter.tag
        assert option.longflag == parameter.flag
        if parameter.extensions:
            assert option.fileExtensions == [*parameter.extensions]
            assert option.channel == ("output" if parameter.is_output else "input")
        if parameter.elements:
            assert option.default in option.elements


@THERE
def test_what_is_text_stays_text(module: Module) -> None:
    odd = Parameter("string", "odd", "<b> & 'c'", 'less < more "x"')
    changed = Module(
        module.name,
        module.command,
        "A & B",
        "x < y",
        (*module.parameters, odd),
        module.results,
        module.run,
    )
    root = ET.fromstring(xml_of(changed).split("\n", 1)[1])
    assert root.findtext("title") == "A & B"
    assert "<b> & 'c'" in [label.text for label in root.iter("label")]
