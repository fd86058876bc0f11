"""The profiles of windows, and points in windows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

CELLS = 256
"""Number of cells in which numbers are drawn by a profile."""
STEPS = 1.1673039782614187 ** -np.arange(1.0, 5.0)
"""Multiples of these powers of the root of x⁵ = x + 1, modulo 1, are a sequence of low discrepancy in four dimensions for any number of points
(Roberts 2018)."""


def half_width(profile: Any) -> float:
    """The half-width of a profile, beyond which it is 0."""
    ((kind, value),) = dict(profile).items()
    return float(value["cut"] if kind == "Gaussian" else value)


def height(profile: Any, t: Floats) -> Floats:
    """The profile at the coordinates `t`: 1 at 0, and 0 for |t| ≥ half-width."""
    ((kind, value),) = dict(profile).items()
    half = half_width(profile)
    if kind == "Hann":
        height = np.cos(0.5 * np.pi * t / half) ** 2
    else:
        height = np.exp(-np.pi * (t / value["width"]) ** 2) if kind == "Gaussian" else np.ones_like(t)
    return np.where(abs(t) < half, height, 0.0)


class ProfileSampler:
    """Draws numbers nearly in proportion to a profile, from numbers that are uniform in [0, 1)."""

    def __init__(self, profile: Any) -> None:
        self.edges: Floats = half_width(profile) * np.linspace(-1, 1, CELLS + 1)
        t = 0.5 * (self.edges[1:] + self.edges[:-1])
        self.sums: Floats = np.concatenate([[0.0], np.cumsum(height(profile, t))])
        self.sums /= self.sums[-1]

    def draw(self, uniform: Floats) -> tuple[Floats, Floats]:
        """The numbers, and their exact densities."""
        cell = np.clip(np.searchsorted(self.sums, uniform, side="right") - 1, 0, CELLS - 1)
        share, width = np.diff(self.sums)[cell], np.diff(self.edges)[cell]
        return self.edges[cell] + width * (uniform - self.sums[cell]) / share, share / width
