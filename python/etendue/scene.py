"""Scenes: files, or trees of the same fields."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union, cast, get_args

import numpy as np
from numpy.typing import NDArray

from etendue import types
from etendue._etendue import Run

if TYPE_CHECKING:
    from etendue._etendue import SceneArgument

T = TypeVar("T")
Method = Literal["photons", "backward", "given"]
"""Photons from the light, rays traced back from the windows, or rays that the user gives to `spectrum`, which are not traced."""
Value = Union[bool, int, float, str, Sequence[float]]
"""The values to which a field can be set: a number, several numbers, or text as in a scene file, such as "Distance(1.5)"."""
Source = Union[str, "os.PathLike[str]", types.Scene]
"""The path of a scene file, or the tree of its fields: `types.Scene`, as described by `etendue schema`."""


@dataclass(frozen=True)
class PlaneInfo:
    """What is known about a virtual plane before anything is measured."""

    name: str
    """The name of the plane."""
    prediction: str
    """The kind of prediction with which the plane is compared: "exact", "first-order" or "reference"."""
    chain: tuple[str, ...]
    """What happens to light on its way to the plane."""
    reasons: tuple[str, ...]
    """The parts of the scene that no theory describes; then another tracer replaces the theory."""


class Scene:
    """A valid scene with the settings of its measurement.

    `set` overrides fields by their paths: `{"blockers.0.pitch": 0.1}`. A tree may refer to
    meshes and pictures in `folder`.

    Raises `SceneError`, whose `faults` lists all errors in the scene.
    """

    def __init__(
        self,
        source: Source,
        *,
        set: Mapping[str, Value] | None = None,
        photons: float | None = None,
        seed: int | None = None,
        method: Method = "photons",
        name: str = "scene",
        folder: str | os.PathLike[str] = ".",
    ) -> None:
        if method not in get_args(Method):
            raise ValueError(f"method is {method!r}; allowed: 'photons' or 'backward'")
        fields = field_texts(set)
        count = None if photons is None else _whole(photons)
        seed = None if seed is None else _seed(seed)
        if isinstance(source, str) and "\n" in source:
            raise ValueError("scene is the text of a scene; allowed: the path of a scene file, or a tree such as json.loads returns")
        if isinstance(source, (str, os.PathLike)):
            self._folder = os.fspath(Path(source).absolute().parent)
            self._run = Run.read(source, fields, count, seed, method)
        else:
            self._folder = os.fspath(Path(folder).absolute())
            if not isinstance(source, Mapping):  # pyright: ignore[reportUnnecessaryIsInstance]
                raise TypeError(f"scene is {source!r}; allowed: the path of a scene file, or a tree of its fields")
            self._run = Run.read((json.dumps(_plain(source, "")), name, self._folder), fields, count, seed, method)
        self._method: Method = method

    @property
    def name(self) -> str:
        """The name of the scene file, without its extension."""
        return self._run.name

    @property
    def file(self) -> types.Scene:
        """The tree of the scene's fields, including defaults and overrides."""
        return cast(types.Scene, json.loads(self._run.json()))

    @property
    def photons(self) -> int:
        """Number of photons that a run emits."""
        return self._run.photons

    @property
    def batches(self) -> int:
        """Number of batches in which photons are emitted; each batch is an independent measurement."""
        return self._run.batches

    @property
    def planes(self) -> list[PlaneInfo]:
        """The virtual planes of the scene."""
        found = self._run.planes()
        return [PlaneInfo(name, kind, tuple(chain), tuple(reasons)) for name, kind, chain, reasons in found]

    @property
    def warnings(self) -> list[str]:
        """Probable mistakes in the scene, each described by a sentence."""
        return self._run.warnings()

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuilt, (self._run.json(), self.name, self._folder, self._method)

    def __repr__(self) -> str:
        names = ", ".join(plane.name for plane in self.planes)
        return f"<etendue.Scene {self.name}: {self.photons} photons; planes {names}>"


