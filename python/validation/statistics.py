"""Calibrates p-values and errors of two_sample, chi_square, furnace, phase_space and mtf; prints results/statistics.md.

usage: python statistics.py [DRAWS]

1,000 draws take about 2 minutes on one core.
"""

import math
import sys

import etendue
import numpy as np

DRAWS = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
LEVEL = 0.01


def table(heads, rows):
    print("| " + " | ".join(heads) + " |\n|" + "---|" * len(heads))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print(flush=True)


def uniform(p):
    """The Kolmogorov–Smirnov distance of p-values from uniform, its bound at 5 %, and the shares below 5 % and 1 %."""
    p = np.sort(p)
    n = p.size
    distance = max((p - np.arange(n) / n).max(), (np.arange(1, n + 1) / n - p).max())
    return f"{distance:.3f}", f"{1.358 / math.sqrt(n):.3f}", f"{100 * np.mean(p <= 0.05):.1f} %", f"{100 * np.mean(p <= 0.01):.2f} %"


def rate(hits):
    share = np.mean(hits)
    return f"{share:.3f} ± {math.sqrt(share * (1 - share) / len(hits)):.3f}"


def coverage(z):
    z = np.abs(np.asarray(z))
    return [f"{100 * np.mean(z < k):.1f} %" for k in (1, 2)]


def image(random, batches, scale=1.0, kind="normal", pixels=100):
    """Renders [batch, pixel] whose mean is 1 to 2, times `scale`."""
    mean = np.linspace(1, 2, pixels)
    noise = random.standard_normal((batches, pixels))
    if kind == "correlated":
        noise = 0.5 * noise + 0.8 * random.standard_normal((batches, 1))
    render = mean * (1 + 0.3 * noise)
    if kind == "fireflies":
        render += (random.random((batches, pixels)) < 0.02) * random.pareto(1.5, (batches, pixels)) * 20
    return scale * render


