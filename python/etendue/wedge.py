"""The wedge of a range of depths in the spectrum of a light field."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from etendue.grids import GridSpectrum

Floats = NDArray[np.float64]


class Wedge:
    """The wedge of a range of depths, measured on a spectrum. Each result is a value and its standard error.

    The light of a point at depth d has its spectrum on the line rho = −h nu with h = 1/d − 1/focus. Shares are of the power of the slices
    below half the sampling rates, without frequencies within 1/half-width of zero, which contain the mean of the light.
    """

    def __init__(self, of: GridSpectrum, d_min: float, d_max: float, *, focus: float, limit: float) -> None:
        self.inverse_depths = 1 / d_min - 1 / focus, 1 / d_max - 1 / focus
        """h of the nearest and of the farthest points, in 1/metre."""
        self.limit = limit
        """The share of the power that may alias at `spacing`, and lies above `cutoff`."""
        self._of = of
        c, s = np.cos(of.azimuth)[:, None, None], np.sin(of.azimuth)[:, None, None]
        rho, nu = of.rho[:, None] + 0 * of.nu, of.nu + 0 * of.rho[:, None]
        # Along a coordinate that is left out, frequencies are 0.
        step = {name: of.spacing.get(name, 1.0) for name in "xyuv"}
        lobes = tuple(1 / min(of.half_width[name] for name in pair if name in of.half_width) for pair in ("xy", "uv"))
        counted = np.broadcast_to((abs(rho) >= lobes[0]) | (abs(nu) >= lobes[1]), of.slices.shape)
        for cycles in (rho * c * step["x"], rho * s * step["y"], nu * c * step["u"], nu * s * step["v"]):
            # Both ends of a period are one frequency.
            counted = counted & (cycles > -0.5 + 1e-9) & (cycles < 0.5 + 1e-9)
        self._counted = counted
        across = rho + sum(self.inverse_depths) / 2 * nu
        folded = [abs(across * turn - np.round(across * turn * step[name]) / step[name]) for turn, name in ((c, "x"), (s, "y"))]
        self._folded = np.maximum(*folded)
        """Distance from the line of the mean inverse depth, along x or y, to which replicas are folded back."""
        self._slope_frequency = abs(nu) * np.maximum(abs(c), abs(s))
        self._bare = self._within(rho, (0.0, 0.0))
        self._inside = np.broadcast_to(self._within(rho, lobes), counted.shape)
        reach = (abs(self._of.rho[-1]) + max(map(abs, self.inverse_depths)) * self._of.nu[-1]) * np.array([step["x"], step["y"]]) + 1
        replicas = np.zeros(counted.shape, dtype=bool)
        for m in range(-int(reach[0]), int(reach[0]) + 1):
            for n in range(-int(reach[1]), int(reach[1]) + 1) if "y" in of.spacing else (0,):
                px, py = m / step["x"], n / step["y"]
                met = abs(px * s - py * c)[:, 0, 0] < lobes[0]
                if (m or n) and met.any():
                    replicas[met] |= self._within(rho - (px * c + py * s)[met], lobes)
        self._replicas = replicas & ~self._inside
        if not self._shares(lambda power: power.sum())[0] > 0:
            raise ValueError("there is no power above the noise at the frequencies of the wedge")

    @cached_property
    def inside(self) -> tuple[float, float]:
        """Share of the power inside the wedge, widened by the main lobe of a Hann window, 1/half-width along each axis."""
        return self._share(self._inside)

    @cached_property
    def inside_bare(self) -> tuple[float, float]:
        """Share of the power inside the wedge without widening."""
        return self._share(self._bare)

    @cached_property
    def replicas(self) -> tuple[float, float]:
        """Share of the power outside the wedge, and inside its replicas at multiples of the sampling rate of the views."""
        return self._share(self._replicas)

    def aliased(self, spacing: float) -> tuple[float, float]:
        """Share of the power that aliases if views are `spacing` apart, in metres: it lies farther than 1/(2 spacing) from the line of the
        mean inverse depth. It is 0 at the spacing of the grid, where the spectrum cannot tell aliased light."""
        if not spacing > 0:
            raise ValueError(f"spacing is {spacing}; allowed: a length above 0")
        return self._share(self._folded > (0.5 + 1e-9) / spacing)

    @cached_property
    def spacing(self) -> tuple[float, float]:
        """The largest spacing of views at which at most `limit` of the power aliases, in metres; at most the width of the window."""
        narrowest = 0.25 / self._of.half_width["x"]
        return self._shares(lambda power: 0.5 / max(self._above(self._folded, power), narrowest))

    @cached_property
    def cutoff(self) -> tuple[float, float]:
        """The frequency K along u or v above which `limit` of the power lies, in cycles per slope."""
        return self._shares(lambda power: self._above(self._slope_frequency, power))

    @property
    def chai_spacing(self) -> float:
        """The spacing of views 1/(K (1/d_min − 1/d_max)) of Chai et al. (2000, Eq. 7), with `cutoff` as K."""
        width = self.cutoff[0] * (self.inverse_depths[0] - self.inverse_depths[1])
        return 1 / width if width else inf

    def __repr__(self) -> str:
        share, spacing = self.inside, self.spacing
        return f"<etendue.Wedge: {share[0]:.4f} ± {share[1]:.4f} of the power; views at most {spacing[0]:.4g} ± {spacing[1]:.2g} m apart>"

    def _within(self, rho: Floats, lobes: tuple[float, ...]) -> NDArray[np.bool_]:
        lines = [rho + h * self._of.nu for h in self.inverse_depths]
        near = [abs(line) <= lobes[0] + abs(h) * lobes[1] for line, h in zip(lines, self.inverse_depths)]
        return near[0] | near[1] | ((lines[0] < 0) != (lines[1] < 0))

    def _shares(self, of: Callable[[Floats], Any]) -> tuple[float, float]:
        value, error = self._of.with_error(lambda power: of(np.where(self._counted, power, 0.0)))
        return float(value), float(error)

    def _share(self, where: NDArray[np.bool_]) -> tuple[float, float]:
        return self._shares(lambda power: (power * where).sum() / power.sum())

    def _above(self, frequency: Floats, power: Floats) -> float:
        """The lowest of the frequencies above which at most `limit` of the power lies."""
        order = np.argsort(np.broadcast_to(frequency, power.shape), axis=None)
        sums = np.cumsum(power.ravel()[order])
        last = np.flatnonzero(sums < (1 - self.limit) * sums[-1]).max(initial=-1)
        at = frequency.ravel()[order[min(int(last) + 1, order.size - 1)]]
        return float(at)
