"""Pages that can be read: short, in lines that fit, without what has no reader."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

from documented_pages import DOCS, FENCE, PAGES, ROOT, name_of

LINE, WORDS, FIGURE_KB = 120, 900, 300
ABLE_TO_BE_LONG = ("results",)
# private words, and words of a diary; the field's stand in CONTRIBUTING.md
UNWANTED = re.compile(
    r"\b(asked for|was asked|tried and|trials whose|wanted:|certified|anchor tree|"
    r"settling|known states|load share|way back|mended)\b|@[A-Z]+@"
)
IDS = [name_of(page) for page in PAGES]


def words(text: str) -> int:
    """Count what is read: prose and tables, not code."""
    return len(re.findall(r"\w[\w'-]*", FENCE.sub("", text)))


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_lines_fit(page: Path) -> None:
    for number, line in enumerate(page.read_text("utf-8").splitlines(), 1):
        row = line.lstrip().startswith("|")  # a table's row cannot be broken
        assert row or len(line) <= LINE, f"line {number} has {len(line)} characters"


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_one_idea_a_page(page: Path) -> None:
    long = page.parent.name in ABLE_TO_BE_LONG or page.parent == ROOT
    count = words(page.read_text("utf-8"))
    assert long or count <= WORDS, f"{count} words"


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_it_has_one_title_and_no_diary(page: Path) -> None:
    prose = FENCE.sub("", page.read_text("utf-8"))
    assert len(re.findall(r"^# ", prose, re.MULTILINE)) == 1
    if page.name != "CONTRIBUTING.md":  # it lists the words to avoid
        assert UNWANTED.search(prose) is None


def test_every_explanation_has_a_figure() -> None:
    for page in (DOCS / "explanation").glob("[!i]*.md"):
        assert re.search(r"!\[[^\]]+\]\(", page.read_text("utf-8")), page.name


def test_figures_are_small_and_used() -> None:
    text = "".join(page.read_text("utf-8") for page in PAGES)
    for figure in (DOCS / "images").iterdir():
        assert figure.stat().st_size < 1000 * FIGURE_KB, figure.name
        assert f"images/{figure.name}" in text, f"no page shows {figure.name}"


@pytest.mark.skipif(shutil.which("node") is None, reason="needs node")
def test_equations_can_be_typeset() -> None:
    found = []
    for page in DOCS.rglob("*.md"):
        prose = re.sub(r"`[^`\n]*`", "", FENCE.sub("", page.read_text("utf-8")))
        found += re.findall(r"\$\$(.+?)\$\$", prose, re.DOTALL)
        rest = re.sub(r"\$\$.+?\$\$", "", prose, flags=re.DOTALL)
        found += re.findall(r"\$([^$]+)\$", rest)
    assert len(found) > 50
    program = (
        f"const katex = require({json.dumps(str(DOCS / 'assets/katex/katex.min.js'))});"
        f"for (const text of {json.dumps(found)})"
        "  katex.renderToString(text, {throwOnError: true, strict: 'error'});"
    )
    subprocess.run(["node"], input=program, text=True, check=True)


def test_the_site_asks_no_other_server() -> None:
    text = (ROOT / "mkdocs.yml").read_text("utf-8")
    assert yaml.safe_load(text)["theme"]["font"] is False
    assert "https://" not in text
