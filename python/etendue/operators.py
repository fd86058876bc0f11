"""The operators of light transport, which compose to the radiance at a plane.

>>> from etendue.operators import Chain, Light, Map, Mask
>>> chain = Chain(Light.rectangle(0.2), [Map.travel(1), Mask.rectangle((0.1, 0.4)), Map.travel(1)])
>>> result = etendue.compare(measured, {"receiver": chain.radiance})

Light is mapped (`Map`, `Warp`), multiplied (`Mask`) and convolved (`Lobe`). Rays have the coordinates (x, y, u, v) of docs/conventions.md:
positions in metres, and slopes relative to the central ray. On a surface, u and v are the angles (θ, φ) in radians. Equations "Eq. n" and
sections are those of Durand et al. 2005.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.lobes import Lobe
from etendue.ranges import finite, real, whole
from etendue.scene import Scene, Source, as_scene
from etendue.theories import Radiance

if TYPE_CHECKING:
    from etendue._etendue import Run

__all__ = ["Chain", "Light", "Lobe", "Map", "Mask", "Operator", "Warp"]

Floats = NDArray[np.float64]
Rays = tuple[Floats, Floats, Floats, Floats]
Pattern = Callable[[Floats, Floats], Any]
"""A function of two coordinates, as arrays."""
Pair = Union[float, Sequence[float]]
"""Two numbers for the two axes, or one number for both."""
Axis = Literal["x", "y"]


class Operator(Protocol):
    """What happens to light."""

    verb: ClassVar[str]
    """map, multiply or convolve."""

    @property
    def name(self) -> str:
        """What the operator is, with its sizes."""
        ...

    @property
    def law(self) -> str:
        """The equation of the operator."""
        ...

    def after(self, before: Radiance) -> Radiance:
        """The radiance after the operator, as a function of rays, for the radiance before it."""
        ...


@dataclass(frozen=True, eq=False, repr=False)
class Map:
    """An affine map of rays, z' = A z + t, which keeps radiance (docs/theory.md (1)).

    Raises `ValueError` unless A has 4 × 4 finite numbers and an inverse, and t has four finite numbers.
    """

    verb: ClassVar[str] = "map"
    matrix: NDArray[Any]
    """A, [4, 4], read-only; rows and columns are x, y, u, v."""
    offset: NDArray[Any] = field(default_factory=lambda: np.zeros(4))
    """t, [4], read-only."""
    name: str = "affine map"
    law: str = ""

    def __post_init__(self) -> None:
        for name, shape in (("matrix", (4, 4)), ("offset", (4,))):
            object.__setattr__(self, name, finite(f"{name} of {self.name}", getattr(self, name), shape))
        if not np.linalg.cond(self.matrix) < 1e12:
            raise ValueError(f"the matrix of {self.name} has no inverse; allowed: condition numbers below 1e12")

    @classmethod
    def travel(cls, distance: float) -> Map:
        """Travel over a distance in metres between planes perpendicular to the central ray. Exact for slopes."""
        d = real("distance", distance)
        return cls(np.kron([[1, d], [0, 1]], np.eye(2)), name=f"travel {d:g} m", law="(x, y)' = (x, y) + d (u, v) (Eq. 3)")

    @classmethod
    def lens(cls, focal_length: float) -> Map:
        """A thin lens of a focal length in metres, positive if it converges light. Exact for rays; radiance to second order."""
        f = real("focal_length", focal_length, nonzero=True)
        law = "(u, v)' = (u, v) − (x, y)/f (theory.md (24))"
        return cls(np.kron([[1, 0], [-1 / f, 1]], np.eye(2)), name=f"lens, f = {f:g} m", law=law)

    @classmethod
    def rotation(cls, angle: float) -> Map:
        """A rotation of the axes about the central ray, from x towards y, in radians. Exact for slopes."""
        a = real("angle", angle)
        c, s = math.cos(a), math.sin(a)
        law = "x' = x cos a + y sin a, y' = −x sin a + y cos a, (u, v) alike (section 5.2)"
        return cls(np.kron(np.eye(2), [[c, s], [-s, c]]), name=f"rotation {a:g} rad", law=law)

    @classmethod
    def incidence(cls, angle: float) -> Map:
        """From the central ray to the tangent plane, at which it arrives at the angle θ₀ in radians. Exact for angles; positions are of
        first order."""
        a = _angle(angle)
        law = "s = −x/cos θ₀, t = y, θ' = θ + θ₀, φ' = −φ (Eq. 9, corrected)"
        return cls(np.diag([-1 / math.cos(a), 1, 1, -1]), np.array([0, 0, a, 0]), f"incidence {a:g} rad", law)

    @classmethod
    def outgoing(cls, angle: float) -> Map:
        """From the tangent plane to the central ray, which leaves at the angle θ₁ in radians: −θ₀ for a mirror. As exact as `incidence`."""
        a = _angle(angle)
        law = "x = s cos θ₁, y = t, θ' = θ − θ₁, φ' = φ (Eq. 10, corrected)"
        return cls(np.diag([math.cos(a), 1, 1, 1]), np.array([0, 0, -a, 0]), f"outgoing {a:g} rad", law)

    @classmethod
    def curvature(cls, curvature: ArrayLike, angle: float = 0.0) -> Map:
        """From the tangent plane to the frames of the local normals, for light about the angle θ₀. `curvature` is 1/R in 1/m, positive for
        convex surfaces; or the curvatures along (T, B); or the shape operator M, [2, 2]."""
        return cls._tilt("curvature", curvature, angle, -1, "(θ, φ)' = (θ, φ) − diag(1, cos θ₀) M (s, t) (Eqs. 11 and 19, corrected)")

    @classmethod
    def back(cls, curvature: ArrayLike, angle: float = 0.0) -> Map:
        """From the frames of the local normals to the tangent plane, for light that leaves about the angle θ₁: −θ₀ for a mirror."""
        return cls._tilt("back", curvature, angle, 1, "(θ, φ)' = (θ, φ) + diag(1, cos θ₁) M (s, t) (section 4.1, step 6)")

    @classmethod
    def _tilt(cls, name: str, curvature: ArrayLike, angle: float, sign: int, law: str) -> Map:
        given, a = np.asarray(curvature), _angle(angle)
        shape = finite("curvature", given if given.ndim == 2 else np.diag(_pair("curvature", given)), (2, 2))
        shear = np.kron([[0, 0], [sign, 0]], np.diag([1, math.cos(a)]) @ shape)
        return cls(np.eye(4) + shear, name=f"{name} {given.tolist()} /m at {a:g} rad", law=law)

    @classmethod
    def mirror(cls) -> Map:
        """The mirror in the frames of the local normals. The BRDF of an ideal mirror is δ/cos θ, so no cosine is needed."""
        return cls(np.diag([1, 1, -1, -1]), name="mirror", law="(θ, φ)' = −(θ, φ) (Eq. 14)")

    @classmethod
    def refraction(cls, ratio: float, angle: float = 0.0) -> Map:
        """Refraction in the frames of the local normals, for light about the angle θ₀. `ratio` is n₁/n₂, the index before the surface over
        that behind it. `Map.incidence(θ₂).inverse` leads to the central ray, and `Mask.constant(ratio**-2)` gives the radiance."""
        n, a = real("ratio", ratio), _angle(angle)
        if n <= 0 or n * abs(math.sin(a)) >= 1:
            raise ValueError(f"ratio is {n:g} at {a:g} rad; allowed: above 0, and without total reflection")
        after = math.asin(n * math.sin(a))
        scale = n * math.cos(a) / math.cos(after)
        law = "θ' = θ₂ + (n₁ cos θ₀/n₂ cos θ₂)(θ − θ₀), φ' = (n₁/n₂) φ (theory.md (27))"
        return cls(np.diag([1, 1, scale, n]), np.array([0, 0, after - scale * a, 0]), f"refraction {n:g} at {a:g} rad", law)

    def __matmul__(self, first: Map) -> Map:
        if not isinstance(first, Map):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise TypeError(f"a map composes with a map, not with {type(first).__name__}; put both into a Chain")
        return Map(self.matrix @ first.matrix, self.matrix @ first.offset + self.offset, f"{self.name} @ {first.name}")

    @property
    def inverse(self) -> Map:
        """The map from rays after to rays before."""
        matrix = np.linalg.inv(self.matrix)
        return Map(matrix, -(matrix @ self.offset), f"({self.name})⁻¹")

    @property
    def of_spectra(self) -> Map:
        """Where content of the spectrum at (Ωx, Ωy, Ωu, Ωv) moves: A⁻ᵀ, without offset (docs/theory.md (1))."""
        return Map(np.linalg.inv(self.matrix).T, name=f"spectrum of {self.name}")

    def __call__(self, x: ArrayLike, y: ArrayLike, u: ArrayLike, v: ArrayLike) -> Rays:
        return self._moved(*_rays(x, y, u, v))

    def _moved(self, *rays: Floats) -> Rays:
        # Most entries are 0 or 1, and rays may be broadcast, so this is several times as fast as a matrix product.
        columns: list[Any] = [
            sum((z if a == 1 else a * z for a, z in zip(row, rays) if a), start=t or 0)
            for row, t in zip(self.matrix, self.offset)
        ]
        return (columns[0], columns[1], columns[2], columns[3])

    def covariance(self, before: ArrayLike) -> Floats:
        """The covariance of rays after the map, A C Aᵀ, [4, 4] (docs/theory.md (23)). The covariance of spectra is that of `of_spectra`."""
        return self.matrix @ finite("the covariance", before, (4, 4)) @ self.matrix.T

    def after(self, before: Radiance) -> Radiance:
        """ℓ'(z) = ℓ(A⁻¹(z − t))."""
        inverse = self.inverse
        return lambda x, y, u, v: before(*inverse._moved(x, y, u, v))

    def __repr__(self) -> str:
        rows = np.array2string(np.column_stack([self.matrix, self.offset]), precision=6, suppress_small=True)
        return f"<etendue.operators.Map {self.name}: {self.law}\n{rows}>"


