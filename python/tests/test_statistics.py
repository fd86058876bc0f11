"""Tests of renderers: two sets of images, samplers against densities, furnaces. Faults are planted in each."""

import math

import etendue
import numpy as np
import pytest
from etendue.sampling import chi_square_above

# One in a thousand: seeds are fixed, so each test passes or fails for good.
LEVEL = 1e-3


def image(seed, batches, shape=(12, 10), noise=0.3):
    """Renders with noise in proportion to their mean, and fireflies whose law has no variance."""
    random = np.random.default_rng(seed)
    mean = np.linspace(1, 2, math.prod(shape)).reshape(shape)
    fireflies = (random.random((batches, *shape)) < 0.005) * random.pareto(1.5, (batches, *shape)) * 20
    return mean * (1 + noise * random.standard_normal((batches, *shape))) + fireflies


def test_p_is_uniform_with_few_batches_and_fireflies():
    p = np.sort([etendue.two_sample(image(i, 4, (20,)), image(1000 + i, 4, (20,)), permutations=99).p for i in range(200)])
    # All 70 assignments are used; the bound is that of Kolmogorov and Smirnov at 0.1 %, plus the steps of p.
    assert etendue.two_sample(image(0, 4), image(1, 4)).labellings == 70
    assert abs(p - (np.arange(200) + 0.5) / 200).max() < 1.95 / math.sqrt(200) + 2 / 70


@pytest.mark.parametrize(
    "fault",
    [
        lambda b: b * 1.15,
        lambda b: b * (1 + 3 * (np.arange(120).reshape(12, 10) == 37)),
        lambda b: b * (1 + 0.5 * np.sign(np.sin(np.arange(120.0) ** 2)).reshape(12, 10)),
        lambda b: b[:, ::-1],
    ],
    ids=["brighter", "one pixel", "everywhere up or down", "upside down"],
)
def test_faults_of_images_are_found(fault):
    a, b = image(1, 16), image(2, 16)
    assert etendue.two_sample(a, b).p > 0.01
    assert etendue.two_sample(a, fault(b)).p <= 0.003  # of 1,000 assignments, each of three statistics is largest at one


def test_a_change_is_measured():
    a, b = image(3, 16, noise=0.1), 1.03 * image(4, 24, noise=0.1)
    found = etendue.two_sample(a, b, effect=0.02)
    change, error = found.change
    # Student's t with about 30 degrees of freedom.
    assert abs(change - 0.03) < 3.6 * error and found.detectable < 0.03 and found.power > 0.7
    assert 0.8 < found.chi2_per_dof < 3 and "detectable" in str(found)
    array = etendue.two_sample(a, b, effect=0.03 * a.mean(0))
    assert array.p <= 0.003 and abs(array.change[0] - 1) < 4 * array.change[1] + 0.2  # the array is itself noisy
    # One in the middle of an image is at its place; complex numbers have one index.
    b = a[::-1] + 0.0
    b[:, 3, 4] += 10
    assert etendue.two_sample(a, b).index == (3, 4) and etendue.two_sample(a, b).z > 5
    both = etendue.two_sample(a * 1j, b * 1j)
    assert both.index == (3, 4) and both.p <= 0.003


def test_images_without_noise():
    a = np.full((8, 5), 0.1, np.float32)
    same = etendue.two_sample(a, a.copy())
    assert same.p == 1 and math.isnan(same.chi2_per_dof) and same.excess == 0
    # Single precision rounds to 6e-8.
    assert etendue.two_sample(a, a * np.float32(1 + 1e-7)).p == 1
    assert etendue.two_sample(a, a * 1.01).p <= 0.003


@pytest.mark.parametrize(
    "a, b, keys, message",
    [
        (np.ones((3, 2)), np.ones((8, 2)), {}, "at least 4 independent batches"),
        (np.ones((8, 2)), np.ones((8, 3)), {}, "allowed: one shape"),
        (np.full((8, 2), np.nan), np.ones((8, 2)), {}, "not finite"),
        (np.empty((8, 0)), np.empty((8, 0)), {}, "allowed: numbers"),
        (np.array([["a"]] * 8), np.ones((8, 1)), {}, "allowed: numbers"),
        (np.ones((8, 2)), np.ones((8, 2)), {"effect": [1, 2, 3]}, "effect is int64"),
        (np.ones((8, 2)), np.ones((8, 2)), {"effect": 1j}, "effect is complex128"),
        (np.ones((8, 2)), np.ones((8, 2)), {"effect": 0}, "effect is int64"),
        (np.ones((8, 2)), np.ones((8, 2)), {"permutations": 9}, "permutations is 9"),
    ],
)
def test_wrong_images_are_refused(a, b, keys, message):
    with pytest.raises(ValueError, match=message):
        etendue.two_sample(a, b, **keys)


