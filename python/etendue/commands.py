"""Sweeps and figures, which write many files."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.progress import Progress, told
from etendue.ranges import thread_count
from etendue.scene import Method, Scene, Source, Value, field_texts, fields, method_of, scene_argument, value_text

if TYPE_CHECKING:
    _Path = Path
else:
    # Before Python 3.12, only the class of the platform can be extended.
    _Path = type(Path())


def sweep(
    scene: Scene | Source,
    set: Mapping[str, Value | Sequence[float] | NDArray[np.float64]],
    *,
    out: str | os.PathLike[str],
    together: bool = False,
    common_seed: bool = False,
    photons: float | None = None,
    seed: int | None = None,
    method: Method | None = None,
    force: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> dict[str, NDArray[Any]]:
    """Runs a scene with several values of its fields. Returns the table of all planes, as an array for each column.

    `set` gives a field one value, a sequence of numbers, or text: `{"blockers.0.pitch": "0.05..0.4:8"}` means 8 values at equal distances,
    and `:8log` means 8 values with logarithmic spacing. Several fields take all combinations of their values; with `together`, they vary
    together, value by value.
    `photons`, `seed` and `method` are as in `run`. Each point has its own seed, unless `common_seed` is true.
    Finished points are kept in `out`, and the same call continues from them, even after Ctrl-C. `force` replaces files in `out` that
    Étendue did not write.
    `progress` states whether a bar is shown, or is a function that receives the number of finished points.

    Raises `SceneError` with all faults of the scene, and `CannotRun` if `out` contains something else.
    """
    arguments = given(
        together=together,
        common_seed=common_seed,
        photons=photons,
        seed=seed,
        method=method_of(scene) if method is None else method,
        force=force,
    )
    values = [(path, _values(path, value)) for path, value in fields(set)]
    threads = thread_count(threads)
    with told(progress) as tell:
        _etendue.sweep(scene_argument(scene), values, out, arguments, threads, tell)
    return read_table(Path(out) / "sweep.csv")


class DrawnFigure(_Path):
    """The path of a PNG, which notebooks show."""

    def _repr_png_(self) -> bytes | None:
        return self.read_bytes() if self.suffix == ".png" and self.is_file() else None


def figure(
    scenes: Sequence[Scene | Source],
    *,
    out: str | os.PathLike[str],
    plane: str | None = None,
    set: Mapping[str, Value] | None = None,
    style: str | os.PathLike[str] | None = None,
    quality: Literal["draft", "print"] | None = None,
    force: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> DrawnFigure:
    """Draws scenes: writes PNG, SVG, PDF and their data to a folder below `out`. Returns the path of the PNG, which notebooks show.

    One scene is drawn along its path, or at `plane` only; several scenes are drawn side by side at `plane`, or each at its last plane.
    A name such as "7" or "table1" means a figure of the paper; if there are several, the PNG of the first is returned.
    `set` overrides fields of the scenes. `style` is a file that determines how the figure looks.
    `quality` is "print" (the default) or "draft", with an eighth of the photons of the scenes, and fewer frequencies.
    `force` replaces files in `out` that Étendue did not write.
    `progress` states whether a bar is shown, or is a function that receives the progress of the current work.
    """
    if isinstance(scenes, (str, os.PathLike, Mapping, Scene)):
        raise TypeError("scenes is one scene; allowed: a sequence of them, such as [scene]")
    arguments = given(plane=plane, style=style, quality=quality, force=force)
    wanted = [scene_argument(scene) for scene in scenes]
    threads = thread_count(threads)
    with told(progress) as tell:
        folder = _etendue.figure(wanted, field_texts(set), out, arguments, threads, tell)
    return DrawnFigure(folder, "figure.png")


def read_table(path: Path) -> dict[str, NDArray[Any]]:
    """The columns of a table in CSV, by name: numbers, NaN where a cell is empty, or texts."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: _column([row[name] for row in rows]) for name in rows[0]}


def given(**arguments: Any) -> dict[str, Any]:
    """The arguments that a caller has given; the library has the defaults of all others."""
    return {name: value for name, value in arguments.items() if value is not None}


def _values(path: str, value: Value | Sequence[float] | NDArray[np.float64]) -> str | list[float]:
    text = value_text(path, value)  # type: ignore[arg-type]
    return text if isinstance(value, str) or np.ndim(value) == 0 else [float(number) for number in value]  # type: ignore[union-attr]


def _column(cells: list[str]) -> NDArray[Any]:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells)
