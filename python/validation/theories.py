"""Theories as a user writes them, in NumPy alone, against photons: are right ones accepted and wrong ones rejected?

Prints results/own-theories.md, in about ten minutes of one core (`--seeds` and `--only` shorten this). Run: python python/validation/theories.py [--seeds N] [--only NAME]
"""

from __future__ import annotations

import argparse
import math
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

import etendue

Tree = dict[str, Any]
X, U = 0.3, 0.25
"""Half-widths of the windows of most scenes."""
CELLS = 1200


# What a user needs: axes, a Hann window, a Fourier transform, and points on a lamp.


def axes(x: float = X, u: float = U) -> tuple[Any, Any]:
    return np.arange(5) / (2 * x), np.arange(-4, 5) / (2 * u)


def hann(t: Any, half: float) -> Any:
    return np.cos(np.pi * t / (2 * half)) ** 2 * (abs(t) < half)


def along(field: Callable[[Any, Any], Any], sign: float = -1, narrow: float = 1, x: float = X, u: float = U) -> Any:
    """The spectrum along (x, u) of a windowed field, by the midpoint rule."""
    rho, nu = axes(x, u)
    px, pu = (half * (2 * np.arange(CELLS) + 1 - CELLS) / CELLS for half in (x, u))
    seen = field(px[:, None], pu) * np.outer(hann(px, narrow * x), hann(pu, narrow * u)) * (2 * x / CELLS) * (2 * u / CELLS)
    return np.exp(sign * 2j * np.pi * np.outer(rho, px)) @ seen @ np.exp(sign * 2j * np.pi * np.outer(pu, nu))


def slices(one: Any, other: Any) -> Any:
    """The slices at 0 and 90 degrees of a product of a field of (x, u) and one of (y, v)."""
    return np.array([one * other[0, 4], other * one[0, 4]])


def inside(at: Any, size: float, center: float = 0) -> Any:
    """1 within an interval; a cell on its edge counts by the part that is inside."""
    return np.clip((size / 2 - abs(at - center)) * CELLS / (2 * X) + 0.5, 0, 1)


def lamp(size: tuple[float, float], nodes: int = 6) -> tuple[Any, Any, Any]:
    """Positions on a lamp and their areas, by Gauss and Legendre."""
    at, weight = np.polynomial.legendre.leggauss(nodes)
    x, y = (a.ravel() for a in np.meshgrid(size[0] / 2 * at, size[1] / 2 * at, indexing="ij"))
    return x, y, np.outer(weight, weight).ravel() * size[0] * size[1] / 4


# The theories. Arguments with defaults are the places of faults.


def travel(sign: int = 1, swapped: bool = False) -> Any:
    one, other = (along(lambda x, u: inside(x - sign * u, size)) for size in (0.2, 0.1))
    return slices(other, one) if swapped else slices(one, other)


def slit(ox: Any, oy: Any, ou: Any, ov: Any, factor: float = 1, jacobian: bool = True) -> Any:
    def part(a: Any, b: Any, hole: float, center: float) -> Any:
        to_lamp, to_slit = 2 * (0.5 * a + b), 2 * (a + b)
        field = 0.3 * np.sinc(0.3 * to_lamp) * hole * np.sinc(hole * to_slit) * np.exp(-2j * np.pi * center * to_slit)
        return 2 * field if jacobian else field

    return factor * part(ox, ou, 0.06, 0.02) * part(oy, ov, 0.2, 0)


def grating(sign: float = -1, narrow: float = 1) -> Any:
    def field(x: Any, u: Any) -> Any:
        return inside(x - u, 0.2) * (1 + 0.8 * np.cos(2 * np.pi * 8 * (x - 0.5 * u) + 0.5)) / 2

    return slices(along(field, sign, narrow), along(lambda x, u: inside(x - u, 0.2), sign, narrow))


