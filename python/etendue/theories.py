"""Predictions by the user: arrays, or functions that give radiance or spectra."""

from __future__ import annotations

import io
import json
import os
import warnings
from collections.abc import Callable, Mapping
from typing import Any, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from etendue.profiles import STEPS, ProfileSampler
from etendue.ranges import thread_count
from etendue.rays import Spectrum
from etendue.result import Result
from etendue.scene import Scene
from etendue.stages import Measurement, Prediction, compare_with

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Radiance = Callable[[Floats, Floats, Floats, Floats], ArrayLike]
Function = Callable[..., ArrayLike]
PlaneTheory = Union[ArrayLike, Mapping[str, Any], Radiance]
"""The theory of a plane: slices [azimuth, rho, nu]; named arrays and functions; or a function radiance(x, y, u, v)."""

COMPLEX = ("slices", "replicates", "derivatives")
TEXTS = ("parameters", "units")
FUNCTIONS = ("radiance", "spectrum")
REPLICATES = 32
FIRST, LAST = 2**12, 2**20
"""The first and the largest number of points of a replicate."""
SHARE = 0.3
"""The largest share of the noise that the error of a function's slices may have."""
COARSE = 0.05
"""The largest error of a function's slices, relative to the slices; above 0.09, replicates may be too uneven for a test."""
STEP = 0.01
"""The step of the differences that give derivatives, as a share of a parameter."""
BLOCK = 2**20
"""The largest number of rays or frequencies at which a function is evaluated at a time."""


def theory(scene: Scene, planes: Mapping[str, PlaneTheory], *, points: int = FIRST, threads: int | None = None) -> Prediction:
    """Makes a prediction of a theory of the user, for `compare`.

    `planes` has for each plane an array of slices [azimuth, rho, nu], with the axes of the plane's `slices` or with rho ≥ 0; or a function
    `radiance(x, y, u, v)` of arrays; or a mapping. The mapping has the arrays of docs/own-theory.md (`slices`, `replicates`, `sigma`,
    `parameters`, `units`, `values`, `derivatives`). In place of the slices it may have the function `radiance`, or `spectrum(ox, oy, ou, ov)`,
    the spectrum of the field without window in cycles per metre and per unit of slope. If it has `parameters` and `values`, the function
    receives them by name; their derivatives are differences over 1 % of each value, or over `steps`. A function is evaluated at `points`
    points of each of 32 shifted sequences.

    Raises `SceneError` if an array does not fit, and `ValueError` for a function that does not.
    """
    planes = _by_plane(planes)
    sums = _sums(scene, planes, threads)
    for each in sums.values():
        each.grow(points)
    return _predicted(scene, planes, sums)


def compare(
    measurement: Measurement | Spectrum,
    prediction: Prediction | Mapping[str, PlaneTheory] | str | os.PathLike[str] | None = None,
    *,
    threads: int | None = None,
) -> Result:
    """Compares a measurement with a prediction, and returns the verdict.

    `prediction` is a prediction of Étendue, by default that of the scene, or a theory of the user: for each plane, what `theory` takes; or
    an NPZ file of arrays PLANE/ARRAY. A `Spectrum` of rays has one plane, "rays", and needs a theory of the user. The points of functions
    are doubled until the error of their slices is at most 0.3 of the noise and 5 % of the slices, or until there are 2²⁰.
    """
    if isinstance(prediction, (str, os.PathLike)):
        with np.load(prediction) as file:
            prediction = dict(file)
    if not isinstance(measurement, (Measurement, Spectrum)):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"compare takes what `measure` or `spectrum` returns, not {type(measurement).__name__}; `run` does all stages")
    if isinstance(measurement, Spectrum):
        if measurement.measurement is None:
            raise ValueError("this spectrum was pickled, which leaves out its batches; compute it again to compare it")
        measurement = measurement.measurement
        if not isinstance(prediction, Mapping):
            raise TypeError("compare needs a theory of rays, {'rays': theory}: Étendue does not know their scene")
    if not isinstance(prediction, Mapping):
        if prediction is not None and not isinstance(prediction, Prediction):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise TypeError(f"a theory is {{plane: theory}}, not {type(prediction).__name__}")
        return compare_with(measurement, prediction, threads)
    scene = measurement.scene
    prediction = _by_plane(prediction)
    sums = _sums(scene, prediction, threads)
    for each in sums.values():
        each.grow(FIRST)
    while True:
        found = compare_with(measurement, _predicted(scene, prediction, sums), threads)
        coarse = [each for name, each in sums.items() if each.is_coarse(found[name].report)]
        if all(each.points >= LAST for each in coarse):
            for each in coarse:
                error, noise = (100 * found[each.name].report[of] for of in ("quadrature_error", "noise_limit"))
                said = f"plane {each.name}: with {LAST} points the function's slices have an error of {error:.2g} %; noise is {noise:.2g} %"
                warnings.warn(said, stacklevel=2)
            return found
        for each in coarse:
            each.refine(found[each.name].report)


