"""Derivatives by fields, against the command and against theory."""

import subprocess
import sys
from pathlib import Path

import etendue
import numpy as np
import pytest

FIG9B = Path(__file__).parents[2] / "scenes" / "fig9b.ron"
FIELD = "surfaces.0.center.2"


@pytest.fixture(scope="module")
def found():
    return etendue.derivative(FIG9B, FIELD, 0.08, photons=2**16)


def test_the_derivative_is_that_of_the_command(found, tmp_path):
    line = ["sweep", FIG9B, f"--derivative={FIELD}=0.08", "--photons=2^16", "--quiet", "--out", tmp_path / "d"]
    code = subprocess.run([sys.executable, "-m", "etendue", *line], check=False).returncode
    assert code == {"pass": 0, "fail": 1, "undecided": 4}[found.verdict]
    assert found.value == 2 and found.field == FIELD and "receiver" in str(found)
    for name, plane in found.items():
        stored = np.load(tmp_path / "d" / name / "derivative.npz")
        assert plane.step == stored["step"] and np.array_equal(plane.derivative[:, plane.rho >= 0], stored["derivative"])
        assert np.array_equal(plane.predicted[:, plane.rho >= 0], stored["predicted"])


def test_derivatives_of_arrays_and_numbers_are_those_of_theory(found):
    plane = found["receiver"]
    assert plane.rho[0] == -plane.rho[-1] and plane.derivative.shape == (plane.azimuth.size, plane.rho.size, plane.nu.size)
    assert np.array_equal(plane.derivative, plane.derivative[:, ::-1, ::-1].conj())
    assert np.array_equal(plane.sigma, plane.sigma[:, ::-1, ::-1])
    # Independent frequencies; noise has a mean square of 1.
    half = plane.rho > 0
    z = abs(plane.derivative - plane.predicted)[:, half] / plane.sigma[:, half]
    assert 0.8 < np.sqrt(np.mean(z**2)) < 1.2
    assert abs(plane.share[0] - 1) < 5 * plane.share[1] and plane.share[1] < 0.1
    # A metre of travel shears by a metre, less what window and replicas change.
    slope = plane.numbers["slope"]
    assert abs(slope.measured - slope.predicted) < 4 * slope.error and slope.error < 0.1 and slope.predicted < -0.3
    assert plane.to_xarray().derivative.dims == ("azimuth", "rho", "nu")
    assert "image/png" in found._repr_html_() and "slope" in found._repr_html_()


def test_runs_are_kept_and_continued(tmp_path):
    words = {"photons": 2**12, "out": tmp_path / "d"}
    first = etendue.derivative(FIG9B, FIELD, **words)
    runs = {run: run.stat().st_mtime_ns for run in (tmp_path / "d").rglob("summary.json")}
    second = etendue.derivative(FIG9B, FIELD, **words)
    assert np.array_equal(first["receiver"].derivative, second["receiver"].derivative)
    assert len(runs) == 6 and all(run.stat().st_mtime_ns == then for run, then in runs.items())


def test_derivatives_that_cannot_be():
    for field, step, message in [
        ("blockers.0.ptch", None, "field=blockers.0.ptch: no field `ptch`"),
        ("blockers.0.pitch", -1, "step is -1.0; allowed: a step above 0"),
        ("blockers.0.pitch", 1.0, "step= states a smaller step"),
        ("run.photons", None, "whole number"),
    ]:
        with pytest.raises(ValueError, match=message):
            etendue.derivative(FIG9B, field, step)
