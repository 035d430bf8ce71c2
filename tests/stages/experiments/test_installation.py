"""The self-test passes here, and notices what is wrong."""

import numpy as np
import pytest

from physgnn.stages import selftest
from physgnn.stages.experiments import installation
from physgnn.stages.experiments.installation import Check


@pytest.mark.slow
def test_this_installation_passes() -> None:
    told = []
    checks = selftest(progress=lambda *at: told.append(at[:2]))
    assert told == [(i, len(installation.CHECKS)) for i in range(len(told))]
    assert [check.name for check in checks if not check.passed] == []
    assert len(checks) == 6


def test_another_law_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    right = installation._neo_hookean
    monkeypatch.setattr(installation, "_neo_hookean", lambda F: 1.001 * right(F))
    (check,) = installation.CHECKS["a closed form"]()
    assert not check.passed


@pytest.mark.parametrize(("found", "passed"), [(0.1, True), (0.3, False)])
def test_a_check_passes_within_its_limit(found: float, passed: bool) -> None:
    assert Check("a", found, 0.2, "mm").passed == passed
    assert not Check("a", np.nan, 0.2, "mm").passed
    assert not Check("a", found, np.nan, "mm").passed
