"""The spectrum of light fields on grids: views times pixels, or epipolar images."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from math import inf
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue import types
from etendue.difference import Sample
from etendue.plot import Shown, Variables, plotted
from etendue.rays import around
from etendue.scene import Scene
from etendue.separable import BLOCK, Axis, compressed_field, full, slices_of
from etendue.wedge import Wedge

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

DRAWS = 32
"""Number of draws of the noise that give the errors of powers."""
KNOWN = 10**9
"""Stands for the number of batches where the noise is stated and not estimated."""


@dataclass(frozen=True, eq=False)
class GridSpectrum(Shown):
    """The windowed spectrum of a light field on a grid. Errors are 0 if neither `noise` nor `replicates` was given."""

    azimuth: Floats
    """In radians."""
    rho: Floats
    """In cycles per metre."""
    nu: Floats
    """In cycles per unit of u."""
    slices: Complex
    """S(azimuth, rho, nu) = Σ L · window · exp(−2πi (rho p + nu q)) · cell, p = x cos φ + y sin φ, q = u cos φ + v sin φ. `cell` is the
    product of the spacings."""
    slices_sigma: Floats
    """Standard error of |slices|: exact where `noise` was given, otherwise from the spread between replicates."""
    spacing: dict[str, float]
    """Distance between neighbouring samples along each coordinate. The spectrum repeats at its inverse."""
    half_width: dict[str, float]
    """Half-width of the window along each coordinate."""
    estimates: Complex
    """[R, azimuth, rho, nu]: the slices of each replicate, or those with another draw of the noise added. They give the errors."""
    replicated: bool
    """Whether `estimates` are replicates."""

    @cached_property
    def power(self) -> Floats:
        """The mean of |slices|² over azimuths, [rho, nu], minus the power of the noise; it may be negative."""
        return self.with_error(_mean)[0]

    @cached_property
    def power_sigma(self) -> Floats:
        """Standard error of `power`. Where noise is above the signal, it is up to √2 too large with replicates, and √3 with `noise`."""
        return self.with_error(_mean)[1]

    @property
    def sample(self) -> Sample:
        """The slices with their noise, for `difference`."""
        batches = len(self.estimates) if self.replicated else KNOWN
        axes = self.azimuth, self.rho, self.nu
        return Sample(self.slices, axes, self.slices_sigma, _noise_dof(self.estimates[:, :, self.rho.size // 2 :]), batches)

    def wedge(self, d_min: float, d_max: float, *, focus: float = inf, limit: float = 0.01) -> Wedge:
        """Measures the wedge of a scene whose depths are between `d_min` and `d_max` (Chai, Tong, Chan, Shum 2000).

        Depths are the distances of points from the plane of the views, in metres, against the direction of light; `d_max` may be infinite.
        `focus` is the depth at which points have the same pixel in all views; it is infinite for parallel cameras. `limit` is the share of
        the power that may alias at the advised spacing. Raises `ValueError` if a number is out of range, or if there is no power.
        """
        if not 0 < d_min <= d_max or d_min == inf:
            raise ValueError(f"d_min is {d_min} and d_max {d_max}; allowed: 0 < d_min ≤ d_max")
        if not abs(focus) > 0 or not 0 < limit < 1:
            raise ValueError(f"focus is {focus} and limit {limit}; allowed: a focus other than 0, and a limit between 0 and 1")
        return Wedge(self, d_min, d_max, focus=focus, limit=limit)

    def with_error(self, of: Callable[[Floats], Any]) -> tuple[Any, Any]:
        """A function of the power [azimuth, rho, nu] without its noise, and its standard error: the jackknife over replicates, or the
        spread over draws of the noise."""
        slices, estimates = self.slices, self.estimates
        count = len(estimates)
        if not self.replicated:
            noise = self.slices_sigma**2
            value = of(abs(slices) ** 2 - noise)
            # A draw has noise twice.
            return value, np.std([of(abs(one) ** 2 - 2 * noise) for one in estimates], 0, ddof=1) if count else 0 * value
        total, squares = estimates.sum(0), (abs(estimates) ** 2).sum(0)
        without = [(abs(total - one) ** 2 - squares + abs(one) ** 2) / ((count - 1) * (count - 2)) for one in estimates]
        spread = np.std([of(power) for power in without], 0)
        return of((abs(total) ** 2 - squares) / (count * (count - 1))), np.sqrt(count - 1) * spread

    def _variables(self) -> Variables:
        axes = {"slices": ("azimuth", "rho", "nu"), "slices_sigma": ("azimuth", "rho", "nu"), "power": ("rho", "nu"), "power_sigma": ("rho", "nu")}
        return {name: (axes[name], getattr(self, name)) for name in axes}

    def plot(self, ax: Any = None, wedge: Wedge | None = None) -> Any:
        """Draws `power` in dB below its peak, on axes of matplotlib; returns the axes. Dotted lines are at whole multiples of the sampling
        rates of views and pixels. The lines of `wedge` are solid, and dashed in its replicas."""
        rho = self.rho
        ax = plotted(ax, rho, self.nu, self.power)
        limits = ax.get_xlim(), ax.get_ylim()
        rates = 1 / self.spacing["x"], 1 / self.spacing["u"]
        for rate, last, line in zip(rates, (rho[-1], self.nu[-1]), (ax.axvline, ax.axhline)):
            for m in range(-int(last / rate), int(last / rate) + 1):
                line(m * rate, color="w", linestyle=":", linewidth=0.8)
        for h in wedge.inverse_depths if wedge else ():
            beyond = int((rho[-1] + abs(h) * self.nu[-1]) / rates[0]) + 1
            for m in range(-beyond, beyond + 1):
                ax.plot(m * rates[0] - h * self.nu, self.nu, color="r", linestyle="--" if m else "-", linewidth=0.6 if m else 1.2)
        ax.set(xlim=limits[0], ylim=limits[1])
        return ax

    def __repr__(self) -> str:
        axes = ", ".join(f"1/{name} {1 / step:.4g}" for name, step in self.spacing.items())
        return f"<etendue.GridSpectrum {self.slices.shape}: repeats at {axes}>"


def grid_spectrum(
    light_field: ArrayLike,
    *,
    x: ArrayLike,
    u: ArrayLike,
    y: ArrayLike | None = None,
    v: ArrayLike | None = None,
    window: types.Window,
    frequencies: types.Frequencies,
    noise: ArrayLike | None = None,
    replicates: bool = False,
    box: str = "",
) -> GridSpectrum:
    """Computes the windowed spectrum of a light field that is sampled on a grid.

    `light_field` holds real numbers [x, y, u, v], or [x, u] without `y` and `v` (an epipolar image). x, y are the positions of views in
    metres, and u, v the slopes of pixels, in the direction in which light travels; each is evenly spaced. `window` and `frequencies` are
    those of `spectrum`, and the window is around 0.

    `noise` is the standard deviation of the independent noise of each sample, one number or an array like the light field. Or, with
    `replicates`, the light field has a first axis of 4 or more independent renderings of the same light. `box` names coordinates along
    which samples are means over cells of the grid, such as "uv" for pixels: the slices are divided by the transform of these cells.

    Raises `ValueError` if shapes do not match or a sample is not finite, and `SceneError` if the window or the frequencies are invalid.
    Warns where frequencies are above half the sampling rate, or where the window goes beyond the grid.
    """
    field = np.asarray(light_field)
    given = {name: np.asarray(at) for name, at in (("x", x), ("y", y), ("u", u), ("v", v)) if at is not None}
    sizes = tuple(at.size for at in given.values())
    if len(given) == 3 or field.dtype.kind not in "buif" or field.shape[bool(replicates) :] != sizes:
        what = f"light_field is {field.dtype} of shape {field.shape}, with {dict(zip(given, sizes))}"
        raise ValueError(f"{what}; allowed: real numbers [x, u] or [x, y, u, v], after an axis of replicates if there are any")
    if replicates and (len(field) < 4 or noise is not None):
        raise ValueError(f"there are {len(field)} replicates, noise is {noise}; allowed: 4 or more replicates, without noise")
    if not set(box) <= set(given):
        raise ValueError(f"box is {box!r}; allowed: letters of {''.join(given)}")
    if len(given) == 2:
        if frequencies.get("azimuths", 1) != 1:
            raise ValueError(f"azimuths is {frequencies.get('azimuths')} for [x, u]; allowed: 1, or nothing")
        frequencies, window = {**frequencies, "azimuths": 1}, cast(types.Window, {name: profile for name, profile in window.items() if name in "xu"})
    # A scene checks window and frequencies, and gives the axes.
    plane = Scene(around(window, frequencies), name="grid")._run.axes(0)  # pyright: ignore[reportPrivateUsage]
    azimuth, upper, all_nu = (np.asarray(plane[name], float) for name in ("azimuth", "rho", "nu"))
    rho, nu = np.concatenate([-upper[:0:-1], upper]), all_nu[all_nu.size // 2 :]
    turns = np.cos(azimuth), np.sin(azimuth)
    axes: list[Axis] = []
    for name, turn, at in (("x", turns[0], rho), ("y", turns[1], rho), ("u", turns[0], nu), ("v", turns[1], nu)):
        profile = window.get(name) or window["x" if name == "y" else "u"]
        axes.append(Axis(name, given.get(name), profile, np.outer(turn, at), name in box))
    shape = tuple(axis.weight.size for axis in axes)

    def inside(array: NDArray[Any]) -> NDArray[Any]:
        return array[tuple(axis.inside for axis in axes if axis.name in given)].reshape(shape)

    def slices(compressed: Floats) -> Complex:
        with np.errstate(over="ignore", invalid="ignore"):
            found = slices_of(compressed, axes)
            if not np.isfinite(abs(found) ** 2).all():
                raise ValueError("a sample in the window, or its power, is not finite; allowed: finite numbers below 1e100 or so")
        return found

    if replicates:
        estimates = np.array([slices(compressed_field(inside(one), axes)) for one in field])
        found = estimates.mean(0)
        sigma = np.sqrt((abs(estimates - found) ** 2).sum(0) / (len(field) * (len(field) - 1)))
    else:
        compressed = compressed_field(inside(field), axes)
        found, level = slices(compressed), np.asarray(0.0 if noise is None else noise)
        if level.dtype.kind not in "buif" or level.shape not in ((), field.shape) or not (np.isfinite(level) & (level >= 0)).all():
            raise ValueError(f"noise is {level.dtype} of shape {level.shape}; allowed: a number ≥ 0, or as many as samples")
        levels: Floats = inside(level.astype(np.float64)) if level.ndim else np.full((1, 1, 1, 1), level, np.float64)
        variance: Floats = levels**2
        for axis in axes:
            variance = (variance * (axis.weight**2).reshape(-1, *np.ones(variance.ndim - 1, int))).sum(0)
        gain = (axes[0].gain * axes[1].gain)[:, :, None] * (axes[2].gain * axes[3].gain)[:, None]
        sigma = full(gain * np.sqrt(variance))
        random = np.random.default_rng(1)
        # Bases are orthonormal: noise of one level is as independent in them as on the grid.
        draws = (
            compressed_field(levels * random.standard_normal(shape), axes)
            if level.ndim
            else level * random.standard_normal(compressed.shape)
            for _ in range(DRAWS if level.any() else 0)
        )
        each = max(1, 4 * BLOCK // compressed.size)
        parts = [found + slices(np.array(part)) for part in iter(lambda: list(islice(draws, each)), [])]
        estimates = np.concatenate([np.zeros((0, *found.shape), complex), *parts])
    kept = [axis for axis in axes if axis.name in given]
    spacing, half = {axis.name: axis.spacing for axis in kept}, {axis.name: axis.half_width for axis in kept}
    return GridSpectrum(azimuth, rho, all_nu, found, sigma, spacing, half, estimates, bool(replicates))


def _mean(power: Floats) -> Floats:
    return power.mean(0)


def _noise_dof(estimates: Complex) -> float | None:
    """The effective number of independent real numbers in the noise (Satterthwaite 1946; Srivastava 2005, Eq. 2.4)."""
    if not len(estimates):
        return None
    n = len(estimates) - 1
    centred = (estimates - estimates.mean(0)).reshape(n + 1, -1)
    size = np.sqrt((abs(centred) ** 2).sum(0) / n)
    centred = centred[:, size > 0] / size[size > 0]
    products = (centred @ centred.conj().T).real / n
    trace = products.trace()
    square = n * n / ((n - 1) * (n + 2)) * ((products**2).sum() - trace**2 / n)
    return float(np.clip(trace**2 / max(square, trace / 2), 1, max(2 * trace, 1))) if trace else None
