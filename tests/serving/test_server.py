"""What the live view refuses before it takes its time."""

import sys

import pytest

from physgnn.errors import InputError
from physgnn.serving.server import serve


def test_a_package_that_a_stream_needs_is_asked_for_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "pyigtl", None)
    said: list[str] = []
    with pytest.raises(InputError, match=r"pip install 'physgnn\[igtl\]'"):
        serve("no-such-run", port=0, igtl=0, log=said.append)
    assert said == []
