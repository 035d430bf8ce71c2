"""The site as it is built: without a warning, and searched without a server."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from browser import browser_tools
from documented_pages import ROOT

WORDS = {  # a word, and a page that has it
    "locking": "glossary.html",
    "boundary_faces": "reference/api/",
    "--tolerance-mm": "reference/commands.html",
}
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    build = [sys.executable, "-m", "properdocs", "build", "--strict"]
    done = subprocess.run(
        [*build, "--config-file", "mkdocs.yml", "--site-dir", str(folder)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert "WARNING" not in done.stderr + done.stdout
    return folder


@pytest.mark.parametrize("word", WORDS)
def test_the_index_holds_it(site: Path, word: str) -> None:
    index = json.loads((site / "search/search_index.json").read_text("utf-8"))
    found = [
        page["location"]
        for page in index["docs"]
        if word in page["title"] + page["text"]
    ]
    assert any(place.startswith(WORDS[word]) for place in found), found


def test_the_index_is_there_for_a_site_opened_from_a_folder(site: Path) -> None:
    script = (site / "search/search_index.js").read_text("utf-8")
    start = "var __index = "
    assert script.startswith(start)
    assert json.loads(script.removeprefix(start))["docs"]
    assert "assets/iframe-worker/" in (site / "index.html").read_text("utf-8")


def test_search_finds_a_word_without_a_server(site: Path) -> None:
    node, playwright, chromium = browser_tools()
    script = Path(__file__).with_name("search.mjs")
    done = subprocess.run(
        [node, str(script), playwright, chromium, str(site), "locking"],
        capture_output=True,
        text=True,
        timeout=180,
    )
    assert done.returncode == 0, done.stderr
    saw = json.loads(done.stdout)
    assert any("elements.html" in place for place in saw["found"])
    assert saw["errors"] == [] and saw["elsewhere"] == []
