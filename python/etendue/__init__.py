"""Étendue measures the space-angle frequency content of light and compares it with theory.

>>> import etendue
>>> result = etendue.run("scenes/fig9b.ron", photons=2**20)
>>> result.verdict
'pass'
>>> result["receiver"].slices.measured.shape       # [azimuth, rho, nu]
(8, 33, 65)

`run` does `measure`, `predict` and `compare` in one call. `spectrum` takes rays of your own. Lengths are in metres, frequencies in cycles
per metre (rho) and in cycles per unit of slope (nu).
"""

from __future__ import annotations

from importlib.metadata import version

from etendue import operators
from etendue._etendue import CannotRun, SceneError
from etendue.commands import DrawnFigure, figure, sweep
from etendue.derivative import Derivative, NumberDerivative, PlaneDerivative, derivative
from etendue.difference import Difference, difference
from etendue.examples import examples
from etendue.fit import Fit, FittedField, fit
from etendue.grids import GridSpectrum, grid_spectrum
from etendue.images import TwoSample, two_sample
from etendue.phase_space import MTF, PhaseSpace, mtf, phase_space
from etendue.rays import Spectrum, spectrum
from etendue.result import LightField, Plane, Radial, Result, Slices
from etendue.sampling import ChiSquare, Furnace, chi_square, furnace
from etendue.scene import PlaneInfo, Scene
from etendue.stages import Measurement, Photons, Prediction, check, load, measure, merge, photons, predict, run
from etendue.theories import compare, theory
from etendue.variance import SamplerVariance, Variance, VarianceCurve, variance
from etendue.wedge import Wedge
from etendue.worlds import ImportedScene, Picture, Probe, ProbedPlane, import_scene, probe, render

__all__ = [
    "CannotRun",
    "ChiSquare",
    "Derivative",
    "Difference",
    "DrawnFigure",
    "Fit",
    "FittedField",
    "Furnace",
    "GridSpectrum",
    "ImportedScene",
    "LightField",
    "MTF",
    "Measurement",
    "PhaseSpace",
    "NumberDerivative",
    "Photons",
    "Picture",
    "Plane",
    "PlaneDerivative",
    "PlaneInfo",
    "Prediction",
    "Probe",
    "ProbedPlane",
    "Radial",
    "Result",
    "SamplerVariance",
    "Scene",
    "SceneError",
    "Slices",
    "Spectrum",
    "TwoSample",
    "Variance",
    "VarianceCurve",
    "Wedge",
    "__version__",
    "check",
    "chi_square",
    "compare",
    "derivative",
    "difference",
    "examples",
    "figure",
    "fit",
    "furnace",
    "grid_spectrum",
    "import_scene",
    "load",
    "measure",
    "merge",
    "mtf",
    "operators",
    "phase_space",
    "photons",
    "predict",
    "probe",
    "render",
    "run",
    "spectrum",
    "sweep",
    "theory",
    "two_sample",
    "variance",
]

__version__ = version("etendue")
