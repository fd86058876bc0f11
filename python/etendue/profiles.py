"""The profiles of windows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


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
