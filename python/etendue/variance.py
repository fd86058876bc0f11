"""The Monte Carlo error of a mean over a window, predicted from the spectrum of photons and found by rays traced back."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.commands import given
from etendue.named import Named
from etendue.progress import Progress, told
from etendue.ranges import thread_count
from etendue.scene import Method, Scene, Source, Value, as_scene

Floats = NDArray[np.float64]
Points = Union[str, "os.PathLike[str]", Floats]
"""A sampler: its name, an array of points [N, 4], or the path of an NPY file of such an array."""
Uncertain = tuple[float, float]
"""A number and its standard error."""


@dataclass(frozen=True, eq=False)
class VarianceCurve:
    """The variances of one sampler: arrays with one element for each number of points N."""

    counts: NDArray[np.int64]
    """N."""
    predicted: Floats
    """Predicted variance of the mean, in the square of the unit of radiance."""
    predicted_error: Floats
    """Standard error of `predicted`, without the error of the shape of the tail."""
    found: Floats
    """Variance found, over sets of points."""
    found_error: Floats
    """Standard error of `found`."""
    ratio: Floats
    """predicted / found."""
    ratio_error: Floats
    """Standard error of `ratio`."""
    gain: Floats
    """N Var/σ² as predicted: 1 for independent points if radiances are exact; smaller is better."""
    gain_found: Floats
    """N Var/σ² as found."""
    tail: Floats
    """Share of `predicted` at frequencies beyond those measured."""
    undecided: NDArray[np.bool_]
    """Whether the prediction is undecided, because a fixed set may have peaks beyond the measured frequencies."""
    slope: float | None
    """Slope of log `predicted` against log N; `None` if there is only one N."""
    slope_found: Uncertain | None
    """Slope of log `found` against log N, with its standard error; `None` if there is only one N."""


@dataclass(frozen=True, eq=False)
class SamplerVariance:
    """The variances of one sampler."""

    name: str
    """The name of the sampler: "array 2" is the array with the index 2 of the argument `samplers`."""
    shifted: VarianceCurve
    """Variances of sets that are shifted at random on the torus."""
    unshifted: VarianceCurve | None
    """Variances of sets that are not shifted; `None` unless they are requested and predicted for this sampler."""
    worse: list[dict[str, Any]]
    """For each N, with shifts: the `share` of σ² at frequencies at which the sampler is worse than independent points, and the `worst`
    three of them."""


class Variance(Named[SamplerVariance]):
    """The variances of all samplers at a plane: a mapping from the name of each sampler."""

    _KIND = "sampler"

    def __init__(self, report: Mapping[str, Any], text: str) -> None:
        self.report = report
        """All numbers, as in `variance.json`."""
        self._text = text
        samplers = (_sampler(sampler) for sampler in report["samplers"])
        super().__init__({sampler.name: sampler for sampler in samplers})

    @property
    def plane(self) -> str:
        """The name of the plane."""
        return self.report["plane"]

    @property
    def mean(self) -> Uncertain:
        """The mean of the radiance over the window and its standard error, by rays traced back."""
        return _uncertain(self.report["mean_by_rays"])

    @property
    def mean_by_photons(self) -> Uncertain:
        """The mean of the radiance over the window and its standard error, by photons."""
        return _uncertain(self.report["mean_by_photons"])

    @property
    def variance(self) -> Uncertain:
        """σ², the variance of the radiance over the window, and its standard error."""
        return _uncertain(self.report["variance"])

    @property
    def noise(self) -> Uncertain:
        """The mean variance of a radiance along a fixed ray, and its standard error; 0 unless light scatters."""
        return _uncertain(self.report["noise"])

    @property
    def inside(self) -> float:
        """The power at the measured frequencies, as a share of σ²."""
        return self.report["inside"]

    @property
    def power(self) -> dict[tuple[str, ...], Uncertain]:
        """The power by set of axes with nonzero frequencies, such as ("x", "u"), as a share of σ², with standard errors."""
        return {tuple(power["axes"]): _uncertain(power["share"]) for power in self.report["axis_sets"]}

    @property
    def undecided(self) -> bool:
        """Whether a prediction is undecided."""
        return any(sampler.shifted.undecided.any() for sampler in self.values())

    def __reduce__(self) -> tuple[object, ...]:
        return Variance, (self.report, self._text)

    def plot(self, ax: Any = None, unshifted: bool = False) -> Any:
        """Draws N Var/σ² against N on axes of matplotlib: lines are predicted, points are found.

        Parameters
        ----------
        ax
            Axes of matplotlib; by default the current axes.
        unshifted
            Whether the sets without shifts are drawn.

        Returns
        -------
        The axes.
        """
        if ax is None:
            import matplotlib.pyplot as plt

            ax = plt.gca()
        for number, sampler in enumerate(self.values()):
            curve = sampler.unshifted if unshifted else sampler.shifted
            if curve is None or not curve.counts.size:
                continue
            color = f"C{number % 10}"
            error = curve.found_error * curve.gain_found / curve.found
            ax.errorbar(curve.counts, curve.gain_found, error, fmt="o", color=color, capsize=3, label=sampler.name)
            known = ~curve.undecided
            # A line through one point would not be seen.
            marker = "_" if known.sum() == 1 else None
            ax.plot(curve.counts[known], curve.gain[known], color=color, marker=marker, markersize=20)
        ax.set(xscale="log", yscale="log", xlabel="N", ylabel="N Var/σ²", title=f"{self.plane}{', not shifted' if unshifted else ''}")
        ax.legend()
        return ax

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<etendue.Variance at {self.plane}: {', '.join(self)}>"


def variance(
    scene: Scene | Source,
    *,
    plane: str | None = None,
    samplers: Sequence[Points] | None = None,
    counts: int | str | Sequence[int] | NDArray[np.integer[Any]] | None = None,
    unshifted: bool = False,
    light_points: bool = False,
    shifts: int | None = None,
    frequencies: int | None = None,
    set: Mapping[str, Value] | None = None,
    photons: float | None = None,
    seed: int | None = None,
    method: Method = "photons",
    threads: int | None = None,
    progress: Progress = None,
) -> Variance:
    """Predicts the error of the mean radiance over the window of a plane by N rays, and finds the error really made.

    The windows of the plane are replaced by Box windows of the same half-widths. Nothing is written to disk.

    Parameters
    ----------
    scene
        A scene, or the path or the tree of one.
    plane
        The name of the plane; by default the only plane of the scene.
    samplers
        A sequence of names ("independent", "jitter", "lhs", "sobol", "padded"), arrays of points and paths of NPY files; by default all
        names. Points are float64 [N, 4] in [0, 1), with the axes x, u, y, v.
    counts
        A number of points N, several numbers, or text: "4..4096" (the default) stands for 4, 16, 64, ... up to 4096. Arrays and files have their own N.
    unshifted
        Whether variances of sets without shifts are predicted and found too.
    light_points
        Whether u and v are the point on the light from which a ray comes, instead of its slopes.
    shifts
        Number of sets of points with which each variance is found, by default 200.
    frequencies
        The largest measured frequency along each axis, in cycles per window, 2 to 16, by default 8.
    set, photons, seed, method, threads
        As in `run`.
    progress
        Whether a bar is shown, or a function that receives the number of photons and then of sets of rays. Ctrl-C stops the work.

    Returns
    -------
    Variance
        The variances of each sampler, by its name; "padded" gives "padded xu+yv" and "padded xy+uv".

    Raises
    ------
    SceneError
        If the scene has faults, the plane sees light without extent, or a file of points is refused.
    ValueError
        If another argument is wrong.
    CannotRun
        If there is too little memory.

    Examples
    --------
    >>> found = etendue.variance("scenes/variance/soft_shadow.ron", samplers=["sobol"], counts=[256])
    >>> found["sobol"].shifted.predicted.shape
    (1,)
    """
    arguments = given(
        plane=plane,
        samplers=samplers,
        counts=counts.tolist() if isinstance(counts, np.ndarray) else counts,
        unshifted=unshifted,
        light_points=light_points,
        shifts=shifts,
        frequencies=frequencies,
    )
    run = as_scene(scene, set, photons, seed, method)._run  # pyright: ignore[reportPrivateUsage]
    threads = thread_count(threads)
    with told(progress) as tell:
        index, text = _etendue.variance(run, arguments, threads, tell)
    return Variance(json.loads(index), text)


def _uncertain(number: Mapping[str, float]) -> Uncertain:
    return number["value"], number["error"]


def _sampler(report: Mapping[str, Any]) -> SamplerVariance:
    unshifted = report["unshifted"]
    return SamplerVariance(
        report["sampler"],
        _curve(report["shifted"]),
        None if unshifted is None else _curve(unshifted),
        [count["worse"] for count in report["shifted"]["counts"]],
    )


def _curve(report: Mapping[str, Any]) -> VarianceCurve:
    counts = report["counts"]

    def numbers(name: str, part: str | None = None) -> Floats:
        return np.array([count[name] if part is None else count[name][part] for count in counts], float)

    slope = report["found_slope"]
    return VarianceCurve(
        counts=np.array([count["count"] for count in counts], np.int64),
        predicted=numbers("predicted", "value"),
        predicted_error=numbers("predicted", "error"),
        found=numbers("found", "value"),
        found_error=numbers("found", "error"),
        ratio=numbers("ratio", "value"),
        ratio_error=numbers("ratio", "error"),
        gain=numbers("predicted_gain"),
        gain_found=numbers("found_gain"),
        tail=numbers("tail"),
        undecided=np.array([count["is_undecided"] for count in counts], np.bool_),
        slope=report["predicted_slope"],
        slope_found=None if slope is None else _uncertain(slope),
    )
