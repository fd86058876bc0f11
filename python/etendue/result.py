"""The results of a run."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.difference import Sample
from etendue.named import Named
from etendue.plot import Shown, Variables, draw_each, picture, plotted, table
from etendue.scene import Scene
from etendue.stored import NotStored, Stored

Floats = NDArray[np.float64]
Verdict = Literal["pass", "fail", "undecided"]
Outcome = Union[_etendue.Outcome, Stored]


@dataclass(frozen=True, eq=False)
class Slices:
    """Slices of the windowed spectrum, [azimuth, rho, nu], complex, as in `slices.npz`."""

    azimuth: Floats
    """In radians."""
    rho: Floats
    """In cycles per metre."""
    nu: Floats
    """In cycles per unit of u."""
    measured: NDArray[np.complex128]
    predicted: NDArray[np.complex128]
    sigma: Floats
    """Standard deviation of |measured − predicted| if the prediction is true."""
    sigma_measured: Floats
    """Standard deviation of |measured| alone; smaller than `sigma` if the prediction also has noise."""


@dataclass(frozen=True, eq=False)
class Radial:
    """The mean of the power spectrum over azimuths, [rho, nu], as in `radial.npz`."""

    rho: Floats
    nu: Floats
    measured: Floats
    """Power minus the noise of photons; noise can make it negative."""
    predicted: Floats
    sigma: Floats
    """Standard deviation of measured − predicted if the prediction is true."""
    sigma_measured: Floats
    """Standard error of measured."""
    shot_noise: Floats
    """The power that the noise of photons added; it has been subtracted."""


@dataclass(frozen=True, eq=False)
class LightField:
    """The windowed light field summed over y and v, [x, u]: means over cells, in W m⁻² sr⁻¹ m."""

    x: Floats
    """Centres of cells, in metres."""
    u: Floats
    """Centres of cells, as slopes."""
    measured: Floats
    predicted: Floats
    sigma: Floats
    """Standard error of measured."""


class Plane(Shown):
    """A virtual plane: measurement, prediction and verdict. NumPy takes over the memory of the arrays without a copy."""

    def __init__(self, outcome: Outcome, number: int, summary: Mapping[str, Any]) -> None:
        self._outcome = outcome
        self._number = number
        self._batches: int = summary["batches"]
        run = summary["scene_file"]["run"]
        self._numbers = (*(summary[name] for name in ("seed", "method", "photons", "batches")), run["sampling"], run["emission"])
        report: Mapping[str, Any] = summary["planes"][number]
        self.report = report
        """All numbers of the plane, as in `summary.json`."""

    @property
    def name(self) -> str:
        """The name of the plane."""
        return self.report["name"]

    @property
    def verdict(self) -> Verdict:
        """The verdict on the plane."""
        return self.report["verdict"]

    @property
    def p_value(self) -> float | None:
        """Probability of a disagreement at least as large as the measured one if the prediction is true."""
        return self.report["p_value"]

    @property
    def parameters(self) -> dict[str, Mapping[str, Any]]:
        """Distances and sizes derived from the spectra alone: `measured`, with its `error`, and the value in the scene, `scene`."""
        return {parameter["name"]: parameter for parameter in self.report["parameters"]}

    @cached_property
    def slices(self) -> Slices:
        """Slices of the spectrum."""
        return Slices(**self._outcome.slices(self._number))

    @cached_property
    def radial(self) -> Radial:
        """The mean of the power spectrum over azimuths."""
        return Radial(**self._outcome.radial(self._number))

    @cached_property
    def light_field(self) -> LightField:
        """The light field in (x, u)."""
        return LightField(**self._outcome.light_field(self._number))

    @property
    def sample(self) -> Sample:
        """The measured slices with their noise, for `difference`."""
        slices, number = self.slices, self._number
        noise = slices.sigma_measured, self.report["noise_dof"], self._batches
        axes = slices.azimuth, slices.rho, slices.nu
        return Sample(slices.measured, axes, *noise, self._numbers, lambda: self._outcome.batches(number))

    def _variables(self) -> Variables:
        slices, radial, axes = self.slices, self.radial, ("azimuth", "rho", "nu")
        found: dict[str, tuple[tuple[str, ...], NDArray[Any]]] = {
            "measured": (axes, slices.measured),
            "predicted": (axes, slices.predicted),
            "sigma": (axes, slices.sigma),
            "power": (axes[1:], radial.measured),
            "predicted_power": (axes[1:], radial.predicted),
            "power_sigma": (axes[1:], radial.sigma),
        }
        try:
            field, cells = self.light_field, ("x", "u")
        except NotStored:
            return found
        found.update(light_field=(cells, field.measured), predicted_light_field=(cells, field.predicted), light_field_sigma=(cells, field.sigma))
        return found

    def _axes(self) -> Mapping[str, NDArray[Any]]:
        axes = {name: getattr(self.slices, name) for name in ("azimuth", "rho", "nu")}
        try:
            return {**axes, "x": self.light_field.x, "u": self.light_field.u}
        except NotStored:
            return axes

    def _attributes(self) -> Mapping[str, Any]:
        return {"plane": self.name, "verdict": self.verdict}

    def plot(self, ax: Any = None, what: Literal["measured", "predicted"] = "measured") -> Any:
        """Draws the radial spectrum, in dB below its peak, on axes of matplotlib; returns the axes."""
        ax = plotted(ax, self.radial.rho, self.radial.nu, getattr(self.radial, what))
        ax.set(title=f"{self.name}: {what}")
        return ax

    def __repr__(self) -> str:
        return f"<etendue.Plane {self.name}: {self.verdict}>"


class Result(Named[Plane]):
    """The results of a run: its planes by name, and the verdict."""

    def __init__(self, scene: Scene | None, outcome: Outcome) -> None:
        self._scene = scene
        self._outcome = outcome
        self.summary: Mapping[str, Any] = json.loads(outcome.summary())
        """`summary.json`, without the hashes of files."""
        planes = (Plane(outcome, i, self.summary) for i in range(len(self.summary["planes"])))
        super().__init__({plane.name: plane for plane in planes})

    @property
    def name(self) -> str:
        """The name of the scene."""
        return self.summary["scene"]

    @cached_property
    def scene(self) -> Scene:
        """The scene that was run.

        A stored result has no copies of meshes and pictures, so for a scene that names some, this raises `SceneError`: read the scene file.
        """
        if self._scene is not None:
            return self._scene
        method = self.summary["method"]
        return Scene(self.summary["scene_file"], method=method, name=self.name)

    @property
    def verdict(self) -> Verdict:
        """The verdict on all planes."""
        return self.summary["verdict"]

    @property
    def planes(self) -> dict[str, Plane]:
        """The planes by name."""
        return dict(self)

    def __reduce__(self) -> tuple[object, ...]:
        outcome = self._outcome
        if isinstance(outcome, Stored):
            return _stored, (outcome.path,)
        run = self.scene._run  # pyright: ignore[reportPrivateUsage]
        return _compared, (self.scene, run.packed(outcome.measurement()), run.packed_prediction(outcome.prediction()))

    def save(self, folder: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Writes what `etendue run` writes: pictures, arrays, `report.html` and `summary.json`. Returns the folder.

        Raises `CannotRun` if the folder contains the result of another scene, unless `force` is true.
        """
        return Path(self._outcome.save(folder, force))

    def plot(self, axes: Any = None) -> Any:
        """Draws the measured spectrum of each plane, side by side, on an array of axes of matplotlib; by default, in a new figure. Returns the
        axes."""
        if axes is None:
            import matplotlib.pyplot as plt

            axes = plt.subplots(1, len(self), figsize=(4.2 * len(self), 3.2), layout="constrained")[1]
        draw_each(self.values(), axes)
        return axes

    def __str__(self) -> str:
        if not isinstance(self._outcome, Stored):
            return self._outcome.table()
        rows = [_HEADS, *map(_cells, self.values())]
        widths = [max(map(len, column)) for column in zip(*rows)]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]
        return "\n".join([f"{self.name}: {self.summary['photons']:,} photons, seed {self.summary['seed']}", "", *lines, "", f"verdict: {self.verdict}"])

    def __repr__(self) -> str:
        return f"<etendue.Result of {self.name}: {self.verdict}>"

    def _repr_html_(self) -> str:
        photons = f"{self.summary['photons']:,}".replace(",", "\u202f")
        head = f"<p><b>{escape(self.name)}: {escape(self.verdict)}</b>, {photons} photons</p>"
        return head + table(_HEADS, map(_cells, self.values())) + picture(*self.values())


def _compared(scene: Scene, batches: list[tuple[int, bytes]], planes: list[bytes]) -> Result:
    """A result that was pickled as its measurement and its prediction."""
    run = scene._run  # pyright: ignore[reportPrivateUsage]
    return Result(scene, run.compare(run.unpacked(batches), run.unpacked_prediction(planes), None))


def _stored(path: str) -> Result:
    """A result that was pickled as the path of its folder."""
    return Result(None, Stored(path))


_HEADS = ["plane", "class", "p", "p of power", "rel. error", "noise alone", "verdict"]


def _cells(plane: Plane) -> list[str]:
    def share(value: float | None) -> str:
        return "–" if value is None else f"{100 * value:.3f} %"

    def p(value: float | None) -> str:
        return "–" if value is None else f"{value:.5f}"

    report = plane.report
    radial: Mapping[str, Any] | None = report["radial"]
    tests = p(report["p_value"]), p(radial["p_value"] if radial else None)
    return [plane.name, report["class"], *tests, share(report["relative_error"]), share(report["noise_limit"]), plane.verdict]
