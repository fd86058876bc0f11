"""The stages of a run: each a function, all in memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.progress import Progress, told
from etendue.result import Result
from etendue.scene import Method, Scene, Source, Value, as_scene


class Measurement:
    """Some batches of a scene, or all. Two of one scene, seed and number of photons are `merge`d, wherever they were measured: it can be
    sent to another process (pickled)."""

    def __init__(self, scene: Scene, raw: _etendue.Measurement) -> None:
        self.scene = scene
        self._raw = raw

    @property
    def batches(self) -> list[int]:
        """The numbers of the batches it holds, those without a photon left out."""
        return self._raw.batches

    @property
    def photons(self) -> int:
        """Photons emitted in them."""
        return self._raw.photons

    def __reduce__(self) -> tuple[object, ...]:
        return _unpacked, (self.scene, self.scene._job.packed(self._raw))  # pyright: ignore[reportPrivateUsage]

    def __repr__(self) -> str:
        return f"<etendue.Measurement of {self.scene.name}: {len(self.batches)} batches, {self.photons} photons>"


class Prediction:
    """What theory says of each plane of a scene; another tracer, where theory has no word."""

    def __init__(self, scene: Scene, raw: _etendue.Prediction) -> None:
        self.scene = scene
        self._raw = raw


def _unpacked(scene: Scene, batches: list[tuple[int, bytes]]) -> Measurement:
    return Measurement(scene, scene._job.unpacked(batches))  # pyright: ignore[reportPrivateUsage]


def check(scene: Scene | Source, *, set: Mapping[str, Value] | None = None) -> Scene:
    """The scene, if it is sound; its `planes` tell what each is held against. Nothing is traced.

    Raises `SceneError` with all its faults.
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
    """Traces photons of a scene: all its batches, or those of these numbers. Other threads of Python go on meanwhile."""
    scene = as_scene(scene, set, photons, seed, method)
    numbers = list(range(scene.batches)) if batches is None else sorted({int(number) for number in batches})
    if numbers and not 0 <= numbers[0] <= numbers[-1] < scene.batches:
        raise ValueError(f"batches are {numbers[0]} to {numbers[-1]}; allowed: 0 to {scene.batches - 1}")
    with told(progress, scene.photons * len(numbers) // scene.batches, "photons") as tell:
        raw = scene._job.measure(numbers, threads, tell)  # pyright: ignore[reportPrivateUsage]
    return Measurement(scene, raw)


def predict(
    scene: Scene | Source, *, set: Mapping[str, Value] | None = None, threads: int | None = None
) -> Prediction:
    """What theory says of each plane of a scene."""
    scene = as_scene(scene, set)
    return Prediction(scene, scene._job.predict(threads))  # pyright: ignore[reportPrivateUsage]


def merge(measurements: Iterable[Measurement]) -> Measurement:
    """Parts of one measurement in one, in any order: the same bits as if it had been measured at once.

    Raises `SceneError` when a batch is in two of them, or they are of different planes, and `ValueError` when they are of different scenes.
    """
    parts = list(measurements)
    if not parts:
        raise ValueError("there is nothing to merge")
    first = parts[0]
    whole = first._raw  # pyright: ignore[reportPrivateUsage]
    for part in parts[1:]:
        if part.scene.file != first.scene.file:
            raise ValueError("the parts are of different scenes, seeds or numbers of photons")
        whole = whole.merged(part._raw)  # pyright: ignore[reportPrivateUsage]
    return Measurement(first.scene, whole)


def compare(measurement: Measurement, prediction: Prediction | None = None, *, threads: int | None = None) -> Result:
    """The verdict on a measurement. Its scene is predicted if no prediction is given."""
    scene = measurement.scene
    if prediction is None:
        prediction = predict(scene, threads=threads)
    elif {**prediction.scene.file, "run": {}} != {**scene.file, "run": {}}:
        raise ValueError("measurement and prediction are of different scenes")
    raw = scene._job.compare(  # pyright: ignore[reportPrivateUsage]
        measurement._raw,  # pyright: ignore[reportPrivateUsage]
        prediction._raw,  # pyright: ignore[reportPrivateUsage]
        threads,
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
    """Measures a scene, predicts it and compares. Nothing is written: `Result.save` does.

    The same bytes as `etendue run`, on any number of threads. Ctrl-C stops it within a tenth of a second.
    """
    scene = as_scene(scene, set, photons, seed, method)
    return compare(measure(scene, threads=threads, progress=progress), threads=threads)


def photons(
    scene: Scene | Source, plane: str, *, batches: Iterable[int] | None = None, **options: float
) -> NDArray[np.float64]:
    """The photons that cross a plane, [N, 5]: x, y in metres, u, v, and weight. The mean of weight times window over all photons emitted is
    the integral of the windowed radiance."""
    scene = as_scene(scene, **options)  # type: ignore[arg-type]
    names = [known.name for known in scene.planes]
    if plane not in names:
        raise KeyError(f"no plane {plane!r}; there are {', '.join(names)}")
    numbers = list(range(scene.batches)) if batches is None else list(batches)
    return scene._job.crossings(numbers, names.index(plane))  # pyright: ignore[reportPrivateUsage]