@dataclass(frozen=True, eq=False)
class Warp:
    """A map of rays that need not be affine, and keeps radiance."""

    verb: ClassVar[str] = "map"
    name: str
    back: Callable[[Floats, Floats, Floats, Floats], Rays]
    """The rays before the map for rays (x, y, u, v) after it."""
    law: str = ""

    @classmethod
    def to_angles(cls) -> Warp:
        """From slopes to longitude and latitude (plane-sphere parameterisation), before the steps on a surface. Exact."""
        law = "θ = atan u, φ = atan(v cos θ) (section 2.1)"
        return cls("slopes to angles", lambda x, y, u, v: (x, y, np.tan(u), np.tan(v) / np.cos(u)), law)

    @classmethod
    def to_slopes(cls) -> Warp:
        """From longitude and latitude to slopes, after the steps on a surface. Exact."""
        law = "u = tan θ, v = tan φ/cos θ (section 2.1)"
        return cls("angles to slopes", lambda x, y, u, v: (x, y, np.arctan(u), np.arctan(v / np.sqrt(1 + u * u))), law)

    def after(self, before: Radiance) -> Radiance:
        """ℓ'(z) = ℓ(back(z))."""
        return lambda x, y, u, v: before(*self.back(x, y, u, v))


@dataclass(frozen=True, eq=False)
class Mask:
    """A factor that multiplies radiance: a function of (x, y, u, v), which must not change its arguments."""

    verb: ClassVar[str] = "multiply"
    name: str
    factor: Radiance
    law: str = "ℓ' = ℓ V(x, y) (Eq. 4)"

    @classmethod
    def pattern(cls, transmission: Pattern, name: str = "pattern") -> Mask:
        """A mask or a texture: the transmission at (x, y), as a function of arrays."""
        return cls(name, lambda x, y, u, v: transmission(x, y))

    @classmethod
    def rectangle(cls, size: Pair, center: Pair = 0.0, opaque: bool = False) -> Mask:
        """A rectangular hole in an opaque screen, or an opaque rectangle; in metres."""
        inside, name = _rectangle(size, center)
        return cls.pattern(lambda x, y: inside(x, y) ^ opaque, f"{'opaque' if opaque else 'open'} {name}")

    @classmethod
    def bars(cls, count: int, pitch: float, fill: float, axis: Axis = "x") -> Mask:
        """Opaque bars whose centres are a pitch in metres apart along an axis, as `Bars` of a scene. `fill` is width / pitch."""
        n, p, share, of = whole("count", count, 1, 10**9), real("pitch", pitch, nonzero=True), real("fill", fill), _axis(axis)
        if not 0 <= share <= 1:
            raise ValueError(f"fill is {share:g}; allowed: 0 to 1")

        def transmission(x: Floats, y: Floats) -> Any:
            at = of(x, y) / p + 0.5 * n
            return 1.0 - ((at >= 0) & (at < n) & (abs(at % 1 - 0.5) < 0.5 * share))

        return cls.pattern(transmission, f"{n} bars along {axis}, pitch {p:g} m, fill {share:g}")

    @classmethod
    def grating(cls, frequency: float, modulation: float = 1.0, phase: float = 0.0, axis: Axis = "x") -> Mask:
        """A semi-transparent grating ½ (1 + m cos(2πft + p)) along an axis, with f in cycles per metre, as `Grating` of a scene."""
        f, m, p, of = real("frequency", frequency), real("modulation", modulation), real("phase", phase), _axis(axis)
        return cls.pattern(lambda x, y: 0.5 + 0.5 * m * np.cos(2 * np.pi * f * of(x, y) + p), f"grating {f:g} /m along {axis}")

    @classmethod
    def constant(cls, factor: float) -> Mask:
        """A constant factor."""
        value = real("factor", factor)
        return cls(f"constant {value:g}", lambda x, y, u, v: value, "ℓ' = constant · ℓ")

    @classmethod
    def cosine(cls, of: Literal["angles", "slopes"] = "angles") -> Mask:
        """The cosine of incidence with the measure of directions: per dθ dφ on a surface, or per du dv on a plane perpendicular to the
        central ray. A plane that records `DifferentialIrradiance` has this factor."""
        if of == "slopes":
            return cls("cosine of slopes", lambda x, y, u, v: (1 + u * u + v * v) ** -2.0, "dE = ℓ (1 + u² + v²)⁻² (Eq. 7)")
        if of != "angles":
            raise ValueError(f"of is {of!r}; allowed: 'angles' or 'slopes'")
        return cls("cosine", lambda x, y, u, v: np.maximum(np.cos(u), 0) * np.cos(v) ** 2, "dE = ℓ cos⁺θ cos²φ (Eq. 12; theory.md (41))")

    def after(self, before: Radiance) -> Radiance:
        """ℓ'(z) = V(z) ℓ(z)."""
        return lambda x, y, u, v: np.multiply(self.factor(x, y, u, v), before(x, y, u, v))


