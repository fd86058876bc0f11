"""Windowed sums over grids, one axis after the other."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from etendue.profiles import half_width, height

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

BLOCK = 1 << 22
"""Number of values that are computed at a time."""


class Axis:
    """A coordinate: its samples in the window, and their exponentials in an orthonormal basis."""

    def __init__(self, name: str, at: NDArray[Any] | None, profile: Any, frequencies: Floats, box: bool) -> None:
        self.name, self.half_width = name, half_width(profile)
        if at is None:
            at, self.spacing, self.inside, self.weight = np.zeros(1), 1.0, slice(None), np.ones(1)
        else:
            if at.ndim != 1 or at.size < 2 or at.dtype.kind not in "iuf" or not np.isfinite(at).all():
                raise ValueError(f"{name} is {at.dtype} of shape {at.shape}; allowed: two or more finite real numbers, evenly spaced")
            at = at.astype(np.float64)
            step = (at[-1] - at[0]) / (at.size - 1)
            # Numbers of 32 bits are rounded.
            if not (abs(np.diff(at) - step) < 1e-3 * abs(step)).all():
                raise ValueError(f"{name} has steps from {np.diff(at).min():.6g} to {np.diff(at).max():.6g}; allowed: equal steps, not 0")
            self.spacing = abs(step)
            weight = self.spacing * height(profile, at)
            used = np.flatnonzero(weight)
            if not used.size:
                raise ValueError(f"no sample of {name}, {at.min():.6g} to {at.max():.6g}, is inside the window, ± {self.half_width:.6g}")
            if max(at.min() + self.half_width, self.half_width - at.max()) > (1 + 1e-6) * self.spacing:
                what = f"{name} is from {at.min():.6g} to {at.max():.6g}, and the window ± {self.half_width:.6g}"
                warnings.warn(f"{what}: the light field counts as 0 where there is no sample", stacklevel=3)
            self.inside = slice(int(used[0]), int(used[-1]) + 1)
            at, self.weight = at[self.inside], weight[self.inside]
        highest = float(abs(frequencies).max())
        self.gain: Floats = np.ones(frequencies.shape)
        if highest * self.spacing > 0.5 + 1e-9:
            what = f"frequencies along {name} reach {highest:.6g}, above half the sampling rate, {0.5 / self.spacing:.6g}"
            if box:
                raise ValueError(f"{what}; allowed with box: at most half the sampling rate")
            warnings.warn(f"{what}: there the spectrum repeats lower frequencies", stacklevel=3)
        if box:
            self.gain /= np.sinc(frequencies * self.spacing)
        self.basis: Floats | None = None
        # Chebyshev interpolation in the frequency converges for more than 2π highest · half-width points (Trefethen 2013).
        count = int(pi * highest * self.half_width) + 30
        if 2 * count < at.size:
            nodes = 2 * pi * highest * np.cos(pi * (np.arange(count) + 0.5) / (2 * count))
            phases = np.outer(at, nodes)
            vectors, sizes, _ = np.linalg.svd(self.weight[:, None] * np.hstack([np.cos(phases), np.sin(phases)]), full_matrices=False)
            self.basis = vectors[:, : np.count_nonzero(sizes > 1e-14 * sizes[0])]
        waves: Any = self.weight * np.exp(-2j * pi * frequencies[:, :, None] * at) * self.gain[:, :, None]
        self.waves: Complex = waves if self.basis is None else waves @ self.basis
        """[azimuth, frequency, member of the basis]."""

    def compressed(self, samples: Floats, axis: int) -> Floats:
        return samples if self.basis is None else np.moveaxis(np.tensordot(samples, self.basis, (axis, 0)), -1, axis)


def compressed_field(field: Iterable[NDArray[Any]], axes: list[Axis]) -> Floats:
    """A light field [x, y, u, v] in the bases of its axes, from one x after the other, so that little memory is used."""
    rows: list[Floats] = []
    for views in field:
        row = np.asarray(views, dtype=np.float64)
        for k in (2, 1, 0):
            row = axes[k + 1].compressed(row, k)
        rows.append(row)
    return axes[0].compressed(np.array(rows), 0)


def slices_of(compressed: Floats, axes: list[Axis]) -> Complex:
    """The slices [..., azimuth, rho, nu] of light fields [..., x, y, u, v] in the bases of their axes."""
    *rest, u, v = compressed.shape
    views, few, many = compressed.reshape(-1, u, v), axes[2].waves, axes[3].waves
    if u > v:
        views, few, many = views.swapaxes(1, 2), many, few
    azimuths, count, _ = many.shape
    block = max(1, BLOCK // (len(views) * count))
    half: list[Complex] = []
    for k in range(azimuths):
        # Products of real matrices take half the time: real and imaginary parts are columns.
        columns = np.ascontiguousarray(many[k].T).view(np.float64)
        pixels = np.zeros((len(views), count), complex)
        for begin in range(0, few.shape[2], block):
            part = slice(begin, begin + block)
            pixels += np.einsum("npf,fp->nf", (views[:, part] @ columns).view(complex), few[k, :, part])
        across = np.einsum("gy,...xyf->...xgf", axes[1].waves[k], pixels.reshape(*rest, count))
        half.append(np.einsum("gx,...xgf->...gf", axes[0].waves[k], across))
    return full(np.stack(half, -3))


def conjugated(half: NDArray[Any]) -> NDArray[Any]:
    """Slices of a real light field for all rho, from those with rho ≥ 0."""
    return np.concatenate([half[..., :0:-1, ::-1].conj(), half], axis=-2)


def full(half: NDArray[Any]) -> NDArray[Any]:
    """Slices of a real light field for all nu, from those with nu ≥ 0."""
    return np.concatenate([half[..., ::-1, :0:-1].conj(), half], axis=-1)