def point(distance: float = 1.5, oblique: bool = True, jacobian: bool = True) -> Any:
    """An isotropic point has L = I (1 + u² + v²)^½ δ(x − Du) δ(y − Dv)."""
    rho, nu = axes(0.4)
    u = U * (2 * np.arange(400) + 1 - 400) / 400
    window = hann(u, U) * hann(distance * u, 0.4) * (2 * U / 400)
    light = np.outer(window, window) * (np.sqrt(1 + u[:, None] ** 2 + u**2) if oblique else 1)
    wave = np.exp(-2j * np.pi * (distance * rho[:, None, None] + nu[:, None]) * u)
    one = wave @ light.sum(axis=1) * (1 if jacobian else distance**2)
    return np.array([one, one])


def irradiance(x: Any, y: Any, size: tuple[float, float], cosines: int = 2, falls: int = 2) -> Any:
    """The irradiance 1 m below a lamp: cos² θ / r²."""
    found = np.zeros(x.size)
    for lx, ly, area in zip(*lamp(size)):
        found += area * (1 + (x - lx) ** 2 + (y - ly) ** 2) ** (-(cosines + falls) / 2)
    return found


def diffuse(x: Any, y: Any, u: Any, v: Any, **fault: int) -> Any:
    return 0.5 / np.pi * irradiance(x, y, (0.6, 0.3), **fault)


def mirror(x: Any, y: Any, u: Any, v: Any, curvature: float = -0.5, reverse: int = -1, tilt: float = 0.3) -> Any:
    """Follows the ray back to the sphere, and from there to the lamp."""
    normal = np.array([math.sin(tilt), 0, -math.cos(tilt)])
    to_x, to_d = reverse * np.array([math.cos(2 * tilt), 0, math.sin(2 * tilt)]), np.array([math.sin(2 * tilt), 0, -math.cos(2 * tilt)])
    to_y, vertex = np.array([0, 1, 0]), np.array([0, 0, 1])
    at = vertex + 0.7 * to_d + np.outer(x, to_x) + np.outer(y, to_y)
    way = to_d + np.outer(u, to_x) + np.outer(v, to_y)
    from_center, square = at - vertex + normal / curvature, (way**2).sum(axis=1)
    half = (from_center * way).sum(axis=1) / square
    root = np.sqrt(half**2 - ((from_center**2).sum(axis=1) - curvature**-2) / square)
    back = half - math.copysign(1, curvature) * root
    hit, local = at - back[:, None] * way, from_center - back[:, None] * way
    before = way - 2 * curvature**2 * (way * local).sum(axis=1, keepdims=True) * local
    start = hit - before * (hit[:, 2:] / before[:, 2:])
    return (abs(start[:, 0]) < 0.1) & (abs(start[:, 1]) < 0.1)


def lens(ox: Any, oy: Any, ou: Any, ov: Any, focal_length: float = 0.5) -> Any:
    def part(a: Any, b: Any) -> Any:
        a, b = (1 - 0.4 / focal_length) * a - b / focal_length, 0.4 * a + b
        return 2 * 0.08**2 * np.sinc(0.08 * (a + 2 * b)) * np.sinc(0.08 * 2 * (a + b))

    return part(ox, ou) * part(oy, ov)


def lens_rays(x: Any, y: Any, u: Any, v: Any, focal_length: float = 0.5) -> Any:
    """A thin lens bends slopes exactly and keeps flux, so radiance is multiplied by the ratio of (1 + u² + v²)² after and before it."""
    at = [p - 0.4 * q for p, q in ((x, u), (y, v))]
    before = [q + p / focal_length for p, q in zip(at, (u, v))]
    lit = [(abs(p - q) < 0.04) & (abs(p - 0.5 * q) < 0.04) for p, q in zip(at, before)]
    return lit[0] * lit[1] * ((1 + u**2 + v**2) / (1 + before[0] ** 2 + before[1] ** 2)) ** 2


