"""Étendue against closed forms and along paths, and modulation transfer functions. Faults are planted in each."""

import math

import etendue
import numpy as np
import pytest

A, SINE = 0.2 * 0.1, math.sin(0.3)


def cone(n=20_000, seed=1):
    """Rays of a rectangle of 0.2 m × 0.1 m into a cone of 0.3 rad."""
    random = np.random.default_rng(seed)
    x, y = random.uniform(-0.1, 0.1, n), random.uniform(-0.05, 0.05, n)
    radius, angle = SINE * np.sqrt(random.random(n)), 2 * math.pi * random.random(n)
    p, q = radius * np.cos(angle), radius * np.sin(angle)
    return x, y, *slopes(p, q)


def slopes(p, q):
    cosine = np.sqrt(1 - p * p - q * q)
    return p / cosine, q / cosine


def cosines(u, v):
    length = np.sqrt(1 + u * u + v * v)
    return u / length, v / length


def agrees(value, truth):
    return abs(value[0] - truth) < 3 * value[1]


def test_a_light_into_a_cone():
    x, y, u, v = cone()
    found = etendue.phase_space(x, y, u, v)
    assert agrees(found.etendue, A * math.pi * SINE**2) and found.etendue[1] < 0.15 * found.etendue[0]
    # The variances of a uniform interval and of a disc.
    assert agrees(found.emittance_x, 0.2 / math.sqrt(12) * SINE / 2) and agrees(found.emittance_y, 0.1 / math.sqrt(12) * SINE / 2)
    # 95 % of a semicircle is within 0.8786 of its radius.
    assert agrees(found.area95_x, 0.2 * 2 * 0.8786 * SINE)
    assert agrees(found.skewness, 0.0) and abs(found.skewness_power.sum() - 1) < 1e-12 and found.power == 20_000
    # Rays of half the flux, twice as many, are the same light.
    twice = etendue.phase_space(*np.tile([x, y, u, v], 2), np.full(40_000, 0.5), batch=np.tile(np.arange(20_000) % 32, 2))
    assert abs(twice.etendue[0] / found.etendue[0] - 1) < 0.05 and abs(twice.emittance[0] / found.emittance[0] - 1) < 1e-9


def test_travel_and_glass_conserve_it():
    x, y, u, v = cone()
    first = etendue.phase_space(x, y, u, v)
    p, q = cosines(u, v)
    # Into glass, n sin α is continuous.
    inside = slopes(p / 1.5, q / 1.5)
    glass = etendue.phase_space(x + 0.1 * inside[0], y + 0.1 * inside[1], *inside, index=1.5)
    for name in ("etendue", "emittance"):
        one, two = getattr(first, name), getattr(glass, name)
        assert abs(one[0] - two[0]) < 3 * math.hypot(one[1], two[1]), name
    assert np.allclose(glass.skewness_power, first.skewness_power)
    # A missing n², and slopes in place of direction cosines, which overstates a cone of 0.9 rad.
    assert etendue.phase_space(x, y, *inside).emittance[0] < 0.5 * first.emittance[0]
    wide = slopes(*(np.array([p, q]) * (math.sin(0.9) / SINE)))
    right, wrong = etendue.phase_space(x, y, *wide), etendue.phase_space(x, y, *(1e-3 * np.array(wide)))
    truth = A * math.pi * math.sin(0.9) ** 2
    assert agrees(right.etendue, truth) and not agrees((1e6 * wrong.etendue[0], 1e6 * wrong.etendue[1]), truth)