def lobe(exponent, axis=(0.6, 0.0, 0.8)):
    """A sampler of a cosⁿ lobe, and its density."""
    axis = np.array(axis)
    across = np.array([0.0, 1.0, 0.0])

    def sample(random, n):
        z = random.random(n) ** (1 / (exponent + 1))
        angle = 2 * math.pi * random.random(n)
        turned = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(axis, across)
        return np.sqrt(1 - z * z)[:, None] * turned + z[:, None] * axis

    return sample, lambda w: (exponent + 1) / (2 * math.pi) * np.maximum(0, w @ axis) ** exponent


KEYS = {"samples": 30_000, "cells": 256}


@pytest.mark.parametrize("exponent, axis", [(1, (0, 0, 1)), (20, (0.6, 0, 0.8)), (1e4, (-1, 0, 0)), (1e7, (0, 0, 1)), (1e7, (0.6, 0, 0.8))])
def test_sharp_lobes_are_integrated(exponent, axis):
    found = etendue.chi_square(*lobe(exponent, axis), **KEYS)
    assert found.p > LEVEL and abs(found.integral - 1) <= 3 * found.integral_error + 1e-9 and found.singular == 0
    # The error of 0.02 standard errors per cell, of about 300 cells.
    assert found.integral_error < 1e-3


@pytest.mark.parametrize("fault", [False, True])
def test_edges_across_slices_at_a_pole(monkeypatch, fault):
    def wedge(random, n):
        z, azimuth = 0.9 + 0.1 * random.random(n), 2.5 * random.random(n)
        return np.stack([np.sqrt(1 - z * z) * np.cos(azimuth), np.sqrt(1 - z * z) * np.sin(azimuth), z], 1)

    if fault:
        # Slices and their parts have the same azimuths of nodes, so an edge of azimuth goes unnoticed.
        monkeypatch.setattr("etendue.sampling.RULES", 2 * etendue.sampling.RULES[:1])
    found = etendue.chi_square(wedge, lambda w: ((w[:, 2] > 0.9) & (np.arctan2(w[:, 1], w[:, 0]) % (2 * math.pi) < 2.5)) / 0.25, **KEYS)
    assert (found.p > LEVEL and abs(found.integral - 1) <= found.integral_error) != fault


def spiked(random, n):
    return np.where(random.random(n)[:, None] < 0.02, [0.0, 0.0, 1.0], lobe(20)[0](random, n))


@pytest.mark.parametrize(
    "sample, pdf",
    [
        (lobe(20)[0], lambda w: 0.99 * lobe(20)[1](w)),
        (lobe(20)[0], lambda w: 1.01 * lobe(20)[1](w)),
        (lobe(20)[0], lobe(22)[1]),
        (lobe(20)[0], lobe(20, (0.62, 0, math.sqrt(1 - 0.62**2)))[1]),
        (spiked, lobe(20)[1]),
        (lambda r, n: -lobe(20)[0](r, n), lobe(20)[1]),
        (lambda r, n: np.where(np.arange(n)[:, None] % 500 == 0, np.nan, lobe(20)[0](r, n)), lobe(20)[1]),
    ],
    ids=["energy lost", "too much", "exponent", "turned", "delta function", "wrong side", "NaN"],
)
def test_faults_of_samplers_are_found(sample, pdf):
    assert etendue.chi_square(sample, pdf, **KEYS).p < LEVEL


def test_delta_functions_and_several_configurations():
    mixed = etendue.chi_square(spiked, lambda w: 0.98 * lobe(20)[1](w), **KEYS)
    assert mixed.p > LEVEL and abs(mixed.singular - 0.02) < 0.004 and abs(mixed.integral - 0.98) < 1e-3
    samplers, densities = zip(lobe(20), lobe(5), lobe(100))
    several = etendue.chi_square(samplers, densities, **KEYS)
    assert len(several.p_values) == 3 and abs(several.p - (1 - (1 - min(several.p_values)) ** 3)) < 1e-12
    assert etendue.chi_square(samplers, densities[::-1], **KEYS).p < LEVEL
    square = ((0, 1), (0, 2))
    found = etendue.chi_square(lambda r, n: r.random((n, 2)) ** 0.5 * [1, 2], lambda x: x[:, 0] * x[:, 1], domain=square, **KEYS)
    assert found.p > LEVEL and abs(found.integral - 1) < 1e-9 and "χ²" in str(found)


