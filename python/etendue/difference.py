"""The test whether two spectra of the same light differ by more than noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue


@dataclass(frozen=True)
class Sample:
    """The spectrum of one measurement, with its noise."""

    slices: NDArray[np.complex128]
    """[azimuth, rho, nu]."""
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


@dataclass(frozen=True)
class Difference:
    """How far two spectra of the same light are apart."""

    p_value: float | None
    """Probability of a difference at least as large if both measured the same light; `None` if both are dark."""
    chi2_per_dof: float | None
    """Mean of |A − B|² / (σ_A² + σ_B²), which is about 1 if only noise differs."""
    difference: float
    """‖A − B‖ / max(‖A‖, ‖B‖)."""
    noise: float
    """The value of `difference` that noise alone gives."""
    paired: bool = False
    """Whether batches were compared in pairs, because both spectra are of photons with the same random numbers."""

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
        pairs = of_a.slices_of_batches(), of_b.slices_of_batches(), of_a.numbers[0]
    return Difference(*_etendue.two_samples(native(of_a), native(of_b), pairs), paired=pairs is not None)
