"""The spectrum of a user's rays."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue import types
from etendue.difference import Sample
from etendue.plot import Shown, Variables, plotted
from etendue.progress import Progress, told
from etendue.ranges import thread_count
from etendue.scene import Scene
from etendue.stages import Measurement

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Spectrum(Shown):
    """The windowed spectrum of rays, with errors."""

    azimuth: Floats
    """In radians."""
    rho: Floats
    """In cycles per metre."""
    nu: Floats
    """In cycles per unit of u."""
    slices: NDArray[np.complex128]
    """S(azimuth, rho, nu) = Σ weight · window · exp(−2πi (rho p + nu q)), p = x cos φ + y sin φ, q = u cos φ + v sin φ."""
    slices_sigma: Floats
    """Standard error of |slices|, from the spread between batches."""
    power: Floats
    """The mean of |slices|² over azimuths, [rho, nu], minus `shot_noise`. Where there is only noise, it may be negative."""
    power_sigma: Floats
    """Standard error of `power`, by the jackknife: up to √2 too large where noise is above the signal."""
    shot_noise: Floats
    """The power that the noise of the rays added; it has been subtracted."""
    x: Floats
    """Centres of the cells of the light field along x, in metres."""
    u: Floats
    """Centres of the cells of the light field along u, as slopes."""
    light_field: Floats
    """The windowed light field summed over y and v, [x, u]."""
    light_field_sigma: Floats
    """Standard error of `light_field`."""
    in_window: int
    """Rays inside the window."""
    noise_dof: float | None
    """Effective number of independent real numbers in the noise of `slices`; `None` without noise or with less than three batches."""
    batches: int
    """Number of groups of rays from which the errors are estimated."""
    slope: tuple[float, float] | None
    """Shear slope of the power, Σ power·rho·nu / Σ power·rho², in metres, and its error; `None` if no ray is in the window. The error is from
    the jackknife, and up to √2 too large if most frequencies contain only noise. The same holds for the bandwidths."""
    bandwidth_rho: tuple[float, float] | None
    """95 % bandwidth along rho in the azimuth where it is largest, and its error."""
    bandwidth_nu: tuple[float, float] | None
    """95 % bandwidth along nu in the azimuth where it is largest, and its error."""
    variation_rho: tuple[float, float] | None
    """`bandwidth_rho` of the light less its mean in the window, which tells how fast the light changes. Sampling needs this bandwidth."""
    variation_nu: tuple[float, float] | None
    """`bandwidth_nu` of the light less its mean in the window."""
    measurement: Measurement | None
    """The batches of rays at the plane "rays", for `compare` with a theory; `None` in a pickled spectrum."""

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "measurement": None}

    @property
    def sample(self) -> Sample:
        """The slices with their noise, for `difference`."""
        return Sample(self.slices, (self.azimuth, self.rho, self.nu), self.slices_sigma, self.noise_dof, self.batches)

    def _variables(self) -> Variables:
        slices, power, field = ("azimuth", "rho", "nu"), ("rho", "nu"), ("x", "u")
        axes = {"slices": slices, "slices_sigma": slices, "power": power, "power_sigma": power, "shot_noise": power}
        axes.update(light_field=field, light_field_sigma=field)
        return {name: (axes[name], getattr(self, name)) for name in axes}

    def plot(self, ax: Any = None) -> Any:
        """Draws `power` in dB below its peak, on axes of matplotlib; returns the axes."""
        return plotted(ax, self.rho, self.nu, self.power)

    def __repr__(self) -> str:
        return f"<etendue.Spectrum {self.slices.shape}: {self.in_window} rays in the window, slope {self.slope}>"


def spectrum(
    x: ArrayLike,
    y: ArrayLike,
    u: ArrayLike,
    v: ArrayLike,
    weight: ArrayLike | None = None,
    *,
    window: types.Window,
    frequencies: types.Frequencies,
    batch: ArrayLike | None = None,
    batches: int = 64,
    threads: int | None = None,
    progress: Progress = None,
) -> Spectrum:
    """Computes the spectrum of a user's rays, by the estimator of Étendue.

    x, y are positions on a plane in metres, and u, v are slopes with respect to its normal (tangents of angles); each array has one number
    per ray. `weight` is the weight of each ray, by default 1; for a spectrum of radiance it is flux times (1 + u² + v²)².

    `window` is a profile for each coordinate, such as `{"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}`; by default, y has the profile of x, and v
    that of u. 0.5 is the half-width h: cos²(π t / 2h) on |t| < h. Other profiles are `{"Box": h}` and `{"Gaussian": {"width": w, "cut": h}}`.
    `frequencies` are `{"rho": {"max": 12}, "nu": {"max": 24}}`, and optionally `"azimuths"` (8 by default). Their spacing is 1/(2h) unless
    `"spacing"` is given, and `max` is rounded up to a multiple of the spacing.

    Errors are estimated from the spread between `batches` groups of rays. Ray i is in group i modulo `batches`, which is right if the rays
    are independent of each other. If they are not (nets, paths that share a vertex), `batch` gives the group of each ray, a whole
    number; the groups must be independent.

    Returns a `Spectrum`. Raises `ValueError` if arrays do not match, and `SceneError` if the window or the frequencies are invalid.
    """
    rays = columns(x, y, u, v, weight)
    group, batches = groups(rays[0].size, batch, batches)
    plane = Scene(around(window, frequencies), method="given", name="rays")
    with told(progress) as tell:
        found: dict[str, Any] = plane._run.spectrum(  # pyright: ignore[reportPrivateUsage]
            rays, group, batches, thread_count(threads), tell
        )
    if not np.isfinite(found["power"]).all():
        raise ValueError("the power of these weights is beyond the largest number; allowed: weights below 1e100 or so")
    if found["in_window"] == 0:
        warnings.warn("no ray is inside the window: the spectrum is zero", stacklevel=2)
    found["measurement"] = Measurement(plane, found["measurement"])
    return Spectrum(**found)


def columns(x: ArrayLike, y: ArrayLike, u: ArrayLike, v: ArrayLike, weight: ArrayLike | None) -> list[Floats]:
    """x, y, u, v and weight of rays, which is 1 by default, as arrays of one size."""
    found = [_column(name, column) for name, column in (("x", x), ("y", y), ("u", u), ("v", v))]
    rays = found[0].size
    found.append(np.ones(rays) if weight is None else _column("weight", weight))
    for name, column in zip(("y", "u", "v", "weight"), found[1:]):
        if column.size != rays:
            raise ValueError(f"{name} has {column.size} numbers and x {rays}; allowed: one number per ray in each")
    return found


def _column(name: str, numbers: ArrayLike) -> Floats:
    column = np.asarray(numbers)
    if column.ndim != 1 or column.dtype.kind not in "buif":
        raise ValueError(f"{name} is {column.dtype} of shape {column.shape}; allowed: real numbers of shape (N,)")
    return np.ascontiguousarray(column, dtype=np.float64)


def groups(rays: int, batch: ArrayLike | None, batches: int) -> tuple[NDArray[np.uint32], int]:
    """The group of each ray, and the number of groups."""
    if batch is None:
        if not 2 <= batches <= rays or batches != int(batches):
            raise ValueError(f"batches is {batches} for {rays} rays; allowed: 2 to the number of rays")
        return np.arange(rays, dtype=np.uint32) % np.uint32(batches), batches
    numbers = np.asarray(batch)
    if numbers.shape != (rays,) or numbers.dtype.kind not in "biu":
        what = f"{numbers.dtype} of shape {numbers.shape}"
        raise ValueError(f"batch is {what}; allowed: a whole number for each of {rays} rays")
    # Any numbers will do: a group is told by its rank among them.
    names, group = np.unique(numbers, return_inverse=True)
    if names.size < 2:
        raise ValueError(f"batch has {names.size} different numbers; allowed: 2 or more")
    return group.astype(np.uint32), names.size


def around(window: types.Window, frequencies: types.Frequencies) -> types.Scene:
    """A scene with one plane that has this window and these frequencies, which are checked as in any scene."""
    return {
        "light": {"Rectangle": {"center": [0, 0, 0], "size": [1, 1]}},
        "surfaces": [{"Rectangle": {"name": "screen", "center": [0, 0, 1], "size": [1, 1]}}],
        "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["screen"]},
        "planes": [{"name": "rays", "at": {"Before": "screen"}}],
        "window": window,
        "frequencies": frequencies,
    }
