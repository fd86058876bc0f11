"""Results that are read from the folders in which they are stored."""

from __future__ import annotations

import csv
import io
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from etendue import _etendue


class NotStored(_etendue.CannotRun):
    """A folder does not have the wanted arrays; the message states how they are stored."""


class Stored:
    """The folder of a result. Files are verified when they are read."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._folder = _etendue.Folder(folder)
        self.path = os.path.abspath(folder)
        self.index: dict[str, Any] = json.loads(self._folder.index)
        self._names = [plane["name"] for plane in self.index.get("planes", [])]

    @property
    def is_result(self) -> bool:
        """Whether the folder has a result; otherwise, it has a measurement."""
        return self._folder.name == "summary.json"

    def summary(self) -> str:
        """`summary.json` without the hashes, in JSON."""
        hashes = ("format", "index_hash")
        return json.dumps({**{key: value for key, value in self.index.items() if key not in hashes}, "files": {}})

    def slices(self, plane: int) -> dict[str, NDArray[Any]]:
        """The arrays of `Slices`."""
        arrays = self._arrays(plane, "slices.npz", "run its scene again")
        arrays["sigma_measured"] = arrays.pop("measured_sigma", arrays["sigma"])
        return arrays

    def radial(self, plane: int) -> dict[str, NDArray[Any]]:
        """The arrays of `Radial`."""
        names = {"power": "measured", "predicted_power": "predicted", "sigma": "sigma_measured", "sigma_predicted": "sigma"}
        arrays = self._arrays(plane, "radial.npz", "run its scene again")
        return {names.get(name, name): array for name, array in arrays.items()}

    def light_field(self, plane: int) -> dict[str, NDArray[Any]]:
        """The arrays of `LightField`; sigma to rounding."""
        text = self._bytes(plane, "primal.csv", "run its scene without --compact").decode()
        rows = np.array(list(csv.reader(io.StringIO(text)))[1:])
        x, u, measured, predicted, z = np.where(rows == "", "nan", rows).astype(np.float64).T
        columns = np.unique(x).size
        # Where z is 0 or not a number, there is no light.
        with np.errstate(invalid="ignore", divide="ignore"):
            sigma = np.nan_to_num((measured - predicted) / z, posinf=0.0, neginf=0.0)
        cells = {name: array.reshape(columns, -1) for name, array in (("measured", measured), ("predicted", predicted), ("sigma", sigma))}
        return {"x": x.reshape(columns, -1)[:, 0].copy(), "u": u[: u.size // columns].copy(), **cells}

    def batches(self, plane: int) -> NDArray[np.complex128]:
        """The slices of each batch, [batch, azimuth, rho ≥ 0, nu]."""
        return self._arrays(plane, "batches.npz", "run its scene with --save batches")["slices"]

    def save(self, folder: str | os.PathLike[str], force: bool) -> Path:
        """Writes the same files to another folder."""
        return self._folder.save(folder, force)

    def _bytes(self, plane: int, name: str, how: str) -> bytes:
        name = f"{self._names[plane]}/{name}"
        found = self._folder.bytes(name)
        if found is None:
            raise NotStored(f"{self.path} does not have {name}: {how}")
        return found

    def _arrays(self, plane: int, name: str, how: str) -> dict[str, NDArray[Any]]:
        with np.load(io.BytesIO(self._bytes(plane, name, how))) as arrays:
            return dict(arrays)
