"""Theories of the user: arrays, arrays with parameters, and radiance functions."""

import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import etendue

PAGE = (Path(__file__).parents[2] / "docs/own-theory.md").read_text()


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    path = tmp_path_factory.mktemp("lamp") / "lamp.ron"
    path.write_text(re.search(r"```ron\n(.*?)```", PAGE, re.DOTALL)[1])
    return etendue.measure(path, photons=2**19)


@pytest.fixture(scope="module")
def axes(measured):
    slices = etendue.compare(measured)["receiver"].slices
    return slices.rho, slices.nu


def lamp_at(distance, axes, n=2000):
    """The slices of the lamp of the page: a product of an integral over (x, u) and one over (y, v)."""
    rho, nu = axes
    x, u = (half * (2 * np.arange(n) + 1 - n) / n for half in (0.3, 0.25))
    window = np.outer(np.cos(np.pi * x / 0.6) ** 2, np.cos(np.pi * u / 0.5) ** 2)
    # A cell of x is lit by the part of it that sees the lamp, so that derivatives are smooth.
    edge = (0.1 - abs(x[:, None] - distance * u)) * n / 0.6 + 0.5
    light = window * np.clip(edge, 0, 1) * (0.6 / n) * (0.5 / n)
    one = np.exp(-2j * np.pi * np.outer(rho, x)) @ light @ np.exp(-2j * np.pi * np.outer(u, nu))
    return np.array([one, one]) * light.sum()


def test_arrays_and_their_parameters(measured, axes):
    slices = lamp_at(1, axes)
    assert etendue.compare(measured, {"receiver": slices}).verdict == "pass"
    assert etendue.compare(measured, {"receiver": lamp_at(1.004, axes)}).verdict == "fail"
    derivative = (lamp_at(1.01, axes) - lamp_at(0.99, axes)) / 0.02
    theory = {"slices": slices, "parameters": ["distance"], "units": ["m"], "values": [1], "derivatives": [derivative]}
    found = etendue.compare(measured, {"receiver": theory})["receiver"].parameters["distance"]
    assert found["unit"] == "m" and found["scene"] == 1
    assert abs(found["measured"] - 1) < 4 * found["error"] < 1e-3  # four standard errors
    # The measurement tells the true distance although the theory supposes another.
    theory |= {"slices": lamp_at(1.004, axes), "values": [1.004]}
    found = etendue.compare(measured, {"receiver": theory})["receiver"].parameters["distance"]
    assert abs(found["measured"] - 1) < 4 * found["error"] + 1e-4  # and second order in 0.004


@pytest.mark.parametrize("sign, verdict", [(1, "pass"), (-1, "fail")])
def test_radiance_functions(measured, sign, verdict):
    def radiance(x, y, u, v):
        x -= sign * u
        return (abs(x) < 0.1) & (abs(y - sign * v) < 0.1)

    # Oblique slices see lattice vectors that slices at 0 and 90 degrees do not.
    few = etendue.measure(measured.scene.file, set={"frequencies.azimuths": 4}, photons=2**15)
    plane = etendue.compare(few, {"receiver": radiance})["receiver"]
    assert plane.verdict == verdict
    assert plane.report["quadrature_error"] < 0.3 * plane.report["noise_limit"]
    # The lamp is symmetric, so that positions or slopes may be reversed.
    said = re.search("if it were reversed in (x and y|u and v)$", "".join(plane.report["warnings"]))
    assert bool(said) == (verdict == "fail")


HOLE = {"Aperture": {"name": "hole", "center": [0, 0, 0.5], "hole": {"Rectangle": {"center": [0, 0], "size": [0.1, 0.1]}}}}


@pytest.fixture(scope="module")
def behind_hole(measured):
    frequencies = {"azimuths": 2, "rho": {"max": 6}, "nu": {"max": 6}}
    scene = measured.scene.file | {"blockers": [HOLE], "frequencies": frequencies}
    return etendue.measure(scene, photons=2**14)


def hole_along(ox, ou, distance):
    """The spectrum along (x, u) of rays whose x − d u is on the lamp and whose x − (d − ½) u is in the hole."""
    lamp, hole = 0.2 * np.sinc(0.4 * ((distance - 0.5) * ox + ou)), 0.1 * np.sinc(0.2 * (distance * ox + ou))
    return 2 * lamp * hole


def spectrum(ox, oy, ou, ov, distance=1.0):
    return hole_along(ox, ou, distance) * hole_along(oy, ov, distance)


def radiance(x, y, u, v, distance=1.0):
    past = [(abs(p - distance * q) < 0.1) & (abs(p - (distance - 0.5) * q) < 0.05) for p, q in ((x, u), (y, v))]
    return past[0] & past[1]


