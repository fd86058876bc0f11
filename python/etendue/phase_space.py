"""The étendue of rays, and the modulation transfer function of a spectrum."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.plot import curves
from etendue.rays import Spectrum, columns, groups
from etendue.result import Plane

Floats = NDArray[np.float64]
Uncertain = tuple[float, float]
"""A number and its standard error."""
PAIRS = 40_000
"""Wanted number of pairs of rays in one cell, from which the étendue is estimated."""
BINS = 64
SHIFTS = 4
"""Random positions of the grid of cells, over which estimates are averaged."""


@dataclass(frozen=True, eq=False)
class PhaseSpace:
    """Rays at a plane in phase space: positions x, y and optical direction cosines p = n cos α, q = n cos β. Errors are from the jackknife
    over groups of rays."""

    power: float
    """Sum of the weights."""
    etendue: Uncertain
    """(∫ f)² / ∫ f² with the power f per dx dy dp dq: ∬ n² cos θ dΩ dA over the rays if basic radiance L/n² is constant, else the volume
    that constant radiance would fill. In m² sr."""
    area_x: Uncertain
    """The same in the section (x, p), in metres."""
    area_y: Uncertain
    """The same in the section (y, q), in metres."""
    area95_x: Uncertain
    """Area of the densest part of the section (x, p) that has 95 % of the power, in metres."""
    area95_y: Uncertain
    """The same in the section (y, q)."""
    emittance_x: Uncertain
    """√(⟨x²⟩⟨p²⟩ − ⟨xp⟩²) about the means: the emittance of beam physics, in metres."""
    emittance_y: Uncertain
    """The same in the section (y, q)."""
    emittance: Uncertain
    """√det of the covariance of (x, y, p, q), in m²: the product of both emittances if the sections are independent."""
    skewness: Uncertain
    """Mean of x q − y p, in metres, which systems that are symmetric about the axis x = y = 0 conserve for each ray."""
    skewness_edges: Floats
    """Edges of 64 bins of x q − y p."""
    skewness_power: Floats
    """Share of the power in each bin."""
    skewness_sigma: Floats
    """Standard error of `skewness_power`."""


def phase_space(
    x: ArrayLike,
    y: ArrayLike,
    u: ArrayLike,
    v: ArrayLike,
    weight: ArrayLike | None = None,
    *,
    index: float = 1.0,
    batch: ArrayLike | None = None,
    batches: int = 32,
) -> PhaseSpace:
    """Measures the étendue, the emittances and the skewness of rays that cross a plane.

    x, y, u, v, `batch` and `batches` are those of `spectrum`. `weight` is the flux of each ray, by default 1, and not negative: the weight
    of a photon of Étendue, divided by (1 + u² + v²)². `index` is the index of refraction n at the plane.

    Slopes become direction cosines, p = n u / √(1 + u² + v²): these are conjugate to x and y, so lossless systems conserve volumes
    dx dy dp dq exactly (Liouville). ∫ f² is found from pairs of rays of different groups in cells of two sizes, and extrapolated towards
    cells of no size; so are areas. Half the difference of the sizes is part of the stated errors. Emittances are moments: linear optics
    conserves them, and travel at large angles does not.

    Raises `ValueError` if arrays do not match, a number is not finite, a weight is negative, or there are less than 4 groups.
    """
    if not (np.isreal(index) and 0 < index < math.inf):
        raise ValueError(f"index is {index}; allowed: a positive number")
    *position, flux = columns(x, y, u, v, weight)
    if not np.isfinite([*position, flux]).all() or (flux < 0).any() or not flux.any():
        raise ValueError("a ray has a coordinate that is not finite, or a weight that is negative, or all weights are 0; allowed: flux")
    group, count = groups(flux.size, batch, batches)
    if count < 4:
        raise ValueError(f"there are {count} groups of rays; allowed: 4 or more")
    cosine = index / np.sqrt(1 + position[2] ** 2 + position[3] ** 2)
    z = np.stack([position[0], position[1], position[2] * cosine, position[3] * cosine], 1)
    rays = _Rays(z, flux / flux.max(), group, count)
    skewness = z[:, 0] * z[:, 3] - z[:, 1] * z[:, 2]
    edges = np.histogram_bin_edges(skewness, BINS)
    bins = np.searchsorted(edges[1:-1], skewness, side="right")
    shares = np.stack([rays.means((bins == i).astype(np.float64)) for i in range(BINS)], -1)
    every, section_x, section_y = (0, 1, 2, 3), (0, 2), (1, 3)
    return PhaseSpace(
        float(flux.sum()),
        rays.extrapolated(rays.volumes, every),
        rays.extrapolated(rays.volumes, section_x),
        rays.extrapolated(rays.volumes, section_y),
        rays.extrapolated(rays.areas95, section_x),
        rays.extrapolated(rays.areas95, section_y),
        rays.emittance(section_x),
        rays.emittance(section_y),
        rays.emittance(every),
        _jackknife(rays.means(skewness)),
        edges,
        shares[0],
        _errors(shares),
    )


class _Rays:
    """Rays in phase space, z = [ray, (x, y, p, q)], in independent groups. Arrays of results are of all groups, then of all but each."""

    def __init__(self, z: Floats, flux: Floats, group: NDArray[Any], count: int) -> None:
        self.flux, self.group, self.count = flux, group, count
        self.effective = float(flux.sum() ** 2 / (flux**2).sum())
        """Number of rays of equal flux with the same noise."""
        self.z = z - flux @ z / flux.sum()
        mean = np.stack([self.means(one) for one in self.z.T], -1)
        products = np.stack([self.means(one * other) for one in self.z.T for other in self.z.T], -1).reshape(-1, 4, 4)
        self.covariance: Floats = products - mean[:, :, None] * mean[:, None, :]

    def sums(self, values: Floats) -> Floats:
        """Sums of flux times values [ray] over each group."""
        return np.bincount(self.group, self.flux * values, self.count).astype(np.float64)

    def means(self, values: Floats) -> Floats:
        return _without(self.sums(values)) / _without(self.sums(np.ones_like(values)))

    def emittance(self, axes: tuple[int, ...]) -> Uncertain:
        return _jackknife(np.sqrt(np.maximum(0.0, np.linalg.det(self.covariance[:, axes][:, :, axes]))))

    def extrapolated(self, of: Callable[[Floats, float], Floats], axes: tuple[int, ...]) -> Uncertain:
        """A volume from cells of two sizes, extrapolated towards cells of no size."""
        part = self.covariance[0][np.ix_(axes, axes)]
        widths = np.asarray(np.sqrt(np.diag(part)), np.float64)
        if not widths.all() or np.linalg.det(part / np.outer(widths, widths)) < 1e-12:
            raise ValueError("the rays fill no volume of phase space; allowed: independent positions and directions")
        # Coordinates of variance 1 without correlation: cells follow the shear of travel.
        root = np.asarray(np.linalg.cholesky(part), np.float64)
        white: Floats = self.z[:, axes] @ np.linalg.inv(root).T
        fine, coarse = (of(white, scale) * np.diag(root).prod() for scale in (1.0, 2.0))
        # Half the cells change a volume by all of the step (hard edges) to a third of it (smooth light), and its densest part by half.
        value, error = _jackknife(fine * np.divide(fine, coarse) ** (0.75 if of == self.volumes else 0.5))
        return value, math.hypot(error, 0.5 * abs(float(coarse[0] - fine[0])))

    def volumes(self, z: Floats, scale: float) -> Floats:
        """(∫ f)² / ∫ f² from pairs of rays."""
        side = scale * float(np.clip((2 * PAIRS / self.effective**2) ** (1 / z.shape[1]) * math.sqrt(12), 0.02, 1.0))
        pairs = np.zeros(self.count + 1)
        for cell in _cells(z, side):
            held = np.bincount(cell, self.flux)
            both, place = np.unique(cell * self.count + self.group, return_inverse=True)
            flux, group = np.bincount(place, self.flux), both % self.count
            at = np.bincount(group, flux * held[both // self.count], self.count)
            squares = np.bincount(group, flux**2, self.count)
            # Pairs of different groups only: rays of one group may depend on each other.
            pairs += np.append(held @ held, held @ held - 2 * at + squares) - _without(squares)
        if not (pairs > 0).all():
            raise ValueError(f"{self.flux.size} rays are too few for the étendue; allowed: about 1,000 rays of similar weight")
        powers = self.sums(np.ones_like(self.flux))
        return SHIFTS * (_without(powers) ** 2 - _without(powers**2)) * side ** z.shape[1] / pairs

    def areas95(self, z: Floats, scale: float) -> Floats:
        """Area of the densest cells with 95 % of the power, in two dimensions."""
        side = scale * float(np.clip(math.sqrt(12) * 3 / self.effective ** (1 / 3), 0.02, 0.5))
        cells = np.zeros(self.count + 1)
        for cell in _cells(z, side):
            most = int(cell.max()) + 1
            held = np.bincount(self.group * most + cell, self.flux, self.count * most).reshape(-1, most)
            shares = np.sort(_without(held), axis=1)[:, ::-1].cumsum(1)
            cells += [np.interp(0.95 * share[-1], share, np.arange(1, most + 1)) for share in shares]
        return cells * side**2 / SHIFTS


def _without(groups: NDArray[Any]) -> NDArray[Any]:
    """Sums over all groups, and then over all but each."""
    total = groups.sum(0)
    return np.concatenate([total[None], total - groups])


def _errors(values: Floats) -> Floats:
    """Standard errors by the jackknife, of values of all groups and of all but each."""
    parts = values[1:]
    return np.sqrt((len(parts) - 1) * parts.var(0))


def _jackknife(values: Floats) -> Uncertain:
    return float(values[0]), float(_errors(values))


def _cells(z: Floats, side: float) -> Iterator[NDArray[np.int64]]:
    """The rank of the cell of each point among the cells with points, for some random positions of the grid of cells."""
    random = np.random.default_rng(1)
    for _ in range(SHIFTS):
        shift = np.asarray(random.random((1, z.shape[1])), np.float64)
        whole = np.floor(z / side + shift).astype(np.int64)
        whole -= whole.min(0)
        # A far outlier would need more cells than there are numbers.
        shape = [int(most) + 1 for most in whole.max(0)]
        if math.prod(shape) >= 2**62:
            raise ValueError("a ray is too far from the others; allowed: positions and directions of comparable spread")
        yield np.unique(np.ravel_multi_index(tuple(whole.T), shape), return_inverse=True)[1]


@dataclass(frozen=True, eq=False)
class MTF:
    """A modulation transfer function: |S| / |S(0)| along one frequency axis, for each azimuth."""

    along: Literal["rho", "nu"]
    azimuth: Floats
    """In radians, from the x axis. With the axis of the system along y, 0 is sagittal and π/2 tangential."""
    frequency: Floats
    """Frequencies ≥ 0: in cycles per metre along rho, in cycles per unit of slope along nu."""
    value: Floats
    """[azimuth, frequency]; 1 at frequency 0. Noise adds its power: the value is about `sigma` where there is no signal."""
    sigma: Floats
    """Standard error: from the jackknife over several spectra. From one spectrum it is a bound, because the noise of S and of S(0) are
    correlated."""

    def plot(self, ax: Any = None) -> Any:
        """Draws a curve with errors for each azimuth, on axes of matplotlib; returns the axes."""
        labels = [f"{math.degrees(azimuth):.0f}°" for azimuth in self.azimuth]
        ax = curves(ax, self.frequency, self.value, self.sigma, labels, "azimuth")
        ax.set(xlabel="ρ [cycles/m]" if self.along == "rho" else "ν [cycles/slope]", ylabel="MTF", ylim=(0, None))
        return ax


def mtf(spectra: Spectrum | Plane | Sequence[Spectrum | Plane], *, along: Literal["rho", "nu"] = "rho") -> MTF:
    """The modulation transfer function of light at a plane: |S| / |S(0)| over rho at nu = 0, or over nu at rho = 0.

    `spectra` is a `Spectrum` or a plane of a `Result` (its measurement); or at least 4 of them, of independent rays with the same window
    and frequencies, which are added. If the light is the image of a point or of a line, the curve over rho is the MTF of the system times
    the window: S is the spectrum of the light times the window, so window and light are convolved in frequency. Nothing is divided out.

    Raises `ValueError` if `along` is another word, if spectra have different frequencies, or if there is no light.
    """
    every = list(spectra) if isinstance(spectra, Sequence) else [spectra]
    if along not in ("rho", "nu") or (len(every) != 1 and len(every) < 4):
        raise ValueError(f"there are {len(every)} spectra along {along!r}; allowed: 1 spectrum or at least 4, along 'rho' or 'nu'")
    axes = [one.slices if isinstance(one, Plane) else one for one in every]
    first = axes[0]
    if not all(np.array_equal(getattr(one, name), getattr(first, name)) for one in axes for name in ("azimuth", "rho", "nu")):
        raise ValueError("the spectra have different frequencies; allowed: the same azimuth, rho and nu")
    rho, nu = first.rho.size // 2, first.nu.size // 2
    frequency, cut = (first.rho[rho:], np.s_[..., rho:, nu]) if along == "rho" else (first.nu[nu:], np.s_[..., rho, nu:])
    # With several spectra: all of them, and all but each.
    parts = np.stack([one.sample.slices[cut] for one in every])
    parts = _without(parts) if len(every) > 1 else parts
    middle = np.abs(parts[..., :1])
    if not middle.all():
        raise ValueError("the spectrum is zero at frequency 0; allowed: light in the window")
    values = np.abs(parts) / middle
    if len(every) > 1:
        return MTF(along, first.azimuth, frequency, values[0], _errors(values))
    noise = every[0].sample.slices_sigma[cut]
    sigma = np.hypot(noise, values[0] * noise[:, :1]) / middle[0]
    sigma[:, 0] = 0.0
    return MTF(along, first.azimuth, frequency, values[0], sigma)
