"""The derivative of the spectrum by a field of a scene."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.commands import given, read_table
from etendue.named import Named
from etendue.plot import Shown, Variables, picture, plotted, table
from etendue.progress import Progress, told
from etendue.ranges import thread_count
from etendue.result import Verdict
from etendue.scene import Method, Scene, Source, Value, field_texts, method_of, scene_argument
from etendue.separable import conjugated

Floats = NDArray[np.float64]
NUMBERS = ("bandwidth_95_rho", "bandwidth_95_nu", "slope")


@dataclass(frozen=True)
class NumberDerivative:
    """The derivative of a number of a plane by a field, in the unit of the number over that of the field."""

    measured: float
    error: float
    """Standard error of `measured`, from pairs of batches with the same random numbers."""
    predicted: float
    """The difference of the predicted numbers over the same step; NaN without prediction."""


@dataclass(frozen=True, eq=False)
class PlaneDerivative(Shown):
    """The derivative of the spectrum at a plane by a field, in one over the unit of the field."""

    plane: str
    """The name of the plane."""
    step: float
    """Half of the difference between the two values of the field."""
    size: float
    """‖∂S/∂field‖ / ‖S‖."""
    noise: float
    """‖error‖ / ‖∂S/∂field‖; NaN if too few batches differ."""
    bias: float
    """The relative error from the length of the step, with one standard error added; NaN if too few batches differ."""
    share: tuple[float, float] | None
    """The measured derivative as a multiple of theory's, with its standard error; `None` without theory."""
    p_value: float | None
    """Probability of a disagreement at least as large if theory's difference over the same step is true; `None` if predictions have errors
    that replicates do not show."""
    numbers: Mapping[str, NumberDerivative]
    """The derivatives of `bandwidth_95_rho`, `bandwidth_95_nu` and `slope`, where they exist."""
    azimuth: Floats
    """In radians."""
    rho: Floats
    """In cycles per metre."""
    nu: Floats
    """In cycles per unit of u."""
    derivative: NDArray[np.complex128]
    """∂S/∂field, [azimuth, rho, nu]."""
    sigma: Floats
    """Standard error of |`derivative`|."""
    predicted: NDArray[np.complex128] | None
    """Theory's difference over the same step; `None` without theory."""

    def _variables(self) -> Variables:
        arrays = {"derivative": self.derivative, "predicted": self.predicted, "sigma": self.sigma}
        return {name: (("azimuth", "rho", "nu"), array) for name, array in arrays.items() if array is not None}

    def _attributes(self) -> Mapping[str, Any]:
        return {"plane": self.plane, "step": self.step}

    def plot(self, ax: Any = None) -> Any:
        """Draws the mean of |`derivative`|² over azimuths, without that of the noise, in dB below its peak, on axes of matplotlib; returns the
        axes."""
        ax = plotted(ax, self.rho, self.nu, (abs(self.derivative) ** 2 - self.sigma**2).mean(0))
        ax.set(title=f"{self.plane}: derivative")
        return ax

    def __repr__(self) -> str:
        return f"<etendue.PlaneDerivative at {self.plane}: size {self.size:.4g}, noise {100 * self.noise:.2g} %>"


class Derivative(Named[PlaneDerivative]):
    """The derivative of the spectra of all planes by a field: a mapping from the name of each plane."""

    def __init__(self, field: str, value: float, verdict: Verdict, text: str, planes: Mapping[str, PlaneDerivative]) -> None:
        self.field = field
        """Path of the field."""
        self.value = value
        """Value of the field."""
        self.verdict = verdict
        """"fail" if theory disagrees at a plane; "undecided" if a derivative has no errors, or a bias above its noise; else "pass"."""
        self._text = text
        super().__init__(planes)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<etendue.Derivative by {self.field}: {self.verdict}>"

    def _repr_html_(self) -> str:
        rows = [
            [at.plane, name, f"{of.measured:.6g}", f"{of.error:.2g}", f"{of.predicted:.6g}"]
            for at in self.values()
            for name, of in at.numbers.items()
        ]
        numbers = table(["plane", "number", "derivative", "error", "predicted"], rows)
        return f"<pre>{escape(self._text)}</pre>{numbers}{picture(*self.values())}"