def _by_plane(stated: Mapping[str, PlaneTheory]) -> dict[str, PlaneTheory]:
    """Collects arrays that are named PLANE/ARRAY, as in a file."""
    found: dict[str, Any] = {}
    for name, of in stated.items():
        plane, slash, array = name.rpartition("/")
        if slash:
            found.setdefault(plane, {})[array] = of
        else:
            found[name] = of
    return found


def _named(of: PlaneTheory) -> Mapping[str, Any]:
    """The arrays and functions of a plane, by their names."""
    if isinstance(of, Mapping):
        return cast(Mapping[str, Any], of)
    return {"radiance" if callable(of) else "slices": of}


def _sums(scene: Scene, planes: Mapping[str, PlaneTheory], threads: int | None) -> dict[str, _Sums]:
    names = [plane.name for plane in scene.planes]
    found: dict[str, _Sums] = {}
    for name, of in planes.items():
        stated = _named(of)
        functions = [kind for kind in FUNCTIONS if kind in stated]
        if not functions:
            continue
        if name not in names:
            raise ValueError(f"no plane {name!r}; there are {', '.join(names)}")
        if len(functions) == 2 or "slices" in stated or "replicates" in stated or not callable(stated[functions[0]]):
            raise ValueError(f"plane {name} has {', '.join(stated)}; allowed: one function, or slices and replicates")
        kind = _Radiance if functions == ["radiance"] else _Spectrum
        found[name] = kind(scene, names.index(name), name, stated, threads)
    return found


def _predicted(scene: Scene, planes: Mapping[str, PlaneTheory], sums: Mapping[str, _Sums]) -> Prediction:
    arrays: dict[str, NDArray[Any]] = {}
    for name, of in planes.items():
        stated = sums[name].arrays() if name in sums else _named(of)
        for array, values in stated.items():
            kind = np.complex128 if array in COMPLEX else np.str_ if array in TEXTS else np.float64
            arrays[f"{name}/{array}"] = np.asarray(values, dtype=kind)
    file = io.BytesIO()
    np.savez(file, **arrays)  # pyright: ignore[reportArgumentType]
    return Prediction(scene, scene._run.theory(file.getvalue()))  # pyright: ignore[reportPrivateUsage]