def _rebuilt(text: str, name: str, folder: str, method: Method) -> Scene:
    return Scene(cast(types.Scene, json.loads(text)), name=name, folder=folder, method=method)


def as_scene(
    scene: Scene | Source,
    set: Mapping[str, Value] | None = None,
    photons: float | None = None,
    seed: int | None = None,
    method: Method = "photons",
) -> Scene:
    """The given scene, or a scene made from its description."""
    if not isinstance(scene, Scene):
        return Scene(scene, set=set, photons=photons, seed=seed, method=method)
    if set is None and photons is None and seed is None:
        return scene
    return Scene(
        scene.file,
        set=set,
        photons=photons,
        seed=seed,
        method=scene._method,  # pyright: ignore[reportPrivateUsage]
        name=scene.name,
        folder=scene._folder,  # pyright: ignore[reportPrivateUsage]
    )


def scene_argument(scene: Scene | Source) -> SceneArgument:
    """A scene as an argument of the native module: the path of its file, or its text with its name and folder."""
    if isinstance(scene, (str, os.PathLike)):
        return os.fspath(scene)
    scene = as_scene(scene)
    return (scene._run.json(), scene.name, scene._folder)  # pyright: ignore[reportPrivateUsage]


def method_of(scene: Scene | Source) -> Method | None:
    """The method by which a scene is measured, if it has one."""
    return scene._method if isinstance(scene, Scene) else None  # pyright: ignore[reportPrivateUsage]


def field_texts(set: Mapping[str, Value] | None) -> list[tuple[str, str]]:
    """Fields and their values as written in scene files."""
    return [(path, value_text(path, value)) for path, value in fields(set or {})]


def fields(set: Mapping[str, T]) -> Iterable[tuple[str, T]]:
    """The paths and values of fields."""
    if not isinstance(set, Mapping):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"set is {set!r}; allowed: a mapping from paths to values, such as {{'blockers.0.pitch': 0.1}}")
    return set.items()


def _plain(value: Any, path: str) -> Any:
    """A tree of values that JSON has, with numbers and arrays of NumPy as numbers and lists."""
    if isinstance(value, Mapping):
        tree = cast("Mapping[str, Any]", value)
        return {name: _plain(part, f"{path}.{name}" if path else str(name)) for name, part in tree.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        value = cast("NDArray[Any]", value).tolist()
    if isinstance(value, (list, tuple)):
        parts = cast("Sequence[Any]", value)
        return [_plain(part, f"{path}.{number}") for number, part in enumerate(parts)]
    if value is not None and not isinstance(value, (bool, int, float, str)):
        raise TypeError(f"{path} is {value!r}; allowed: numbers, texts, sequences and mappings")
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{path} is {value}; allowed: finite numbers")
    return value


def _whole(photons: float) -> int:
    if isinstance(photons, str) or not 0 < photons < 2**63 or photons != int(photons):
        raise ValueError(f"photons is {photons!r}; allowed: a whole number above 0, such as 1e6 or 2**20")
    return int(photons)


def _seed(seed: int) -> int:
    if not 0 <= seed < 2**64 or seed != int(seed):
        raise ValueError(f"seed is {seed!r}; allowed: a whole number, 0 or above")
    return int(seed)


def value_text(path: str, value: Value) -> str:
    """The value of a field as written in scene files."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        # Numbers of NumPy are written in another way.
        return repr(float(value)) if isinstance(value, float) else repr(int(value))
    try:
        numbers = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        numbers = np.empty((0, 0))
    # `None` would become a number that is not one.
    if numbers.ndim > 1 or value is None:  # pyright: ignore[reportUnnecessaryComparison]
        raise TypeError(f"in set, {path}: {value!r}; allowed: a number, a sequence of numbers, or text such as 'Hann(0.5)'")
    return repr(float(numbers)) if numbers.ndim == 0 else "(" + ", ".join(repr(float(number)) for number in numbers) + ")"
