"""Commands that write many files, as functions."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from etendue._etendue import CannotRun, SceneError
from etendue.scene import Scene, Source, Value, _text, _whole, as_scene  # pyright: ignore[reportPrivateUsage]


def sweep(
    scene: Scene | Source,
    set: Mapping[str, Value | Sequence[float] | NDArray[np.float64]],
    *,
    out: str | os.PathLike[str],
    together: bool = False,
    photons: float | None = None,
) -> dict[str, NDArray[Any]]:
    """Runs a scene with fields that take several values; returns the table of all planes, a column each.

    `set` gives a field one value, a sequence of numbers, or text as the command takes it: `{"blockers.0.pitch": "0.05..0.4:8"}`.
    Several fields make a grid, or with `together` go in step. What is done is kept in `out`: the same call goes on from there.
    """
    arguments = [f"--set={path}={_values(value)}" for path, value in set.items()]
    if together:
        arguments.append("--together")
    if photons is not None:
        arguments.append(f"--photons={_whole(photons)}")
    _done("sweep", [scene], arguments, Path(out))
    with open(Path(out) / "sweep.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: _column([row[name] for row in rows]) for name in rows[0]}


def figure(
    scenes: Sequence[Scene | Source],
    *,
    out: str | os.PathLike[str],
    planes: Sequence[str] = (),
    style: str | os.PathLike[str] | None = None,
) -> Path:
    """Draws planes of scenes side by side: PNG, SVG, PDF and their data. Returns the PNG."""
    arguments = [f"--plane={plane}" for plane in planes]
    if style is not None:
        arguments.append(f"--style={os.fspath(style)}")
    _done("figure", scenes, arguments, Path(out))
    found = sorted(Path(out).rglob("figure.png"))
    return found[0]


def _values(value: object) -> str:
    if isinstance(value, (str, int, float)):
        return _text(value)
    return ",".join(repr(float(number)) for number in value)  # type: ignore[attr-defined]


def _column(cells: list[str]) -> NDArray[Any]:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells)


def _done(command: str, scenes: Sequence[Scene | Source], arguments: list[str], out: Path) -> None:
    """Runs a command; a fault of its input and one of this machine are raised as everywhere."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [_path(scene, Path(folder)) for scene in scenes]
        # What follows `--` is a path, whatever it begins with.
        line = [sys.executable, "-m", "etendue", command, *arguments, f"--out={out}", "--quiet", "--", *paths]
        ended = subprocess.run(line, capture_output=True, text=True, check=False)
    message = ended.stderr.strip().removeprefix("error: ")
    if ended.returncode == 2:
        error = SceneError(message)
        error.faults = message.splitlines()
        raise error
    if ended.returncode not in (0, 1, 4):
        raise CannotRun(message)


def _path(scene: Scene | Source, folder: Path) -> str:
    """A file that holds the scene."""
    if isinstance(scene, (str, os.PathLike)):
        return os.fspath(scene)
    scene = as_scene(scene)
    path = folder / f"{scene.name}.ron"
    path.write_text(json.dumps(scene.file), encoding="utf-8")
    return os.fspath(path)
