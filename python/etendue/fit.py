"""Fits of scene fields to a measurement."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue
from etendue.plot import Shown, Variables, axes_of, picture, table
from etendue.progress import Progress, told
from etendue.ranges import thread_count, whole
from etendue.rays import Spectrum
from etendue.scene import Scene, Source, Value, field_texts, scene_argument
from etendue.stages import Measurement

Folder = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class FittedField:
    """A free field and its estimate."""

    field: str
    """Path of the field."""
    start: float
    """The value in the scene."""
    value: float
    """The estimate."""
    error: float | None
    """Standard error; `None` if the spectra do not tell the field from others."""
    error_alone: float | None
    """Standard error if all other fields were known."""
    bound: float | None
    """Cramér–Rao bound of the error, which weights that know the covariance of the noise can reach."""


@dataclass(frozen=True, eq=False)
class Fit(Shown):
    """Fields of a scene, fitted to a measurement. `fit["surfaces.0.center.2"]` is the estimate of a field."""

    fields: Mapping[str, FittedField]
    """The free fields by their paths."""
    verdict: str
    """"pass" if no disagreement with the scene of these values is found, "fail" if no values explain it, or "undecided"."""
    p_value: float | None
    """Probability of a disagreement at least this large if the scene is right."""
    undecided: str | None
    """Why the fit is undecided."""
    degeneracy: str | None
    """The combination of fields that is told much worse than single fields, in words."""
    correlations: NDArray[np.float64]
    """Correlations of the estimates, [field, field]; empty if the fields are not determined."""
    fisher_information: NDArray[np.float64] | None
    """[field, field], in inverse units of the fields."""
    index: Mapping[str, Any]
    """The content of `fit.json`, which the command `etendue fit` writes."""

    def __getitem__(self, field: str) -> FittedField:
        return self.fields[field]

    def _variables(self) -> Variables:
        names = ("start", "value", "error", "error_alone", "bound")
        columns = {name: (("field",), np.array([getattr(of, name) for of in self.fields.values()], np.float64)) for name in names}
        pairs = {"correlations": self.correlations, "fisher_information": self.fisher_information}
        known = {name: (("field", "other_field"), array) for name, array in pairs.items() if array is not None and array.size}
        return {**columns, **known}

    def _axes(self) -> Mapping[str, NDArray[Any]]:
        names = np.array(list(self.fields))
        return {"field": names, "other_field": names}

    def _attributes(self) -> Mapping[str, Any]:
        return {"verdict": self.verdict, "p_value": np.nan if self.p_value is None else self.p_value}

    def plot(self, ax: Any = None) -> Any:
        """Draws the correlations of the estimates, on axes of matplotlib; returns the axes.

        Raises `ValueError` if the spectra do not determine the fields, so that there are no correlations.
        """
        if not self.correlations.size:
            raise ValueError("the fields are not determined: there are no correlations to draw")
        ax, names = axes_of(ax), list(self.fields)
        image = ax.imshow(self.correlations, vmin=-1, vmax=1, cmap="RdBu_r")
        ax.set_xticks(range(len(names)), names, rotation=30, ha="right")
        ax.set_yticks(range(len(names)), names)
        ax.figure.colorbar(image, ax=ax, label="correlation")
        return ax

    def _repr_html_(self) -> str:
        def number(value: float | None) -> str:
            return "–" if value is None else f"{value:.6g}"

        rows = [[of.field, *map(number, (of.start, of.value, of.error, of.error_alone, of.bound))] for of in self.fields.values()]
        heads = ["field", "start", "value", "error", "error if all others were known", "bound"]
        drawn = picture(self) if len(self.fields) > 1 and self.correlations.size else ""
        return f"<p><b>fit: {self.verdict}</b>, p = {number(self.p_value)}</p>{table(heads, rows)}{drawn}"

    def __repr__(self) -> str:
        found = ", ".join(f"{of.field} {of.value:.6g} ± {of.error or float('nan'):.2g}" for of in self.fields.values())
        return f"<etendue.Fit {self.verdict}, p = {self.p_value}: {found}>"


def fit(
    scene: Scene | Source,
    to: Measurement | Spectrum | Folder | Sequence[Folder],
    free: Sequence[str],
    *,
    set: Mapping[str, Value] | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    starts: int = 8,
    planes: Sequence[str] = (),
    threads: int | None = None,
    progress: Progress = None,
) -> Fit:
    """Finds the values of the fields `free` with which the predicted slices are closest to a measurement, in units of its noise.

    `to` is a measurement, the spectrum of rays, a folder of the command `measure` or of `run --save batches` (several are parts of one
    measurement), or an NPZ file of arrays. A plane of `to` belongs to the plane of the scene with the same name, or to the only one if each
    side has one; both need the same window and frequencies.

    The first start is the scene, with `set`; other starts are in `ranges`, by default ± 50 % of the value.
    `planes` are the names of the planes to compare, by default all measured planes.

    Raises `SceneError` if a field is not a real number of the scene, or if no plane is measured.
    """
    if isinstance(free, str):
        raise TypeError(f"free is {free!r}; allowed: a sequence of paths, such as [{free!r}]")
    if isinstance(to, Spectrum):
        if to.measurement is None:
            raise ValueError("the spectrum was pickled, and has no batches; allowed: a spectrum of this process")
        to = to.measurement
    target: _etendue.Measurement | list[str]
    if isinstance(to, Measurement):
        target = to._raw  # pyright: ignore[reportPrivateUsage]
    elif isinstance(to, (str, os.PathLike)):
        target = [os.fspath(to)]
    elif isinstance(to, Sequence):  # pyright: ignore[reportUnnecessaryIsInstance]
        target = [os.fspath(path) for path in to]
    else:
        raise TypeError(f"to is {to!r}; allowed: a Measurement, a Spectrum, a path, or a sequence of paths")
    given = [(path, (float(low), float(high))) for path, (low, high) in (ranges or {}).items()]
    count, threads = whole("starts", starts, 1, 1000), thread_count(threads)
    with told(progress) as tell:
        text = _etendue.fit(
            scene_argument(scene), field_texts(set), target, list(free), given, count, list(planes), threads, tell
        )
    index: dict[str, Any] = json.loads(text)
    information = index["fisher_information"]
    return Fit(
        fields={of["field"]: FittedField(**of) for of in index["fields"]},
        verdict=index["verdict"],
        p_value=index["p_value"],
        undecided=index["undecided"],
        degeneracy=index["degeneracy"] and index["degeneracy"]["words"],
        correlations=np.array(index["correlations"]),
        fisher_information=None if information is None else np.array(information),
        index=index,
    )
