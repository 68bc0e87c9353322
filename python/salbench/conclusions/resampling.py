# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws over the units of inference, by the bootstrap [efron1993] and by sign flips: a matrix of draws times
a matrix of scores.

One set of draws serves every column of a table, so that means, differences and ranks of models are compared
within the same draw. The product is exact, hence identical for any library, order and number of threads:
scores are rounded to a grid on which sums fit into the 53 bits of a double.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from salbench.conclusions.parallel import MOST_THREADS, mapped
from salbench.conclusions.samples import TAIL, means
from salbench.conclusions.units import Floats

Draws = NDArray[np.integer[Any]]

RESAMPLES = 10_000
# Resamples and units per block: they fit into a core's cache, which helps libraries that do not block. Signs
# of 64 rows fill whole words.
_ROWS = _UNITS = 128
_MOST_KEPT = 50_000_000  # counts to keep, one byte each

# With fewer units, all of them lie on one side of a mean more often than in one of twenty samples, and so do
# all resamples; and none of 16 sign flips is rarer than one in twenty.
FEWEST = 6


class Bootstrap:
    """Resamples of units with replacement, which depend only on the seed and the number of units.

    Draws come in blocks of rows, each multiplied before the next one is drawn: all draws of 20 000 units
    would take 200 MB.
    """

    def __init__(self, seed: int, resamples: int = RESAMPLES, threads: int | None = None) -> None:
        """threads: for multiplication; by default one per core."""
        self._seed, self._resamples, self._threads = seed, resamples, threads
        self._kept: dict[int, list[Draws]] = {}

    def counts(self, n: int) -> Iterable[Draws]:
        """Yields how often each of n units is drawn: blocks of resamples x n. Small ones are kept, since many
        tables use them."""
        if self._resamples * n > _MOST_KEPT:
            return self._drawn(n)
        if n not in self._kept:
            while len(self._kept) > 3:
                del self._kept[next(iter(self._kept))]
            self._kept[n] = list(self._drawn(n))
        return self._kept[n]

    def signs(self, n: int) -> Iterable[Draws]:
        """Yields +1 or -1 for each of n units in blocks of draws x n. For few units, all patterns up to the
        overall sign, each once. The first draw is the sample itself, all +1."""
        draws = min(self._resamples, 2 ** (n - 1))
        words = np.random.PCG64([self._seed, n, 1])
        for first in range(0, draws, _ROWS):
            rows = min(_ROWS, draws - first)
            if 2 ** (n - 1) <= self._resamples:
                flipped = ((np.arange(first, first + rows)[:, None] >> np.arange(n)) & 1).astype(np.int8)
            else:
                bits = words.random_raw(-(-rows * n // 64)).astype("<u8").view(np.uint8)
                flipped = np.unpackbits(bits, count=rows * n).reshape(rows, n).astype(np.int8)
                if first == 0:
                    flipped[0] = 0
            yield 1 - 2 * flipped

    def sums_of_signs(self, n: int) -> Floats:
        """Sum of the n signs in each draw."""
        return np.concatenate([block.sum(axis=1, dtype=float) for block in self.signs(n)])

    def _drawn(self, n: int) -> Iterator[NDArray[np.uint8]]:
        """Raw draws of PCG64, which no release of NumPy may change. n is far below 2^32, so taking the upper
        32 bits times n is biased by at most n / 2^32."""
        generator = np.random.PCG64([self._seed, n])
        block = max(1, min(_ROWS, 1_000_000 // n))
        for first in range(0, self._resamples, block):
            rows = min(block, self._resamples - first)
            units = ((generator.random_raw(rows * n) >> np.uint64(32)) * np.uint64(n)) >> np.uint64(32)
            cells = units.astype(np.intp).reshape(rows, n) + n * np.arange(rows)[:, None]
            counted = np.bincount(cells.ravel(), minlength=rows * n).reshape(rows, n)
            yield counted.astype(np.uint8)  # a count beyond 255 is practically impossible

    def means(self, values: Floats) -> Floats:
        """Means of the columns of units x columns over each resample: resamples x columns.

        Equal columns have equal means, and the mean of a constant column is its value.
        """
        return self.means_of_each([values])[0]

    def means_of_each(self, samples: Sequence[Floats]) -> list[Floats]:
        """`means` of several samples. Samples of fewer than two units have no resamples."""
        sums = self._sums_of_each(self.counts, [values - values[:1] for values in samples], 2)
        return [own / len(values) + values[0] if len(own) else own for own, values in zip(sums, samples)]

    def flipped_of_each(self, samples: Sequence[Floats]) -> list[Floats]:
        """Sums of the columns, on the grid, with the signs of each draw: draws x columns; none for fewer than
        six units."""
        return self._sums_of_each(self.signs, samples, FEWEST)

    def _sums_of_each(
        self, draws: Callable[[int], Iterable[Draws]], samples: Sequence[Floats], fewest: int
    ) -> list[Floats]:
        """Sums of each sample. Samples with the same number of units share one product, which is much
        faster."""
        sums: list[Floats] = [np.empty((0, values.shape[1])) for values in samples]
        for n in sorted({len(values) for values in samples if len(values) >= fewest and values.size}):
            places = [place for place, values in enumerate(samples) if len(values) == n and values.size]
            drawn = self._product(draws(n), np.hstack([on_grid(samples[place]) for place in places]))
            ends = np.cumsum([samples[place].shape[1] for place in places])
            for place, own in zip(places, np.split(drawn, ends[:-1], axis=1)):
                sums[place] = own
        return sums

    def _product(self, draws: Iterable[Draws], values: Floats) -> Floats:
        """Sums of the columns over each draw."""

        def multiply(block: Draws) -> Floats:
            sums = np.zeros((len(block), values.shape[1]))
            for unit in range(0, len(values), _UNITS):
                units = slice(unit, unit + _UNITS)
                sums += block[:, units].astype(float) @ values[units]
            return sums

        blocks, sums = iter(draws), list[Floats]()
        while some := list(islice(blocks, 2 * MOST_THREADS)):
            sums += mapped(multiply, some, self._threads)
        return np.concatenate(sums)


def on_grid(values: Floats) -> Floats:
    """Rounds to multiples of a power of two, such that n times the largest value is below 2^53 multiples: to
    2^-40 of the largest value for 4 800 units. Values whose squares would underflow become 0. Columns that
    differ only by rounding, such as scores summed in another order, become equal."""
    _, exponent = np.frexp(np.abs(values).max() * len(values))
    step = np.ldexp(1.0, max(int(exponent) - 53, -500))
    rounded: Floats = np.rint(values / step) * step
    return rounded


def bca_interval(sample: Floats, resampled: Floats) -> tuple[float, float]:
    """95 % interval for the mean of a sample from its resampled means, bias-corrected and accelerated
    [efron1987].

    NaN for fewer than two values, or for equal ones.
    """
    if len(sample) < 2 or np.ptp(sample) == 0:
        return np.nan, np.nan
    # coarser than the grid: a resampled mean may equal the sample's mean
    mean, rounding = means(sample), 1e-10 * np.ptp(sample)
    # ties count one half
    below = ((resampled < mean - rounding).mean() + (resampled <= mean + rounding).mean()) / 2
    if below <= 0 or below >= 1:
        return np.nan, np.nan
    away = sample - mean
    bias, acceleration = special.ndtri(below), (away**3).sum() / (6 * (away**2).sum() ** 1.5)
    z = bias + special.ndtri([TAIL, 1 - TAIL])
    low, high = np.quantile(resampled, special.ndtr(bias + z / (1 - acceleration * z)))
    return float(low), float(high)


def percentile_interval(values: Floats, n: int) -> tuple[float, float]:
    """95 % interval for any function of the means of n units, from its values in their resamples.

    Percentiles are taken at levels that reproduce Student's interval for the mean of normal values
    [hesterberg2015]. Ends are among the values, which may be infinite. NaN for too few units, for NaN values,
    or for equal finite values.
    """
    if n < FEWEST or len(values) == 0 or np.isnan(values).any():
        return np.nan, np.nan
    z = np.sqrt(n / (n - 1)) * special.stdtrit(n - 1, 1 - TAIL)
    place = int(special.ndtr(-z) * (len(values) - 1))
    ends = np.partition(values, [place, len(values) - 1 - place])
    low, high = float(ends[place]), float(ends[len(values) - 1 - place])
    return (np.nan, np.nan) if low == high and np.isfinite(low) else (low, high)