@pytest.mark.parametrize("function", [radiance, spectrum])
def test_functions_and_their_parameters(behind_hole, function):
    parameters = {"parameters": ["distance"], "units": ["m"], "values": [1.002]}
    plane = etendue.compare(behind_hole, {"receiver": {function.__name__: function, **parameters}})["receiver"]
    assert plane.verdict == "pass"
    assert plane.report["quadrature_error"] < 0.3 * plane.report["noise_limit"]
    found = plane.parameters["distance"]
    assert found["scene"] == 1.002 and abs(found["measured"] - 1) < 4 * found["error"] < 2e-2  # four standard errors


@pytest.mark.parametrize(
    "wrong, hint",
    [
        (lambda *at: spectrum(*at) / (2 * np.pi), "multiplied by 6.2"),
        (lambda ox, oy, ou, ov: spectrum(ox, oy, -ou, -ov), "reversed in "),
        (lambda *at: 2 * spectrum(at[0], at[1], -at[2], at[3]), None),
    ],
)
def test_a_wrong_convention_is_named(behind_hole, wrong, hint):
    plane = etendue.compare(behind_hole, {"receiver": {"spectrum": wrong}})["receiver"]
    assert plane.verdict == "fail"
    said = [words for words in plane.report["warnings"] if "would agree" in words]
    assert hint in said[0] if hint else not said


def test_a_theory_far_below_the_noise_fails(measured):
    # The lamp is 20 times too small. The noise is far above this light, so points are doubled because their replicates are uneven.
    few = etendue.measure(measured.scene, photons=2**12)
    plane = etendue.compare(few, {"receiver": lambda x, y, u, v: (abs(x - u) < 0.005) & (abs(y - v) < 0.005)})["receiver"]
    assert plane.verdict == "fail" and plane.report["quadrature_error"] < 0.05 < 0.3 * plane.report["noise_limit"]


def test_a_function_that_predicts_darkness_fails(measured):
    assert etendue.compare(measured, {"receiver": lambda x, y, u, v: 0 * x}).verdict == "fail"


def test_spectra_of_rays(behind_hole):
    random = np.random.default_rng(1)
    x, y, u, v = (half * random.uniform(-1, 1, 200_000) for half in (0.3, 0.3, 0.25, 0.25))
    scene = behind_hole.scene.file
    found = etendue.spectrum(x, y, u, v, radiance(x, y, u, v), window=scene["window"], frequencies=scene["frequencies"])
    scale = 16 * (0.3 * 0.25) ** 2 / 200_000  # the volume of the window for each ray
    for factor, verdict in [(1, "pass"), (1.1, "fail")]:
        result = etendue.compare(found, {"rays": lambda *at: factor * radiance(*at) / scale})
        assert result.verdict == verdict
        assert not result.summary["inquiries"]
    assert re.search(r"multiplied by 0\.(8[89]|9[0-3])", "".join(result["rays"].report["warnings"]))
    assert result.summary["photons"] == 200_000
    with pytest.raises(TypeError, match="needs a theory"):
        etendue.compare(found)
    copy = pickle.loads(pickle.dumps(found))
    assert (copy.slices == found.slices).all()
    with pytest.raises(ValueError, match="was pickled"):
        etendue.compare(copy, {"rays": radiance})


def test_files_of_arrays(measured, axes, tmp_path):
    np.savez(tmp_path / "theory.npz", **{"receiver/slices": lamp_at(1, axes)})
    with np.load(tmp_path / "theory.npz") as file:
        for theory in (tmp_path / "theory.npz", str(tmp_path / "theory.npz"), file):
            assert etendue.compare(measured, theory).verdict == "pass"


def test_theories_that_do_not_fit_are_refused(measured):
    for theory, message in [
        ({"receiver": np.zeros((2, 3))}, "receiver/slices"),
        ({"elsewhere": np.zeros((2, 3))}, "elsewhere/slices"),
        ({"receiver": {"slice": [0]}}, "receiver/slice"),
        ({}, "receiver/slices"),
    ]:
        with pytest.raises(etendue.SceneError, match=message):
            etendue.compare(measured, theory)
    for function, message in [
        (lambda x, y, u, v: 1j * x, "plane receiver returned complex128"),
        (lambda x, y, u, v: x[1:], "of shape"),
        (lambda x, y, u, v: np.full(x.size, np.nan), "not finite"),
    ]:
        with pytest.raises(ValueError, match=message):
            etendue.compare(measured, {"receiver": function})
    for theory, message in [
        ({"radiance": 3}, "one function"),
        ({"radiance": np.add, "spectrum": np.add}, "one function"),
        ({"radiance": np.add, "parameters": ["d"]}, "1 parameters, 0 values"),
        ({"radiance": np.add, "parameter": ["d"]}, "parameter; allowed beside a function"),
    ]:
        with pytest.raises(ValueError, match=message):
            etendue.compare(measured, {"receiver": theory})
    with pytest.raises(TypeError, match="not dict"):
        etendue.compare(measured.scene.file, {"receiver": np.add})
    with pytest.raises(TypeError, match="not ndarray"):
        etendue.compare(measured, np.zeros(3))
    with pytest.raises(ValueError, match="no plane 'elsewhere'"):
        etendue.compare(measured, {"elsewhere": lambda x, y, u, v: x})
