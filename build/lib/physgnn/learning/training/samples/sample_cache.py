"""Samples kept on disk for as long as a run lasts: read back, not made again."""

import shutil
import tempfile
from math import prod
from pathlib import Path
from typing import Self

import torch
from torch import Tensor

Sample = tuple[int, int]
MAX_BYTES = 16 * 2**30


class SampleCache:
    """Float32 arrays of one shape by path and level, in a file without a name.

    On disk rather than in memory, of which a dataset's inputs would take gigabytes;
    what fits stays in the system's page cache anyway. The file is gone when the context
    ends or the process does.

    Parameters
    ----------
    folder : path
        On the disk to use.
    max_bytes : int
        Upper limit of the file; half of the free disk is another. What doesn't fit
        isn't kept.
    """

    def __init__(self, folder: str | Path, max_bytes: int = MAX_BYTES) -> None:
        self._file = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
        self._left = min(max_bytes, shutil.disk_usage(folder).free // 2)
        self._shape: tuple[int, ...] = ()
        self._place: dict[Sample, int] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def __contains__(self, sample: Sample) -> bool:
        return sample in self._place

    def get(self, sample: Sample) -> Tensor | None:
        """Return what was put there, or None."""
        if sample not in self._place:
            return None
        data = bytearray(4 * prod(self._shape))
        self._file.seek(self._place[sample] * len(data))
        if self._file.readinto(data) != len(data):
            return None
        return torch.frombuffer(data, dtype=torch.float32).view(self._shape)

    def put(self, sample: Sample, values: Tensor) -> None:
        """Keep values, of the same shape every time, if there is room."""
        self._shape = tuple(values.shape)
        n_bytes = 4 * values.numel()
        if sample in self._place or n_bytes > self._left:
            return
        self._file.seek(len(self._place) * n_bytes)
        try:
            written = self._file.write(values.contiguous().numpy().tobytes())
        except OSError:  # the disk is full: someone else needed it too
            written = 0
        if written != n_bytes:
            self._left = 0
            return
        self._left -= n_bytes
        self._place[sample] = len(self._place)
