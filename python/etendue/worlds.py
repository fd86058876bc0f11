"""Scenes of other programs: what their cameras see, and the light field behind a pixel."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue, types
from etendue.commands import given
from etendue.difference import Sample
from etendue.plot import Shown, Variables, axes_of, picture, plotted
from etendue.progress import Progress, told
from etendue.ranges import thread_count
from etendue.scene import Value, field_texts
from etendue.variance import Variance

if TYPE_CHECKING:
    import xarray

Point = Sequence[float]
Size = Union[str, "tuple[int, int]"]
Color = Literal["luminance", "red", "green", "blue"]
Sampling = Literal["reference", "auto", "uniform", "predicted", "paper", "weighted", "variance"]


@dataclass(frozen=True)
class Picture(Shown):
    """The picture that a camera sees: arrays [row, column], with row 0 at the top."""

    radiance: NDArray[np.float64]
    """In W m⁻² sr⁻¹, the mean over each pixel."""
    error: NDArray[np.float64]
    """Standard error of the radiance; NaN for pictures from few shading samples, which have no error."""
    folder: Path
    """The folder of picture.exr and picture.png."""

    def _variables(self) -> Variables:
        return {name: (("row", "column"), getattr(self, name)) for name in ("radiance", "error")}

    def _axes(self) -> Mapping[str, NDArray[Any]]:
        rows, columns = self.radiance.shape
        axes: dict[str, NDArray[Any]] = {"row": np.arange(rows), "column": np.arange(columns)}
        return axes

    def plot(self, ax: Any = None) -> Any:
        """Draws the radiance up to its 99th percentile, row 0 at the top, on axes of matplotlib; returns the axes."""
        ax = axes_of(ax)
        image = ax.imshow(self.radiance, cmap="gray", vmin=0, vmax=float(np.percentile(self.radiance, 99)) or None)
        ax.set(xlabel="column", ylabel="row")
        ax.figure.colorbar(image, ax=ax, label="radiance [W m⁻² sr⁻¹]")
        return ax

    def __repr__(self) -> str:
        rows, columns = self.radiance.shape
        return f"<etendue.Picture {columns} × {rows} in {self.folder}>"


@dataclass(frozen=True)
class Probe:
    """The light field behind a pixel."""

    verdict: str
    """The verdict on the comparison of rays traced back with photons: pass, fail or undecided."""
    surfaces: list[dict[str, Any]]
    """The surfaces on the central ray, in order from the camera, with angle, curvatures and criterion."""
    planes: list[dict[str, Any]]
    """The planes, with report, verdict and bandwidths of the light less its mean [value, standard error], in cycles per unit slope and per
    metre."""
    picture: dict[str, Any]
    """The bandwidth of the picture around the pixel, less its mean: `largest` [value, standard error] in cycles per unit slope, with its
    `azimuth`; `across` it; `window`, that of the window alone; `samples` per pixel along a direction; `None` where the picture is smooth."""
    folder: Path
    """The folder of the arrays and pictures of all planes."""
    text: str
    """Surfaces, planes and bandwidths, as `etendue probe` prints them."""
    batches: int
    """Number of batches from which the errors of the planes are estimated."""

    def slices(self, plane: str) -> Mapping[str, NDArray[Any]]:
        """The slices of a plane: azimuth, measured (rays), predicted (photons), sigma, rho and nu, as in `slices.npz`."""
        with np.load(self.folder / plane / "slices.npz") as arrays:
            return dict(arrays)

    def measured(self, plane: str) -> ProbedPlane:
        """The spectrum that rays traced back measured at a plane, for `difference`, with the position and the window of the plane."""
        found = self._plane(plane)
        arrays = self.slices(plane)
        sigma, axes = arrays.get("measured_sigma", arrays["sigma"]), (arrays["azimuth"], arrays["rho"], arrays["nu"])
        sample = Sample(arrays["measured"], axes, sigma, found["report"]["noise_dof"], self.batches)
        return ProbedPlane(plane, sample, found["report"]["frame"], found["report"]["distance"], found["window"], found["frequencies"])

    def variance(self, plane: str) -> Variance:
        """The variances of samplers at a plane, if they were requested. The spectrum is from rays traced back, and the text is that of the probe."""
        found = self._plane(plane)
        if "variance" not in found:
            raise KeyError(f"no variances at {plane!r}: they were not requested, or the plane is dark, or its radiance does not vary")
        return Variance(found["variance"], self.text)

    def _plane(self, name: str) -> dict[str, Any]:
        names = [found["report"]["name"] for found in self.planes]
        if name not in names:
            raise KeyError(f"no plane {name!r}; there are {', '.join(names)}")
        return self.planes[names.index(name)]

    def to_xarray(self, plane: str) -> xarray.Dataset:
        """The spectrum that rays traced back measured at a plane, as an xarray dataset. Raises `ImportError` without xarray."""
        return self.measured(plane).to_xarray()

    def plot(self, plane: str, ax: Any = None) -> Any:
        """Draws the spectrum that rays traced back measured at a plane, on axes of matplotlib; returns the axes."""
        return self.measured(plane).plot(ax)

    def _repr_html_(self) -> str:
        planes = (self.measured(found["report"]["name"]) for found in self.planes)
        return f"<pre>{escape(self.text)}</pre>{picture(*planes)}"

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class ProbedPlane(Shown):
    """The measurement of a probe at a plane."""

    name: str
    """The name of the plane."""
    sample: Sample
    """The slices with their noise."""
    frame: Mapping[str, Any]
    """Origin O and axes X, Y and D of the plane in world coordinates. Light travels along D."""
    distance: float
    """From the last surface of the probe along the central ray, in metres."""
    window: types.Window
    """The window of the plane."""
    frequencies: types.Frequencies
    """The frequencies of the slices."""

    def _variables(self) -> Variables:
        axes = ("azimuth", "rho", "nu")
        return {"slices": (axes, self.sample.slices), "slices_sigma": (axes, self.sample.slices_sigma)}

    def _axes(self) -> Mapping[str, NDArray[Any]]:
        return dict(zip(("azimuth", "rho", "nu"), self.sample.axes))

    def plot(self, ax: Any = None) -> Any:
        """Draws the mean power over azimuths, without that of the noise, in dB below its peak, on axes of matplotlib; returns the axes."""
        power = (abs(self.sample.slices) ** 2 - self.sample.slices_sigma**2).mean(0)
        ax = plotted(ax, self.sample.axes[1], self.sample.axes[2], power)
        ax.set(title=self.name)
        return ax

    def __repr__(self) -> str:
        return f"<etendue.ProbedPlane {self.name}: {self.sample.slices.shape}>"


@dataclass(frozen=True)
class ImportedScene:
    """The contents of a scene."""

    counts: dict[str, int]
    """The number of objects of each kind, such as triangles."""
    cameras: list[tuple[str, tuple[int, int]]]
    """The name of each camera, and its width and height in pixels. The first camera is used unless another is named."""
    has_light: bool
    """Whether the scene has a light."""
    depth: int | None
    """The maximum number of surfaces that light meets between a source and the camera, if the file states one."""
    notes: list[str]
    """A sentence about each thing that was left out or approximated."""
    text: str
    """All contents, as `etendue import` prints them."""

    def __str__(self) -> str:
        return self.text


def import_scene(
    scene: str | os.PathLike[str],
    *,
    root: str | os.PathLike[str] | None = None,
    color: Color | None = None,
    set: Mapping[str, Value] | None = None,
    bounces: int | None = None,
    sky: float | None = None,
    look_from: Point | None = None,
    look_at: Point | None = None,
    up: Point | None = None,
    fov: float | None = None,
) -> ImportedScene:
    """Reads a scene of Mitsuba 3, pbrt-v4, glTF, OBJ or PLY, and returns its contents. The arguments are those of `render`.

    Raises `SceneError` with all reasons for which the scene is refused.
    """
    arguments = given(
        root=root,
        color=color,
        set=field_texts(set),
        bounces=bounces,
        sky=sky,
        look_from=look_from,
        look_at=look_at,
        up=up,
        fov=fov,
    )
    found = _etendue.import_scene(scene, arguments)
    return ImportedScene(
        found["counts"],
        [(name, (size[0], size[1])) for name, size in found["cameras"]],
        found["has_light"],
        found["depth"],
        found["notes"],
        "\n".join(found["lines"]),
    )


def render(
    scene: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str],
    camera: str | None = None,
    size: Size | None = None,
    method: Sampling | None = None,
    samples: int | None = None,
    shading_samples: int | None = None,
    paths: int | None = None,
    blocker_rays: int | None = None,
    isotropic: bool = False,
    seed: int | None = None,
    root: str | os.PathLike[str] | None = None,
    color: Color | None = None,
    set: Mapping[str, Value] | None = None,
    bounces: int | None = None,
    sky: float | None = None,
    look_from: Point | None = None,
    look_at: Point | None = None,
    up: Point | None = None,
    fov: float | None = None,
    force: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Picture:
    """Traces paths from a camera of a scene of Mitsuba 3, pbrt-v4, glTF, OBJ or PLY.

    `camera` is the name of a camera, by default the first; `size` is the width and height in pixels, (64, 48) or "64x48", and replaces that
    of the camera. `method` is "reference", with `samples` paths for each pixel (64 by default), or a way to distribute a small number of
    `shading_samples` with `paths` paths each (128 by default): "auto", "uniform", "predicted", "paper", "weighted" or "variance". If
    only `shading_samples` is given, it is "auto". `blocker_rays` is the number of rays that find the distance of blockers, by default 100 for
    "paper" and otherwise 16; with `isotropic`, samples are equally dense along all directions.

    `root` is the folder that must contain all files of the scene; `color` is the number to which a colour is converted; `set` sets
    parameters of a Mitsuba file. `bounces` is the maximum number of surfaces that light meets; `sky` adds light of this radiance from all
    directions. `look_from` and `look_at` add a camera, with `up` and `fov`, the horizontal angle of view in degrees.

    `force` replaces files in `out` that Étendue did not write. `progress` states whether a bar is shown, or is a function that receives the
    number of finished pixels. Ctrl-C stops rendering at the end of a row. Raises `SceneError` with all reasons for which the scene is refused.
    """
    arguments = given(
        camera=camera,
        size=size,
        method=method,
        samples=samples,
        shading_samples=shading_samples,
        paths=paths,
        blocker_rays=blocker_rays,
        isotropic=isotropic,
        seed=seed,
        root=root,
        color=color,
        set=field_texts(set),
        bounces=bounces,
        sky=sky,
        look_from=look_from,
        look_at=look_at,
        up=up,
        fov=fov,
        force=force,
    )
    threads = thread_count(threads)
    with told(progress) as tell:
        _etendue.render(scene, out, arguments, threads, tell)
    with np.load(Path(out) / "picture.npz") as arrays:
        radiance = arrays["radiance"]
        error = arrays["error"] if "error" in arrays else np.full_like(radiance, np.nan)
        return Picture(radiance, error, Path(out))


def probe(
    scene: str | os.PathLike[str],
    pixel: tuple[int, int],
    *,
    out: str | os.PathLike[str],
    camera: str | None = None,
    size: Size | None = None,
    depth: int | None = None,
    window: float | None = None,
    rays: float | None = None,
    photons: float | None = None,
    seed: int | None = None,
    covariance: bool = False,
    variance: bool | Sequence[Any] = False,
    root: str | os.PathLike[str] | None = None,
    color: Color | None = None,
    set: Mapping[str, Value] | None = None,
    bounces: int | None = None,
    sky: float | None = None,
    look_from: Point | None = None,
    look_at: Point | None = None,
    up: Point | None = None,
    fov: float | None = None,
    force: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Probe:
    """Measures the light field behind a pixel (column, row), by rays traced back and by photons.

    `depth` is the maximum number of surfaces along the ray, 1 to 16, by default 1; `window` is the width of the window in pixels, by default
    the narrowest that shows the bandwidth of the picture. `rays` is the number of rays traced back for each plane, by default 2**20, and
    `photons` is the number of photons that check them; without `photons`, a plane gets as many of both as its verdict needs, at most 2**28.
    `covariance` also measures the covariance of each plane's spectrum. `variance` also predicts the error of the mean radiance over the
    window of each plane, and measures it with many sets of points: `True` for all named samplers of `etendue.variance`, or a sequence of
    samplers. All other arguments are those of `render`.
    """
    arguments = given(
        camera=camera,
        size=size,
        depth=depth,
        window=window,
        rays=rays,
        photons=photons,
        seed=seed,
        covariance=covariance,
        variance=variance,
        root=root,
        color=color,
        set=field_texts(set),
        bounces=bounces,
        sky=sky,
        look_from=look_from,
        look_at=look_at,
        up=up,
        fov=fov,
        force=force,
    )
    threads = thread_count(threads)
    with told(progress) as tell:
        lines = _etendue.probe(scene, pixel, out, arguments, threads, tell)
    found = json.loads((Path(out) / "probe.json").read_text(encoding="utf-8"))
    return Probe(found["verdict"], found["surfaces"], found["planes"], found["picture"], Path(out), "\n".join(lines), found["batches"])
