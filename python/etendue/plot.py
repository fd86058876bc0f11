"""Pictures of spectra, by matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def plotted(ax: Any, rho: Floats, nu: Floats, power: Floats) -> Any:
    """Draws a power spectrum [rho, nu] in dB below its peak, on axes of matplotlib; returns the axes."""
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.gca()
    level = 10 * np.log10(np.maximum(power, 1e-12 * power.max()) / power.max())
    image = ax.pcolormesh(rho, nu, level.T, vmin=-60, vmax=0, shading="nearest")
    ax.set(xlabel="ρ [cycles/m]", ylabel="ν [cycles/slope]")
    ax.figure.colorbar(image, ax=ax, label="dB")
    return ax


def curves(ax: Any, x: Floats, values: Floats, sigmas: Floats, labels: list[str], title: str) -> Any:
    """Draws curves [curve, x] with their standard errors and a legend with a title, on axes of matplotlib; returns the axes."""
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.gca()
    for value, sigma, label in zip(values, sigmas, labels):
        ax.errorbar(x, value, sigma, capsize=2, label=label)
    ax.legend(title=title)
    return ax
