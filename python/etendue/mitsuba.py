"""Light fields of scenes of Mitsuba 3, measured with any of its integrators.

>>> import mitsuba as mi
>>> mi.set_variant("llvm_ad_rgb")
>>> import etendue.mitsuba
>>> seen = etendue.mitsuba.probe("cbox.xml", (128, 128), integrator="volpath")
>>> seen["camera"].variation_nu

Rays are drawn in the window of a virtual plane and traced back from there; the integrator gives the radiance along each ray. Needs the package
`mitsuba` (`pip install etendue[mitsuba]`), with a variant that is vectorised, such as llvm_ad_rgb or cuda_ad_spectral.
"""

from __future__ import annotations

import importlib
import os
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import NDArray

from etendue import types
from etendue.profiles import STEPS, ProfileSampler
from etendue.progress import Progress, told
from etendue.rays import Spectrum, spectrum
from etendue.worlds import ProbedPlane

__all__ = ["Placement", "probe", "record"]

Floats = NDArray[np.float64]
Vector = Sequence[float]
Color = Literal["luminance", "red", "green", "blue"]
Source = Union[str, "os.PathLike[str]", Mapping[str, Any], Any]
"""The path of a scene file, a dictionary for `mitsuba.load_dict`, or a loaded scene."""

LARGEST = 1 << 19
"""The largest number of rays that Mitsuba traces at a time."""
FREQUENCIES = 12
"""Default number of frequencies on either side of zero; adjacent frequencies differ by one cycle per width of the window."""
INTEGRATORS = {
    "PathIntegrator": "path",
    "VolumetricSimplePathIntegrator": "volpath",
    "VolumetricMisPathIntegrator": "volpathmis",
    "PRBIntegrator": "prb",
    "BasicPRBIntegrator": "prb_basic",
    "PathProjectiveIntegrator": "prb_projective",
    "PRBVolpathIntegrator": "prbvolpath",
}
"""Integrators whose depth stands in their description, with the name in that description."""
CHANNELS = {"red": 0, "green": 1, "blue": 2}


@dataclass(frozen=True)
class Placement:
    """A virtual plane, and where the rays through it start."""

    origin: Vector
    """The origin of x and y, in world coordinates."""
    direction: Vector
    """The direction D in which light travels through the plane, which is perpendicular to D."""
    x_axis: Vector
    """The direction of x. Its component along D is ignored; y is along D × x."""
    window: types.Window
    """A profile for each coordinate, as in `etendue.spectrum`."""
    frequencies: types.Frequencies
    """The frequencies of the slices, as in `etendue.spectrum`."""
    ahead: float = 0.0
    """Rays start this far from the plane along D, in metres, and run back against D. What stands between the plane and the start blocks them."""
    on_surface: bool = False
    """Whether rays start instead on the surface that the central ray hits at the origin, at the point that is nearest to the plane. Rays that miss
    this surface start at the plane."""

    @classmethod
    def of(cls, plane: ProbedPlane, ahead: float = 0.0, on_surface: bool = False) -> Placement:
        """The plane of a probe. A plane on which light leaves a surface needs `ahead`, the distance from the surface to where the light is seen; a
        plane on which light arrives at a surface needs `on_surface`."""
        frame = plane.frame
        return cls(frame["O"], frame["D"], frame["X"], plane.window, plane.frequencies, ahead, on_surface)