@dataclass(frozen=True, eq=False)
class Light:
    """A source of light, which is itself a function of rays (x, y, u, v)."""

    name: str
    radiance: Radiance

    @classmethod
    def rectangle(cls, size: Pair, *, radiance: float = 1.0, center: Pair = 0.0) -> Light:
        """A Lambertian rectangle of a size in metres, in the plane where rays begin."""
        (inside, name), scale = _rectangle(size, center), real("radiance", radiance)
        return cls(f"{name}, radiance {scale:g}", lambda x, y, u, v: scale * inside(x, y))

    @classmethod
    def gaussian(cls, position: float, slope: float, *, radiance: float = 1.0) -> Light:
        """Light with the standard deviations `position` in metres and `slope` about the central ray."""
        p, s, scale = real("position", position, nonzero=True), real("slope", slope, nonzero=True), real("radiance", radiance)

        def radiance_of(x: Floats, y: Floats, u: Floats, v: Floats) -> Floats:
            return scale * np.exp(-0.5 * ((x * x + y * y) / p**2 + (u * u + v * v) / s**2))

        return cls(f"Gaussian {p:g} m, slope {s:g}, radiance {scale:g}", radiance_of)

    @classmethod
    def environment(cls, radiance: Pattern, name: str = "environment") -> Light:
        """Light from far away: the radiance at slopes (u, v), as a function of arrays."""
        return cls(name, lambda x, y, u, v: radiance(u, v))

    def __call__(self, x: Floats, y: Floats, u: Floats, v: Floats) -> ArrayLike:
        return self.radiance(x, y, u, v)


