"""Where MKL's library is: told by a record, or by the user."""

import ctypes
import os
import subprocess
import sys

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


@pytest.mark.parametrize("threads", [1, 2])
def test_a_solver_may_have_the_threads_that_the_user_allows(threads: int) -> None:
    program = """
from physgnn.mechanics.linear.mkl import all_threads, mkl_library
mkl_library().MKL_Set_Num_Threads_Local(7)  # as another solver leaves it
print(all_threads())
"""
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    environment.pop("MKL_NUM_THREADS", None)
    environment["MKL_DYNAMIC"] = "FALSE"  # more threads than cores, if need be
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert int(done.stdout) == threads
