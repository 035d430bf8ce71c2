"""Digests, and the manifest that keeps them."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.io.integrity.digest import Manifest, digest_of, digest_of_file

REMEDY = "make it again"


def test_a_mapping_counts_in_canonical_form() -> None:
    one, other = {"a": 1, "b": [2.5, "µ"]}, {"b": [2.5, "µ"], "a": 1}
    assert digest_of(one) == digest_of(other) != digest_of({"a": 2, "b": [2.5, "µ"]})


def test_an_array_counts_with_shape_type_and_values() -> None:
    values = np.arange(6.0)
    digests = {
        digest_of(array)
        for array in (
            values,
            values.reshape(2, 3),
            values.astype(np.float32),
            values + 1,
        )
    }
    assert len(digests) == 4
    assert digest_of(values[::2]) == digest_of(values[::2].copy())


def test_a_file_has_the_digest_of_its_bytes(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"abc")
    assert digest_of_file(tmp_path / "file") == hashlib.sha256(b"abc").hexdigest()
    with pytest.raises(InputError, match="cannot read"):
        digest_of_file(tmp_path / "none")


def test_a_part_is_what_it_was_or_will_be_while_it_is_replaced() -> None:
    before = Manifest().with_parts({"weights": "1", "record": "2"})
    during = before.with_either({"weights": "3", "bounds": "4"})
    after = during.with_parts({"weights": "3"})
    for manifest, allowed in ((before, "1"), (during, "13"), (after, "3")):
        for digest in "123":
            if digest in allowed:
                manifest.check("weights", digest, "here", REMEDY)
            else:
                with pytest.raises(InputError, match=r"weights.*make it again"):
                    manifest.check("weights", digest, "here", REMEDY)
    with pytest.raises(InputError, match="bounds does not belong"):
        after.without("bounds").check("bounds", "4", "here", REMEDY)


def test_it_is_read_as_written(tmp_path: Path) -> None:
    file = tmp_path / "manifest.json"
    assert Manifest.read(file, REMEDY) is None
    manifest = Manifest().with_parts({"a": "1", "b": "2"}).with_either({"b": "3"})
    manifest.write(file)
    assert Manifest.read(file, REMEDY) == manifest


def _with(file: Path, **changes: object) -> None:
    file.write_text(json.dumps({**json.loads(file.read_text()), **changes}))


def test_a_changed_manifest_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "manifest.json"
    manifest = Manifest().with_parts({"a": "1", "b": "2"})
    for changes, said in (
        ({"parts": {"a": ["1"], "b": ["3"]}}, "do not give its root"),
        ({"parts": {"a": ["1"]}}, "do not give its root"),
        ({"parts": 3}, "damaged"),
        ({"version": 9}, "of format physgnn-manifest 9"),
    ):
        manifest.write(file)
        _with(file, **changes)
        with pytest.raises(InputError, match=said):
            Manifest.read(file, REMEDY)
    for text in (b"", b"[1", b"[]", b"\xff\xfe", b"[" * 100_000):
        file.write_bytes(text)
        with pytest.raises(InputError, match="make it again"):
            Manifest.read(file, REMEDY)
