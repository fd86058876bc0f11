"""The test whether two spectra of the same light differ by more than noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.plot import Shown, Variables, mapped
from etendue.separable import conjugated


@dataclass(frozen=True)
class Sample:
    """The spectrum of one measurement, with its noise."""

    slices: NDArray[np.complex128]
    """[azimuth, rho, nu]."""
    axes: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
    """azimuth, rho and nu."""
    slices_sigma: NDArray[np.float64]
    """Standard error of |slices|."""
    noise_dof: float | None
    """Effective number of independent real numbers in the noise; `None` without noise."""
    batches: int
    """Number of independent batches from which the errors were estimated."""
    numbers: tuple[object, ...] | None = None
    """What determines the random numbers of the photons, beginning with the seed; `None` if it is not known."""
    slices_of_batches: Callable[[], NDArray[np.complex128]] | None = None
    """Returns the slices of each batch, [batch, azimuth, rho ≥ 0, nu]."""


class Measured(Protocol):
    """A measured spectrum: a `Spectrum`, a plane of a `Result`, or what `Probe.measured` returns."""

    @property
    def sample(self) -> Sample:
        """The spectrum with its noise."""
        ...


@dataclass(frozen=True, eq=False)
class Difference(Shown):
    """How far two spectra of the same light are apart."""

    p_value: float | None
    """Probability of a difference at least as large if both measured the same light; `None` if both are dark."""
    chi2_per_dof: float | None
    """Mean of |A − B|² / (σ_A² + σ_B²), which is about 1 if only noise differs."""
    difference: float
    """‖A − B‖ / max(‖A‖, ‖B‖)."""
    noise: float
    """The value of `difference` that noise alone gives."""
    paired: bool
    """Whether batches were compared in pairs, because both spectra are of photons with the same random numbers."""
    azimuth: NDArray[np.float64]
    """In radians."""
    rho: NDArray[np.float64]
    """In cycles per metre."""
    nu: NDArray[np.float64]
    """In cycles per unit of u."""
    slices: NDArray[np.complex128]
    """B − A, [azimuth, rho, nu]."""
    slices_sigma: NDArray[np.float64]
    """Standard error of |`slices`|; 0 where neither spectrum has noise."""

    @property
    def z(self) -> NDArray[np.float64]:
        """|B − A| in standard errors, [azimuth, rho, nu]; NaN where there is no noise. Its mean square is about 1 if only noise differs."""
        return abs(self.slices) / np.where(self.slices_sigma > 0, self.slices_sigma, np.nan)

    def _variables(self) -> Variables:
        axes = ("azimuth", "rho", "nu")
        return {"slices": (axes, self.slices), "slices_sigma": (axes, self.slices_sigma), "z": (axes, self.z)}

    def _attributes(self) -> dict[str, Any]:
        return {"p_value": np.nan if self.p_value is None else self.p_value, "paired": int(self.paired)}

    def plot(self, ax: Any = None) -> Any:
        """Draws the root of the mean of z² over azimuths, on axes of matplotlib; returns the axes. It is about 1 if only noise differs."""
        z = np.sqrt(np.nan_to_num(self.z**2).mean(0))
        return mapped(ax, self.rho, self.nu, z, "difference in standard errors", vmin=0, vmax=max(3.0, float(z.max())))

    def __str__(self) -> str:
        p = "–" if self.p_value is None else f"{self.p_value:.4f}"
        return f"difference {100 * self.difference:.3f} %, noise alone {100 * self.noise:.3f} %, p {p}"


def difference(a: Measured, b: Measured) -> Difference:
    """Tests whether two spectra differ by more than noise, as `etendue diff` does.

    `a` and `b` are spectra of the same plane in the same window at the same frequencies: a `Spectrum`, a plane of a `Result` (its
    measurement), or `Probe.measured(name)`. Their rays must be independent, unless both are planes of results of the same seed, method and
    number of photons. These share their random numbers, so batches are compared in pairs, and most of their noise cancels. Raises
    `ValueError` if their frequencies differ in number, or if one has less than four batches.
    """

    def native(sample: Sample) -> tuple[Any, Any, float | None, int]:
        slices = np.ascontiguousarray(sample.slices, complex)
        return slices, np.ascontiguousarray(sample.slices_sigma, float), sample.noise_dof, sample.batches

    of_a, of_b = a.sample, b.sample
    pairs = None
    if of_a.numbers is not None and of_a.numbers == of_b.numbers and of_a.slices_of_batches and of_b.slices_of_batches:
        batches = of_a.slices_of_batches(), of_b.slices_of_batches()
        pairs = *batches, of_a.numbers[0]
    numbers = _etendue.two_samples(native(of_a), native(of_b), pairs)
    sigma = np.hypot(of_a.slices_sigma, of_b.slices_sigma)
    if pairs:
        apart = pairs[1] - pairs[0]
        sigma = conjugated(np.std(apart, 0, ddof=1) / np.sqrt(len(apart)))
    return Difference(*numbers, pairs is not None, *of_a.axes, of_b.slices - of_a.slices, sigma)