def two_sample():
    print("## `two_sample`\n\nImages have 100 pixels, unless a row has another number, with a noise of 30 % per batch. "
        "Fireflies are in 2 % of the pixels, and their law has no variance.\n")
    rows = []
    for name, kind, a, b, samples, pixels in [
        ("8 + 8 batches", "normal", 8, 8, 1, 100),
        ("8 + 8, correlated pixels", "correlated", 8, 8, 1, 100),
        ("8 + 8, fireflies", "fireflies", 8, 8, 1, 100),
        ("4 + 12, fireflies", "fireflies", 4, 12, 1, 100),
    ] + [
        (f"unequal: {a} + {b}, b has a third of the noise, pixels: {pixels:,}", "normal", a, b, 9, pixels)
        for a, b, pixels in [(8, 8, 1), (8, 8, 100), (8, 8, 1000), (6, 18, 1), (6, 18, 100)]
    ]:
        p = []
        for seed in range(DRAWS):
            random = np.random.default_rng([seed, a, b])
            second = image(random, b * samples, kind=kind, pixels=pixels).reshape(b, samples, -1).mean(1)
            p.append(etendue.two_sample(image(random, a, kind=kind, pixels=pixels), second, permutations=199, seed=seed).p)
        rows.append((name, *uniform(np.array(p))))
    table(["sets of the same mean", "KS distance", "bound at 5 %", "p ≤ 5 %", "p ≤ 1 %"], rows)
    print("A change of everything, 16 + 16 batches. The stated power is an estimate from one of the three statistics.\n")
    rows = []
    for effect in (0.01, 0.02, 0.03, 0.04, 0.06):
        found = []
        for seed in range(DRAWS // 4):
            random = np.random.default_rng([seed, 7])
            # The change is relative to the mean of both sets.
            one, two = image(random, 16, 1 - effect / 2), image(random, 16, 1 + effect / 2)
            found.append(etendue.two_sample(one, two, effect=effect, permutations=399, seed=seed))
        z = [(one.change[0] - effect) / one.change[1] for one in found]
        square = np.array([one.excess * abs(one.excess) for one in found])
        power, excess = f"{np.mean([one.power for one in found]):.3f}", math.copysign(math.sqrt(abs(square.mean())), square.mean())
        rows.append((f"{100 * effect:.0f} %", power, rate([one.p <= LEVEL for one in found]), *coverage(z), f"{100 * excess:.2f} %"))
    table(["change", "power", "rate of p ≤ 1 %", "`change` within 1 σ", "2 σ", "`excess`, root of the mean square"], rows)
    print("Planted faults, 8 + 8 batches:\n")
    rows = []
    for name, fault in [
        ("one pixel of 100 has twice its brightness", lambda b, r: b * (1 + 1.0 * (np.arange(100) == 50))),
        ("every pixel is 10 % brighter", lambda b, r: b * 1.1),
        ("every pixel changes by ± 30 % at random", lambda b, r: b * (1 + 0.3 * np.sign(np.sin(np.arange(100) ** 2)))),
        ("batches are counted twice (not independent)", lambda b, r: np.repeat(b[:4], 2, axis=0)),
    ]:
        hits = []
        for seed in range(DRAWS // 10):
            random = np.random.default_rng([seed, 8])
            a, b = image(random, 8), image(random, 8)
            hits.append(etendue.two_sample(a, fault(b, random), permutations=399, seed=seed).p <= LEVEL)
        rows.append((name, rate(hits)))
    table(["fault", "rate of p ≤ 1 %"], rows)


def half(random, n):
    """Directions of a half of the sphere whose edge crosses cells in both coordinates."""
    drawn = random.standard_normal((4 * n, 3))
    drawn /= np.linalg.norm(drawn, axis=1)[:, None]
    return drawn[drawn @ HALF > 0][:n]


HALF = np.array([1.0, 0.3, 0.0])


def lobe(exponent, axis=(0.6, 0.0, 0.8)):
    axis = np.array(axis)
    across = np.array([0.0, 1.0, 0.0])
    other = np.cross(axis, across)

    def sample(random, n):
        z = random.random(n) ** (1 / (exponent + 1))
        angle = 2 * math.pi * random.random(n)
        turned = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * other
        return np.sqrt(1 - z * z)[:, None] * turned + z[:, None] * axis

    return sample, lambda points: (exponent + 1) / (2 * math.pi) * np.maximum(0, points @ axis) ** exponent


def chi_square():
    print("## `chi_square`\n\nSamplers of cosⁿ lobes with their densities, 4,000 samples, about 100 to 140 cells. "
        "Rows have the same random numbers, so they deviate together: two are above the bound here, and 3,000 draws with other seeds "
        "give 0.013 (n = 1) and 0.015 (n = 10⁶), below their bound of 0.025.\n")
    keys = {"samples": 4000, "cells": 64}
    rows = []
    cases = [(str(exponent), lobe(exponent)) for exponent in (1, 30, 1_000_000)]
    cases.append(("none: half of the sphere", (half, lambda points: (points @ HALF > 0) / (2 * math.pi))))
    for name, pair in cases:
        found = [etendue.chi_square(*pair, seed=seed, **keys) for seed in range(DRAWS)]
        error = max(abs(one.integral - 1) for one in found)
        rows.append((name, *uniform(np.array([one.p for one in found])), f"{error:.0e}"))
    table(["n", "KS distance", "bound at 5 %", "p ≤ 5 %", "p ≤ 1 %", "error of the integral"], rows)
    print("The density has another exponent than the sampler (n = 30). The power is that of the noncentral χ² with λ = N Σ (q − p)²/p.\n")
    rows = []
    for other in (31, 32.5, 34, 36, 40):
        found = [etendue.chi_square(lobe(30)[0], lobe(other)[1], seed=seed, **keys) for seed in range(DRAWS // 4)]
        rows.append((other, f"{predicted(other, found[0].dof):.3f}", rate([one.p <= LEVEL for one in found])))
    table(["exponent of the density", "power", "rate of p ≤ 1 %"], rows)
    sample, density = lobe(30)
    turned = math.asin(0.6) + math.pi / 90

    def spiked(random, n):
        return np.where(random.random(n)[:, None] < 0.02, [0.0, 0.0, 1.0], sample(random, n))

    rows = []
    for name, draw, pdf in [
        ("density lacks 2 % of the energy", sample, lambda points: 0.98 * density(points)),
        ("density has 2 % too much", sample, lambda points: 1.02 * density(points)),
        ("2 % of the samples are a delta function", spiked, density),
        ("the same, and the density lacks 2 %: no fault", spiked, lambda points: 0.98 * density(points)),
        ("the lobe is turned by 2°", sample, lobe(30, (math.sin(turned), 0, math.cos(turned)))[1]),
    ]:
        rows.append((name, rate([etendue.chi_square(draw, pdf, seed=seed, **keys).p <= LEVEL for seed in range(DRAWS // 10)])))
    table(["fault", "rate of p ≤ 1 %"], rows)


def predicted(other, dof):
    """Power of χ² at 1 %, for the density with another exponent."""
    from etendue.sampling import chi_square_above

    # Along the lobe, both densities are functions of c = cos θ: ∫ (q − p)² / p with c as the variable.
    c = (np.arange(200_000) + 0.5) / 200_000
    p, q = (other + 1) * c**other, 31 * c**30
    mean = 4000 * np.mean((q - p) ** 2 / p)
    low, high = 0.0, 10.0 * dof
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if chi_square_above(middle, dof) > LEVEL else (low, middle)
    terms = range(int(mean / 2 + 12 * math.sqrt(mean / 2 + 1) + 20))
    return sum(math.exp(j * math.log(mean / 2) - mean / 2 - math.lgamma(j + 1)) * chi_square_above(low, dof + 2 * j) for j in terms)


def furnace():
    print("## `furnace`\n\nA cosine sampled uniformly (lossless: weights 2 cos θ), 7 angles of 1,000 samples.\n")

    def pair(scale):
        def sample(random, n, incident):
            z = random.random(n)
            return np.stack([np.sqrt(1 - z * z), 0 * z, z], 1), scale * 2 * z

        return sample, lambda incident, directions: np.maximum(0, directions[:, 2]) / math.pi

    found = [etendue.furnace(pair(1.0), samples=1000, seed=seed) for seed in range(DRAWS)]
    rows = [(name, *uniform(np.array([getattr(one, name)[1] for one in found]))) for name in ("gain", "loss")]
    table(["p of", "KS distance", "bound at 5 %", "p ≤ 5 %", "p ≤ 1 %"], rows)
    rows = [
        ("`albedo`", *coverage([(one.albedo - 1) / one.sigma for one in found])),
        ("`evaluated`", *coverage([(one.evaluated - 1) / one.evaluated_sigma for one in found])),
    ]
    table(["number", "within 1 σ", "2 σ"], rows)
    faults = [(1.1, "gain"), (0.9, "loss")]
    rows = []
    for scale, name in faults:
        found = [etendue.furnace(pair(scale), samples=1000, seed=seed) for seed in range(DRAWS // 10)]
        rows.append((scale, name, rate([getattr(one, name)[1] <= LEVEL for one in found])))
    table(["weights times", "p of", "rate of p ≤ 1 %"], rows)


def rays(random, n, kind):
    """Rays of a rectangle into a cone, or of a Gaussian beam; with the étendue, and emittance and 95 % area in (x, p)."""
    if kind == "gaussian":
        x, y, p, q = random.standard_normal((4, n)) * np.array([0.1, 0.1, 0.02, 0.02])[:, None]
        truth = 16 * math.pi**2 * 4e-6, 4e-6, -2 * math.log(0.05) * math.pi * 2e-3
    else:
        sine = math.sin(0.3)
        x, y = random.uniform(-0.1, 0.1, n), random.uniform(-0.05, 0.05, n)
        radius, angle = sine * np.sqrt(random.random(n)), 2 * math.pi * random.random(n)
        p, q = radius * np.cos(angle), radius * np.sin(angle)
        # 95 % of the semicircle is within 0.8786 of its radius.
        truth = 0.02 * math.pi * sine**2, 0.2 * 0.1 / 12 * sine**2 / 4, 0.2 * 2 * 0.8786 * sine
    cosine = np.sqrt(1 - p * p - q * q)
    return (x, y, p / cosine, q / cosine), truth


def phase_space():
    print("## `phase_space`\n\n20,000 rays of a light A = 0.2 m × 0.1 m into a cone of 0.3 rad "
        "(étendue A π sin²θ), and of a Gaussian beam.\n")
    rows = []
    for kind in ("cone", "gaussian"):
        found = []
        for seed in range(DRAWS // 20):
            columns, truth = rays(np.random.default_rng(seed), 20_000, kind)
            found.append(etendue.phase_space(*columns))
        for name, true in zip(("etendue", "emittance", "area95_x"), truth):
            values = np.array([getattr(one, name) for one in found])
            mean = f"{values[:, 0].mean() / true:.4f}"
            spread = f"{100 * values[:, 0].std() / true:.2f} %", f"{100 * values[:, 1].mean() / true:.2f} %"
            rows.append((kind, f"`{name}`", mean, *spread, *coverage((values[:, 0] - true) / values[:, 1])))
    table(["rays", "number", "mean / closed form", "spread", "stated error", "within 1 σ", "2 σ"], rows)
    rows = []
    (x, y, u, v), truth = rays(np.random.default_rng(1), 100_000, "cone")
    right = etendue.phase_space(x, y, u, v).etendue
    far = etendue.phase_space(x + u, y + v, u, v).etendue
    # Into glass: n sin α is continuous, so slopes inside follow from p / 1.5.
    cosine = np.sqrt(1 + u * u + v * v)
    p, q = u / cosine / 1.5, v / cosine / 1.5
    inside = p / np.sqrt(1 - p * p - q * q), q / np.sqrt(1 - p * p - q * q)
    glass = etendue.phase_space(x, y, *inside, index=1.5).etendue
    fault = etendue.phase_space(x, y, *inside).etendue
    for name, found in [("light", right), ("after 1 m", far), ("in glass, index 1.5", glass), ("in glass, n² missing", fault)]:
        rows.append((name, f"{found[0] / truth[0]:.4f} ± {found[1] / truth[0]:.4f}"))
    table(["plane", "étendue / A π sin²θ"], rows)


def mtf():
    print("## `mtf`\n\nA Gaussian (σ = 0.05 m) and a box (0.2 m), each times a box window that does not cut them; "
        "2,000 rays in each of 8 spectra.\n")
    rows = []
    for name in ("gaussian", "box"):
        many, one = [], []
        for seed in range(DRAWS // 20):
            random = np.random.default_rng(seed)
            spectra = []
            for _ in range(8):
                x, y = random.standard_normal((2, 2000)) * 0.05 if name == "gaussian" else random.uniform(-0.1, 0.1, (2, 2000))
                u, v = random.uniform(-0.1, 0.1, (2, 2000))
                window = {"x": {"Box": 0.5}, "u": {"Box": 0.5}}
                frequencies = {"rho": {"max": 4}, "nu": {"max": 2}, "azimuths": 2}
                spectra.append(etendue.spectrum(x, y, u, v, window=window, frequencies=frequencies, threads=1))
            for found, out in ((etendue.mtf(spectra), many), (etendue.mtf(spectra[0]), one)):
                rho = found.frequency
                true = np.exp(-2 * (math.pi * rho * 0.05) ** 2) if name == "gaussian" else np.abs(np.sinc(0.2 * rho))
                # Where |S| is below three errors, its noise is not normal.
                known = (true > 0.1) & (rho > 0)
                out.append(((found.value - true) / np.where(known, found.sigma, 1.0))[:, known])
        rows += [(name, "8 spectra", *coverage(many)), (name, "1 spectrum", *coverage(one))]
    table(["blur", "errors from", "within 1 σ", "2 σ"], rows)


print("# Calibration of the tests in Python\n")
print("Written by `python python/validation/statistics.py`.\n")
print(f"Each row has {DRAWS:,} draws; power curves and faults have a quarter or a tenth of them, and rays a twentieth. "
    f"Normal errors are within 1 σ at 68.3 %, within 2 σ at 95.4 %.\n")
for part in (two_sample, chi_square, furnace, phase_space, mtf):
    part()
