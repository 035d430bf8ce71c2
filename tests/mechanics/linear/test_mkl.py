"""Where MKL's library is: told by a record, or by the user."""

import ctypes

import pytest

from physgnn.mechanics.linear import mkl

pytestmark = pytest.mark.skipif(mkl.mkl_library() is None, reason="needs MKL")


def test_the_record_leads_to_the_library_that_a_search_finds() -> None:
    place = mkl._installed()
    if place is None:
        pytest.skip("MKL was not installed by pip")
    found = mkl._found()
    assert found is not None
    assert ctypes.CDLL(place)._handle == ctypes.CDLL(found)._handle


def test_a_place_that_the_user_names_comes_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    named = mkl._installed() or mkl._found()
    assert named is not None
    monkeypatch.setenv(mkl.NAMED, named)
    assert mkl._installed() is None
    assert mkl._found() == named


def test_without_a_record_the_search_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mkl, "files", lambda _: None)
    assert mkl._installed() is None
