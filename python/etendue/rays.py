"""The spectrum of rays of one's own."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue import types
from etendue.progress import Progress, told
from etendue.ranges import thread_count
from etendue.scene import Scene

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The windowed spectrum of rays, with errors."""

    azimuth: Floats
    """Radians."""
    rho: Floats
    """Cycles per metre."""
    nu: Floats
    """Cycles per unit of u."""
    slices: NDArray[np.complex128]
    """S(azimuth, rho, nu) = Σ weight · window · exp(−2πi (rho p + nu q)), p = x cos φ + y sin φ, q = u cos φ + v sin φ."""
    slices_sigma: Floats
    """Standard error of |slices|, from the spread between batches."""
    power: Floats
    """The mean of |slices|² over azimuths, [rho, nu] with rho ≥ 0, less `shot_noise`. Where there is only noise it may be negative."""
    power_sigma: Floats
    """Its standard error, by the jackknife: up to √2 too large where noise is above the signal."""
    shot_noise: Floats
    """What the noise of the rays added, and was taken away."""
    x: Floats
    """Centres of the cells of the light field, metres."""
    u: Floats
    """Centres of its cells, slope."""
    light_field: Floats
    """The windowed light field summed over y and v, [x, u]."""
    light_field_sigma: Floats
    """Its standard error."""
    in_window: int
    """Rays inside the window."""
    slope: tuple[float, float] | None
    """Shear slope of the power, Σ power·rho·nu / Σ power·rho², in metres, and its error; `None` where no ray is in the window. The error is by the
    jackknife, and up to √2 too large where most frequencies hold noise. So it is with the bandwidths."""
    bandwidth_rho: tuple[float, float] | None
    """95 % bandwidth along rho in the azimuth where it is largest, and its error."""
    bandwidth_nu: tuple[float, float] | None
    """95 % bandwidth along nu in the azimuth where it is largest, and its error."""

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
    """The spectrum of anybody's rays, by the estimator of Étendue.

    x, y are positions on a plane in metres, u, v slopes against its normal (tangents of angles), one of each for a ray.
    `weight` is what a ray carries, 1 unless given: for radiance, flux times (1 + u² + v²)².

    `window` is a profile for each coordinate, such as `{"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}`: y and v are as x and u unless given.
    0.5 is the half-width: cos²(π t / 2h) on |t| < h. Others are `{"Box": h}` and `{"Gaussian": {"width": w, "cut": h}}`.
    `frequencies` are `{"rho": {"max": 12}, "nu": {"max": 24}}`, with `"azimuths"` if not 8. Their spacing is 1/(2h) unless `"spacing"` is
    given, and `max` is rounded up to a multiple of it.

    Errors come from the spread between `batches` groups of rays. Ray i is in group i modulo `batches`, which is right where rays
    are independent of each other. Where they are not (nets, paths that share a vertex), `batch` gives the group of each, a whole
    number: groups must be independent.

    Returns a `Spectrum`. Raises `ValueError` where arrays do not fit together, and `SceneError` for a window or frequencies that cannot be.
    """
    columns = [_column(name, column) for name, column in (("x", x), ("y", y), ("u", u), ("v", v))]
    rays = columns[0].size
    columns.append(np.ones(rays) if weight is None else _column("weight", weight))
    for name, column in zip(("y", "u", "v", "weight"), columns[1:]):
        if column.size != rays:
            raise ValueError(f"{name} has {column.size} numbers and x {rays}; allowed: one of each for a ray")
    group, batches = _groups(rays, batch, batches)
    plane = Scene(_around(window, frequencies), name="rays")
    with told(progress) as tell:
        found: dict[str, Any] = plane._job.spectrum(  # pyright: ignore[reportPrivateUsage]
            columns, group, batches, thread_count(threads), tell
        )
    if not np.isfinite(found["power"]).all():
        raise ValueError("the power of these weights is beyond the largest number; allowed: weights below 1e100 or so")
    if found["in_window"] == 0:
        warnings.warn("no ray is inside the window: the spectrum is zero", stacklevel=2)
    return Spectrum(**found)


def _column(name: str, numbers: ArrayLike) -> Floats:
    column = np.asarray(numbers)
    if column.ndim != 1 or column.dtype.kind not in "buif":
        raise ValueError(f"{name} is {column.dtype} of shape {column.shape}; allowed: real numbers of shape (N,)")
    return np.ascontiguousarray(column, dtype=np.float64)


def _groups(rays: int, batch: ArrayLike | None, batches: int) -> tuple[NDArray[np.uint32], int]:
    """The group of each ray, and how many there are."""
    if batch is None:
        if not 2 <= batches <= rays or batches != int(batches):
            raise ValueError(f"batches is {batches} for {rays} rays; allowed: 2 to one a ray")
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


def _around(window: types.Window, frequencies: types.Frequencies) -> types.Scene:
    """A scene with one plane that has this window and these frequencies: what they may be is checked as in any scene."""
    return {
        "light": {"Rectangle": {"center": [0, 0, 0], "size": [1, 1]}},
        "surfaces": [{"Rectangle": {"name": "screen", "center": [0, 0, 1], "size": [1, 1]}}],
        "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["screen"]},
        "planes": [{"name": "rays", "at": {"Before": "screen"}}],
        "window": window,
        "frequencies": frequencies,
    }
