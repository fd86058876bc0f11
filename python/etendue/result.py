"""The results of a run."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.difference import Sample
from etendue.plot import plotted
from etendue.scene import Scene

if TYPE_CHECKING:
    import xarray

Floats = NDArray[np.float64]
Verdict = Literal["pass", "fail", "undecided"]


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
    """The mean of the power spectrum over azimuths, [rho, nu]; rho also has negative values, as in `radial.npz`."""

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


class Plane:
    """A virtual plane: measurement, prediction and verdict. NumPy takes over the memory of the arrays without a copy."""

    def __init__(self, outcome: _etendue.Outcome, number: int, summary: Mapping[str, Any]) -> None:
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
        return Sample(slices.measured, *noise, self._numbers, lambda: self._outcome.batches(number))

    def to_xarray(self) -> xarray.Dataset:
        """Slices and radial spectrum with their axes and units (needs xarray)."""
        import xarray

        slices, radial = self.slices, self.radial
        axes = ("azimuth", "rho", "nu")
        # The radial spectrum has rho ≥ 0.
        half = radial.rho.size - radial.measured.shape[0]
        return xarray.Dataset(
            {
                "measured": (axes, slices.measured),
                "predicted": (axes, slices.predicted),
                "sigma": (axes, slices.sigma),
                "power": (axes[1:], radial.measured, {"long_name": "radial power"}),
                "predicted_power": (axes[1:], radial.predicted),
                "power_sigma": (axes[1:], radial.sigma),
            },
            coords={
                "azimuth": ("azimuth", slices.azimuth, {"units": "rad"}),
                "rho": ("rho", slices.rho[half:] if half else slices.rho, {"units": "cycles/m"}),
                "nu": ("nu", slices.nu, {"units": "cycles/slope"}),
            },
            attrs={"plane": self.name, "verdict": self.verdict},
        )

    def plot(self, ax: Any = None, what: Literal["measured", "predicted"] = "measured") -> Any:
        """Draws the radial spectrum, in dB below its peak, on axes of matplotlib; returns the axes."""
        ax = plotted(ax, self.radial.rho, self.radial.nu, getattr(self.radial, what))
        ax.set(title=f"{self.name}: {what}")
        return ax

    def __repr__(self) -> str:
        return f"<etendue.Plane {self.name}: {self.verdict}>"


class Result(Mapping[str, Plane]):
    """The results of a run: its planes by name, and the verdict."""

    def __init__(self, scene: Scene, outcome: _etendue.Outcome) -> None:
        self.scene = scene
        self._outcome = outcome
        self.summary: Mapping[str, Any] = json.loads(outcome.summary())
        """`summary.json`, without the hashes of files."""
        planes = (Plane(outcome, i, self.summary) for i in range(len(self.summary["planes"])))
        self._planes = {plane.name: plane for plane in planes}

    @property
    def verdict(self) -> Verdict:
        """The verdict on all planes."""
        return self.summary["verdict"]

    @property
    def planes(self) -> dict[str, Plane]:
        """The planes by name."""
        return dict(self._planes)

    def __getitem__(self, name: str) -> Plane:
        if name not in self._planes:
            raise KeyError(f"no plane {name!r}; there are {', '.join(self._planes)}")
        return self._planes[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._planes)

    def __len__(self) -> int:
        return len(self._planes)

    def __reduce__(self) -> tuple[object, ...]:
        run, outcome = self.scene._run, self._outcome  # pyright: ignore[reportPrivateUsage]
        return _compared, (self.scene, run.packed(outcome.measurement()), run.packed_prediction(outcome.prediction()))

    def save(self, folder: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Writes what `etendue run` writes: pictures, arrays, `report.html` and `summary.json`. Returns the folder.

        Raises `CannotRun` if the folder contains the result of another scene, unless `force` is true.
        """
        return Path(self._outcome.save(folder, force))

    def __str__(self) -> str:
        return self._outcome.table()

    def __repr__(self) -> str:
        return f"<etendue.Result of {self.scene.name}: {self.verdict}>"

    def _repr_html_(self) -> str:
        rows = "".join(_row(plane.report) for plane in self._planes.values())
        heads = "".join(f"<th>{head}</th>" for head in ("plane", "class", "p", "p of power", "rel. error", "noise alone", "verdict"))
        photons = f"{self.summary['photons']:,}".replace(",", "\u202f")
        return (
            f"<p><b>{escape(self.scene.name)}: {escape(self.verdict)}</b>, {photons} photons</p>"
            f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
        )


def _compared(scene: Scene, batches: list[tuple[int, bytes]], planes: list[bytes]) -> Result:
    """A result that was pickled as its measurement and its prediction."""
    run = scene._run  # pyright: ignore[reportPrivateUsage]
    return Result(scene, run.compare(run.unpacked(batches), run.unpacked_prediction(planes), None))


def _row(report: Mapping[str, Any]) -> str:
    def share(value: float | None) -> str:
        return "–" if value is None else f"{100 * value:.3f} %"

    def p(value: float | None) -> str:
        return "–" if value is None else f"{value:.5f}"

    radial: Mapping[str, Any] | None = report["radial"]
    cells = [
        report["name"],
        report["class"],
        p(report["p_value"]),
        p(radial["p_value"] if radial else None),
        share(report["relative_error"]),
        share(report["noise_limit"]),
        report["verdict"],
    ]
    return "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in cells) + "</tr>"
