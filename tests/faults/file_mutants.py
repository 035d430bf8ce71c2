"""Damage done to files, by chance that a seed repeats."""

import re
import time
import traceback
import warnings
from pathlib import Path

import numpy as np

from faults.file_formats import FileFormat
from physgnn.errors import InputError

NUMBER = re.compile(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?")
STRANGE = (
    *(b"-1", b"0", b"1e999", b"nan", b"-inf", b"4294967296", b"99999999999999999999"),
    *(
        b"1.5",
        b"",
        b"1_0",
        b"x",
        b"-0",
        b"2147483648",
        b"1e-320",
        b"\xff\xfe",
        b"[" * 9,
    ),
)
LONGEST_S = 10.0


def mutated(data: bytes, random: np.random.Generator) -> bytes:
    """Return a damaged copy: one to three kinds of damage."""
    for _ in range(random.integers(1, 4)):
        data = KINDS[random.integers(len(KINDS))](data, random)
    return data


def flipped(data: bytes, bit: int) -> bytes:
    """Return a copy with one bit the other way."""
    changed = bytearray(data)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def _bits(data: bytes, random: np.random.Generator) -> bytes:
    for _ in range(random.integers(1, 6)):
        if data:
            # half of them in the first bytes, where headers are
            n = len(data) if random.random() < 0.5 else min(len(data), 400)
            data = flipped(data, int(random.integers(8 * n)))
    return data


def _cut(data: bytes, random: np.random.Generator) -> bytes:
    return data[: random.integers(len(data) + 1)]


def _number(data: bytes, random: np.random.Generator) -> bytes:
    """Put something strange for a number in text."""
    found = list(NUMBER.finditer(data[:200_000]))
    if not found:
        return _word(data, random)
    start, end = found[random.integers(len(found))].span()
    return data[:start] + STRANGE[random.integers(len(STRANGE))] + data[end:]


def _word(data: bytes, random: np.random.Generator) -> bytes:
    """Put something large, negative or NaN for a binary number."""
    values = [-1, 0, 2**31 - 1, -(2**31), 2**63 - 1, float("nan"), 1e308]
    value = values[random.integers(len(values))]
    kind = "<f8" if isinstance(value, float) else "<i8"
    size = (2, 4, 8)[random.integers(3)]
    word = np.array([value]).astype(kind).tobytes()[-size:]
    at = int(random.integers(max(min(len(data), 600) - size, 1)))
    return data[:at] + word + data[at + size :]


def _twice(data: bytes, random: np.random.Generator) -> bytes:
    start, end = np.sort(random.integers(len(data) + 1, size=2))
    end = min(end, start + 2000)
    return data[:end] + data[start:end] + data[end:]


def _without(data: bytes, random: np.random.Generator) -> bytes:
    start = int(random.integers(len(data) + 1))
    return data[:start] + data[start + int(random.integers(1, 200)) :]


KINDS = (_bits, _bits, _cut, _number, _number, _word, _twice, _without)


def fault(form: FileFormat, path: Path) -> str:
    """Read a file; return what is wrong with how that went, or nothing.

    A result, which its own type has checked, and an InputError of one line that names
    the file are right.
    """
    started = time.monotonic()
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            form.read(path)
        except InputError as error:
            text = str(error)
            if "\n" in text or path.name not in text:
                return f"not one line that names the file: {text!r}"
        except BaseException:
            return traceback.format_exc()
    if warned:
        return f"warns: {warned[0].message}"
    seconds = time.monotonic() - started
    return f"takes {seconds:.0f} s" if seconds > LONGEST_S else ""


def faults(
    form: FileFormat, folder: Path, *, count: int, seed: int
) -> list[tuple[int, str]]:
    """Read so many mutants of a format; return number and fault of those that fail.

    The mutant of a number is always the same, and is left in `folder` if it fails.
    """
    path = folder / form.name
    form.make(path)
    whole = path.read_bytes()
    assert not fault(form, path), fault(form, path)
    found = []
    for i in range(count):
        random = np.random.default_rng([seed, i])
        path.write_bytes(mutated(whole, random))
        wrong = fault(form, path)
        if wrong:
            path.with_name(f"fault-{seed}-{i}-{form.name}").write_bytes(
                path.read_bytes()
            )
            found.append((i, wrong))
    return found