def ggx(x: Any, y: Any, u: Any, v: Any, roughness: float = 0.2, jacobian: bool = True, cosine: bool = True, tilt: float = 0.7) -> Any:
    """Microfacets (Walter et al. 2007, Eqs. 20, 33 and 34), lit by a lamp."""
    normal = np.array([math.sin(tilt), 0, -math.cos(tilt)])
    to_x, to_d = -np.array([math.cos(2 * tilt), 0, math.sin(2 * tilt)]), np.array([math.sin(2 * tilt), 0, -math.cos(2 * tilt)])
    way = to_d + np.outer(u, to_x) + np.outer(v, [0, 1, 0])
    at = 0.2 * to_d + np.outer(x, to_x) + np.outer(y, [0, 1, 0])
    hit = at - way * ((at @ normal) / (way @ normal))[:, None] + [0, 0, 1]
    out = way / np.linalg.norm(way, axis=1, keepdims=True)
    sight = out @ normal
    found = np.zeros(x.size)
    for lx, ly, area in zip(*lamp((0.2, 0.2))):
        to = np.array([lx, ly, 0]) - hit
        r = np.linalg.norm(to, axis=1)
        to /= r[:, None]
        middle = (to + out) / np.linalg.norm(to + out, axis=1, keepdims=True)
        cos, height = to @ normal, middle @ normal
        density = roughness**2 / (np.pi * (height**2 * (roughness**2 - 1) + 1) ** 2)
        shadows = [2 / (1 + np.sqrt(1 + roughness**2 * (c**-2 - 1))) for c in (cos, sight)]
        brdf = density * shadows[0] * shadows[1] / (4 * cos * (sight if jacobian else 1))
        found += brdf * (cos if cosine else 1) * -to[:, 2] / r**2 * area
    return found


def spot(x: Any, y: Any, u: Any, v: Any, exponent: float = 20) -> Any:
    return (abs(x - 0.5 * u) < 0.05) * (abs(y - 0.5 * v) < 0.05) * (1 + u**2 + v**2) ** (-exponent / 2)


def texture(x: Any, y: Any, u: Any, v: Any, reverse: int = -1, swapped: bool = False) -> Any:
    """A wall seen from 0.2 m; X is reversed there."""
    s, t = reverse * (x - 0.2 * u), y - 0.2 * v
    pattern = (1 + 0.9 * np.cos(2 * np.pi * 6 * (t if swapped else s) + 0.4)) / 2
    return 0.6 / np.pi * pattern * irradiance(s, t, (0.4, 0.4))


def occluders(distances: tuple[float, float] = (0.6, 0.3), added: bool = False, narrow: float = 1) -> Any:
    first, second = distances

    def field(x: Any, u: Any) -> Any:
        hole, card = inside(x - first * u, 0.1, 0.02), inside(x - second * u, 2, -0.98)
        return inside(x - u, 0.3) * (hole + card - 1 if added else hole * card)

    return slices(along(field, narrow=narrow), along(lambda x, u: inside(x - u, 0.3) * inside(x - first * u, 0.1), narrow=narrow))


def environment(x: Any, y: Any, u: Any, v: Any, sign: int = 1, slopes: bool = False) -> Any:
    """The radiance of a lobe that comes from (0.1, 0.05, −1), of width 0.15 rad."""
    a, b = sign * -0.1, sign * -0.05
    if slopes:
        angle = np.hypot(u - a, v - b)
        return np.exp((np.cos(angle) - 1) / 0.15**2)
    cos = (1 + a * u + b * v) / np.sqrt((1 + u**2 + v**2) * (1 + a**2 + b**2))
    return np.exp((cos - 1) / 0.15**2)


# The scenes.


def scene(light: Tree, surface: Tree | None = None, at: Any = None, blockers: Any = (), x: float = X, u: float = U) -> Tree:
    wall = {"Rectangle": {"name": "wall", "center": [0, 0, 2], "size": [6, 6]}}
    return {
        "light": {kind: {"center": [0, 0, 0], **of} for kind, of in light.items()},
        "blockers": list(blockers),
        "surfaces": [surface or wall],
        "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["wall"]},
        "planes": [{"name": "p", "at": at or {"Distance": 1}}],
        "window": {"x": {"Hann": x}, "u": {"Hann": u}},
        "frequencies": {"azimuths": 2, "rho": {"max": 3.99 / (2 * x)}, "nu": {"max": 3.99 / (2 * u)}},
    }


