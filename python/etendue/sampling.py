"""Tests of samplers and BRDFs: samples against their density, and the energy that a surface reflects and transmits."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.ranges import whole

Floats = NDArray[np.float64]
Sampler = Callable[[np.random.Generator, int], ArrayLike]
Density = Callable[[Floats], ArrayLike]
Domain = Union[Literal["sphere", "hemisphere"], tuple[tuple[float, float], tuple[float, float]]]

NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)
SHARE = 0.02
"""Largest error of the density's integral over a cell, in standard errors of the cell's count."""
DEEPEST, FINEST = 40, 14
"""How often a cell is quartered to be a cell of the test, and then for its integral alone."""
MOST = 1 << 25
"""Largest number of densities that are computed."""
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
    """Share of samples outside of the domain, not finite, where the density is 0, or repeated exactly (delta functions)."""
    repeated: float
    """Share of samples in points that at least 1 of 1,000 samples hits exactly: delta functions."""
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
    is large, or where a quarter more samples, which are not counted, lie. Expectations are integrals by 6 × 6 points of Gauss in each
    quarter, which are quartered until their error is small against the noise.

    The share of samples without a density (see `singular`) is tested too, against 1 − `integral`: a delta function with the missing share
    passes, and energy that the density lacks fails. If 25 such samples are expected, p is of the smaller of both p-values (Šidák).

    Raises `ValueError` if arrays have wrong shapes, a density is negative or not finite, or its integral stays too inaccurate.
    """
    samplers: Sequence[Sampler] = [sample] if callable(sample) else sample
    densities: Sequence[Density] = [pdf] if callable(pdf) else pdf
    if not samplers or len(samplers) != len(densities):
        raise ValueError(f"there are {len(samplers)} samplers and {len(densities)} densities; allowed: one density for each sampler")
    on_sphere = isinstance(domain, str)
    limits: Any = {"sphere": ((-1, 1), (0, 2 * math.pi)), "hemisphere": ((0, 1), (0, 2 * math.pi))}.get(domain, ()) if on_sphere else domain
    box = np.array(limits, float)
    if box.shape != (2, 2) or not np.isfinite(box).all() or not (box[:, 0] < box[:, 1]).all():
        raise ValueError(f"domain is {domain!r}; allowed: 'sphere', 'hemisphere' or ((x0, x1), (y0, y1))")
    whole("samples", samples, 1000, 10**9)
    whole("cells", cells, 4, samples // 10)
    found = [_chi_square(s, p, box.T, on_sphere, samples, cells, seed + i) for i, (s, p) in enumerate(zip(samplers, densities))]
    p_values = tuple(one.p for one in found)
    worst = found[int(np.argmin(p_values))]
    # −expm1(k log1p(−p)) is 1 − (1 − p)^k without cancellation.
    p = -math.expm1(len(found) * math.log1p(-worst.p)) if worst.p < 1 else 1.0
    return replace(worst, p=p, p_values=p_values)


def _chi_square(
    sample: Sampler, pdf: Density, box: Floats, on_sphere: bool, samples: int, cells: int, seed: int
) -> ChiSquare:
    pilot = samples // 4
    drawn = np.asarray(sample(np.random.default_rng(seed), pilot + samples))
    if drawn.shape != (pilot + samples, 3 if on_sphere else 2) or drawn.dtype.kind not in "iuf":
        what = f"{drawn.dtype} of shape {drawn.shape}"
        raise ValueError(f"the sampler returned {what}; allowed: real numbers of shape ({pilot + samples}, {3 if on_sphere else 2})")
    drawn = np.ascontiguousarray(drawn, np.float64)
    flat = np.stack([drawn[:, 2], np.arctan2(drawn[:, 1], drawn[:, 0]) % (2 * math.pi)], 1) if on_sphere else drawn
    # Single precision leaves unit vectors within 1e-6 of unit length.
    unit = np.abs(np.linalg.norm(drawn, axis=1) - 1) < 1e-3 if on_sphere else np.isfinite(drawn).all(1)
    clipped = np.clip(flat, box[0], box[1])
    regular = unit & (np.abs(clipped - flat) < (1e-6 if on_sphere else 1e-300)).all(1)
    _, inverse, counts = np.unique(drawn.view(f"V{drawn.itemsize * drawn.shape[1]}")[:, 0], return_inverse=True, return_counts=True)
    repeated = counts[inverse] >= max(16, drawn.shape[0] // 1000)
    regular &= ~repeated
    regular[regular] = _evaluated(pdf, drawn[regular]) > 0
    spent = 0

    def density(points: Floats) -> Floats:
        sine = np.sqrt(np.maximum(0.0, 1 - points[:, 0] ** 2))
        place = np.stack([sine * np.cos(points[:, 1]), sine * np.sin(points[:, 1]), points[:, 0]], 1) if on_sphere else points
        return _evaluated(pdf, place)

    def integrals(low: Floats, high: Floats) -> Floats:
        """Integrals of the density over rectangles [n, 2]."""
        nonlocal spent
        spent += 36 * len(low)
        half = 0.5 * (high - low)
        middle = low + half
        out = np.empty(len(low))
        for first in range(0, len(low), 1 << 14):
            part = slice(first, first + (1 << 14))
            grid = [middle[part, None, i] + half[part, None, i] * NODES for i in (0, 1)]
            points = np.stack(np.broadcast_arrays(grid[0][:, :, None], grid[1][:, None, :]), -1).reshape(-1, 2)
            values = density(points).reshape(-1, 6, 6)
            out[part] = 4 * 0.25 * np.einsum("nij,i,j->n", values, WEIGHTS, WEIGHTS) * half[part].prod(1)
        return out

    def tall(low: Floats, high: Floats) -> NDArray[np.bool_]:
        """Whether rectangles are longer in polar angle than in azimuth, as they are at the poles."""
        theta = np.arccos(np.clip([low[:, 0], high[:, 0]], -1, 1))
        return on_sphere & (theta[0] - theta[1] > np.sin(theta).max(0) * (high - low)[:, 1])

    def quarters(low: Floats, high: Floats) -> tuple[Floats, Floats, Floats]:
        """Rectangles [n, 4, 2] and their integrals [n, 4]."""
        long = tall(low, high)[:, None, None]
        corner = np.where(long, [[0, 0], [0.25, 0], [0.5, 0], [0.75, 0]], [[0, 0], [0, 0.5], [0.5, 0], [0.5, 0.5]])
        lows = low[:, None] + (high - low)[:, None] * corner
        highs = lows + (high - low)[:, None] * np.where(long, [0.25, 1], [0.5, 0.5])
        return lows, highs, integrals(lows.reshape(-1, 2), highs.reshape(-1, 2)).reshape(-1, 4)

    # The cells of the test: a quadtree that begins with 8 × 8 cells.
    steps = np.stack(np.meshgrid(np.arange(8), np.arange(8), indexing="ij"), -1).reshape(-1, 2)
    low = box[0] + (box[1] - box[0]) * steps / 8
    high = low + (box[1] - box[0]) / 8
    value = integrals(low, high)
    test = np.zeros(drawn.shape[0], bool)
    test[pilot:] = True
    which = np.flatnonzero(regular)
    places = clipped[which]
    owner = np.minimum(7, (8 * (places - box[0]) / (box[1] - box[0])).astype(int)) @ [8, 1]
    kept: list[tuple[NDArray[Any], ...]] = []
    for depth in range(DEEPEST):
        lows, highs, values = quarters(low, high)
        total = values.sum(1)
        guide = np.bincount(owner[~test[which]], minlength=len(low)) / pilot
        grows = (np.maximum(total, guide) > 1.5 / cells) & (depth < DEEPEST - 1)
        counted = np.bincount(owner[test[which]], minlength=len(low))
        kept.append(tuple(of[~grows] for of in (low, high, lows, highs, values, np.abs(total - value), counted)))
        if not grows.any():
            break
        stays = grows[owner]
        which, places, owner = which[stays], places[stays], owner[stays]
        part = (places - low[owner]) / (high - low)[owner]
        quarter = np.where(tall(low, high)[owner], part[:, 0] * 4 // 1, (part >= 0.5) @ [2, 1]).astype(int)
        owner = 4 * (np.cumsum(grows) - 1)[owner] + np.clip(quarter, 0, 3)
        low, high, value = lows[grows].reshape(-1, 2), highs[grows].reshape(-1, 2), values[grows].reshape(-1)
    low, high, lows, highs, values, errors, counted = (np.concatenate(part) for part in zip(*kept))
    mass = values.sum(1)
    allowed = SHARE * np.sqrt(np.maximum(mass, 1 / samples) / samples)
    # The integrals of cells whose error is too large.
    cell = np.repeat(np.flatnonzero(errors > allowed), 4)
    rough = errors > allowed
    errors = np.where(rough, 0.0, errors)
    low_, high_, value = lows[rough].reshape(-1, 2), highs[rough].reshape(-1, 2), values[rough].reshape(-1)
    for depth in range(1, FINEST):
        if not cell.size:
            break
        lows, highs, values = quarters(low_, high_)
        off = values.sum(1) - value
        np.add.at(mass, cell, off)
        # An edge through a cell crosses 2^depth of its parts.
        again = (np.abs(off) > allowed[cell] * 0.5**depth) & (depth < FINEST - 1) & (spent < MOST)
        np.add.at(errors, cell[~again], np.abs(off[~again]))
        low_, high_, value = lows[again].reshape(-1, 2), highs[again].reshape(-1, 2), values[again].reshape(-1)
        cell = np.repeat(cell[again], 4)

    integral, error = float(mass.sum()), float(errors.sum())
    lost = int(np.count_nonzero(~regular[pilot:]))
    expected, observed = (samples - lost) * mass / max(integral, 1e-300), counted
    order = np.argsort(expected)
    few = int(np.searchsorted(expected[order], EXPECTED))
    # The pool grows until it too has the least expectation.
    while few and few < order.size and expected[order[:few]].sum() < EXPECTED:
        few += 1
    pools = [order[:few]] if few else []
    alone = order[few:]
    expected_, observed_ = (np.append(of[alone], [of[pool].sum() for pool in pools]) for of in (expected, observed))
    dof = expected_.size - 1
    bias = float(((samples * errors) ** 2 / np.maximum(samples * mass, 1)).sum())
    if bias > 0.1 * math.sqrt(2 * max(dof, 1)):
        what = f"{integral:.6g} ± {error:.2g}"
        raise ValueError(f"the integral of the density is {what}; allowed: an error below the noise of {samples} samples")
    chi2 = float(((observed_ - expected_) ** 2 / np.maximum(expected_, 1e-300)).sum())
    impossible = integral - 1 > error + 0.1 / math.sqrt(samples)
    z = (observed - expected) / np.sqrt(np.maximum(expected, EXPECTED))
    top = int(np.abs(z).argmax())
    middle = 0.5 * (low + high)[top]
    sine = math.sqrt(max(0.0, 1 - middle[0] ** 2))
    place = np.array([sine * math.cos(middle[1]), sine * math.sin(middle[1]), middle[0]]) if on_sphere else middle
    p = 0.0 if impossible else _both(chi_square_above(chi2, dof) if dof else 1.0, lost, samples, max(0.0, 1 - integral), error)
    singular, twice = (float(np.mean(of[pilot:])) for of in (~regular, repeated))
    return ChiSquare(p, (p,), chi2, dof, integral, error, singular, twice, place, float(z[top]))


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
    return -math.expm1(2 * math.log1p(-min(p, other))) if min(p, other) < 1 else 1.0


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
        one = min(1.0, off.shape[1] * 0.5 * math.erfc(z / math.sqrt(2)))
        return z, -math.expm1(self.angles.size * math.log1p(-one)) if one < 1 else 1.0

    def plot(self, ax: Any = None) -> Any:
        """Draws the albedo with its error against the angle, on axes of matplotlib; returns the axes."""
        if ax is None:
            import matplotlib.pyplot as plt

            ax = plt.gca()
        for channel in range(self.albedo.shape[1]):
            ax.errorbar(np.degrees(self.angles), self.albedo[:, channel], self.sigma[:, channel], fmt="o-", color=f"C{channel}", capsize=3)
        ax.axhline(1.0, color="0.7", zorder=0)
        ax.set(xlabel="angle of incidence [°]", ylabel="albedo")
        return ax


def furnace(
    bsdf: Any, *, angles: ArrayLike = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5), samples: int = 2**14, seed: int = 1
) -> Furnace:
    """Measures how much of the light a surface sends out again: the white furnace test.

    Parameters
    ----------
    bsdf
        A pair of functions (sample, evaluate), in the frame whose z is the normal. `sample(random, n, incident)` returns directions
        [n, 3] and their weights f cos θ / density; `evaluate(incident, directions)` returns f cos θ. Weights are [n] or [n, channel]. Or a
        `mitsuba.BSDF`, or a dictionary for `mitsuba.load_dict`; scalar variants of Mitsuba take about 10 µs per sample.
    angles
        Angles of incidence in radians, from 0 to below π/2.
    samples
        Number of directions for each angle.
    seed
        Seed of the directions.

    Returns
    -------
    Furnace
        Albedos with errors. An albedo above 1 makes energy. One below 1 of a surface without absorption loses energy, as rough models with
        single scattering do. `albedo` and `evaluated` differ if sampling and evaluation contradict each other.

    Raises
    ------
    ValueError
        If an angle is out of its range, or the functions return arrays of wrong shapes.
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
    if mi.variant() is None:
        raise ValueError("Mitsuba has no variant; allowed: mitsuba.set_variant('scalar_rgb') or another before")
    scalar: bool = mi.variant().startswith("scalar")
    loaded: Any = mi.load_dict(dict(bsdf)) if isinstance(bsdf, Mapping) else bsdf  # pyright: ignore[reportUnknownArgumentType]
    if not isinstance(loaded, mi.BSDF):
        raise ValueError(f"bsdf is {type(loaded).__name__}; allowed: a pair of functions, a mitsuba.BSDF or its dictionary")
    # Importance: refraction changes the solid angle of radiance, but keeps flux.
    context = mi.BSDFContext(mi.TransportMode.Importance)

    def at(incident: Floats) -> Any:
        hit = mi.SurfaceInteraction3f() if scalar else importlib.import_module("drjit").zeros(mi.SurfaceInteraction3f)
        hit.wi, hit.n, hit.uv, hit.p = incident.tolist(), [0, 0, 1], [0.5, 0.5], [0, 0, 0]
        hit.sh_frame = mi.Frame3f(hit.n)
        if mi.is_spectral:
            hit.wavelengths = mi.sample_rgb_spectrum(0.5)[0]
        return hit

    def spectra(values: Any, count: int) -> Floats:
        array = np.array(mi.unpolarized_spectrum(values), float)
        array = array.reshape(-1, count).T if count > 1 else array
        return array.mean(-1, keepdims=True) if mi.is_spectral else array

    def sample(random: np.random.Generator, n: int, incident: Floats) -> tuple[Floats, Floats]:
        numbers, hit = random.random((3, n)), at(incident)
        if not scalar:
            found, weight = bsdf_sample(hit, mi.Float(numbers[0].astype("f4")), mi.Point2f(numbers[1:].astype("f4")))
            return np.array(found.wo, float).T, spectra(weight, n)
        drawn = [bsdf_sample(hit, one, [two, three]) for one, two, three in numbers.T]
        return np.array([found.wo for found, _ in drawn]), np.array([spectra(weight, 1) for _, weight in drawn])

    def bsdf_sample(hit: Any, one: Any, two: Any) -> Any:
        return loaded.sample(context, hit, one, two)

    def evaluate(incident: Floats, directions: Floats) -> Floats:
        hit = at(incident)
        if not scalar:
            return spectra(loaded.eval(context, hit, mi.Vector3f(directions.T.astype("f4"))), len(directions))
        return np.array([spectra(loaded.eval(context, hit, direction), 1) for direction in directions])

    return sample, evaluate