@pytest.mark.parametrize(
    "sample, pdf, keys, message",
    [
        (lambda r, n: np.ones((n, 2)), lobe(1)[1], {}, "the sampler returned float64 of shape"),
        (lobe(1)[0], lambda w: -np.ones(len(w)), {}, "the density has shape"),
        (lobe(1)[0], lambda w: np.ones((len(w), 1)), {}, "the density has shape"),
        (lobe(1)[0], lobe(1)[1], {"domain": ((0, 0), (0, 1))}, "domain is"),
        (lobe(1)[0], lobe(1)[1], {"domain": "disc"}, "domain is 'disc'"),
        (lobe(1)[0], lobe(1)[1], {"samples": 10}, "samples is 10"),
        ([lobe(1)[0]], [], {}, "allowed: one density for each sampler"),
    ],
)
def test_wrong_samplers_are_refused(sample, pdf, keys, message):
    with pytest.raises(ValueError, match=message):
        etendue.chi_square(sample, pdf, **{**KEYS, **keys})


def test_chi_square_has_its_tabulated_quantiles():
    # Abramowitz and Stegun 1964, table 26.8: six digits of x, and the tail falls by a fifth per unit of x.
    for x, dof, p in [(3.84146, 1, 0.05), (18.3070, 10, 0.05), (63.6907, 40, 0.01), (149.449, 100, 0.001), (77.9295, 100, 0.95)]:
        assert abs(chi_square_above(x, dof) / p - 1) < 1e-4
    assert chi_square_above(0.0, 5) == 1 and chi_square_above(1e9, 4) == 0


def cosine(scale=1.0, reflectance=1.0):
    """A diffuse surface, sampled uniformly over the hemisphere; `scale` is a fault of the weights."""

    def sample(random, n, incident):
        z = random.random(n)
        return np.stack([np.sqrt(1 - z * z), 0 * z, z], 1), scale * reflectance * 2 * z

    return sample, lambda incident, w: reflectance * np.maximum(0, w[:, 2]) / math.pi


def test_furnaces():
    found = etendue.furnace(cosine(), samples=20_000)
    assert found.albedo.shape == (7, 1) and found.gain[1] > LEVEL and found.loss[1] > LEVEL
    assert (abs(found.albedo - found.evaluated) < 4 * np.hypot(found.sigma, found.evaluated_sigma)).all()
    assert etendue.furnace(cosine(1.03), samples=20_000).gain[1] < LEVEL
    grey = etendue.furnace(cosine(reflectance=0.97), samples=20_000)
    assert grey.loss[1] < LEVEL < grey.gain[1]
    with pytest.raises(ValueError, match="angles is"):
        etendue.furnace(cosine(), angles=[2.0])
    with pytest.raises(ValueError, match="sample returned weights of shape"):
        etendue.furnace((lambda r, n, w: (None, [1.0]), cosine()[1]))
    pytest.importorskip("matplotlib").use("Agg")
    assert grey.plot().get_ylabel() == "albedo"


def test_furnaces_of_mitsuba():
    mi = pytest.importorskip("mitsuba")
    before = mi.variant()
    mi.set_variant("scalar_rgb")
    try:
        keys = {"samples": 1000, "angles": [0.2, 1.2]}
        for lossless in ({"type": "conductor", "material": "none"}, {"type": "dielectric"}, {"type": "diffuse", "reflectance": 1.0}):
            found = etendue.furnace(lossless, **keys)
            assert found.albedo.shape == (2, 3) and found.gain[1] > LEVEL and found.loss[1] > LEVEL, lossless
        # Single scattering loses energy.
        for lossy in ({"type": "roughconductor", "material": "none", "alpha": 0.5}, {"type": "roughplastic", "diffuse_reflectance": 1.0}):
            assert etendue.furnace(lossy, **keys).loss[1] < LEVEL, lossy
        with pytest.raises(ValueError, match="allowed: a pair of functions"):
            etendue.furnace({"type": "sphere"}, **keys)
        mi.set_variant("scalar_spectral")
        with pytest.raises(ValueError, match="the variant of Mitsuba is scalar_spectral"):
            etendue.furnace({"type": "diffuse"}, **keys)
    finally:
        if before:
            mi.set_variant(before)
