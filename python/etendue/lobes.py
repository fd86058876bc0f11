"""The lobes of surfaces, which convolve light over directions: part of `etendue.operators`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.ranges import finite, real, whole
from etendue.theories import Radiance

Floats = NDArray[np.float64]
Brdf = Callable[[Floats, Floats, Floats, Floats], Any]
Box = Sequence[Sequence[float]]

HALF_TURN = (-math.pi / 2, math.pi / 2)
BLOCK = 2**18
"""The largest number of directions at which a lobe evaluates arriving light at a time."""
# Roberts (2018): multiples of powers of the root of x³ = x + 1, a sequence of low discrepancy for any number of points.
STEPS = 1.324717957244746 ** -np.arange(1.0, 3.0)


@dataclass(frozen=True, eq=False)
class Lobe:
    """A BRDF, which spreads light over directions at each place: ℓ'(θₒ, φₒ) = ∫ ℓ(θ, φ) ρ dθ dφ (docs/theory.md (41)).

    Coordinates are angles in the frames of the local normals, after the cosine (`Mask.cosine`) and the mirror (`Map.mirror`). A constant
    BRDF also takes slopes, with a `box`.

    The integral is a mean over `nodes` directions, which a pseudo-random function of the outgoing ray shifts. So the mean is unbiased over
    rays, and `etendue.compare` finds its error. Raises `ValueError` if a number is out of its range.
    """

    verb: ClassVar[str] = "convolve"
    name: str
    brdf: Brdf
    """ρ(θ, φ, θₒ, φₒ) in 1/sr, with θ, φ after the mirror: the lobe is largest about θₒ = θ, φₒ = φ."""
    width: float = 1e3
    """Half of the directions are within about this angle of the outgoing one; a large width spreads them evenly."""
    law: str = "ℓ' = ∫ dE ρ dθ dφ (Eqs. 15 to 17)"
    nodes: int = 32
    box: Box = (HALF_TURN, HALF_TURN)
    """The ranges of θ and φ, after the mirror, from which light arrives."""

    def __post_init__(self) -> None:
        whole("nodes", self.nodes, 1, BLOCK)
        if real("width", self.width) <= 0:
            raise ValueError(f"width is {self.width!r}; allowed: above 0")
        low, high = finite("box", self.box, (2, 2)).T
        if not (low < high).all():
            raise ValueError(f"box is {self.box!r}; allowed: two ranges, each from a lower to a higher number")

    def sampled(self, nodes: int, box: Box | None = None) -> Lobe:
        """The lobe with another number of nodes, and light from a box of angles only."""
        return replace(self, nodes=nodes, box=self.box if box is None else box)

    @classmethod
    def lambertian(cls, albedo: float) -> Lobe:
        """A diffuse surface."""
        rho = real("albedo", albedo) / math.pi
        law = "ℓ' = (albedo/π) ∫ dE (Eqs. 6 and 7, corrected)"
        return cls(f"Lambertian, albedo {albedo:g}", lambda theta, phi, to_theta, to_phi: rho, law=law)

    @classmethod
    def phong(cls, exponent: float, albedo: float = 1.0) -> Lobe:
        """Phong's lobe of unit integral about the mirror direction (Phong 1975)."""
        n, scale = real("exponent", exponent), real("albedo", albedo) * (exponent + 1) / (2 * math.pi)
        if n <= 0:
            raise ValueError(f"exponent is {n:g}; allowed: above 0")
        return cls(f"Phong, exponent {n:g}", _of_angle(lambda cos: scale * np.maximum(cos, 0) ** n), (2 / (n + 1)) ** 0.5)

    @classmethod
    def table(cls, angles: ArrayLike, values: ArrayLike) -> Lobe:
        """A BRDF over the angle from the mirror direction in radians, ascending; interpolated linearly, and zero beyond the last angle."""
        at, value = (finite(name, numbers, np.shape(angles)) for name, numbers in (("angles", angles), ("values", values)))
        if at.ndim != 1 or at.size < 2 or not (np.diff(at) > 0).all():
            raise ValueError(f"angles has shape {at.shape}; allowed: two or more ascending numbers")
        width = max(float(at[np.argmax(value < 0.5 * value.max())]), float(at[1] - at[0]))
        brdf = _of_angle(lambda cos: np.interp(np.arccos(np.clip(cos, -1, 1)), at, value, right=0.0))
        return cls(f"table of {at.size} angles", brdf, width)

    @classmethod
    def ggx(cls, roughness: float, albedo: float = 1.0) -> Lobe:
        """Microfacets with the normals of Trowbridge and Reitz (1975), as in Walter et al. 2007, Eqs. 33 and 34."""
        a = real("roughness", roughness, nonzero=True)

        def slopes(tan2: Floats) -> Floats:
            return 1 / (np.pi * a * a * (1 + tan2 / a**2) ** 2)

        return cls._microfacets(f"GGX, α = {a:g}", slopes, lambda tan2: 2 / (1 + np.sqrt(1 + a * a * tan2)), a, albedo)

    @classmethod
    def beckmann(cls, roughness: float, albedo: float = 1.0) -> Lobe:
        """Microfacets with Beckmann's normals, as in Walter et al. 2007, Eqs. 25 and 26."""
        a = real("roughness", roughness, nonzero=True)

        def shadow(tan2: Floats) -> Floats:
            at = np.minimum(1 / (a * np.sqrt(np.maximum(tan2, 1e-30))), 30.0)
            return 2 / (1 + _erf(at) + np.exp(-at * at) / (at * np.sqrt(np.pi)))

        return cls._microfacets(f"Beckmann, α = {a:g}", lambda tan2: np.exp(-tan2 / a**2) / (np.pi * a * a), shadow, a, albedo)

    @classmethod
    def _microfacets(
        cls, name: str, slopes: Callable[[Floats], Floats], shadow: Callable[[Floats], Floats], roughness: float, albedo: float
    ) -> Lobe:
        scale = 0.25 * real("albedo", albedo)
        if not 0 < roughness <= 1:
            raise ValueError(f"roughness is {roughness:g}; allowed: above 0, up to 1")

        def brdf(theta: Floats, phi: Floats, to_theta: Floats, to_phi: Floats) -> Floats:
            (a, b, c), (to_a, to_b, to_c) = _direction(theta, phi), _direction(to_theta, to_phi)
            # Light arrives from the direction (−a, −b, c).
            tilt = ((to_a - a) ** 2 + (to_b - b) ** 2) / np.maximum(to_c + c, 1e-9) ** 2
            inside, to_inside = (np.maximum(cos, 1e-9) for cos in (c, to_c))
            shadows = shadow(inside**-2 - 1) * shadow(to_inside**-2 - 1)
            return np.where((c > 0) & (to_c > 0), scale * slopes(tilt) * (1 + tilt) ** 2 * shadows / (inside * to_inside), 0.0)

        return cls(name, brdf, 2 * abs(roughness), "ρ = D G/(4 cos θᵢ cos θₒ) (Walter et al. 2007, Eq. 20)")

    def after(self, before: Radiance) -> Radiance:
        """ℓ'(x, y, θₒ, φₒ) = ∫ ℓ(x, y, θ, φ) ρ(θ, φ, θₒ, φₒ) dθ dφ."""

        def radiance(*columns: Floats) -> Floats:
            rays = np.array(np.broadcast_arrays(*columns), np.float64)
            flat = rays.reshape(4, -1)
            step = max(1, BLOCK // self.nodes)
            blocks = [self._integral(before, flat[:, i : i + step]) for i in range(0, flat.shape[1], step)]
            return np.concatenate([*blocks, np.zeros(0)]).reshape(rays.shape[1:])

        return radiance

    def _integral(self, before: Radiance, rays: Floats) -> Floats:
        """The integral over arriving directions for rays [4, N], [N]."""
        box, to = np.asarray(self.box, np.float64)[:, :, None], rays[2:]
        # Directions have a Cauchy density about the outgoing one, cut off at the box.
        low, high = (np.arctan((box[:, end] - to) / self.width) for end in (0, 1))
        at = (np.arange(self.nodes)[:, None] * STEPS)[..., None] + _shifts(rays)
        tangent = np.tan(low + (high - low) * (at % 1))
        measure = (high - low) * self.width * (1 + tangent**2)
        theta, phi = np.moveaxis(to + self.width * tangent, 1, 0)
        x, y, to_theta, to_phi = (np.broadcast_to(row, theta.shape) for row in rays)
        weight = self.brdf(theta, phi, to_theta, to_phi) * measure[:, 0] * measure[:, 1]
        return np.mean(np.multiply(weight, before(x, y, theta, phi)), axis=0)


def _direction(theta: Floats, phi: Floats) -> tuple[Floats, Floats, Floats]:
    """The direction along (T, B, N) of a longitude and a latitude."""
    return np.cos(phi) * np.sin(theta), np.sin(phi), np.cos(phi) * np.cos(theta)


def _of_angle(of: Callable[[Floats], Floats]) -> Brdf:
    """A BRDF that depends on the cosine of the angle from the mirror direction."""

    def brdf(theta: Floats, phi: Floats, to_theta: Floats, to_phi: Floats) -> Floats:
        (a, b, c), (to_a, to_b, to_c) = _direction(theta, phi), _direction(to_theta, to_phi)
        return np.where(to_c > 0, of(a * to_a + b * to_b + c * to_c), 0.0)

    return brdf


def _erf(t: Floats) -> Floats:
    """The error function for t ≥ 0 to 1.5·10⁻⁷ (Abramowitz and Stegun 1964, 7.1.26)."""
    s = 1 / (1 + 0.3275911 * t)
    return 1 - np.exp(-t * t) * s * np.polyval(np.array([1.061405429, -1.453152027, 1.421413741, -0.284496736, 0.254829592]), s)


def _shifts(rays: Floats) -> Floats:
    """Two pseudo-random numbers for each ray, [2, N]: the bits of its coordinates, mixed by SplitMix64 (Steele et al. 2014)."""
    mixed = np.zeros(rays.shape[1], np.uint64)
    found: list[Any] = []
    for row in (*np.ascontiguousarray(rays).view(np.uint64), np.uint64(0)):
        mixed = (mixed ^ row) + np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        mixed ^= mixed >> np.uint64(31)
        found.append((mixed >> np.uint64(11)) * 2.0**-53)
    return np.array(found[-2:])
