"""The map names every folder, and no folder or module is too full."""

import re
from pathlib import Path

import physgnn

SOURCE = Path(physgnn.__file__).parent
CONTRIBUTING = Path(__file__).parents[2] / "CONTRIBUTING.md"
MOST_MODULES, MOST_LINES = 12, 300


def folders_on_the_map() -> list[str]:
    text = CONTRIBUTING.read_text("utf-8").split("## Map of the rooms")[1]
    lines = text.split("```text")[1].split("```")[0].splitlines()
    found: list[str] = []
    above: list[str] = []
    for line in lines:
        if named := re.match(r"((?:  )*)(\w+)/ ", line):
            above = [*above[: len(named[1]) // 2], named[2]]
            found.append("/".join(above))
    return found


def test_every_folder_is_on_the_map_once() -> None:
    folders = {
        file.parent.relative_to(SOURCE).as_posix()
        for file in SOURCE.rglob("__init__.py")
    }
    found = folders_on_the_map()
    assert sorted(found) == sorted(folders - {"."})


def modules_of(folder: Path) -> list[Path]:
    """The modules in a folder; its face, ``__init__.py``, only hands names on."""
    return [
        file
        for file in folder.iterdir()
        if file.suffix in (".py", ".js") and file.name != "__init__.py"
    ]


def folders_of_ours() -> list[Path]:
    """The package's folders, the page's among them, but for what others wrote."""
    every = [SOURCE, *(path for path in SOURCE.rglob("*") if path.is_dir())]
    return [path for path in every if not {"vendor", "__pycache__"} & set(path.parts)]


def test_a_folder_has_at_most_a_dozen_modules() -> None:
    full = {
        folder.relative_to(SOURCE).as_posix(): n
        for folder in folders_of_ours()
        if (n := len(modules_of(folder))) > MOST_MODULES
    }
    assert not full, f"give these folders rooms: {full}"


def test_a_module_has_at_most_300_lines() -> None:
    long = {
        file.relative_to(SOURCE).as_posix(): n
        for folder in folders_of_ours()
        for file in modules_of(folder)
        if (n := len(file.read_text("utf-8").splitlines())) > MOST_LINES
    }
    assert not long, f"split these modules by ideas: {long}"
