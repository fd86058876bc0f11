"""Tests of samplers and BRDFs: samples against their density, and the energy that a surface reflects and transmits."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.plot import curves
from etendue.ranges import whole

Floats = NDArray[np.float64]
Sampler = Callable[[np.random.Generator, int], ArrayLike]
Density = Callable[[Floats], ArrayLike]
Domain = Union[Literal["sphere", "hemisphere"], tuple[tuple[float, float], tuple[float, float]]]

RULES = [np.polynomial.legendre.leggauss(n) for n in (6, 7)]
"""Gauss rules of rectangles and of their quarters, in turn: a jump of the density that one rule misses is found by the other."""
SHARE = 0.02
"""Largest error of the density's integral over a rectangle, in standard errors of its count."""
DEEPEST = 40
"""How often a rectangle is quartered."""
MOST = 1 << 17
"""Number of rectangles of one size above which they are not quartered any more for their integrals."""
EXPECTED = 5.0
"""Cells of smaller expected counts are pooled."""


@dataclass(frozen=True, eq=False)
class ChiSquare:
    """Samples against their density. With several configurations, all but `p_values` are those of the one with the smallest p."""

    p: float
    """Probability of a deviation at least as large if the samples have the density; of k configurations 1 − (1 − least p)^k (Šidák)."""
    p_values: tuple[float, ...]
    """p of each configuration alone."""
    chi2: float
    dof: int
    integral: float
    """Integral of the density over the domain. What is missing to 1 should be the share of `singular`; above 1, p is 0."""
    integral_error: float
    """Bound of the numerical error of `integral`."""
    singular: float
    """Share of samples outside of the domain, not finite, where the density is 0, or in a point that 1 of 1,000 hit (delta functions)."""
    cell: Floats
    """Middle of the cell with the largest deviation, a direction or a point."""
    z: float
    """(counted − expected) / √expected of this cell."""

    def __str__(self) -> str:
        return (
            f"p {self.p:.4f}, χ² {self.chi2:.1f} of {self.dof}, integral {self.integral:.6f} ± {self.integral_error:.1g}, "
            f"singular {100 * self.singular:.3g} %, largest at {np.round(self.cell, 3)}: z = {self.z:.1f}"
        )


