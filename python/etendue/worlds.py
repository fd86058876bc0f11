"""Scenes of other programs: what their cameras see, and the light field behind a pixel."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from etendue.commands import _done  # pyright: ignore[reportPrivateUsage]


@dataclass(frozen=True)
class Picture:
    """What a camera sees: arrays [row, column], row 0 at the top."""

    radiance: NDArray[np.float64]
    """W m⁻² sr⁻¹, the mean over each pixel."""
    error: NDArray[np.float64]
    """Its standard error."""
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

    def slices(self, plane: str) -> Mapping[str, NDArray[Any]]:
        """The slices of a plane: azimuth, measured (rays), predicted (photons), sigma, rho, nu, as `slices.npz` has them."""
        with np.load(self.folder / plane / "slices.npz") as arrays:
            return dict(arrays)


def render(scene: str | os.PathLike[str], *, out: str | os.PathLike[str], samples: int = 64, **options: Any) -> Picture:
    """Traces paths from a camera of a scene of Mitsuba 3, pbrt-v4, glTF, OBJ or PLY.

    `options` are those of the command `etendue render`, such as `size="64x64"`, `bounces=1` or `camera="front"`.
    """
    _done("render", [scene], [f"--samples={samples}", *_arguments(options)], Path(out))
    with np.load(Path(out) / "picture.npz") as arrays:
        return Picture(arrays["radiance"], arrays["error"], Path(out))


def probe(scene: str | os.PathLike[str], pixel: tuple[int, int], *, out: str | os.PathLike[str], **options: Any) -> Probe:
    """Measures the light field behind a pixel (column, row), by rays traced back and by photons.

    `options` are those of the command `etendue probe`, such as `depth=2`, `window=64` or `rays=2**20`.
    """
    column, row = pixel
    _done("probe", [scene], [f"--pixel={column},{row}", *_arguments(options)], Path(out))
    found = json.loads((Path(out) / "probe.json").read_text(encoding="utf-8"))
    return Probe(found["verdict"], found["surfaces"], found["planes"], Path(out))


def _arguments(options: Mapping[str, Any]) -> list[str]:
    return [f"--{name.replace('_', '-')}={value}" for name, value in options.items()]
