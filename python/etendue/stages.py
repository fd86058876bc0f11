"""The stages of a run. Each is a function that works in memory."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.progress import Progress, told
from etendue.ranges import thread_count, whole
from etendue.result import Result
from etendue.scene import Method, Scene, Source, Value, as_scene
from etendue.stored import Stored


class Measurement:
    """The measurement of some or all batches of a scene. Measurements with the same scene, seed and number of photons can be combined by
    `merge`, wherever they were made; a measurement can be pickled, to send it to another process."""

    def __init__(self, scene: Scene, raw: _etendue.Measurement) -> None:
        self.scene = scene
        self._raw = raw

    @property
    def batches(self) -> list[int]:
        """The numbers of the measured batches, without batches that have no photon."""
        return self._raw.batches

    @property
    def photons(self) -> int:
        """Number of photons emitted in these batches."""
        return self._raw.photons

    def __reduce__(self) -> tuple[object, ...]:
        return _unpacked, (self.scene, self.scene._run.packed(self._raw))  # pyright: ignore[reportPrivateUsage]

    def __repr__(self) -> str:
        return f"<etendue.Measurement of {self.scene.name}: {len(self.batches)} batches, {self.photons} photons>"


class Prediction:
    """The prediction for each plane of a scene: by theory, or by another tracer where no theory applies."""

    def __init__(self, scene: Scene, raw: _etendue.Prediction) -> None:
        self.scene = scene
        self._raw = raw

    def __reduce__(self) -> tuple[object, ...]:
        return _unpacked_prediction, (self.scene, self.scene._run.packed_prediction(self._raw))  # pyright: ignore[reportPrivateUsage]


def _unpacked(scene: Scene, batches: list[tuple[int, bytes]]) -> Measurement:
    return Measurement(scene, scene._run.unpacked(batches))  # pyright: ignore[reportPrivateUsage]


def _unpacked_prediction(scene: Scene, planes: list[bytes]) -> Prediction:
    return Prediction(scene, scene._run.unpacked_prediction(planes))  # pyright: ignore[reportPrivateUsage]


def check(scene: Scene | Source, *, set: Mapping[str, Value] | None = None) -> Scene:
    """Returns the scene if it is valid; `planes` states with what each plane is compared. Nothing is traced.

    Raises `SceneError` with all faults of the scene.
    """
    return as_scene(scene, set)


def measure(
    scene: Scene | Source,
    *,
    batches: Iterable[int] | None = None,
    set: Mapping[str, Value] | None = None,
    photons: float | None = None,
    seed: int | None = None,
    method: Method = "photons",
    threads: int | None = None,
    progress: Progress = None,
) -> Measurement:
    """Traces photons of a scene: all batches, or the batches with the given numbers. Other Python threads continue meanwhile."""
    scene = as_scene(scene, set, photons, seed, method)
    numbers = _batches(scene, batches)
    threads = thread_count(threads)
    with told(progress) as tell:
        raw = scene._run.measure(numbers, threads, tell)  # pyright: ignore[reportPrivateUsage]
    return Measurement(scene, raw)


def predict(
    scene: Scene | Source, *, set: Mapping[str, Value] | None = None, threads: int | None = None
) -> Prediction:
    """Predicts each plane of a scene."""
    scene = as_scene(scene, set)
    return Prediction(scene, scene._run.predict(thread_count(threads)))  # pyright: ignore[reportPrivateUsage]


def merge(measurements: Iterable[Measurement]) -> Measurement:
    """Merges parts of one measurement, in any order. The result is bit-identical to a measurement made at once.

    Raises `SceneError` if a batch is in two parts, or the parts have different planes, and `ValueError` if they are of different scenes.
    """
    parts = list(measurements)
    if not all(isinstance(part, Measurement) for part in parts):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError("merge takes measurements, as `measure` returns them")
    if not parts:
        raise ValueError("there is nothing to merge")
    first = parts[0]
    if any(part.scene.file != first.scene.file for part in parts):
        raise ValueError("the parts are of different scenes, seeds or numbers of photons")
    raw = [part._raw for part in parts]  # pyright: ignore[reportPrivateUsage]
    return Measurement(first.scene, raw[0].merged(raw[1:]))


def compare_with(measurement: Measurement, prediction: Prediction | None, threads: int | None) -> Result:
    """Compares a measurement with a prediction of its scene, which is predicted if none is given."""
    scene = measurement.scene
    if prediction is None:
        prediction = predict(scene, threads=threads)
    elif {**prediction.scene.file, "run": {}} != {**scene.file, "run": {}}:
        raise ValueError("measurement and prediction are of different scenes")
    raw = scene._run.compare(  # pyright: ignore[reportPrivateUsage]
        measurement._raw,  # pyright: ignore[reportPrivateUsage]
        prediction._raw,  # pyright: ignore[reportPrivateUsage]
        thread_count(threads),
    )
    return Result(scene, raw)


def run(
    scene: Scene | Source,
    *,
    set: Mapping[str, Value] | None = None,
    photons: float | None = None,
    seed: int | None = None,
    method: Method = "photons",
    threads: int | None = None,
    progress: Progress = None,
) -> Result:
    """Measures a scene, predicts it and compares both. Nothing is written; `Result.save` writes files.

    `scene` is the path of a scene file, a tree of its fields (`etendue.types.Scene`), or a `Scene`.
    `set` overrides fields by their paths, as in `{"blockers.0.pitch": 0.1}`; vectors are sequences, and text is as in a scene file: "Distance(1.5)".
    `photons` and `seed` replace those of the scene. Noise falls with the number of photons, and is lowest for powers of two.
    `method` is "photons", which are sent from the light, or "backward": rays are traced from each window back to the light.
    `threads` is 1 to 1024, by default one for each core; the result does not depend on it.
    `progress` states whether a bar is shown, or is a function that receives the number of traced photons.

    The result has the same bytes as that of `etendue run` on the same kind of processor. Ctrl-C stops the run within a tenth of a second.
    Raises `SceneError` with all faults of the scene, and `CannotRun` if there is not enough memory.
    """
    scene = as_scene(scene, set, photons, seed, method)
    return compare_with(measure(scene, threads=threads, progress=progress), None, threads)


def load(folder: str | os.PathLike[str]) -> Result | Measurement:
    """Reads what is stored in a folder.

    A folder of `etendue run` or `compare`, or of `Result.save`, gives a `Result` with the same numbers and arrays as that of `run`; the
    folder of `etendue measure`, which may be a part, gives a `Measurement`, for `merge` and `compare`. Arrays are read when they are first
    used, and each file must be as it was written. Only `str()` differs: it has no parameters. `sigma` of a light field is known to rounding.

    Raises `SceneError` if there is no such folder, if it has no result, or if a file has changed. An array that the folder does not have
    raises `CannotRun`, with the option that stores it: `--save batches` stores the batches that `difference` compares in pairs, and
    `--compact` leaves out light fields.
    """
    stored = Stored(folder)
    if stored.is_result:
        return Result(None, stored)
    index, inputs = stored.index, Path(stored.path) / "measurement.inputs"
    scene = Scene(index["scene_file"], method=index["method"], name=index["scene"], folder=inputs)
    return Measurement(scene, scene._run.stored(folder))  # pyright: ignore[reportPrivateUsage]


@dataclass(frozen=True, eq=False)
class Photons:
    """Photons that cross a plane."""

    rays: NDArray[np.float64]
    """[N, 5]: x, y in metres, u, v, and weight."""
    batch: NDArray[np.uint32]
    """The batch of each photon, [N]. Batches are independent of each other; the photons of one batch are not."""
    emitted: int
    """Number of emitted photons, including those that do not reach the plane. The sum of weight times window, divided by this number, is
    the integral of the windowed radiance."""


def photons(
    scene: Scene | Source,
    plane: str,
    *,
    batches: Iterable[int] | None = None,
    set: Mapping[str, Value] | None = None,
    photons: float | None = None,
    seed: int | None = None,
) -> Photons:
    """The photons of a scene that cross one of its planes, inside and outside the window."""
    scene = as_scene(scene, set, photons, seed)
    names = [known.name for known in scene.planes]
    if plane not in names:
        raise KeyError(f"no plane {plane!r}; there are {', '.join(names)}")
    numbers = _batches(scene, batches)
    run = scene._run  # pyright: ignore[reportPrivateUsage]
    rays, counts, emitted = run.crossings(numbers, names.index(plane))
    return Photons(rays, np.repeat(np.array(numbers, dtype=np.uint32), counts), sum(emitted))


def _batches(scene: Scene, batches: Iterable[int] | None) -> list[int]:
    if batches is None:
        return list(range(scene.batches))
    if not isinstance(batches, Iterable):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"batches is {batches!r}; allowed: their numbers, such as range(8)")
    return sorted({whole("one of batches", number, 0, scene.batches - 1) for number in batches})