def chi_square(
    sample: Sampler | Sequence[Sampler],
    pdf: Density | Sequence[Density],
    *,
    domain: Domain = "sphere",
    samples: int = 2**17,
    cells: int = 1024,
    seed: int = 1,
) -> ChiSquare:
    """Tests samples against their density by χ².

    `sample(random, n)` returns n samples: unit vectors [n, 3], or points [n, 2] of a rectangle; `random` is a NumPy generator.
    `pdf(points)` returns their densities, in sr⁻¹ or per area. Sequences of both test several configurations. `domain` is "sphere",
    "hemisphere" (z ≥ 0) or ((x0, x1), (y0, y1)). About `cells` cells of similar expectation are used: cells are quartered where the density
    is large, or where a quarter more samples, which are not counted, lie. Expectations are integrals by Gauss rules
    of 6 × 6 or 7 × 7 points in parts of cells, which are quartered until their error is small against the noise.

    The share of samples without a density (see `singular`) is tested too, against 1 − `integral`: a delta function with the missing share
    passes, and energy that the density lacks fails. If 25 such samples are expected, p is of the smaller of both p-values (Šidák).

    Raises `ValueError` if arrays have wrong shapes, a density is negative or not finite, or its integral stays too inaccurate.
    """
    samplers: Sequence[Sampler] = [sample] if callable(sample) else sample
    densities: Sequence[Density] = [pdf] if callable(pdf) else pdf
    if not samplers or len(samplers) != len(densities):
        raise ValueError(f"there are {len(samplers)} samplers and {len(densities)} densities; allowed: one density for each sampler")
    chart = _Chart(domain)
    whole("samples", samples, 1000, 10**9)
    whole("cells", cells, 4, samples // 10)
    found = [_one_chi_square(s, p, chart, samples, cells, seed + i) for i, (s, p) in enumerate(zip(samplers, densities))]
    p_values = tuple(one.p for one in found)
    return replace(found[int(np.argmin(p_values))], p=_sidak(min(p_values), len(found)), p_values=p_values)


def _sidak(p: float, tests: int) -> float:
    """1 − (1 − p)^tests without cancellation."""
    return -math.expm1(tests * math.log1p(-p)) if p < 1 else 1.0


def _one_chi_square(sample: Sampler, pdf: Density, chart: _Chart, samples: int, cells: int, seed: int) -> ChiSquare:
    pilot = samples // 4
    drawn = np.asarray(sample(np.random.default_rng(seed), pilot + samples))
    if drawn.shape != (pilot + samples, chart.columns) or drawn.dtype.kind not in "iuf":
        what = f"{drawn.dtype} of shape {drawn.shape}"
        raise ValueError(f"the sampler returned {what}; allowed: real numbers of shape ({pilot + samples}, {chart.columns})")
    drawn = np.ascontiguousarray(drawn, np.float64)
    flat, regular = chart.flat(drawn)
    regular &= ~_repeated(drawn)
    regular[regular] = _evaluated(pdf, drawn[regular]) > 0
    is_pilot = np.arange(len(drawn)) < pilot
    found = _Cells(chart, pdf, flat[regular], is_pilot[regular], samples, cells)
    lost = int(np.count_nonzero(~regular & ~is_pilot))

    integral, error = float(found.mass.sum()), float(found.error.sum())
    expected = (samples - lost) * found.mass / max(integral, 1e-300)
    chi2, dof = _pooled_chi2(found.counted, expected)
    bias = float(((samples * found.error) ** 2 / np.maximum(samples * found.mass, 1)).sum())
    if bias > 0.1 * math.sqrt(2 * max(dof, 1)):
        what = f"{integral:.6g} ± {error:.2g}"
        raise ValueError(f"the integral of the density is {what}; allowed: an error below the noise of {samples} samples")
    p = _both(chi_square_above(chi2, dof) if dof else 1.0, lost, samples, max(0.0, 1 - integral), error)
    if integral - 1 > error + 0.1 / math.sqrt(samples):
        p = 0.0
    z = (found.counted - expected) / np.sqrt(np.maximum(expected, EXPECTED))
    top = int(np.abs(z).argmax())
    return ChiSquare(p, (p,), chi2, dof, integral, error, lost / samples, chart.place(found.middle[top]), float(z[top]))


def _repeated(drawn: Floats) -> NDArray[np.bool_]:
    """Whether each sample is a point that at least 1 of 1,000 samples hits exactly."""
    # Rows as single items of bytes: unique values of these are much faster than along an axis.
    rows = drawn.view(f"V{drawn.itemsize * drawn.shape[1]}")[:, 0]
    _, inverse, counts = np.unique(rows, return_inverse=True, return_counts=True)
    return counts[inverse] >= max(16, len(drawn) // 1000)


def _pooled_chi2(counted: Floats, expected: Floats) -> tuple[float, int]:
    """χ² and its degrees of freedom, with the cells of the smallest expectations as one."""
    order = np.argsort(expected)
    # The pool grows until it too has the least expectation.
    few = int(np.searchsorted(expected[order], EXPECTED))
    while 0 < few < order.size and expected[order[:few]].sum() < EXPECTED:
        few += 1
    if few:
        expected, counted = (np.concatenate([of[order[few:]], [of[order[:few]].sum()]]) for of in (expected, counted))
    return float(((counted - expected) ** 2 / np.maximum(expected, 1e-300)).sum()), expected.size - 1


class _Chart:
    """A rectangle [2, 2] of two coordinates with low and high corners: (z, azimuth) of directions, which conserves areas, or x and y."""

    def __init__(self, domain: Domain) -> None:
        self.on_sphere = isinstance(domain, str)
        names = {"sphere": ((-1, 1), (0, 2 * math.pi)), "hemisphere": ((0, 1), (0, 2 * math.pi))}
        box = np.array(names.get(domain, ()) if isinstance(domain, str) else domain, float)
        if box.shape != (2, 2) or not np.isfinite(box).all() or not (box[:, 0] < box[:, 1]).all():
            raise ValueError(f"domain is {domain!r}; allowed: 'sphere', 'hemisphere' or ((x0, x1), (y0, y1))")
        self.low, self.high = box.T
        self.columns = 3 if self.on_sphere else 2

    def flat(self, places: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Coordinates of directions or points, and whether these are in the domain. Single precision leaves directions within 1e-6."""
        flat, inside = places, np.isfinite(places).all(1)
        if self.on_sphere:
            flat = np.stack([places[:, 2], np.arctan2(places[:, 1], places[:, 0]) % (2 * math.pi)], 1)
            inside &= np.abs(np.linalg.norm(places, axis=1) - 1) < 1e-3
        clipped = np.clip(flat, self.low, self.high)
        far = np.abs(clipped - flat).max(1)
        return clipped, np.logical_and(inside, far <= (1e-6 if self.on_sphere else 0.0))

    def place(self, flat: Floats) -> Floats:
        """Directions or points of coordinates [..., 2]."""
        if not self.on_sphere:
            return flat
        z, azimuth = flat[..., 0], flat[..., 1]
        sine = np.sqrt(np.maximum(0.0, 1 - z * z))
        return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), z], -1)

    def quarters(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """Corners of quarters [n, 4, 2]; a rectangle that is longer in polar angle than in azimuth, as at the poles, has slices."""
        polar = np.arccos(np.clip([low[:, 0], high[:, 0]], -1, 1))
        is_tall = self.on_sphere & (polar[0] - polar[1] > np.sin(polar).max(0) * (high - low)[:, 1])[:, None, None]
        corner = np.where(is_tall, [[0, 0], [0.25, 0], [0.5, 0], [0.75, 0]], [[0, 0], [0, 0.5], [0.5, 0], [0.5, 0.5]])
        size = (high - low)[:, None]
        lows = low[:, None] + size * corner
        return lows, lows + size * np.where(is_tall, [0.25, 1], [0.5, 0.5])


class _Cells:
    """The cells of the test: rectangles that are quartered where the density or pilot samples are large, and for their integrals."""

    def __init__(self, chart: _Chart, pdf: Density, places: Floats, is_pilot: NDArray[np.bool_], samples: int, cells: int) -> None:
        low, high = chart.low[None], chart.high[None]
        value = _integrals(chart, pdf, low, high, 0)
        # `owner` is the rectangle of each sample. Rectangles of one cell have its number: they are quartered for their integrals only.
        owner: NDArray[np.int64] = np.zeros(len(places), np.int64)
        cell, number = np.zeros(1, np.int64), 1
        kept: list[tuple[NDArray[Any], ...]] = []
        for depth in range(1, DEEPEST + 1):
            lows, highs = chart.quarters(low, high)
            values = _integrals(chart, pdf, lows.reshape(-1, 2), highs.reshape(-1, 2), depth).reshape(-1, 4)
            total = values.sum(1)
            error = np.abs(total - value)
            guide = np.bincount(owner[is_pilot], minlength=len(low)) / (samples // 4)
            is_large = (np.maximum(total, guide) > 1.5 / cells) | (depth <= 3)
            is_rough = (error > SHARE * np.sqrt(np.maximum(total, 1 / samples) / samples)) & (len(low) < MOST)
            grows = (is_large | is_rough) & (depth < DEEPEST)
            counted = np.bincount(owner[~is_pilot], minlength=len(low))
            kept.append(tuple(of[~grows] for of in (cell, total, error, counted, 0.5 * (low + high))))
            if not grows.any():
                break
            stays = grows[owner]
            places, is_pilot, owner = places[stays], is_pilot[stays], owner[stays]
            # The last quarter whose low corner is not above the sample.
            above = np.greater_equal(places[:, None], lows[owner])
            quarter = 3 - np.argmax(np.all(above, axis=2)[:, ::-1], axis=1)
            owner = 4 * (np.cumsum(grows) - 1)[owner] + quarter
            fresh = number + np.arange(4 * len(low)).reshape(-1, 4)
            cell = np.where(is_large[:, None], fresh, cell[:, None])[grows].ravel()
            number += fresh.size
            low, high, value = (of[grows].reshape(-1, *of.shape[2:]) for of in (lows, highs, values))
        cell, total, error, counted, middle = (np.concatenate(part) for part in zip(*kept))
        _, first, cell = np.unique(cell, return_index=True, return_inverse=True)
        self.mass, self.error, self.counted = (np.bincount(cell, of).astype(np.float64) for of in (total, error, counted))
        """Integrals of the density over the cells, bounds of their errors, and numbers of samples without pilot samples."""
        self.middle = middle[first]
        """A point of each cell, [cell, 2]."""


def _integrals(chart: _Chart, pdf: Density, low: Floats, high: Floats, depth: int) -> Floats:
    """Integrals of the density over rectangles [n, 2]."""
    nodes, weights = RULES[depth % 2]
    half = 0.5 * (high - low)
    out = np.empty(len(low))
    for first in range(0, len(low), 1 << 14):
        part = slice(first, first + (1 << 14))
        x, y = (low[part, None, i] + half[part, None, i] * (1 + nodes) for i in (0, 1))
        points = np.stack(np.broadcast_arrays(x[:, :, None], y[:, None, :]), -1).reshape(-1, 2)
        values = _evaluated(pdf, chart.place(points)).reshape(-1, nodes.size, nodes.size)
        out[part] = np.einsum("nij,i,j->n", values, weights, weights) * half[part].prod(1)
    return out


def _both(p: float, lost: int, samples: int, share: float, error: float) -> float:
    """p of the cells, together with p of the number of samples that have no density."""
    expected = samples * share
    if expected >= 25:
        other = math.erfc(abs(lost - expected) / math.sqrt(2 * expected * (1 - share)))
    else:
        # The probability of so many by Poisson's law; fewer are no finding.
        other = 1 - chi_square_above(2 * (expected + samples * (error + 1e-7)), 2 * lost) if lost else 1.0
        if other > 1e-4:
            return p
    return _sidak(min(p, other), 2)


def _evaluated(pdf: Density, points: Floats) -> Floats:
    values = np.asarray(pdf(points.copy()), np.float64)
    if values.shape != (len(points),) or not np.isfinite(values).all() or (values < 0).any():
        raise ValueError(f"the density has shape {values.shape} for {len(points)} points; allowed: a finite number of at least 0 for each")
    return values


def chi_square_above(x: float, dof: int) -> float:
    """The probability that χ² with a whole number of degrees of freedom exceeds x (Abramowitz and Stegun 1964, 26.4.4 and 26.4.5)."""
    terms = np.arange(dof % 2 / 2, dof / 2)
    tail = math.erfc(math.sqrt(x / 2)) if dof % 2 else 0.0
    if x <= 0:
        return 1.0
    return min(1.0, tail + float(np.exp(terms * math.log(x / 2) - x / 2 - [math.lgamma(t + 1) for t in terms]).sum()))


Weights = Callable[[np.random.Generator, int, Floats], tuple[ArrayLike, ArrayLike]]
"""sample(random, n, incident): sampled directions [n, 3] and weights f cos θ / density, [n] or [n, channel]."""
Evaluate = Callable[[Floats, Floats], ArrayLike]
"""evaluate(incident, directions): f cos θ, [n] or [n, channel]."""
ROUNDING = 2e-6
"""The error of albedos that single precision causes."""


@dataclass(frozen=True, eq=False)
class Furnace:
    """The share of light that a surface reflects and transmits, by angle of incidence."""

    angles: Floats
    """Angles of incidence, in radians."""
    albedo: Floats
    """[angle, channel]: mean of the weights of sampled directions."""
    sigma: Floats
    """Standard error of `albedo`, at least the rounding of single precision."""
    evaluated: Floats
    """[angle, channel]: integral of f cos θ by directions that are uniform on the sphere. It lacks delta functions."""
    evaluated_sigma: Floats
    """Standard error of `evaluated`; too small where a lobe is so narrow that few directions meet it."""

    @property
    def gain(self) -> tuple[float, float]:
        """By how many standard errors an albedo is above 1 at most, and the probability of that if none is above 1 (Šidák)."""
        return self._worst(self.albedo - 1)

    @property
    def loss(self) -> tuple[float, float]:
        """By how many standard errors an albedo is below 1 at most, and the probability of that if all are 1, as without absorption."""
        return self._worst(1 - self.albedo)

    def _worst(self, off: Floats) -> tuple[float, float]:
        z = float((off / self.sigma).max())
        # Channels share their samples, so only angles are independent.
        return z, _sidak(min(1.0, off.shape[1] * 0.5 * math.erfc(z / math.sqrt(2))), self.angles.size)

    def plot(self, ax: Any = None) -> Any:
        """Draws the albedo with its error against the angle, on axes of matplotlib; returns the axes."""
        labels = [str(channel) for channel in range(self.albedo.shape[1])]
        ax = curves(ax, np.degrees(self.angles), self.albedo.T, self.sigma.T, labels, "channel")
        ax.axhline(1.0, color="0.7", zorder=0)
        ax.set(xlabel="angle of incidence [°]", ylabel="albedo")
        return ax


def furnace(
    bsdf: Any, *, angles: ArrayLike = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5), samples: int = 2**14, seed: int = 1
) -> Furnace:
    """Measures how much of the light a surface sends out again: the white furnace test.

    `bsdf` is a pair of functions (sample, evaluate), in the frame whose z is the normal: `sample(random, n, incident)` returns directions
    [n, 3] and their weights f cos θ / density, and `evaluate(incident, directions)` returns f cos θ, [n] or [n, channel]. Or it is a
    `mitsuba.BSDF`, or a dictionary for `mitsuba.load_dict`, with the variant scalar_rgb, which takes about 10 µs per sample. `angles` are
    angles of incidence in radians, from 0 to below π/2; `samples` is the number of directions for each, and `seed` their seed.

    An albedo above 1 makes energy. One below 1 of a surface without absorption loses energy, as rough models with single scattering do.
    `albedo` and `evaluated` differ if sampling and evaluation contradict each other.

    Raises `ValueError` if an angle is out of its range, or the functions return arrays of wrong shapes.
    """
    at = np.atleast_1d(np.asarray(angles, np.float64))
    if at.ndim != 1 or not at.size or not ((at >= 0) & (at < 0.5 * math.pi)).all():
        raise ValueError(f"angles is {angles}; allowed: angles from 0 to below π/2")
    whole("samples", samples, 100, 10**8)
    pair: tuple[Weights, Evaluate] = bsdf if isinstance(bsdf, tuple) else _mitsuba_pair(bsdf)  # pyright: ignore[reportUnknownVariableType]
    random = np.random.default_rng(seed)
    rows: list[tuple[Floats, ...]] = []
    for angle in at:
        incident = np.array([math.sin(angle), 0.0, math.cos(angle)])
        weights = _weights("sample", pair[0](random, samples, incident)[1], samples)
        everywhere = random.standard_normal((samples, 3))
        everywhere /= np.linalg.norm(everywhere, axis=1, keepdims=True)
        evaluated = 4 * math.pi * _weights("evaluate", pair[1](incident, everywhere), samples)
        rows.append((*_mean(weights), *_mean(evaluated)))
    albedo, sigma, evaluated, evaluated_sigma = (np.array(column) for column in zip(*rows))
    return Furnace(at, albedo, np.hypot(sigma, ROUNDING), evaluated, evaluated_sigma)


def _weights(name: str, values: ArrayLike, samples: int) -> Floats:
    weights = np.asarray(values, np.float64)
    weights = weights[:, None] if weights.ndim == 1 else weights
    if weights.ndim != 2 or len(weights) != samples or not np.isfinite(weights).all():
        raise ValueError(f"{name} returned weights of shape {weights.shape}; allowed: finite numbers [{samples}] or [{samples}, channel]")
    return weights


def _mean(values: Floats) -> tuple[Floats, Floats]:
    return values.mean(0), values.std(0, ddof=1) / math.sqrt(len(values))


def _mitsuba_pair(bsdf: Any) -> tuple[Weights, Evaluate]:
    try:
        mi: Any = importlib.import_module("mitsuba")
    except ImportError as error:
        raise ValueError(f"bsdf is {type(bsdf).__name__}; allowed without Mitsuba: a pair of functions (sample, evaluate)") from error
    if mi.variant() != "scalar_rgb":
        raise ValueError(f"the variant of Mitsuba is {mi.variant()}; allowed: mitsuba.set_variant('scalar_rgb')")
    loaded: Any = mi.load_dict(dict(bsdf)) if isinstance(bsdf, Mapping) else bsdf  # pyright: ignore[reportUnknownArgumentType]
    if not isinstance(loaded, mi.BSDF):
        raise ValueError(f"bsdf is {type(loaded).__name__}; allowed: a pair of functions, a mitsuba.BSDF or its dictionary")
    # Importance: refraction changes the solid angle of radiance, but keeps flux.
    context = mi.BSDFContext(mi.TransportMode.Importance)

    def hit(incident: Floats) -> Any:
        at = mi.SurfaceInteraction3f()
        at.wi, at.n, at.uv, at.p = incident.tolist(), [0, 0, 1], [0.5, 0.5], [0, 0, 0]
        at.sh_frame = mi.Frame3f(at.n)
        return at

    def sample(random: np.random.Generator, n: int, incident: Floats) -> tuple[Floats, Floats]:
        at = hit(incident)
        drawn = [loaded.sample(context, at, one, [two, three]) for one, two, three in random.random((n, 3))]
        return np.array([found.wo for found, _ in drawn]), np.array([weight for _, weight in drawn])

    def evaluate(incident: Floats, directions: Floats) -> Floats:
        at = hit(incident)
        return np.array([loaded.eval(context, at, direction) for direction in directions])

    return sample, evaluate
