"""What pyright must accept: a scene and its results, with all types."""

from pathlib import Path

import etendue
import numpy as np
from etendue import types

light: types.Light = {"Rectangle": {"center": [0, 0, 0], "size": [0.2, 0.2]}}
scene: types.Scene = {
    "light": light,
    "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": []},
    "planes": [{"name": "far", "at": {"Distance": 2}}],
    "window": {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}},
    "frequencies": {"rho": {"max": 8}, "nu": {"max": 16}},
}
result = etendue.run(scene, photons=1e5, set={"run.seed": 3})
slope: float = result["far"].report["slope"]["measured"]
power = result["far"].radial.measured.max()
shape: tuple[int, ...] = result["far"].slices.measured.shape
table = etendue.sweep(scene, {"light.center.2": [0.0, 0.1], "run.seed": 3}, out="out", method="backward", threads=2)
column: int = table["plane"].size
drawn: str = etendue.figure([scene, "other.ron"], out="out", plane="far", quality="draft").suffix
picture = etendue.render("cbox.xml", out="out", size=(64, 48), look_from=(0, 1, 4), look_at=(0, 0, 0), progress=print)
error: float = picture.error.max()
probed = etendue.probe("cbox.xml", (3, 4), out="out", rays=1e6, window=8)
surfaces: int = len(probed.surfaces)
triangles: int = etendue.import_scene("cbox.xml", set={"res": 64}).counts["triangles"]
mean = etendue.variance(scene, samplers=["sobol", np.zeros((4, 4)), Path("set.npy")], counts="4..64", unshifted=True, threads=2)
gain: float = mean["sobol"].shifted.gain.max()
share: float = mean.power["x", "u"][0]
stored = etendue.load("out/fig9b")
found = stored if isinstance(stored, etendue.Result) else etendue.compare(stored)
centres = found["far"].to_xarray()["x"].size
by_field = etendue.derivative(etendue.examples["fig9b"], "blockers.0.pitch", 0.01, set={"run.seed": 3})
tangent: float = by_field["far"].numbers["slope"].measured
