"""The test whether two sets of independent images, spectra or vectors differ by more than noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.ranges import whole

Floats = NDArray[np.float64]

LEVEL = 0.01
"""The level of the test for which power and detectable changes are stated."""
FLOOR = 1e-4
"""The smallest variance within the two sets, as a share of the variance of all batches: a pixel that takes few values may have none."""
TOGETHER = 1 << 17
"""Largest number of values (labellings times pixels) that are held at a time."""


@dataclass(frozen=True, eq=False)
class TwoSample:
    """How far two sets of batches are apart. Differences are b − a."""

    p: float
    """Probability of a difference at least as large if all batches have the same distribution: a multiple of 1 / `labellings`."""
    labellings: int
    """Number of assignments of the batches to the two sets by which p was found."""
    chi2_per_dof: float
    """Mean of (A − B)² / (σ_A² + σ_B²) over values with noise, which is about 1 if only noise differs; NaN if no value has noise."""
    excess: float
    """‖A − B‖ / ‖mean of all‖ without noise: the signed root of the squared difference less its expected noise."""
    excess_squared_error: float
    """Standard error of excess·|excess|, by the jackknife: up to √2 too large where noise is above the difference."""
    change: tuple[float, float]
    """The difference along `effect` and its standard error: the relative change of everything, or the multiple of the array."""
    power: float
    """Probability that the test finds `effect` at the level 1 %. Only the test of `change` is counted, so the power is at least this."""
    detectable: float
    """The size of `change` that the test at 1 % finds nine times in ten; infinite if the batches are too few."""
    index: tuple[int, ...]
    """Where the difference is largest, in standard errors."""
    z: float
    """The difference there, in standard errors. Noise alone reaches 4 to 8 in a large image; `p` accounts for the number of values."""

    def __str__(self) -> str:
        return (
            f"p {self.p:.4f}, change {self.change[0]:.3g} ± {self.change[1]:.2g} (detectable: {self.detectable:.2g}), "
            f"χ²/dof {self.chi2_per_dof:.3f}, largest at {self.index}: z = {self.z:.1f}"
        )


def two_sample(
    a: ArrayLike, b: ArrayLike, *, effect: float | ArrayLike = 0.01, permutations: int = 999, seed: int = 1
) -> TwoSample:
    """Tests whether two sets of independent batches have the same mean, by permutations.

    Parameters
    ----------
    a, b
        Arrays [batch, ...] of the same shape without the first axis, real or complex, each of at least 4 independent batches: images of
        renders with different seeds, spectra, vectors. Real and imaginary part count as two values.
    effect
        The difference b − a for which the power is stated: a relative change of everything, or an array without the axis of batches.
    permutations
        Number of random assignments of batches to the two sets. If there are no more assignments than that, all are used.
    seed
        Seed of the assignments.

    Returns
    -------
    TwoSample
        p combines three statistics: the mean of (A − B)² / s², with the variance s² of all batches; its largest value, which finds one
        changed pixel; and Student's t of the projection on `effect`, which finds a small change of everything. p is that of the smallest
        of their p-values, by the same permutations (Westfall and Young 1993). It is exact, whatever the distribution and correlation of
        pixels, if all batches have one distribution under the null hypothesis. Sets of different noise have not, and are rejected
        too often: take as many samples for each batch of both. (`difference` has σ² of each set for s², and its p is from the law of χ²,
        which needs many batches.)

    Raises
    ------
    ValueError
        If shapes do not match, a number is not finite, a set has less than 4 batches, or an argument is out of its range.
    """
    sets = [_batches("a", a), _batches("b", b)]
    shape = sets[0].shape[1:]
    if sets[1].shape[1:] != shape:
        raise ValueError(f"a batch of a has shape {shape} and of b {sets[1].shape[1:]}; allowed: one shape")
    member = _labellings(len(sets[0]), len(sets[1]), whole("permutations", permutations, 99, 10**6), seed)
    sizes = len(sets[0]), len(sets[1])
    is_complex = any(one.dtype.kind == "c" for one in sets)
    kind = np.result_type(*sets)
    rounding = 16 * (np.finfo(kind).eps if kind.kind in "fc" else 0.0)
    rows = [_reals(one, is_complex) for one in sets]
    along = np.asarray(effect)
    kinds = "buifc" if is_complex and along.ndim else "buif"
    if along.dtype.kind not in kinds or along.shape not in ((), shape) or not np.isfinite(along).all() or not along.any():
        what = f"{along.dtype} of shape {along.shape}"
        raise ValueError(f"effect is {what}; allowed: a finite number other than 0, or numbers of shape {shape}")
    wanted = _reals(along[None], is_complex)[0] if along.ndim else None

    batches, count = len(member[0]), rows[0].shape[1]
    each = max(1, TOGETHER // len(member))
    short = member.astype(np.float32)
    sums, largest = np.zeros(len(member)), np.zeros(len(member))
    projection, length, used = np.zeros(batches), 0.0, 0
    gram, squares = np.zeros((batches, batches)), 0.0
    chi2, where, z = 0.0, 0, 0.0
    for first in range(0, count, each):
        values = np.concatenate([row[:, first : first + each] for row in rows]).astype(np.float64)
        bad = np.count_nonzero(~np.isfinite(values))
        if bad:
            raise ValueError(f"{bad} values of a and b are not finite; allowed: finite numbers")
        mean = values.mean(0)
        off = values - mean
        gram += off @ off.T
        squares += mean @ mean
        deviation = np.sqrt((off**2).sum(0) / (batches - 1))
        # Values that differ by rounding only are equal.
        noisy = np.flatnonzero(deviation > rounding * np.abs(values).max(0))
        if not noisy.size:
            continue
        scaled = off[:, noisy] / deviation[noisy]
        ahead = (mean if wanted is None else wanted[first : first + each])[noisy] / deviation[noisy]
        projection += scaled @ ahead
        # The mean itself is noisy: its square is too large by its variance, 1 / batches in these units.
        length += float(ahead @ ahead) - (noisy.size / batches if wanted is None else 0.0)
        # For sets of equal size, the square of the sum orders labellings as t² does.
        squared = short @ scaled.astype(np.float32)
        squared *= squared
        sums += squared.sum(1, dtype=np.float64)
        np.maximum(largest, squared.max(1), out=largest)
        apart, variance = (one[0] for one in _welch(member[:1], scaled, sizes))
        t2 = apart**2 / variance
        chi2 += float(t2.sum())
        used += noisy.size
        top = int(t2.argmax())
        if t2[top] > z * z:
            where, z = first + int(noisy[top]), float(apart[top] / math.sqrt(variance[top]))

    place = tuple(int(i) for i in np.unravel_index(where // 2 if is_complex else where, shape))
    excess, error = _excess(gram, squares, sizes)
    if not used:
        return TwoSample(1.0, len(member), math.nan, excess, error, (0.0, 0.0), math.nan, math.nan, place, 0.0)
    apart, variance = (one[:, 0] for one in _welch(member, projection[:, None], sizes))
    directed = apart**2 / variance
    chances = np.array([_chance(statistic) for statistic in (sums, largest, directed)])
    # The others order labellings whose smallest p is the same.
    best = chances.min(0) + 1e-6 * chances.mean(0)
    p = np.count_nonzero(best <= best[0] + 1e-12) / best.size
    # Each deviation contains the difference: E[d / sd²] is smaller by (n − 3) / (n − 1) for normal noise of n batches. Without a mean above
    # the noise there is no relative change.
    length = length * (batches - 3) / (batches - 1) if length > 0 else math.nan
    change = float(apart[0]) / length, math.sqrt(variance[0]) / length
    power, detectable = _power(best, directed, member, projection, sizes, length, float(along) if wanted is None else 1.0)
    free = batches - 2
    # The variance is estimated: t² has the mean free / (free − 2) for normal noise.
    chi2 *= (free - 2) / free / used
    return TwoSample(p, len(member), chi2, excess, error, change, power, detectable, place, z)


def _batches(name: str, values: ArrayLike) -> NDArray[Any]:
    array = np.asarray(values)
    if array.dtype.kind not in "buifc" or array.ndim == 0 or array.size == 0 or len(array) < 4:
        what = f"{array.dtype} of shape {array.shape}"
        raise ValueError(f"{name} is {what}; allowed: numbers [batch, ...] with at least 4 independent batches")
    return array


def _reals(batches: NDArray[Any], is_complex: bool) -> NDArray[Any]:
    """The batches as rows of real numbers; a complex number becomes two, next to each other."""
    rows = batches.reshape(len(batches), -1)
    if not is_complex:
        return rows
    return np.ascontiguousarray(rows, np.result_type(rows, np.complex64)).view(np.float32 if rows.dtype == np.complex64 else np.float64)


def _labellings(a: int, b: int, permutations: int, seed: int) -> Floats:
    """Assignments of batches to the first set, [labelling, batch] of 0 and 1; the first is the true one."""
    if math.comb(a + b, a) <= permutations + 1:
        chosen = np.array(list(combinations(range(a + b), a)))
    else:
        order = np.random.default_rng(seed).permuted(np.tile(np.arange(a + b), (permutations, 1)), axis=1)
        chosen = np.concatenate([np.arange(a)[None], order[:, :a]])
    member = np.zeros((len(chosen), a + b))
    np.put_along_axis(member, chosen, 1.0, axis=1)
    return member


def _welch(member: NDArray[Any], values: NDArray[Any], sizes: tuple[int, int]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Mean of b less mean of a and its variance, [labelling, value], of values [batch, value] with the mean 0."""
    a, b = sizes
    total = member @ values
    every = (values**2).sum(0)
    # The sums of squares of the sets, about their means: Σ x² − (Σ x)² / size, over size (size − 1).
    variance = total**2
    variance *= -1 / (a**2 * (a - 1)) - 1 / (b**2 * (b - 1))
    variance += every / (b * (b - 1))
    if a != b:
        variance += (1 / (a * (a - 1)) - 1 / (b * (b - 1))) * (member @ values**2)
    np.maximum(variance, FLOOR * every / (a + b - 1) * (1 / a + 1 / b) + np.finfo(np.float32).tiny, out=variance)
    total *= -1 / a - 1 / b
    return total, variance


