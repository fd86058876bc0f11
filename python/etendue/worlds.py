"""Scenes of other programs: what their cameras see, and the light field behind a pixel."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.commands import given
from etendue.progress import Progress, told
from etendue.ranges import thread_count
from etendue.scene import Value, field_texts

Point = Sequence[float]
Size = Union[str, "tuple[int, int]"]
Color = Literal["luminance", "red", "green", "blue"]
Sampling = Literal["reference", "uniform", "predicted", "printed", "weighted", "variance"]


@dataclass(frozen=True)
class Picture:
    """What a camera sees: arrays [row, column], row 0 at the top."""

    radiance: NDArray[np.float64]
    """W m⁻² sr⁻¹, the mean over each pixel."""
    error: NDArray[np.float64]
    """Its standard error; NaN for pictures of few shading samples, which have none."""
    folder: Path
    """Where picture.exr and picture.png are."""


@dataclass(frozen=True)
class Probe:
    """The light field behind a pixel."""

    verdict: str
    """Of rays traced back against photons: pass, fail or undecided."""
    surfaces: list[dict[str, Any]]
    """The surfaces on the central ray, from the camera on, with angle, curvatures and criterion."""
    planes: list[dict[str, Any]]
    """The planes, with report, verdict and bandwidths [value, standard error] in cycles per slope and per metre."""
    folder: Path
    """Where the arrays and pictures of each plane are."""
    text: str
    """Surfaces, planes and bandwidths, as `etendue probe` prints them."""

    def slices(self, plane: str) -> Mapping[str, NDArray[Any]]:
        """The slices of a plane: azimuth, measured (rays), predicted (photons), sigma, rho, nu, as `slices.npz` has them."""
        with np.load(self.folder / plane / "slices.npz") as arrays:
            return dict(arrays)

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class ImportedScene:
    """What a scene holds."""

    counts: dict[str, int]
    """What there is of each kind, such as triangles."""
    cameras: list[tuple[str, tuple[int, int]]]
    """Each camera's name, and its pixels across and down. The first is used unless another is named."""
    has_light: bool
    """Whether something shines."""
    depth: int | None
    """Most surfaces that light meets between a source and the camera, if the file says so."""
    notes: list[str]
    """A sentence for all that was left out or approximated."""
    text: str
    """All of it, as `etendue import` prints it."""

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
    """Reads a scene of Mitsuba 3, pbrt-v4, glTF, OBJ or PLY, and says what it holds. The arguments are those of `render`.

    Raises `SceneError` with all causes for which the scene is refused.
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

    `camera` is its name, the first unless said; `size` is pixels across and down, (64, 48) or "64x48", instead of the camera's.
    `method` is "reference" with `samples` paths for each pixel (64 unless said), or a way to place `shading_samples` few samples of
    `paths` paths each (128 unless said): "uniform", "predicted", "printed", "weighted" or "variance". It is "predicted" where
    `shading_samples` is given alone. `blocker_rays` rays find the distance of blockers; with `isotropic`, samples are as dense along all
    directions.

    `root` is the folder that no file of the scene may lie out of; `color` is the number that a colour becomes; `set` gives parameters of
    a Mitsuba file values. `bounces` is how many surfaces light meets at most; `sky` adds light of this radiance from everywhere.
    `look_from` and `look_at` add a camera, with `up` and `fov`, the angle from side to side in degrees.

    `force` replaces files in `out` that Étendue did not write. `progress` is whether a bar is shown, or a function that is told how many
    pixels are done. Ctrl-C stops it at the end of a row. Raises `SceneError` with all causes for which the scene is refused.
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

    `depth` is how many surfaces along the ray are looked at, 1 to 16, 1 unless said; `window` is how many pixels are across the window, 16
    unless said. `rays` rays are traced back for each plane, 2**20 unless said, and `photons` photons check them, 2**25 unless said.
    `covariance` measures the covariance of each plane's spectrum too. All other arguments are those of `render`.
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
    return Probe(found["verdict"], found["surfaces"], found["planes"], Path(out), "\n".join(lines))