def square(size: float, other: float | None = None) -> Tree:
    return {"Rectangle": {"size": [size, other or size]}}


def smooth(event: Any, tilt: float = 0, form: Any = "Plane") -> Tree:
    facing = [math.sin(tilt), 0, -math.cos(tilt)]
    return {"Smooth": {"name": "wall", "center": [0, 0, 1], "facing": facing, "form": form, "aperture": 0.9, "event": event}}


def hole(z: float, size: list[float], center: float = 0) -> Tree:
    return {"Aperture": {"name": f"hole{z}", "center": [0, 0, z], "hole": {"Rectangle": {"center": [center, 0], "size": size}}}}


FLOOR = {"Rectangle": {"name": "wall", "center": [0, 0, 1], "size": [6, 6], "albedo": 0.5}}
BARS = {"Grating": {"name": "bars", "center": [0, 0, 0.5], "axis": "X", "frequency": 8, "modulation": 0.8, "phase": 0.5}}
CARD = {"Shapes": {"name": "card", "center": [0, 0, 0.7], "shapes": [{"HalfPlane": {"axis": "X", "edge": 0.02, "opaque": "Above"}}]}}
COSINE = {"Cosine": {"axis": "X", "frequency": 6, "modulation": 0.9, "phase": 0.4}}
PAINTED = {"Reflects": {"brdf": {"lobe": "Lambertian", "albedo": 0.6}, "texture": COSINE}}
GGX = {"Reflects": {"brdf": {"lobe": {"Ggx": 0.2}}}}
SKY = {"Environment": {"map": {"Lobes": [{"from": [0.1, 0.05, -1], "width": 0.15}]}}}
LENS = scene(square(0.08), smooth({"ThinLens": 0.5}), {"Distance": 1.4}, [hole(0.5, [0.08, 0.08])], 0.15, 0.15)


@dataclass
class Case:
    kind: str
    """slices, radiance or spectrum."""
    scene: Tree
    theory: Callable[..., Any]
    faults: dict[str, tuple[Tree, str]]
    """Arguments that are wrong, and a pattern of the words that name this cause."""
    parameter: tuple[str, float] | None = None
    photons: int = 2**14
    points: int = 2**12

    def stated(self, **fault: Any) -> Any:
        """What `etendue.compare` takes for the plane."""
        if self.kind == "slices":
            return self.theory(**fault)
        if not self.parameter:
            return {self.kind: partial(self.theory, **fault)}
        name, value = self.parameter
        return {self.kind: partial(self.theory, **fault), "parameters": [name], "values": [fault.pop(name, value)]}

    def prediction(self, **fault: Any) -> etendue.Prediction:
        return etendue.theory(etendue.Scene(self.scene), {"p": self.stated(**fault)}, points=self.points, threads=1)

    def compared(self, prediction: etendue.Prediction, photons: int, seed: int = 1) -> Any:
        measured = etendue.measure(self.scene, photons=photons, seed=seed, threads=1)
        return etendue.compare(measured, prediction, threads=1)["p"]


