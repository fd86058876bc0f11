"""Predictions by the user: arrays, or functions that give the radiance of rays."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.profiles import half_width
from etendue.rays import spectrum
from etendue.result import Result
from etendue.scene import Scene
from etendue.stages import Measurement, Prediction, compare_with

Floats = NDArray[np.float64]
Radiance = Callable[[Floats, Floats, Floats, Floats], ArrayLike]
PlaneTheory = Union[ArrayLike, Mapping[str, ArrayLike], Radiance]
"""The theory of a plane: slices [azimuth, rho, nu]; named arrays; or a function radiance(x, y, u, v)."""

COMPLEX = ("slices", "replicates", "derivatives")
TEXTS = ("parameters", "units")
REPLICATES = 32
FIRST, LAST = 2**12, 2**20
"""The first and the largest number of points of a replicate."""
SHARE = 0.3
"""The largest share of the noise that the error of a function's slices may have."""
# Roberts (2018): multiples of powers of the root of x⁵ = x + 1, a sequence of low discrepancy for any number of points.
STEPS = 1.1673039782614187 ** -np.arange(1.0, 5.0)


def theory(scene: Scene, planes: Mapping[str, PlaneTheory], *, points: int = FIRST) -> Prediction:
    """Returns a theory of the user as a prediction, for `compare`.

    `planes` has for each plane an array of slices [azimuth, rho, nu], with the axes of the plane's `slices` or with rho ≥ 0; or a mapping
    with the arrays of docs/own-theory.md (`slices`, `replicates`, `sigma`, `parameters`, `units`, `values`, `derivatives`); or a function
    `radiance(x, y, u, v)` of arrays. The function is evaluated at `points` points of each of 32 shifted sequences in the plane's window.

    Raises `SceneError` if an array does not fit.
    """
    arrays: dict[str, NDArray[Any]] = {}
    for name, of in planes.items():
        if callable(of):
            of = {"replicates": _replicates(scene, name, of, points)}
        for array, values in (of if isinstance(of, Mapping) else {"slices": of}).items():
            kind = np.complex128 if array in COMPLEX else np.str_ if array in TEXTS else np.float64
            arrays[f"{name}/{array}"] = np.asarray(values, dtype=kind)
    file = io.BytesIO()
    np.savez(file, **arrays)  # pyright: ignore[reportArgumentType]
    return Prediction(scene, scene._run.theory(file.getvalue()))  # pyright: ignore[reportPrivateUsage]


def compare(
    measurement: Measurement, prediction: Prediction | Mapping[str, PlaneTheory] | None = None, *, threads: int | None = None
) -> Result:
    """Compares a measurement with a prediction, and returns the verdict.

    `prediction` is a prediction of Étendue, by default that of the scene, or a theory of the user: for each plane, what `theory` takes.
    The points of functions are doubled until the error of their slices is at most 0.3 of the noise, or until there are 2²⁰.
    """
    if prediction is not None and not isinstance(prediction, (Prediction, Mapping)):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"a theory is {{plane: theory}}, not {type(prediction).__name__}")
    if not isinstance(prediction, Mapping):
        return compare_with(measurement, prediction, threads)
    points = FIRST
    while True:
        found = compare_with(measurement, theory(measurement.scene, prediction, points=points), threads)
        reports = [found[name].report for name, of in prediction.items() if callable(of)]
        if points >= LAST or all(report["quadrature_error"] <= SHARE * report["noise_limit"] for report in reports):
            return found
        points *= 2


def _replicates(scene: Scene, name: str, radiance: Radiance, points: int) -> NDArray[np.complex128]:
    """Estimates of the slices of a radiance function, [replicate, azimuth, rho, nu]."""
    file = scene.file
    plane = next((plane for plane in file["planes"] if plane["name"] == name), None)
    if plane is None:
        raise ValueError(f"no plane {name!r}; there are {', '.join(plane['name'] for plane in file['planes'])}")
    window = plane.get("window") or file["window"]
    frequencies = plane.get("frequencies") or file["frequencies"]
    profiles = [window["x"], window.get("y") or window["x"], window["u"], window.get("v") or window["u"]]
    half = np.array([half_width(profile) for profile in profiles])
    sequence = np.arange(points)[:, None] * STEPS
    random = np.random.default_rng(1)

    def one() -> NDArray[np.complex128]:
        x, y, u, v = ((2 * ((sequence + random.random(4)) % 1) - 1) * half).T
        # The function may change its arguments.
        values = np.asarray(radiance(x.copy(), y.copy(), u.copy(), v.copy()))
        if values.dtype.kind not in "buif" or values.shape not in ((), (points,)):
            what = f"{values.dtype} of shape {values.shape}"
            raise ValueError(f"the function of plane {name} returned {what}; allowed: a real number for each of {points} rays")
        values = np.broadcast_to(values.astype(np.float64), (points,))
        weight = values * (np.prod(2 * half) / points)
        return spectrum(x, y, u, v, weight, window=window, frequencies=frequencies, batches=3).slices

    return np.array([one() for _ in range(REPLICATES)])
