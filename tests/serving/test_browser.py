"""The page in a real browser: tests/browser.py says what that needs.

PHYSGNN_VIEW_RUN names a trained run to show instead of the block; empty means the
bundled model.
"""

import asyncio
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from live_server import serving

from browser import browser_tools
from physgnn.io import read_load_case
from physgnn.serving.protocol.messages import PatchLoad
from physgnn.serving.scene.colours import FIELDS, TISSUE, ColourField
from physgnn.serving.scene.viewed import Viewed, view
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.predictions import load_case

LEAST_RATE = 20  # predictions drawn a second, while dragging
MOST_MS = 100.0  # of the processor for one: two cores then draw as many
ADDED = ColourField(
    label="Upward",
    title="Displacement along +z, mm",
    stops=("#2a5fa8", TISSUE, "#a8323a"),
    least=1.0,
    measure=lambda _, solved: solved.prediction.displacement[:, 2],
    diverging=True,
)


@pytest.fixture(scope="module")
def shown(viewed: Viewed) -> Viewed:
    run = os.environ.get("PHYSGNN_VIEW_RUN")
    return viewed if run is None else view(run or None)


@pytest.fixture(scope="module")
def saw(shown: Viewed, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the browser saw; browse.mjs says what it did."""
    node, playwright, chromium = browser_tools()
    script = Path(__file__).with_name("browse.mjs")
    downloads = tmp_path_factory.mktemp("downloads")
    busy = "PYTEST_XDIST_WORKER" in os.environ or loaded()
    engine = Engine(shown)
    asyncio.run(engine.warm_up())
    with pytest.MonkeyPatch.context() as patch, serving(engine) as address:
        patch.setitem(FIELDS, "added", ADDED)
        url = f"{address.page}/"
        done = subprocess.run(
            [node, str(script), playwright, chromium, url, str(downloads)],
            capture_output=True,
            text=True,
            timeout=300,
        )
    assert done.returncode == 0, done.stderr
    seen: dict[str, Any] = json.loads(done.stdout)
    seen["busy"] = busy or loaded()
    print(
        f"{seen['rate']:.1f} predictions/s, {seen['latencyMs']:.0f} ms latency, "
        f"{seen['processorMs']:.0f} ms of the processor each"
    )
    return seen


def loaded() -> bool:
    """Whether more wants to run on this machine than it has cores."""
    return os.getloadavg()[0] > (os.cpu_count() or 1)


def expected(shown: Viewed, patch_load: dict[str, Any], name: str = "network") -> Any:
    engine = Engine(shown)
    case = load_case(engine, PatchLoad(**patch_load))
    engine.close()
    return shown.predictors[name](case)


def test_the_page_has_no_errors_and_asks_nobody_else(saw: dict[str, Any]) -> None:
    assert saw["errors"] == []
    assert saw["elsewhere"] == []


def test_a_drag_deforms_the_brain(saw: dict[str, Any]) -> None:
    assert saw["pictureChanged"]
    assert np.any(saw["dragged"]["displaced"])
    assert saw["dragged"]["predictions"]["network"]["largest_mm"] > 0


def test_what_is_shown_is_what_predict_answers_for_the_kept_load_case(
    saw: dict[str, Any], shown: Viewed
) -> None:
    saved = saw["saved"]
    file = saw["downloads"]["load-case.json"]
    prediction = shown.predictors["network"](read_load_case(file, shown.body.mesh))
    largest = np.linalg.norm(prediction.displacement, axis=1).max()
    estimate = prediction.error_estimate_mm
    assert saved["predictions"]["network"]["largest_mm"] == pytest.approx(
        largest, rel=1e-5
    )
    assert float(saved["largest"]) == pytest.approx(largest, abs=0.006)
    assert float(saved["error"]) == pytest.approx(estimate.max_mm, rel=0.06)
    on_page = np.array(saved["displaced"]).reshape(-1, 3)
    engine = Engine(shown)
    there = prediction.displacement[engine.shown.nodes]
    engine.close()
    np.testing.assert_allclose(on_page, there, atol=1e-4)


def test_the_page_keeps_up(saw: dict[str, Any]) -> None:
    if saw["busy"]:  # other work costs time, not the processor's
        assert saw["rate"] >= LEAST_RATE or saw["processorMs"] < MOST_MS
    else:
        assert saw["rate"] >= LEAST_RATE


def test_the_screenshot_is_a_picture(saw: dict[str, Any]) -> None:
    content = Path(saw["downloads"]["physgnn.png"]).read_bytes()
    assert content.startswith(b"\x89PNG")
    assert len(content) > 10_000


def test_finite_elements_replace_the_predict(saw: dict[str, Any]) -> None:
    solved = saw["solved"]
    prediction = solved["predictions"]["finite elements"]
    assert solved["chip"] == "solved"
    assert float(solved["largest"]) == pytest.approx(
        prediction["largest_mm"], abs=0.006
    )


def test_side_by_side_shows_all_three(saw: dict[str, Any]) -> None:
    names = [caption.splitlines()[0] for caption in saw["captions"]]
    assert names == ["Network", "Linear", "Finite elements"]


def test_the_menu_and_the_legends_are_the_rows_of_the_table(
    saw: dict[str, Any],
) -> None:
    rows = {name: row for name, row in FIELDS.items() if not row.registered}
    assert saw["menu"] == [*(row.label for row in rows.values()), ADDED.label]
    titles = {name: row.title for name, row in rows.items()}
    assert saw["legends"] == {**titles, "added": ADDED.title}


def test_keys_and_touch_patch_load_and_let_go(saw: dict[str, Any]) -> None:
    assert saw["released"]["patch_load"] is None
    assert saw["released"]["chip"] == "at rest"
    assert saw["keyboard"]["grew"]
    assert saw["keyboard"]["patch_load"] is not None
    assert saw["touched"]["patch_load"] is not None