CASES = {
    "free travel": Case("slices", scene(square(0.2, 0.1)), travel, {
        "sign of the shear": ({"sign": -1}, "reversed in (x and y|u and v)$"), "axes swapped": ({"swapped": True}, "exchanged")}),
    "slit": Case("spectrum", scene(square(0.3), blockers=[hole(0.5, [0.06, 0.2], 0.02)]), slit, {
        "(2π)⁻² in front": ({"factor": (2 * np.pi) ** -2}, "multiplied"), "(2π)⁻⁴ in front": ({"factor": (2 * np.pi) ** -4}, "multiplied"),
       
        "Jacobian left out": ({"jacobian": False}, "multiplied")}, None, 2**15, 2**14),
    "grating": Case("slices", scene(square(0.2), blockers=[BARS]), grating, {
        "sign of the exponent": ({"sign": 1}, "exponent|conjugate|reversed"), "half window": ({"narrow": 0.5}, "window"),
        "2π left out of the exponent": ({"sign": -0.5 / np.pi}, "2π")}),
    "point light": Case("slices", scene({"Point": {}}, at={"Distance": 1.5}, x=0.4), point, {
        "1/r² left out": ({"jacobian": False}, "multiplied"), "cosine left out": ({"oblique": False}, "cosine")}),
    "diffuse receiver": Case("radiance", scene(square(0.6, 0.3), FLOOR, {"After": "wall"}), diffuse, {
        "one cosine left out": ({"cosines": 1}, "cosine"), "1/r² left out": ({"falls": 0}, "1/r")}, None, 2**15, 2**14),
    "curved mirror": Case("radiance", scene(square(0.2), smooth("Mirror", 0.3, {"Sphere": -0.5}), {"Distance": 1.7}), mirror, {
        "one shear for two": ({"curvature": -0.25}, "curvature"), "sign of the curvature": ({"curvature": 0.5}, "curvature"),
        "X not reversed": ({"reverse": 1}, "reversed in x and u")}, ("curvature", -0.5), 2**16, 2**15),
    "thin lens": Case("spectrum", LENS, lens, {
        "sign of the focal length": ({"focal_length": -0.5}, "focal_length"),
        "focal length 2 % too large": ({"focal_length": 0.51}, "focal_length")}, ("focal_length", 0.5), 2**18, 2**13),
    "thin lens, exact": Case("radiance", LENS, lens_rays, {}, ("focal_length", 0.5), 2**18, 2**16),
    "GGX": Case("radiance", scene(square(0.2), smooth(GGX, 0.7), {"Distance": 1.2}), ggx, {
        "Jacobian without cos θₒ": ({"jacobian": False}, "multiplied"), "cosine left out": ({"cosine": False}, "cosine"),
        "α² for α": ({"roughness": 0.04}, "roughness")}, ("roughness", 0.2), 2**16, 2**13),
    "spot": Case("radiance", scene({"Spot": {"bulb": {"Square": 0.1}, "exponent": 20}}, at={"Distance": 0.5}, u=0.5), spot, {
        "n + 1 for n": ({"exponent": 21}, "exponent"), "2n for n": ({"exponent": 40}, "exponent")}, ("exponent", 20), 2**13, 2**18),
    "texture": Case("radiance", scene(square(0.4), smooth(PAINTED), {"Distance": 1.2}), texture, {
        "axes swapped": ({"swapped": True}, "exchanged"), "X not reversed": ({"reverse": 1}, "reversed")}, None, 2**17, 2**16),
    "two occluders": Case("slices", scene(square(0.3), blockers=[hole(0.4, [0.1, 0.1], 0.02), CARD]), occluders, {
        "distances from the lamp": ({"distances": (0.4, 0.7)}, "distance"), "shadows added": ({"added": True}, "shadow"),
        "half window": ({"narrow": 0.5}, "window")}, photons=2**16),
    "environment": Case("radiance", scene(SKY, at={"Distance": 0.5}), environment, {
        "slopes for angles": ({"slopes": True}, "angle"), "from for to": ({"sign": -1}, "reversed")}, None, 2**15, 2**15),
}  # fmt: skip


# The tables.


def distance_from_uniform(p: list[float]) -> float:
    """The statistic of Kolmogorov and Smirnov."""
    rank = np.arange(len(p) + 1) / len(p)
    ordered = np.sort(p)
    return float(max((rank[1:] - ordered).max(), (ordered - rank[:-1]).max()))