@pytest.mark.parametrize("event", [None, "Mirror", {"Refraction": {"front": 1, "back": 1.5}}], ids=["travel", "mirror", "refraction"])
def test_lossless_scenes_conserve_it(event):
    mirror = event == "Mirror"
    facing = [0.5, 0, -1] if mirror else [0, 0, -1]
    surface = {"name": "s", "center": [0, 0, 0.5], "facing": facing, "form": "Plane", "aperture": 3, "event": event}
    scene = {
        "light": {"Spot": {"center": [0, 0, 0], "bulb": {"Square": 0.2}, "exponent": 60}},
        "surfaces": [{"Smooth": surface} if event else {"Rectangle": {"name": "s", "center": [0, 0, 2], "size": [1, 1]}}],
        "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["s"]},
        "planes": [{"name": "light", "at": "Emission"}, {"name": "far", "at": {"Distance": 0.9}}],
        "window": {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}},
        "frequencies": {"rho": {"max": 2}, "nu": {"max": 2}},
        "run": {"emission": "Plain"},
    }
    found = []
    for plane, index in (("light", 1.0), ("far", 1.5 if isinstance(event, dict) else 1.0)):
        light = etendue.photons(scene, plane, photons=2**14)
        x, y, u, v, weight = light.rays.T
        flux = weight / (1 + u * u + v * v) ** 2
        found.append(etendue.phase_space(x, y, u, v, flux, index=index, batch=light.batch))
        fault = etendue.phase_space(x, y, u, v, flux, index=index**2, batch=light.batch)
    first, second = found
    for name in ("etendue", "area_x", "emittance", "skewness"):
        one, two = getattr(first, name), getattr(second, name)
        assert abs(one[0] - two[0]) < 4 * math.hypot(one[1], two[1]), (name, one, two)
    if isinstance(event, dict):
        assert abs(fault.emittance[0] - first.emittance[0]) > 4 * math.hypot(fault.emittance[1], first.emittance[1])


@pytest.mark.parametrize(
    "change, message",
    [
        ({"index": 0}, "index is 0"),
        ({"weight": -np.ones(2000)}, "negative"),
        ({"x": np.full(2000, np.nan)}, "not finite"),
        ({"x": np.zeros(3)}, "allowed: one number per ray"),
        ({"x": np.zeros(2000)}, "fill no volume"),
        ({"batches": 3}, "there are 3 groups"),
    ],
)
def test_wrong_rays_are_refused(change, message):
    x, y, u, v = cone(2000)
    with pytest.raises(ValueError, match=message):
        etendue.phase_space(**{"x": x, "y": y, "u": u, "v": v, **change})


def images(blur, count):
    """Spectra of the blurred image of a point, which the window does not cut."""
    found = []
    for seed in range(count):
        random = np.random.default_rng(seed)
        x, y = blur(random, (2, 4000))
        u, v = random.uniform(-0.1, 0.1, (2, 4000))
        window, frequencies = {"x": {"Box": 0.5}, "u": {"Box": 0.5}}, {"rho": {"max": 6}, "nu": {"max": 4}, "azimuths": 2}
        found.append(etendue.spectrum(x, y, u, v, window=window, frequencies=frequencies, threads=1))
    return found


@pytest.mark.parametrize(
    "blur, truth",
    [
        (lambda r, shape: 0.05 * r.standard_normal(shape), lambda rho: np.exp(-2 * (math.pi * rho * 0.05) ** 2)),
        (lambda r, shape: r.uniform(-0.1, 0.1, shape), lambda rho: abs(np.sinc(0.2 * rho))),
    ],
    ids=["Gaussian", "box"],
)
@pytest.mark.parametrize("count", [1, 16])
def test_mtf_of_blurs(blur, truth, count):
    spectra = images(blur, count)
    found = etendue.mtf(spectra if count > 1 else spectra[0])
    assert found.value.shape == (2, found.frequency.size) and (found.value[:, 0] == 1).all() and (found.sigma[:, 0] == 0).all()
    # Noise adds to |S| where there is no signal.
    known = (truth(found.frequency) > 0.2) & (found.frequency > 0)
    off = (abs(found.value - truth(found.frequency)) / np.maximum(found.sigma, 1e-12))[:, known]
    # Student's t of 16 spectra, 20 numbers.
    assert off.max() < 4.5
    # A blur that is 5 % wider is found by 16 spectra.
    wider = (abs(found.value - truth(1.05 * found.frequency)) / np.maximum(found.sigma, 1e-12))[:, known]
    assert count == 1 or wider.max() > 4.5
    angular = etendue.mtf(spectra[0], along="nu")
    assert abs(angular.value - abs(np.sinc(0.2 * angular.frequency))).max() < 0.1
    pytest.importorskip("matplotlib").use("Agg")
    assert found.plot().get_xlabel().startswith("ρ")


def test_wrong_spectra_are_refused():
    (one,) = images(lambda r, shape: r.uniform(-0.1, 0.1, shape), 1)
    for spectra, keys in [([one, one], {}), (one, {"along": "x"})]:
        with pytest.raises(ValueError, match="allowed: 1 spectrum or at least 4, along 'rho' or 'nu'"):
            etendue.mtf(spectra, **keys)