def _chance(statistic: Floats) -> Floats:
    """For each labelling, the share of labellings whose statistic is at least as large."""
    # Labellings with the sets exchanged have equal statistics but for rounding.
    return 1 - np.searchsorted(np.sort(statistic), statistic * (1 - 1e-5)) / statistic.size


def _power(
    best: Floats, directed: Floats, member: Floats, projection: Floats, sizes: tuple[int, int], length: float, effect: float
) -> tuple[float, float]:
    """Power at the effect, and the multiple of the effect's unit that is found nine times in ten, by the test of the projection alone."""
    count = best.size
    share = np.searchsorted(np.sort(best), best + 1e-12) / count
    allowed = best[share <= LEVEL]
    if not allowed.size:
        return 0.0, math.inf
    limit = np.sort(directed)[-round(float(allowed.max()) * count)]
    # Batches without the difference, with the spread within each set.
    halves = np.split(projection, [sizes[0]])
    noise = np.concatenate([(half - half.mean()) * math.sqrt(half.size / (half.size - 1)) for half in halves])
    apart, variance = (one[:, 0] for one in _welch(member, (noise - noise.mean())[:, None], sizes))
    reach = np.sqrt(limit * variance)
    detectable = float(np.quantile((reach - apart) / length, 0.9))
    return np.count_nonzero(np.abs(apart + effect * length) >= reach) / reach.size, detectable


def _excess(gram: Floats, squares: float, sizes: tuple[int, int]) -> tuple[float, float]:
    """Relative difference without noise, and the standard error of its square, from products of batches less the mean of all."""

    def square(kept: NDArray[np.int_]) -> float:
        a, b = kept[kept < sizes[0]], kept[kept >= sizes[0]]
        within = sum((gram[np.ix_(s, s)].sum() - gram[s, s].sum()) / (s.size * (s.size - 1)) for s in (a, b))
        return float(within - 2 * gram[np.ix_(a, b)].mean())

    every = np.arange(sum(sizes))
    norm = squares - float(np.trace(gram)) / (every.size * (every.size - 1))
    if norm <= 0:
        return math.nan, math.nan
    left_out = np.array([square(np.delete(every, i)) for i in every])
    variance = sum((s.size - 1) / s.size * ((s - s.mean()) ** 2).sum() for s in np.split(left_out, [sizes[0]]))
    found = square(every) / norm
    return math.copysign(math.sqrt(abs(found)), found), math.sqrt(variance) / norm