def calibrated(name: str, case: Case, seeds: int) -> str:
    began = time.perf_counter()
    prediction = case.prediction()
    planes = [case.compared(prediction, case.photons, seed).report for seed in range(1, seeds + 1)]
    each = (time.perf_counter() - began) / seeds
    slices, power = ([plane["p_value"] for plane in planes], [plane["radial"]["p_value"] for plane in planes])
    verdicts = [plane["verdict"] for plane in planes]
    noise = np.mean([plane["noise_limit"] for plane in planes])
    error = f"{100 * planes[0]['quadrature_error']:.2f} %" if planes[0]["quadrature_error"] is not None else "–"
    pulls = [(of["measured"] - of["scene"]) / of["error"] for plane in planes for of in plane["parameters"] if of["error"]]
    told = f"{np.mean(pulls):.2f} ± {np.std(pulls) / np.sqrt(len(pulls)):.2f}, {np.std(pulls):.2f}" if pulls else "–"
    return (f"| {name} | {case.kind} | 2^{case.photons.bit_length() - 1} | {100 * noise:.2f} % | {error} | {distance_from_uniform(slices):.3f} | "
            f"{distance_from_uniform(power):.3f} | {verdicts.count('fail')} | {verdicts.count('undecided')} | {told} | {each:.2f} |")  # fmt: skip


def hint(report: Any) -> str:
    """The first hint of a cause: a warning that names one, or the number that is furthest from the theory's."""
    for words in report["warnings"]:
        if "would agree" in words:
            return words.removeprefix("the prediction ")
    apart = [(of["measured"], of["scene"], of["error"], of["name"]) for of in report["parameters"]]
    slope = report["slope"]
    apart.append((slope["measured"], slope["predicted"], slope["error"], "shear slope"))
    found = [(abs(a - b) / error, f"{name} {a:.3g}, theory {b:.3g}: {abs(a - b) / error:.1f} σ") for a, b, error, name in apart if error]
    return max(found)[1]


def planted(name: str, case: Case) -> list[str]:
    rows: list[str] = []
    for fault, (wrong, cause) in case.faults.items():
        prediction = case.prediction(**wrong)
        for power in range(10, 21):
            plane = case.compared(prediction, 2**power)
            if plane.verdict == "fail":
                said = [hint(of.report) for of in (plane, case.compared(prediction, 2 ** (power + 4)))]
                named = ["yes" if re.search(cause, words) else "no" for words in said]
                rows.append(f"| {name} | {fault} | 2^{power} | {said[0]} | {named[0]} | {said[1]} | {named[1]} |")
                break
        else:
            rows.append(f"| {name} | {fault} | not up to 2^20 | – | – | – | – |")
    return rows


# Random fields with known slices: products of two profiles along sheared coordinates, for (x, u) and for (y, v).


@dataclass
class Field:
    edges: bool
    d: float
    e: float
    sizes: tuple[float, float]
    centers: tuple[float, float]
    frequency: float

    def value(self, x: Any, u: Any) -> Any:
        t = [x - shear * u - center for shear, center in zip((self.d, self.e), self.centers)]
        shapes = [abs(a) < size / 2 if self.edges else np.exp(-np.pi * (a / size) ** 2) for a, size in zip(t, self.sizes)]
        return shapes[0] * shapes[1] * (1 + np.cos(2 * np.pi * self.frequency * x + 0.5)) / 2

    def spectrum(self, a: Any, b: Any) -> Any:
        def plain(a: Any) -> Any:
            found = 1 / abs(self.d - self.e)
            for other, sign, size, center in zip((self.e, self.d), (-1, 1), self.sizes, self.centers):
                k = sign * (other * a + b) / (self.d - self.e)
                shape = np.sinc(size * k) if self.edges else np.exp(-np.pi * (size * k) ** 2)
                found = found * size * shape * np.exp(-2j * np.pi * k * center)
            return found

        wave = np.exp(0.5j) * plain(a - self.frequency)
        return (plain(a) + (wave + np.exp(-0.5j) * plain(a + self.frequency)) / 2) / 2

    def windowed(self, rho: Any, nu: Any, x: float, u: float, cells: int) -> Any:
        """The spectrum with a Hann window: for each u, the integral over x in closed form if there are edges, else the midpoint rule."""
        pu = u * (2 * np.arange(cells) + 1 - cells) / cells
        if self.edges:
            ends = [np.array([s * pu + c - w / 2, s * pu + c + w / 2]) for s, c, w in zip((self.d, self.e), self.centers, self.sizes)]
            low = np.clip(np.maximum(ends[0][0], ends[1][0]), -x, x)
            size = np.maximum(np.clip(np.minimum(ends[0][1], ends[1][1]), -x, x) - low, 0)
            inner = np.zeros((rho.size, cells), complex)
            for move, weight in ((0, 0.5), (0.5 / x, 0.25), (-0.5 / x, 0.25)):
                for wave, part in ((0, 0.5), (self.frequency, np.exp(0.5j) / 4), (-self.frequency, np.exp(-0.5j) / 4)):
                    k = (rho - move - wave)[:, None]
                    inner += weight * part * size * np.sinc(k * size) * np.exp(-2j * np.pi * k * (low + size / 2))
        else:
            px = x * (2 * np.arange(cells) + 1 - cells) / cells
            inner = np.exp(-2j * np.pi * np.outer(rho, px)) @ (hann(px, x)[:, None] * self.value(px[:, None], pu)) * (2 * x / cells)
        return (inner * hann(pu, u)) @ np.exp(-2j * np.pi * np.outer(pu, nu)) * (2 * u / cells)


