"""Where node, playwright-core and Chromium are, for tests that drive a real browser.

Set PHYSGNN_PLAYWRIGHT to the folder of playwright-core (``npm install playwright-core``
anywhere; the folder is node_modules/playwright-core), PHYSGNN_CHROMIUM if Chromium is
not on the path. With PHYSGNN_REQUIRE_BROWSER, as in .ci/run, it is an error if they
are missing.
"""

import os
import shutil
from pathlib import Path

import pytest


def browser_tools() -> tuple[str, str, str]:
    node = shutil.which("node")
    chromium = os.environ.get("PHYSGNN_CHROMIUM") or shutil.which("chromium")
    playwright = os.environ.get("PHYSGNN_PLAYWRIGHT", "")
    for name, there in (
        ("node", node),
        ("chromium", chromium),
        ("playwright-core (set PHYSGNN_PLAYWRIGHT)", Path(playwright, "index.mjs")),
    ):
        if there is None or not Path(there).exists():
            says = f"no {name} on this machine: tests/browser.py says how to get it"
            if os.environ.get("PHYSGNN_REQUIRE_BROWSER"):
                pytest.fail(says)
            pytest.skip(says)
    return str(node), playwright, str(chromium)
