"""Write THIRD_PARTY.md: what constraints.txt installs, with versions and licences.

    python docs/build/third_party.py

Everything comes from the metadata of the installed packages, so nothing is asked of a
server. Run it again whenever constraints.txt changes; a test compares the two.
"""

from importlib.metadata import Distribution, distribution
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "THIRD_PARTY.md"
CONSTRAINTS = ROOT / "constraints.txt"
LONGEST = 60  # what is longer is the text of a licence, not its name
OSI = "License :: OSI Approved :: "
# what metadata cannot tell: of extras not installed, and of code within a wheel
BY_HAND = {
    "crcmod": "MIT",
    "pyigtl": "MIT",
    "tetgen": "MIT; TetGen within it AGPL-3.0-or-later",
}
HEAD = """\
# Third-party packages

What `constraints.txt` installs, with the licence that each package's metadata states.
`docs/build/third_party.py` writes this list.
[Dependencies](docs/reference/dependencies.md) says what the main ones are for.

tetgen and pymeshfix are extras, which a plain `pip install physgnn` leaves out.

The repository carries three.js, KaTeX and iframe-worker, all MIT.

| package | version | licence |
|---|---|---|
"""


def pinned() -> dict[str, str]:
    """Return the version of every package in constraints.txt, by its name there."""
    lines = CONSTRAINTS.read_text("utf-8").splitlines()
    pairs = (line.split("==") for line in lines if "==" in line and line[0] != "#")
    return {name.strip(): version.strip() for name, version in pairs}


def licence(found: Distribution) -> str:
    """Return the licence that a package states: expression, classifiers or text."""
    stated = found.metadata
    expression = stated.get("License-Expression")
    if expression:
        return str(expression)
    named = (kind for kind in stated.get_all("Classifier") or () if OSI in kind)
    names = [kind.removeprefix(OSI) for kind in named]
    if names:
        return ", ".join(names)
    text = str(stated.get("License") or "").strip().splitlines()
    if len(text) == 1 and len(text[0]) <= LONGEST:
        return text[0]
    raise LookupError(f"{stated['Name']} names no licence: read it, and name it here")


def row(name: str, version: str) -> str:
    """Return the line of a package."""
    named = BY_HAND.get(name) or licence(distribution(name))
    return f"| {name} | {version} | {named} |\n"


if __name__ == "__main__":
    rows = (row(name, version) for name, version in pinned().items())
    PAGE.write_text(HEAD + "".join(rows), "utf-8")