def quadrature(cases: int) -> list[str]:
    random = np.random.default_rng(2005)
    ratios: dict[tuple[str, str, str], list[float]] = {}
    truth = 0.0
    for number in range(cases):
        x, u = random.uniform(0.1, 0.5), random.uniform(0.1, 0.4)
        edges = bool(number % 2)
        fields: list[Field] = []
        for _ in range(2):
            d, gap = random.uniform(-1.5, 1.5), random.choice([-1, 1]) * random.uniform(0.3, 1)
            sizes, centers = random.uniform(0.1, 0.4, 2), random.uniform(-0.05, 0.05, 2)
            fields.append(Field(edges, d, d + gap, (sizes[0], sizes[1]), (centers[0], centers[1]), random.uniform(0, 1.5) / x))
        tree = scene(square(0.2), x=x, u=u)
        tree["frequencies"] = {"azimuths": 2, "rho": {"max": 1.99 / (2 * x)}, "nu": {"max": 1.99 / (2 * u)}}
        measured = etendue.measure(tree, photons=2**11, threads=1)

        def radiance(x: Any, y: Any, u: Any, v: Any, of: list[Field] = fields) -> Any:
            return of[0].value(x, u) * of[1].value(y, v)

        def spectrum(ox: Any, oy: Any, ou: Any, ov: Any, of: list[Field] = fields) -> Any:
            return of[0].spectrum(ox, ou) * of[1].spectrum(oy, ov)

        points = int(2 ** random.integers(7, 11))
        for kind, function in (("radiance", radiance), ("spectrum", spectrum)):
            stated = {"p": {kind: function}}
            steered = kind == "radiance" and number // 2 % 2 == 1
            plane = etendue.compare(measured, stated if steered else etendue.theory(measured.scene, stated, points=points, threads=1), threads=1)["p"]
            found = plane.slices
            turns = [(math.cos(turn), math.sin(turn)) for turn in found.azimuth]
            exact, rough = (np.array([np.prod([of.windowed(t * found.rho, t * found.nu, x, u, cells) for of, t in zip(fields, turn)], axis=0)
                                      for turn in turns]) for cells in (1600, 800))  # fmt: skip
            error = float(np.linalg.norm(found.predicted - exact))
            told = float(plane.report["quadrature_error"] * np.linalg.norm(found.predicted))
            truth = max(truth, float(np.linalg.norm(exact - rough)) / told)
            ratios.setdefault((kind, "edges" if edges else "smooth", "compare" if steered else "2⁷ to 2¹⁰"), []).append(error / told)
    rows = [row(" | ".join(of), np.array(found)) for of, found in sorted(ratios.items())]
    rows.append(row("all | all | all", np.concatenate([*map(np.array, ratios.values())])))
    return [*rows, "", f"Halving the cells of the exact slices changes them by at most {truth:.1e} of the stated error."]


