"""A release has one name, whichever build of it is installed."""

import importlib.metadata

import pytest
import torch

from physgnn.versions import release


@pytest.mark.parametrize("build", ["2.13.0", "2.13.0+cu130", "2.13.0+cpu"])
def test_the_build_is_no_part_of_it(
    build: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.metadata, "version", lambda _: build)
    assert release("torch") == "2.13.0"


def test_metadata_and_import_agree() -> None:
    assert release("torch") == torch.__version__.partition("+")[0]


def test_what_is_not_installed() -> None:
    with pytest.raises(importlib.metadata.PackageNotFoundError):
        release("no-such-package")