def derivative(
    scene: Scene | Source,
    field: str,
    step: float | None = None,
    *,
    set: Mapping[str, Value] | None = None,
    photons: float | None = None,
    seed: int | None = None,
    method: Method | None = None,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Derivative:
    """Measures the derivative of the spectra by a field of a scene, as `etendue sweep --derivative` does, and compares it with theory's.

    `field` is the path of a real number, such as "surfaces.0.center.2". The scene is run at its value ± `step` with the same random numbers, and
    so with a quarter and a sixteenth of the step; the largest step is taken whose bias is below the noise. `step` is by default 4 % of the
    value, or 0.04 if the value is 0.
    `set`, `photons`, `seed` and `method` are as in `run`.
    The six runs are kept in `out`, if it is given, and the same call continues from them. `force` replaces files in `out` that Étendue did
    not write. `progress` states whether a bar is shown, or is a function that receives the number of finished runs.

    Returns a `Derivative`. Raises `SceneError` if `field` is not a real number of the scene, or if a value at a step is not allowed, `ValueError`
    if `step` is not above 0, and `CannotRun` if `out` contains something else.
    """
    arguments = given(photons=photons, seed=seed, method=method_of(scene) if method is None else method, force=force)
    threads = thread_count(threads)
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()) if out is None else out)
        tell = stack.enter_context(told(progress))
        values: list[tuple[str, str | list[float]]] = [*field_texts(set)]
        native = _etendue.derivative(scene_argument(scene), (field, step), values, folder, arguments, threads, tell)
        value, verdict, text = native
        steps, points = read_table(folder / "derivative.csv"), read_table(folder / "sweep.csv")
        chosen = np.flatnonzero(steps["chosen"] == "true")
        planes = {steps["plane"][row]: _plane(folder, {name: column[row] for name, column in steps.items()}, value, points) for row in chosen}
    return Derivative(steps["field"][0], value, verdict, text, planes)  # type: ignore[arg-type]


def _plane(folder: Path, row: Mapping[str, Any], value: float, points: Mapping[str, NDArray[Any]]) -> PlaneDerivative:
    name = str(row["plane"])
    with np.load(folder / name / "derivative.npz") as arrays:
        half = dict(arrays)
    rho = half["rho"]
    numbers = {
        number: NumberDerivative(float(row[number]), float(row[f"error_of_{number}"]), _predicted(points, row, number, value))
        for number in NUMBERS
        if np.isfinite(row[number])
    }
    share = float(row["share_of_theory"]), float(row["error_of_share"])
    return PlaneDerivative(
        plane=name,
        step=float(row["step"]),
        size=float(row["size"]),
        noise=float(row["noise"]),
        bias=float(row["bias"]),
        share=share if np.isfinite(share[0]) else None,
        p_value=float(row["p_value"]) if np.isfinite(row["p_value"]) else None,
        numbers=numbers,
        azimuth=half["azimuth"],
        rho=np.concatenate([-rho[:0:-1], rho]),
        nu=half["nu"],
        derivative=conjugated(half["derivative"]),
        sigma=conjugated(half["sigma"]),
        predicted=conjugated(half["predicted"]) if "predicted" in half else None,
    )


def _predicted(points: Mapping[str, NDArray[Any]], row: Mapping[str, Any], number: str, value: float) -> float:
    """The central difference of a predicted number over the step of a row."""
    here = (points["plane"] == row["plane"]) & (points["quantity"] == number)
    at, predicted = points[str(row["field"])][here], points["predicted"][here]
    ends = [predicted[np.argmin(abs(at - value - sign * row["step"]))] for sign in (-1, 1)]
    return float((ends[1] - ends[0]) / (2 * row["step"]))