def row(of: str, ratios: Any) -> str:
    shares = " | ".join(f"{100 * np.mean(ratios < most):.0f} %" for most in (1, 2))
    return f"| {of} | {ratios.size} | {np.median(ratios):.2f} | {np.mean(ratios**2):.2f} | {shares} | {ratios.max():.2f} |"


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--seeds", type=int, default=200)
    options.add_argument("--only", choices=[*CASES, "quadrature"])
    given = options.parse_args()
    cases = {name: case for name, case in CASES.items() if given.only in (None, name)}
    print(HEAD.format(seeds=given.seeds, bound=1.36 / given.seeds**0.5, expected=given.seeds / 100, count=2 * len(cases)))
    for name, case in cases.items():
        print(calibrated(name, case, given.seeds), flush=True)
    print(FAULTS)
    for name, case in cases.items():
        print("".join(f"{row}\n" for row in planted(name, case)), end="", flush=True)
    if given.only in (None, "quadrature"):
        print("\n".join([QUADRATURE, *quadrature(50)]))


HEAD = """# Theories of users against photons

Written by `python python/validation/theories.py`.

Theories are written in NumPy as a user writes them ([Check a theory of your own](../docs/own-theory.md)); none calls a prediction or an operator of Étendue.
Each has a scene of its own, and `etendue.compare` compares it with photons.
A theory states slices, a radiance function or a spectrum function.

## Right theories

Each theory is compared with the photons of {seeds} seeds.
*D* is the largest distance of the distribution of p from the uniform one (Kolmogorov and Smirnov): for p of the slices, and for p of power.
The 5 % bound of D is {bound:.3f}, so about one of the {count} numbers is expected above it.
Of {seeds} verdicts, about {expected:.0f} are expected to fail, because α is 1 %.
The theory's own error is the same for all seeds, so it is kept far below the noise: with 2^12 points the slit's p of power has D = 0.109, and the same slit as an array has 0.063 with the same photons.
*Error* is its stated error, and *noise* contains it.
*Pull* is the measured parameter minus the true one in standard errors: the mean over the seeds with its error, and the standard deviation.

| theory | stated as | photons | noise | error | D of slices | D of power | fail | undecided | pull of parameter | seconds a seed |
|---|---|---|---|---|---|---|---|---|---|---|"""
FAULTS = """
The thin lens as a spectrum function has constant radiance, which is right to second order in slopes: its focal length is 0.3 % too small.
The radiance function *thin lens, exact* has the factor by which flux is kept, (1 + u² + v²)² after the lens over that before it, and no such bias.
GGX is undecided where noise is above 10 %, `run.resolution`.

## Wrong theories

Each fault is planted into the theory.
*Photons* is the smallest power of two from 2^10 with which the verdict is *fail*, with seed 1.
*Hint* is the warning that names a convention, if there is one; else the number, of the shear slope and the theory's parameters, that is most standard errors from the theory's.
*Named* states whether the hint names the cause.

| theory | fault | photons | hint | named | hint with 16 times as many photons | named |
|---|---|---|---|---|---|---|"""
QUADRATURE = """
A factor and a reversed or exchanged axis are named, and so is a wrong parameter, if the theory has it as a parameter.
A half window, a cosine or 1/r² that is left out, 2π in the exponent and slopes for angles are rejected but not named.
With few photons a factor may agree although it is not the cause; with 16 times as many photons this happens less often.

## Stated errors of functions

Fields are products of two boxes (*edges*) or two Gaussians (*smooth*) along random sheared coordinates, times a grating, in windows of random size.
They are functions of (x, u) times functions of (y, v), so that quadrature in two dimensions gives the exact slices.
*Ratio* is the distance from the exact slices over the stated error; a right error has a mean square of about 1.
*Points* of a sequence are a random power of two, or as many as `compare` chooses.

| function | field | points | fields | median ratio | mean square | ratio below 1 | below 2 | largest |
|---|---|---|---|---|---|---|---|---|"""

if __name__ == "__main__":
    main()
