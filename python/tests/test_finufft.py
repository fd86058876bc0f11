"""The estimator against FINUFFT: values, and seconds as a ratio."""

import time

import etendue
import numpy as np

finufft = __import__("pytest").importorskip("finufft")


def test_against_finufft():
    rays = 1 << 20
    x, y, u, v = np.random.default_rng(7).normal(0, 0.2, (4, rays))
    weight = np.random.default_rng(8).uniform(0.5, 1.5, rays)
    window = {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}
    frequencies = {"azimuths": 8, "rho": {"max": 24}, "nu": {"max": 24}}
    ours, theirs = [], []
    for _ in range(3):
        begun = time.perf_counter()
        found = etendue.spectrum(x, y, u, v, weight, window=window, frequencies=frequencies, threads=1)
        ours.append(time.perf_counter() - begun)
        begun = time.perf_counter()
        hann = np.prod([np.where(abs(t) < 0.5, np.cos(np.pi * t) ** 2, 0) for t in (x, y, u, v)], axis=0)
        inside = hann > 0
        carried = (weight * hann)[inside].astype(complex)
        rho, nu = found.rho[1] - found.rho[0], found.nu[1] - found.nu[0]
        slices = []
        for azimuth in found.azimuth:
            p = (x * np.cos(azimuth) + y * np.sin(azimuth))[inside]
            q = (u * np.cos(azimuth) + v * np.sin(azimuth))[inside]
            points = 2 * np.pi * rho * p, 2 * np.pi * nu * q
            shape = found.rho.size, found.nu.size
            slices.append(finufft.nufft2d1(*points, carried, shape, eps=1e-7, isign=-1, nthreads=1))
        theirs.append(time.perf_counter() - begun)
    difference = np.abs(found.slices - np.array(slices)).max() / carried.real.sum()
    print(f"largest difference {difference:.1e} of the sum; FINUFFT takes {np.median(theirs) / np.median(ours):.2f} times as long")
    # Both state errors of about 1e-7 of the sum of weights (docs/theory.md (11)).
    assert difference < 4e-7