class _Sums:
    """Sums of a function over shifted sequences of points, which grow with the number of points."""

    def __init__(self, scene: Scene, plane: int, name: str, stated: Mapping[str, Any], threads: int | None) -> None:
        self.name, self.points = name, 0
        self.plane, self.run, self.threads = plane, scene._run, thread_count(threads)  # pyright: ignore[reportPrivateUsage]
        axes = self.run.axes(plane)
        self.window: dict[str, dict[str, Any]] = json.loads(axes["window"])
        self.stated = {array: values for array, values in stated.items() if array not in (*FUNCTIONS, "steps")}
        self.function: Function = stated["radiance" if "radiance" in stated else "spectrum"]
        known = (*FUNCTIONS, *TEXTS, "values", "steps", "derivatives", "sigma", "azimuth", "rho", "nu")
        if unknown := [key for key in stated if key not in known]:
            raise ValueError(f"plane {name} has {', '.join(unknown)}; allowed beside a function: {', '.join(known)}")
        names = [str(name) for name in np.atleast_1d(np.asarray(stated.get("parameters", []), dtype=object))]
        values = np.atleast_1d(np.asarray(stated.get("values", []), dtype=float))
        self.steps = np.asarray(stated.get("steps", STEP * np.where(values == 0, 1, abs(values))), dtype=float)
        if not len(names) == values.size == self.steps.size or not (self.steps > 0).all():
            raise ValueError(f"plane {name} has {len(names)} parameters, {values.size} values and {self.steps.size} steps above 0")
        # The values of the parameters, and these values with each parameter moved forwards and backwards.
        moves = [] if "derivatives" in stated else [sign * row for row in np.diag(self.steps) for sign in (1, -1)]
        self.settings = [dict(zip(names, values + move)) for move in [np.zeros(values.size), *moves]]
        azimuth, rho, nu = (np.asarray(axes[axis], float) for axis in ("azimuth", "rho", "nu"))
        self.shape = (REPLICATES, azimuth.size, rho.size, nu.size)
        radii, turns = (np.repeat(rho, nu.size), np.tile(nu, rho.size)), (np.cos(azimuth), np.sin(azimuth))
        self.omega: list[Floats] = [np.outer(turn, radius).ravel() for radius in radii for turn in turns]
        self.sums = np.zeros((len(self.settings), *self.shape), complex)
        self.shifts = np.random.default_rng(1).random((REPLICATES, 1, 4))

    def grow(self, points: int) -> None:
        """Adds the points that are missing."""
        while self.points < points:
            until = min(points, self.points + max(BLOCK // REPLICATES, 1))
            sequence = np.arange(self.points, until)[:, None] * STEPS
            nodes, weights = self.nodes((sequence + self.shifts) % 1)
            for sums, setting in zip(self.sums, self.settings):
                sums += self.added(nodes, weights, setting)
            self.points = until

    def nodes(self, places: Floats) -> tuple[Floats, Floats]:
        """Nodes of the integral for places that are uniform in [0, 1)⁴, [replicate, point, 4], and their weights [replicate, point]."""
        raise NotImplementedError

    def added(self, nodes: Floats, weights: Floats, setting: Mapping[str, float]) -> Complexes:
        """The sums over new nodes, [replicate, azimuth, rho, nu]."""
        raise NotImplementedError

    def checked(self, values: ArrayLike, shape: tuple[int, ...], kinds: str) -> NDArray[Any]:
        found = np.asarray(values)
        if found.dtype.kind not in kinds or found.shape not in ((), shape):
            kind, what = "complex" if "c" in kinds else "real", f"{found.dtype} of shape {found.shape}"
            raise ValueError(f"the function of plane {self.name} returned {what}; allowed: a {kind} number for each of {shape}")
        if not np.isfinite(found).all():
            raise ValueError(f"the function of plane {self.name} returned a number that is not finite")
        return np.broadcast_to(found, shape)

    def arrays(self) -> dict[str, Any]:
        means = self.sums[1:].mean(axis=1) / self.points
        found = {**self.stated, "replicates": self.sums[0] / self.points}
        if not self.sums[0].any():
            # A function that predicts darkness is certain of it, as an array is.
            found["slices"] = found.pop("replicates")[0]
        if self.settings[1:]:
            found["derivatives"] = (means[::2] - means[1::2]) / (2 * self.steps[:, None, None, None])
        return found

    def error(self) -> float:
        """The standard error of the slices, relative to the slices."""
        mean = self.sums[0].mean(axis=0)
        variance = self.sums[0].var(axis=0).sum() / (REPLICATES - 1)
        return float(np.sqrt(variance / (abs(mean) ** 2).sum())) if mean.any() else 0.0

    def is_coarse(self, report: Mapping[str, Any]) -> bool:
        error, noise = report["quadrature_error"], report["noise_limit"]
        return error is not None and noise is not None and error > min(SHARE * noise, COARSE)

    def refine(self, report: Mapping[str, Any]) -> None:
        """Doubles the points until the error is as small as it should be beside the noise of the measurement alone."""
        noise = np.sqrt(max(report["noise_limit"] ** 2 - report["quadrature_error"] ** 2, 0))
        first = self.points
        while self.points == first or (self.points < LAST and self.error() > min(SHARE * noise, COARSE)):
            self.grow(2 * self.points)


class _Radiance(_Sums):
    def nodes(self, places: Floats) -> tuple[Floats, Floats]:
        draws = [ProfileSampler(self.window[name]).draw(places[..., i]) for i, name in enumerate("xyuv")]
        # A batch holds the mean over all batches.
        weights = 1 / (np.prod([density for _, density in draws], axis=0) * REPLICATES)
        return np.array([place.ravel() for place, _ in draws]), weights

    def added(self, nodes: Floats, weights: Floats, setting: Mapping[str, float]) -> Complexes:
        # The function may change its arguments.
        values = self.checked(self.function(*nodes.copy(), **setting), nodes[0].shape, "buif")
        batch = np.repeat(np.arange(REPLICATES, dtype=np.uint32), weights.shape[1])
        return self.run.sums(self.plane, [*nodes, values * weights.ravel()], batch, REPLICATES, self.threads)


class _Spectrum(_Sums):
    """Ŝ(Ω) = ∫ ℓ̂(Ω − k) Ŵ(k) dk, with nodes k of density ∏ (1 + t²)^(−3/2)/2, t = 2hk, which falls as the transform of a Hann window does."""

    def nodes(self, places: Floats) -> tuple[Floats, Floats]:
        if any(list(profile) != ["Hann"] for profile in self.window.values()):
            raise ValueError(f"the window of plane {self.name} has other profiles than Hann, and a spectrum function needs Hann")
        half = np.array([self.window[name]["Hann"] for name in "xyuv"])
        place = 2 * places - 1
        rest = np.maximum(1 - place**2, np.finfo(float).tiny)
        t = place / np.sqrt(rest)
        weights = (np.sinc(t) + 0.5 * (np.sinc(t - 1) + np.sinc(t + 1))) / rest**1.5
        return t / (2 * half), weights.prod(axis=-1)

    def added(self, nodes: Floats, weights: Floats, setting: Mapping[str, float]) -> Complexes:
        sums = np.zeros((REPLICATES, self.omega[0].size), complex)
        block = max(BLOCK // self.omega[0].size, 1)
        for total, moves, weight in zip(sums, nodes, weights):
            for first in range(0, weight.size, block):
                move = moves[first : first + block]
                frequencies = [axis - column[:, None] for axis, column in zip(self.omega, move.T)]
                values = self.checked(self.function(*frequencies, **setting), frequencies[0].shape, "buifc")
                total += weight[first : first + block] @ values
        return sums.reshape(self.shape)
