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
"""Largest number of values (labellings times pixels) that are held at a time: they fit into the cache of a core."""


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
    change: tuple[float, float]
    """The difference along `effect` and its standard error: the relative change of everything, or the multiple of the array."""
    power: float
    """Estimated probability that the test finds `effect` at the level 1 % by its third statistic, the projection on `effect`."""
    detectable: float
    """The size of `change` that this statistic finds nine times in ten at 1 %; infinite if the batches are too few."""
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

    `a` and `b` are arrays [batch, ...] of the same shape without the first axis, real or complex, each of at least 4 independent batches:
    images of renders with different seeds, spectra, vectors. Real and imaginary part count as two values. `effect` is the difference b − a
    for which the power is stated: a relative change of everything, or an array without the axis of batches. `permutations` is the number of
    random assignments of batches to the two sets, with the seed `seed`; if there are no more assignments than that, all are used.

    p combines three statistics: the mean of (A − B)² / s², with the variance s² of all batches; its largest value, which finds one changed
    pixel; and Welch's t of the projection on `effect`, which finds a small change of everything. p is that of the smallest of their
    p-values, by the same permutations (Westfall and Young 1993). It is exact, whatever the distribution and correlation of pixels, if all
    batches have one distribution under the null hypothesis. Sets of the same mean and different noise have not: they are rejected, the more
    often the more pixels there are. (`difference` has σ² of each set for s², and its p is from the law of χ², which needs many batches.)

    Raises `ValueError` if shapes do not match, a number is not finite, a set has less than 4 batches, or an argument is out of its range.
    """
    sets = [_batches("a", a), _batches("b", b)]
    shape = sets[0].shape[1:]
    if sets[1].shape[1:] != shape:
        raise ValueError(f"a batch of a has shape {shape} and of b {sets[1].shape[1:]}; allowed: one shape")
    is_complex = any(one.dtype.kind == "c" for one in sets)
    direction = _direction(effect, shape, is_complex)
    first, batches = len(sets[0]), len(sets[0]) + len(sets[1])
    member = _labellings(first, batches, whole("permutations", permutations, 99, 10**6), seed)
    sums = _Sums(member, [_reals(one, is_complex) for one in sets], direction, 16 * max(_epsilon(one) for one in sets))

    products, projection, length = sums.scaled[:-1, :-1], sums.scaled[:-1, -1], float(sums.scaled[-1, -1])
    if direction is None:
        # The mean itself is noisy: its square is too large by its variance, 1 / batches in these units.
        length -= sums.values / batches
    # Each deviation contains the difference: E[d / s²] is smaller by (n − 3) / (n − 1) for normal noise of n batches. Without a mean above
    # the noise there is no relative change.
    length = length * (batches - 3) / (batches - 1) if length > 0 else math.nan
    apart, variance = _welch(member, projection)
    t2 = apart**2 / variance
    squares = ((member @ products) * member).sum(1)
    chances = np.array([_chance(one) for one in (squares, sums.largest, t2)])
    # The mean of the three orders labellings whose smallest p is the same.
    best = np.asarray(chances.min(0) + 1e-6 * chances.mean(0), np.float64)
    change, error = float(apart[0]) / length, float(np.sqrt(variance[0])) / length
    power, detectable = _power(best, t2, 1.0 if direction is not None else float(np.asarray(effect)), error)
    return TwoSample(
        p=np.count_nonzero(best <= best[0] + 1e-12) / best.size,
        labellings=len(member),
        # The variance is estimated: t² has the mean free / (free − 2) for normal noise with free = batches − 2.
        chi2_per_dof=sums.t2 * (batches - 4) / (batches - 2) / sums.values if sums.values else math.nan,
        excess=_excess(sums.products, first),
        change=(change, error),
        power=power,
        detectable=detectable,
        index=tuple(int(i) for i in np.unravel_index(sums.index // 2 if is_complex else sums.index, shape)),
        z=sums.z,
    )


def _batches(name: str, values: ArrayLike) -> NDArray[Any]:
    array = np.asarray(values)
    if array.dtype.kind not in "buifc" or array.ndim == 0 or array.size == 0 or len(array) < 4:
        what = f"{array.dtype} of shape {array.shape}"
        raise ValueError(f"{name} is {what}; allowed: numbers [batch, ...] with at least 4 independent batches")
    return array


def _direction(effect: float | ArrayLike, shape: tuple[int, ...], is_complex: bool) -> Floats | None:
    """The effect as a row of real numbers; None for a relative change."""
    along = np.asarray(effect)
    kinds = "buifc" if is_complex and along.ndim else "buif"
    if along.dtype.kind not in kinds or along.shape not in ((), shape) or not np.isfinite(along).all() or not along.any():
        what = f"{along.dtype} of shape {along.shape}"
        raise ValueError(f"effect is {what}; allowed: a finite number other than 0, or numbers of shape {shape}")
    return _reals(along[None], is_complex)[0] if along.ndim else None


def _epsilon(batches: NDArray[Any]) -> float:
    return float(np.finfo(batches.dtype).eps) if batches.dtype.kind in "fc" else 0.0


def _reals(batches: NDArray[Any], is_complex: bool) -> NDArray[Any]:
    """The batches as rows of real numbers; a complex number becomes two, next to each other."""
    rows = batches.reshape(len(batches), -1)
    return np.ascontiguousarray(rows, np.complex128).view(np.float64) if is_complex else rows


def _labellings(first: int, batches: int, permutations: int, seed: int) -> Floats:
    """Assignments of batches to the first set, [labelling, batch] of 0 and 1; the first is the true one."""
    if math.comb(batches, first) <= permutations + 1:
        chosen = np.array(list(combinations(range(batches), first)))
    else:
        order = np.random.default_rng(seed).permuted(np.tile(np.arange(batches), (permutations, 1)), axis=1)
        chosen = np.concatenate([np.arange(first)[None], order[:, :first]])
    member = np.zeros((len(chosen), batches))
    np.put_along_axis(member, chosen, 1.0, axis=1)
    return member


class _Sums:
    """Sums over all values, which are pixels or parts of complex numbers."""

    def __init__(self, member: Floats, rows: list[NDArray[Any]], direction: Floats | None, rounding: float) -> None:
        batches = member.shape[1]
        self.products = np.zeros((batches + 1, batches + 1))
        """Products of the batches less their mean, and, as the last row and column, of the mean."""
        self.scaled = np.zeros((batches + 1, batches + 1))
        """The same in units of the deviation of each value, with the direction of the effect as the last row and column."""
        self.largest = np.zeros(len(member))
        """For each labelling, the largest (A − B)² / s², but for a factor that depends on the numbers of batches alone."""
        self.values, self.t2, self.index, self.z = 0, 0.0, 0, 0.0
        """Number of values with noise, the sum of Welch's t² over them, where it is largest, and its signed root there."""
        member32 = member.astype(np.float32)
        each = max(1, TOGETHER // len(member))
        for start in range(0, rows[0].shape[1], each):
            part = slice(start, start + each)
            values = np.concatenate([row[:, part] for row in rows]).astype(np.float64)
            if not np.isfinite(values).all():
                raise ValueError(f"{np.count_nonzero(~np.isfinite(values))} values of a and b are not finite; allowed: finite numbers")
            mean = values.mean(0)
            off = values - mean
            self.products += _gram(off, mean)
            deviation = off.std(0, ddof=1)
            # Values that differ by rounding only are equal.
            noisy = np.flatnonzero(deviation > rounding * np.abs(values).max(0))
            if noisy.size:
                scaled = off[:, noisy] / deviation[noisy]
                self.scaled += _gram(scaled, (mean if direction is None else direction[part])[noisy] / deviation[noisy])
                squares = member32 @ scaled.astype(np.float32)
                squares *= squares
                np.maximum(self.largest, squares.max(1), out=self.largest)
                apart, variance = _welch(member[:1], scaled)
                z: Floats = (apart / np.sqrt(variance))[0]
                self.values += z.size
                self.t2 += float(z @ z)
                top = int(np.abs(z).argmax())
                if abs(z[top]) > abs(self.z):
                    self.index, self.z = start + int(noisy[top]), float(z[top])


def _gram(rows: Floats, last: Floats) -> Floats:
    every = np.concatenate([rows, last[None]])
    return every @ every.T


def _welch(member: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Mean of b less mean of a and its variance, [labelling, ...], of values [batch, ...] with the mean 0 (Welch 1947)."""
    means: list[Floats] = []
    variance = np.zeros(())
    for chosen in (member, 1 - member):
        size = chosen[0].sum()
        means.append(chosen @ values / size)
        variance = variance + (chosen @ values**2 / size - means[-1] ** 2) / (size - 1)
    first, batches = member[0].sum(), len(values)
    floor = FLOOR * values.var(0, ddof=1) * (1 / first + 1 / (batches - first)) + np.finfo(np.float64).tiny
    return means[1] - means[0], np.maximum(variance, floor)


def _chance(statistic: Floats) -> Floats:
    """For each labelling, the share of labellings whose statistic is at least as large."""
    # Labellings with the sets exchanged have equal statistics but for rounding.
    return 1 - np.searchsorted(np.sort(statistic), statistic * (1 - 1e-5)) / statistic.size


def _power(best: Floats, t2: Floats, effect: float, error: float) -> tuple[float, float]:
    """Power at the effect, and the change that is found nine times in ten, by the projection alone with a normal error."""
    share = np.searchsorted(np.sort(best), best + 1e-12) / best.size
    allowed = best[share <= LEVEL]
    if not allowed.size:
        return 0.0, math.inf
    limit = math.sqrt(np.sort(t2)[-round(float(allowed.max()) * t2.size)])
    beyond = [0.5 * math.erfc((limit - side * effect / error) / math.sqrt(2)) for side in (-1, 1)]
    # The normal law exceeds −1.2816 nine times in ten.
    return sum(beyond), (limit + 1.2816) * error


def _excess(products: Floats, first: int) -> float:
    """Relative difference without noise, from products of different batches only; their mean is the last row and column."""
    of = products[:-1, :-1]
    sides = of[:first, :first], of[first:, first:]
    within = sum(float(one.sum() - np.trace(one)) / (len(one) * (len(one) - 1)) for one in sides)
    square = within - 2 * float(of[:first, first:].mean())
    norm = float(products[-1, -1] - np.trace(of) / (len(of) * (len(of) - 1)))
    return math.copysign(math.sqrt(abs(square) / norm), square) if norm > 0 else math.nan
