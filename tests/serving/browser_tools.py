"""What drives a real browser, where it is installed."""

import os
import shutil
from pathlib import Path

import pytest


def browser_tools() -> tuple[str, str, str]:
    """Return node, playwright-core and Chromium; skip or fail where one is missing."""
    node = shutil.which("node")
    chromium = os.environ.get("PHYSGNN_CHROMIUM") or shutil.which("chromium")
    playwright = os.environ.get("PHYSGNN_PLAYWRIGHT", "")
    for name, there in (
        ("node", node),
        ("chromium", chromium),
        ("playwright-core (set PHYSGNN_PLAYWRIGHT)", Path(playwright, "index.mjs")),
    ):
        if there is None or not Path(there).exists():
            says = f"no {name} on this machine: test_browser.py says how"
            if os.environ.get("PHYSGNN_REQUIRE_BROWSER"):
                pytest.fail(says)
            pytest.skip(says)
    return str(node), playwright, str(chromium)
