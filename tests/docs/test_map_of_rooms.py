"""The map in CONTRIBUTING.md names every folder of the package, in its place."""

import re
from pathlib import Path

import physgnn

SOURCE = Path(physgnn.__file__).parent
CONTRIBUTING = Path(__file__).parents[2] / "CONTRIBUTING.md"


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
