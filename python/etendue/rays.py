"""The spectrum of rays of one's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue import types
from etendue.progress import Progress, told
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
    """Power over azimuths, [rho, nu], without the noise of the rays."""
    power_sigma: Floats
    """Its standard error."""
    shot_noise: Floats
    """What the noise of the rays added, and was taken away."""
    x: Floats
    u: Floats
    light_field: Floats
    """The windowed light field summed over y and v, [x, u]."""
    light_field_sigma: Floats
    in_window: int
    """Rays inside the window."""
    slope: tuple[float, float] | None
    """Shear slope of the power in metres, and its error."""
    bandwidth_rho: tuple[float, float] | None
    """95 % bandwidth along rho, and its error."""
    bandwidth_nu: tuple[float, float] | None
    """95 % bandwidth along nu, and its error."""


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
    `frequencies` are `{"rho": {"max": 12}, "nu": {"max": 24}}`, with `"azimuths"` if not 8.

    Errors come from the spread between `batches` groups of rays. Ray i is in group i modulo `batches`, which is right where rays
    are independent of each other. Where they are not (nets, paths that share a vertex), `batch` gives the group of each: groups
    must be independent.
    """
    columns = [np.ascontiguousarray(column, dtype=np.float64) for column in (x, y, u, v)]
    rays = columns[0].size
    carried = np.ones(rays) if weight is None else np.ascontiguousarray(weight, dtype=np.float64)
    if batch is None:
        group = np.arange(rays, dtype=np.uint32) % np.uint32(batches)
    else:
        group = np.ascontiguousarray(batch, dtype=np.uint32)
        batches = int(group.max(initial=0)) + 1
    plane = Scene(_around(window, frequencies), name="rays")
    with told(progress, rays, "rays") as tell:
        found: dict[str, Any] = plane._job.spectrum(  # pyright: ignore[reportPrivateUsage]
            [*columns, carried], group, batches, threads, tell
        )
    return Spectrum(**found)


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
