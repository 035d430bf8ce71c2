"""The short form of `kills`: ten at random moments, nothing lost, nothing different."""

from pathlib import Path

import pytest

from faults.kills import kill_simulate


@pytest.mark.slow
def test_ten_kills(tmp_path: Path) -> None:
    outcome = kill_simulate(10, 5, tmp_path, paths=8)
    assert outcome.faults == ()
    assert outcome.kills == 10