def record(
    scene: Source,
    plane: Placement,
    *,
    integrator: Any = None,
    medium: Any = None,
    color: Color = "luminance",
    rays: float = 2**20,
    batches: int = 64,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = None,
) -> Spectrum:
    """Measures the spectrum of the light that passes a virtual plane of a scene of Mitsuba.

    `integrator` is the name of an integrator, a dictionary for `mitsuba.load_dict` or an integrator, by default that of the scene. `medium` is
    the medium in which rays start. `color` selects luminance or a channel; variants with one channel have luminance alone.

    `rays` rays are traced in `batches` independent groups, from whose differences errors are estimated. Positions and slopes are
    drawn in proportion to the window, from a sequence that fills the window evenly.

    Returns the `Spectrum` of radiance in W m⁻² sr⁻¹: S = ∫ L W exp(−2πi …) dx dy du dv. Raises `ValueError` for wrong arguments.
    """
    mi = _mitsuba()
    loaded = _loaded(mi, scene)
    asked = _integrator(mi, loaded, integrator)
    colors = ("luminance",) if mi.is_monochromatic else ("luminance", *CHANNELS)
    if color not in colors:
        raise ValueError(f"color is {color!r}; allowed for this variant of Mitsuba: {', '.join(colors)}")
    if batches != int(batches) or batches < 4 or not batches <= rays < 2**32:
        raise ValueError(f"batches is {batches} for {rays} rays; allowed: 4 to the number of rays, which is below 2**32")
    each = -(-int(rays) // batches)
    together = max(1, min(batches, LARGEST // each))
    frame = _Frame(plane)
    profiles = [ProfileSampler(plane.window.get(name) or plane.window[other]) for name, other in zip("xyuv", "xxuu")]
    numbers = np.random.default_rng(seed)
    shape = _first_surface(mi, loaded, frame) if plane.on_surface else None
    columns: list[Floats] = []
    weights: list[Floats] = []
    with told(progress) as tell:
        for first in range(0, batches, together):
            count = min(together, batches - first)
            drawn = _even(numbers.random((count, 4)), each)
            pairs = [profile.draw(drawn[i]) for i, profile in enumerate(profiles)]
            x, y, u, v = (where for where, _ in pairs)
            density: Floats = np.prod([of for _, of in pairs], axis=0)
            along = frame.d[:, None] + u * frame.x[:, None] + v * frame.y[:, None]
            start = frame.origin[:, None] + x * frame.x[:, None] + y * frame.y[:, None]
            if shape is None:
                start = start + plane.ahead * along
            else:
                start = _on_surface(mi, loaded, shape, start, along)
            along /= np.linalg.norm(along, axis=0)
            own = int(2**31 * numbers.random())
            light: Floats = _radiance(mi, loaded, asked, medium, color, start, -along, own)
            columns.append(np.array([x, y, u, v]))
            weights.append(light / (density * each * batches))
            if tell is not None:
                tell(0, "trace", "rays", each * batches, (first + count) * each)
    weight: Floats = np.concatenate(weights)
    if not np.isfinite(weight).all():
        bad = np.count_nonzero(~np.isfinite(weight))
        warnings.warn(f"{bad} of {weight.size} rays have a radiance that is not finite; they count as dark", stacklevel=2)
        weight = np.where(np.isfinite(weight), weight, 0.0)
    x, y, u, v = np.concatenate(columns, axis=1)
    group = np.repeat(np.arange(batches), each)
    window, frequencies = plane.window, plane.frequencies
    return spectrum(x, y, u, v, weight, window=window, frequencies=frequencies, batch=group, threads=threads, progress=progress)


def probe(
    scene: Source,
    pixel: tuple[int, int],
    *,
    sensor: int = 0,
    window: float = 31,
    integrator: Any = None,
    color: Color = "luminance",
    azimuths: int = 8,
    rays: float = 2**20,
    batches: int = 64,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = None,
) -> dict[str, Spectrum]:
    """Measures the light field behind a pixel (column, row) of a sensor of Mitsuba.

    The central ray goes through the middle of the pixel to the first surface. The planes are `camera`, light that arrives at the camera;
    `leaving_1`, light that leaves this surface towards the camera; and `arriving_1`, light that arrives at this surface along the path
    that a mirror would reflect into the central ray. `window` is the width of their windows in pixels at the middle of the film, as a slope; in
    position it is that slope times the distance from the camera. X is in the plane of incidence. All other arguments are those of `record`.

    Light that arrives at the first surface has met one surface less than light at the camera. If `integrator` is a name, a dictionary or that of the
    scene, its `max_depth` is reduced accordingly.
    """
    mi = _mitsuba()
    loaded = _loaded(mi, scene)
    asked = _words(loaded.integrator()) if integrator is None else integrator
    planes, medium = _placements(mi, loaded, pixel, sensor, window, azimuths)
    found: dict[str, Spectrum] = {}
    for number, (name, plane) in enumerate(planes.items()):
        found[name] = record(
            loaded,
            plane,
            integrator=_shorter(asked) if plane.on_surface else asked,
            medium=None if plane.on_surface else medium,
            color=color,
            rays=rays,
            batches=batches,
            seed=seed + (number << 32),
            threads=threads,
            progress=progress,
        )
    return found


def _mitsuba() -> Any:
    try:
        mi = importlib.import_module("mitsuba")
    except ImportError as error:
        raise ImportError("etendue.mitsuba needs Mitsuba 3: pip install etendue[mitsuba]") from error
    variant: str | None = mi.variant()
    if variant is None or variant.startswith("scalar"):
        raise ValueError(f"the variant of Mitsuba is {variant}; allowed: a vectorised one: mitsuba.set_variant('llvm_ad_rgb')")
    return mi


def _loaded(mi: Any, scene: Source) -> Any:
    if isinstance(scene, (str, os.PathLike)):
        # Not optimised: that would merge the shapes of one material.
        return mi.load_file(os.fspath(scene), optimize=False)
    if isinstance(scene, Mapping):
        return mi.load_dict(dict(scene), optimize=False)  # pyright: ignore[reportUnknownArgumentType]
    if not isinstance(scene, mi.Scene):
        raise ValueError(f"scene is {type(scene).__name__}; allowed: a path, a dictionary or a mitsuba.Scene")
    return scene


def _integrator(mi: Any, scene: Any, asked: Any) -> Any:
    if asked is None:
        asked = scene.integrator()
    elif isinstance(asked, str):
        asked = mi.load_dict({"type": asked})
    elif isinstance(asked, Mapping):
        asked = mi.load_dict(dict(asked))  # pyright: ignore[reportUnknownArgumentType]
    if not isinstance(asked, mi.SamplingIntegrator):
        raise ValueError(f"integrator is {asked}; allowed: one that gives the radiance along a ray, such as 'path' or 'volpath'")
    return asked


def _words(integrator: Any) -> Any:
    """The dictionary of an integrator whose parameter is its depth; any other integrator itself."""
    described = str(integrator)
    name = INTEGRATORS.get(described.partition("[")[0])
    depth = dict(re.findall(r"(max_depth|rr_depth) = (\d+)", described))
    if name is None or "max_depth" not in depth or "hide_emitters = true" in described or getattr(integrator, "hide_emitters", False):
        return integrator
    return {"type": name, **{key: int(number) if int(number) < 2**31 else -1 for key, number in depth.items()}}


def _shorter(integrator: Any) -> Any:
    """An integrator of paths that meet one surface less, if it is given in words."""
    if not isinstance(integrator, Mapping):
        return integrator
    words: dict[str, Any] = dict(integrator)  # pyright: ignore[reportUnknownArgumentType]
    if words.get("max_depth", -1) > 0:
        words["max_depth"] -= 1
    return words


class _Frame:
    """The axes of a plane."""

    def __init__(self, plane: Placement) -> None:
        d, x = (np.asarray(axis, dtype=float) for axis in (plane.direction, plane.x_axis))
        self.origin: Floats = np.asarray(plane.origin, dtype=float)
        if {d.shape, x.shape, self.origin.shape} != {(3,)} or not np.isfinite([d, x, self.origin]).all():
            raise ValueError("origin, direction and x_axis: allowed: three finite numbers each")
        self.d: Floats = d / (np.linalg.norm(d) or 1.0)
        x = x - (x @ self.d) * self.d
        if not np.linalg.norm(x) > 1e-9 or not d.any():
            raise ValueError(f"x_axis is {plane.x_axis}; allowed: a vector that is not along direction {plane.direction}")
        self.x: Floats = x / np.linalg.norm(x)
        self.y: Floats = np.cross(self.d, self.x)


def _even(shifts: Floats, each: int) -> Floats:
    """Numbers [4, batches · each] that fill the unit cube of each batch evenly: a sequence, shifted at random for each batch."""
    counts = np.arange(each)[None, :, None]
    drawn = (shifts[:, None, :] + counts * STEPS) % 1.0
    return drawn.reshape(-1, 4).T


def _rays(mi: Any, start: Floats, along: Floats) -> Any:
    return mi.RayDifferential3f(mi.Ray3f(mi.Point3f(start.astype("f4")), mi.Vector3f(along.astype("f4"))))


def _radiance(mi: Any, scene: Any, integrator: Any, medium: Any, color: Color, start: Floats, along: Floats, seed: int) -> Floats:
    count = start.shape[1]
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, count)
    ray = _rays(mi, start, along)
    share: Any = 1.0
    if mi.is_spectral:
        ray.wavelengths, share = mi.sample_rgb_spectrum(mi.sample_shifted(sampler.next_1d()))
    value = mi.unpolarized_spectrum(_sampled(mi, integrator, scene, sampler, ray, medium)) * share
    if mi.is_monochromatic:
        one = value[0]
    else:
        if mi.is_spectral:
            value = mi.xyz_to_srgb(mi.spectrum_to_xyz(value, ray.wavelengths))
        one = mi.luminance(mi.Color3f(value)) if color == "luminance" else value[CHANNELS[color]]
    return np.array(one, dtype=float) * np.ones(count)


def _sampled(mi: Any, integrator: Any, scene: Any, sampler: Any, ray: Any, medium: Any) -> Any:
    """The spectra that an integrator finds along rays."""
    if not isinstance(integrator, mi.ad.integrators.common.ADIntegrator):
        return integrator.sample(scene, sampler, ray, medium)[0]
    if medium is not None:
        raise ValueError("the integrator is for derivatives, and begins outside of media; allowed where rays start in a medium: 'volpath', 'volpathmis'")
    # Integrators for derivatives take the kind of derivative first.
    primal = importlib.import_module("drjit").ADMode.Primal
    nothing = {"δL": None, "δaovs": None, "state_in": None}
    return integrator.sample(primal, scene, sampler, mi.Ray3f(ray), depth=mi.UInt32(0), active=mi.Bool(True), **nothing)[0]


def _first_surface(mi: Any, scene: Any, frame: _Frame) -> Any:
    """The shape at the origin, which light reaches along D."""
    scale = _size(scene)
    start = frame.origin - 1e-3 * scale * frame.d
    hit = scene.ray_intersect(_rays(mi, start[:, None], frame.d[:, None]))
    if not np.array(hit.is_valid()).all() or np.array(hit.t)[0] > 2e-3 * scale:
        raise ValueError("no surface is at the origin of the plane; allowed with on_surface: a plane through a surface")
    return hit.shape


def _on_surface(mi: Any, scene: Any, shape: Any, point: Floats, along: Floats) -> Floats:
    """The points nearest to the plane at which lines meet a shape; where they miss it, the points in the plane."""
    reach = 0.5 * _size(scene)
    length = np.linalg.norm(along, axis=0)
    unit = along / length
    nearest = np.full(point.shape[1], np.inf)
    left = np.zeros(point.shape[1])
    # Lines are followed from before the plane to behind it, over the surfaces that they meet on the way.
    for _ in range(8):
        start = point + (left - reach) * unit
        hit = scene.ray_intersect(_rays(mi, start, unit))
        valid = np.array(hit.is_valid()) & np.ones(left.shape, bool)
        t = np.where(valid, np.array(hit.t, dtype=float), np.inf) + left - reach
        own = valid & (np.array(hit.shape == shape) & np.ones(left.shape, bool))
        nearest = np.where(own & (np.abs(t) < np.abs(nearest)), t, nearest)
        left = np.where(valid, t + reach + 1e-4 * reach, 2 * reach)
        if not (valid & (t < np.abs(nearest))).any():
            break
    # A little before the surface, where light arrives.
    return point + np.where(np.isfinite(nearest), nearest - 2e-5 * reach, 0.0) * unit


def _size(scene: Any) -> float:
    """The diagonal of the scene."""
    box = scene.bbox()
    return float(np.linalg.norm(np.array(box.max, float) - np.array(box.min, float)))


def _placements(
    mi: Any, scene: Any, pixel: tuple[int, int], sensor: int, pixels: float, azimuths: int
) -> tuple[dict[str, Placement], Any]:
    """The planes of a probe, and the medium around the camera."""
    sensors = scene.sensors()
    if not 0 <= sensor < len(sensors):
        raise ValueError(f"sensor is {sensor}; allowed: 0 to {len(sensors) - 1}")
    camera = sensors[sensor]
    size = np.array(camera.film().crop_size(), int).reshape(-1)
    if not all(0 <= at < most for at, most in zip(pixel, size)):
        raise ValueError(f"pixel is {pixel}; allowed: (0, 0) to ({size[0] - 1}, {size[1] - 1})")
    # Rays of Mitsuba start at the near clipping plane.
    eye = np.array(camera.world_transform().translation(), float).reshape(-1)
    start, away = _look(mi, camera, (pixel[0] + 0.5, pixel[1] + 0.5), size)
    (_, ahead), (_, next_to) = (_look(mi, camera, (0.5 * size[0] + step, 0.5 * size[1]), size) for step in (0, 1))
    right = next_to / (next_to @ ahead) - ahead
    if np.linalg.norm(np.cross(start - eye, away)) > 1e-5 * _size(scene) or not right.any():
        raise ValueError("the rays of this sensor do not start at one point; allowed: a perspective sensor")
    hit = scene.ray_intersect(_rays(mi, eye[:, None], away[:, None]))
    if not np.array(hit.is_valid()).all():
        raise ValueError(f"the ray through pixel {pixel} meets nothing")
    distance = float(np.array(hit.t)[0])
    normal, point = (np.array(vector, float).reshape(-1) for vector in (hit.sh_frame.n, hit.p))
    normal = -normal if normal @ away > 0 else normal
    across = normal - (normal @ away) * away
    x = across if np.linalg.norm(across) > 1e-4 else right
    half = 0.5 * pixels * float(np.linalg.norm(right))

    def axis(width: float) -> types.Axis:
        return {"max": FREQUENCIES / (2 * width), "spacing": 1 / (2 * width)}

    wide = half * distance
    window: types.Window = {"x": {"Hann": wide}, "u": {"Hann": half}}
    frequencies: types.Frequencies = {"rho": axis(wide), "nu": axis(half), "azimuths": azimuths}
    leaves = -away
    arrives = leaves - 2 * (leaves @ normal) * normal
    mirrored = x - 2 * (x @ normal) * normal

    def placed(origin: Floats, d: Floats, x: Floats, ahead: float = 0.0, on_surface: bool = False) -> Placement:
        return Placement(origin.tolist(), d.tolist(), x.tolist(), window, frequencies, ahead, on_surface)

    planes = {
        "camera": placed(eye, leaves, x),
        "leaving_1": placed(point, leaves, x, ahead=distance),
        "arriving_1": placed(point, arrives, mirrored, on_surface=True),
    }
    return planes, camera.get_medium()


def _look(mi: Any, camera: Any, place: tuple[float, float], size: NDArray[np.int_]) -> tuple[Floats, Floats]:
    """Start and direction of the ray through a place of the film, in pixels."""
    share = mi.Point2f(float(place[0] / size[0]), float(place[1] / size[1]))
    ray, _ = camera.sample_ray(0.0, 0.5, share, mi.Point2f(0.5))
    start, along = (np.array(vector, float).reshape(-1) for vector in (ray.o, ray.d))
    return start, along / np.linalg.norm(along)