@dataclass(frozen=True, eq=False)
class Chain:
    """A light, and the operators in the order in which its light meets them. Raises `TypeError` for anything else."""

    light: Radiance
    """A `Light`, or a function radiance(x, y, u, v)."""
    operators: Sequence[Operator] = ()

    def __post_init__(self) -> None:
        if isinstance(self.operators, Map):
            raise TypeError("the operators of a chain are a list of maps, masks and lobes, not one of them")
        object.__setattr__(self, "operators", tuple(self.operators))
        if not callable(self.light) or not all(callable(getattr(operator, "after", None)) for operator in self.operators):
            raise TypeError("a chain has a light, which is a function of rays, and a list of maps, masks and lobes")

    def __call__(self, x: ArrayLike, y: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
        """`radiance`, so that a chain is a radiance function, and the light of another chain."""
        return self.radiance(x, y, u, v)

    @classmethod
    def of_plane(cls, scene: Scene | Source, plane: str) -> Chain:
        """The chain from the light of a scene to a plane, between parallel planes or along mirrors, interfaces and lenses.

        Its maps are those of Étendue's theory. Masks on the first leg are included; what else stands beside the path is not. Raises `KeyError`
        if there is no such plane, and `ValueError` if no chain of these operators leads to it, or the light is no rectangle, disc or spot.
        """
        scene = as_scene(scene)
        names = [known.name for known in scene.planes]
        if plane not in names:
            raise KeyError(f"no plane {plane!r}; there are {', '.join(names)}")
        run, index = scene._run, names.index(plane)  # pyright: ignore[reportPrivateUsage]
        steps = run.chain(index)
        if steps is None:
            raise ValueError(f"plane {plane} has no chain of maps; allowed: one light, and only mirrors, interfaces and lenses before the plane")
        operators: list[Operator] = []
        for number, (words, kind, moved) in enumerate(steps):
            name = " ".join(words.split()[1:])
            if moved is not None:
                matrix, offset, factor = moved
                operators.append(Map(np.array(matrix), np.array(offset), name))
                if abs(factor - 1) > 1e-12:  # rounding of a determinant
                    operators.append(Mask.constant(factor))
            elif kind == "mask":
                operators.append(Mask.pattern(_transmission(run, index, number), name))
            elif kind in ("slopes", "angles"):
                operators.append(Mask.cosine(kind))
            else:
                raise ValueError(f"the chain of plane {plane} has a step that is no operator: {words}; compose it from `Lobe` and others")
        return cls(_light(scene.file["light"]), operators)

    def radiance(self, x: ArrayLike, y: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
        """The radiance of rays after the last operator, as an array of their common shape; `etendue.compare` takes this function."""
        # The light may change its arguments, which masks and lobes use again.
        found: Radiance = lambda x, y, u, v: self.light(*_rays(x, y, u, v))  # noqa: E731
        for operator in self.operators:
            found = operator.after(found)
        rays = _rays(x, y, u, v)
        return np.array(np.broadcast_to(np.asarray(found(*rays)), rays.shape[1:]))

    def then(self, *operators: Operator) -> Chain:
        """The chain with further operators."""
        return Chain(self.light, [*self.operators, *operators])

    def replace(self, index: int, *operators: Operator) -> Chain:
        """The chain with another operator at an index, or with several, or with none."""
        if not -len(self) <= index < len(self):
            raise IndexError(f"index is {index}; the chain has {len(self)} operators")
        i = index % len(self)
        return Chain(self.light, [*self.operators[:i], *operators, *self.operators[i + 1 :]])

    @overload
    def __getitem__(self, index: slice) -> Chain: ...
    @overload
    def __getitem__(self, index: int) -> Operator: ...
    def __getitem__(self, index: slice | int) -> Chain | Operator:
        """The chain of some operators, or one operator."""
        return Chain(self.light, self.operators[index]) if isinstance(index, slice) else self.operators[index]

    def __len__(self) -> int:
        return len(self.operators)

    def __str__(self) -> str:
        rows = [("source", getattr(self.light, "name", "function"), ""), *((o.verb, o.name, o.law) for o in self.operators)]
        width = max(len(name) for _, name, _ in rows)
        return "\n".join(f"{verb:8}  {name:{width}}  {law}".rstrip() for verb, name, law in rows)


def _transmission(run: Run, plane: int, step: int) -> Pattern:
    def transmission(x: Floats, y: Floats) -> Floats:
        x, y = np.broadcast_arrays(x, y)
        return run.transmittance(plane, step, x.ravel(), y.ravel()).reshape(x.shape)

    return transmission


def _light(file: Mapping[str, Any]) -> Light:
    """The light of a scene file, about the start of the central ray."""
    ((kind, of),) = file.items()
    if kind not in ("Rectangle", "Disc", "Spot"):
        raise ValueError(f"the light is a {kind}; allowed: Rectangle, Disc or Spot, because others have no radiance in (x, y, u, v)")
    bulb: dict[str, Any] = of.get("bulb", {"Disc": of["radius"]} if kind == "Disc" else {"Square": of.get("size")})
    ((shape, size),) = bulb.items()
    scale, exponent = real("radiance", of["radiance"]), real("exponent", of.get("exponent", 0.0))
    inside, name = _disc(size) if shape == "Disc" else _rectangle(size, 0.0)

    def radiance(x: Floats, y: Floats, u: Floats, v: Floats) -> Floats:
        return scale * inside(x, y) * (1 + u * u + v * v) ** (-0.5 * exponent)

    return Light(f"{name}, radiance {scale:g}{f' cosⁿθ, n = {exponent:g}' if exponent else ''}", radiance)


def _rays(x: ArrayLike, y: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
    """Rays as one new array [4, …]."""
    columns = [np.asarray(column) for column in (x, y, u, v)]
    for name, column in zip("xyuv", columns):
        if column.dtype.kind not in "buif":
            raise ValueError(f"{name} is {column.dtype}; allowed: real numbers")
    return np.array(np.broadcast_arrays(*columns), dtype=np.float64)


def _pair(name: str, values: ArrayLike) -> Floats:
    return finite(name, np.full(2, values) if np.ndim(values) == 0 else values, (2,))


def _angle(angle: float) -> float:
    if not abs(number := real("angle", angle)) < math.pi / 2:
        raise ValueError(f"angle is {number:g} rad; allowed: between −π/2 and π/2")
    return number


def _axis(axis: str) -> Callable[[Floats, Floats], Floats]:
    if axis not in ("x", "y"):
        raise ValueError(f"axis is {axis!r}; allowed: 'x' or 'y'")
    return lambda x, y: x if axis == "x" else y


def _rectangle(size: Pair, center: Pair) -> tuple[Callable[[Floats, Floats], NDArray[np.bool_]], str]:
    (w, h), (a, b) = _pair("size", size), _pair("center", center)
    return lambda x, y: (abs(x - a) < 0.5 * w) & (abs(y - b) < 0.5 * h), f"rectangle {w:g} x {h:g} m"


def _disc(radius: float) -> tuple[Callable[[Floats, Floats], NDArray[np.bool_]], str]:
    return lambda x, y: x * x + y * y < radius**2, f"disc of radius {radius:g} m"
