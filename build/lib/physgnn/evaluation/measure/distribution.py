"""Distribution of many errors, in constant memory.

Mean, standard deviation, largest and the fraction within 1 mm are exact; quantiles come
from a histogram with logarithmic bins 0.25 % wide, from 10⁻⁶ to 10⁴ mm.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

SMALLEST_MM = 1e-6  # what is smaller counts as zero in quantiles
LARGEST_MM = 1e4
RESOLUTION = 0.0025
N_BINS = int(np.ceil(np.log(LARGEST_MM / SMALLEST_MM) / np.log1p(RESOLUTION)))
BIN_EDGES_MM = SMALLEST_MM * (1 + RESOLUTION) ** np.arange(N_BINS + 1)
MERGED_BINS = 48  # how many bins make one of `histogram`
HISTOGRAM_EDGES_MM = tuple(BIN_EDGES_MM[::MERGED_BINS].tolist())


@dataclass(frozen=True)
class Distribution:
    """Absolute errors over nodes and samples, mm (`within_1mm`: a fraction)."""

    mean: float
    std: float
    median: float
    percentile_95: float
    percentile_99: float
    largest: float
    within_1mm: float


class RunningDistribution:
    """Takes errors in batches, gives their `Distribution`."""

    def __init__(self) -> None:
        self.count = 0
        self.counts = np.zeros(N_BINS + 1, dtype=np.int64)  # bin 0: counts as zero
        self._sum = self._sum_of_squares = self._largest = 0.0
        self._within = 0

    def add(self, errors: ArrayLike) -> None:
        """Take a batch of non-negative errors in mm, any shape."""
        values = np.asarray(errors, dtype=np.float64).ravel()
        if values.size == 0:
            return
        self.count += values.size
        self._sum += float(values.sum())
        self._sum_of_squares += float(values @ values)
        self._largest = max(self._largest, float(values.max()))
        self._within += int((values <= 1.0).sum())
        scaled = np.log(np.maximum(values, SMALLEST_MM / 2) / SMALLEST_MM)
        bins = np.floor(scaled / np.log1p(RESOLUTION)).astype(np.int64) + 1
        self.counts += np.bincount(bins.clip(0, N_BINS), minlength=N_BINS + 1)

    def quantile(self, probability: float) -> float:
        """Return a quantile, mm, to within `RESOLUTION`."""
        cumulated = np.cumsum(self.counts)
        rank = probability * self.count
        bin_ = int(np.searchsorted(cumulated, rank))
        if bin_ == 0:
            return 0.0
        inside = (rank - cumulated[bin_ - 1]) / self.counts[bin_]
        value = BIN_EDGES_MM[bin_ - 1] * (1 + RESOLUTION) ** inside
        return float(min(value, self._largest))

    def histogram(self) -> tuple[int, ...]:
        """Return the count that is zero, then one count a step of 13 %.

        The steps are those of `HISTOGRAM_EDGES_MM`; what lies above them all is in the
        last.
        """
        last = len(HISTOGRAM_EDGES_MM) - 1
        merged = np.zeros(last + 1, dtype=np.int64)
        step = np.minimum(1 + np.arange(N_BINS) // MERGED_BINS, last)
        np.add.at(merged, step, self.counts[1:])
        merged[0] = self.counts[0]
        return tuple(merged.tolist())

    def summary(self) -> Distribution | None:
        """Return the summary, or None if nothing was added."""
        if self.count == 0:
            return None
        mean = self._sum / self.count
        variance = max(self._sum_of_squares / self.count - mean**2, 0.0)
        return Distribution(
            mean=mean,
            std=float(np.sqrt(variance)),
            median=self.quantile(0.5),
            percentile_95=self.quantile(0.95),
            percentile_99=self.quantile(0.99),
            largest=self._largest,
            within_1mm=self._within / self.count,
        )
