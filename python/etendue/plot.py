"""Arrays with named axes, and pictures of them by matplotlib."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray

Floats = NDArray[np.float64]
Variables = Mapping[str, tuple[tuple[str, ...], NDArray[Any]]]
"""Arrays by name, each with the names of its axes."""

UNITS = {"azimuth": "rad", "rho": "cycles/m", "nu": "cycles/slope", "x": "m", "u": "slope"}
"""The units of axes."""


class Shown:
    """An object whose arrays xarray holds, which matplotlib draws, and which notebooks show with that picture."""

    def _variables(self) -> Variables:
        """The arrays by name, each with the names of its axes."""
        raise NotImplementedError

    def _axes(self) -> Mapping[str, NDArray[Any]]:
        """The values of the axes, by default the attributes with their names."""
        names = {name: None for axes, _ in self._variables().values() for name in axes}
        return {name: getattr(self, name) for name in names}

    def _attributes(self) -> Mapping[str, Any]:
        """What else the dataset states."""
        return {}

    def to_xarray(self) -> xarray.Dataset:
        """The arrays as an xarray dataset, with the names, values and units of their axes. Raises `ImportError` without xarray."""
        import xarray

        coords = {name: (name, values, {"units": UNITS[name]} if name in UNITS else {}) for name, values in self._axes().items()}
        return xarray.Dataset(dict(self._variables()), coords=coords, attrs=dict(self._attributes()))

    def plot(self, ax: Any = None) -> Any:
        """Draws the object on axes of matplotlib, by default the current axes; returns the axes. Raises `ImportError` without matplotlib."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        return f"<p>{escape(str(self))}</p>{picture(self)}"


def draw_each(all: Iterable[Shown], axes: Any) -> None:
    """Draws objects, each on one of several axes of matplotlib."""
    panels: list[Any] = np.ravel(axes).tolist()
    for one, ax in zip(all, panels):
        one.plot(ax)


def table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table in HTML."""

    def line(cells: Iterable[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f"<table><thead>{line(heads, 'th')}</thead><tbody>{body}</tbody></table>"


def picture(*all: Shown) -> str:
    """An image in HTML of objects that are drawn side by side; nothing without matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return ""
    # Not a figure of pyplot: those would be shown a second time.
    figure: Any = Figure(figsize=(4.2 * len(all), 3.2), layout="constrained")
    draw_each(all, figure.subplots(1, len(all)))
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=90)
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}">'


def axes_of(ax: Any) -> Any:
    """The given axes of matplotlib, or the current axes."""
    if ax is None:
        import matplotlib.pyplot as plt

        return plt.gca()
    return ax


def plotted(ax: Any, rho: Floats, nu: Floats, power: Floats) -> Any:
    """Draws a power spectrum [rho, nu] in dB below its peak, on axes of matplotlib; returns the axes. Darkness is drawn as the floor."""
    peak = power.max()
    level = 10 * np.log10(np.maximum(power / peak, 1e-12)) if peak > 0 else np.full_like(power, -60.0)
    return mapped(ax, rho, nu, level, "dB", vmin=-60, vmax=0)


def mapped(ax: Any, rho: Floats, nu: Floats, values: Floats, label: str, **colors: Any) -> Any:
    """Draws values [rho, nu] with a bar of colours, rho to the right and nu upwards, on axes of matplotlib; returns the axes."""
    ax = axes_of(ax)
    image = ax.pcolormesh(rho, nu, values.T, shading="nearest", **colors)
    ax.set(xlabel="ρ [cycles/m]", ylabel="ν [cycles/slope]")
    ax.figure.colorbar(image, ax=ax, label=label)
    return ax


def curves(ax: Any, x: Floats, values: Floats, sigmas: Floats, labels: list[str], title: str) -> Any:
    """Draws curves [curve, x] with their standard errors and a legend with a title, on axes of matplotlib; returns the axes."""
    ax = axes_of(ax)
    for value, sigma, label in zip(values, sigmas, labels):
        ax.errorbar(x, value, sigma, capsize=2, label=label)
    ax.legend(title=title)
    return ax
