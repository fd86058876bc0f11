"""The spectrum of a small light behind fog: Mitsuba's photons against the theory of small angles.

usage: fog.py PICTURE [RAYS]      needs etendue[mitsuba] and matplotlib

Light travels 2 m from a square to a plane, through a slab of fog from 0.5 m to 1.5 m that scatters forward. Travel over a distance d shears the
spectrum, F(ρ, ν) → F(ρ, ν + d ρ), and a thin layer of fog multiplies it by 1 − (1 − p(ν)) dτ, where p is the transform of the phase function over
slopes (Belcour, Bala and Soler 2014 have the same convolution over angles). So fog multiplies the spectrum of the clear light by
exp(−τ ∫ (1 − p(ν + (e + s) ρ)) ds / ℓ), where the slab of length ℓ ends at a distance e before the plane. For small angles, the phase function of
Henyey and Greenstein has p(ν) = exp(−2π a |ν|) with a = (1 − g)/√g.
"""

import sys

import matplotlib.pyplot as plt
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_mono")
import etendue.mitsuba

G, LENGTH, AFTER, DISTANCE = 0.97, 1.0, 0.5, 2.0
WINDOW = {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}
FREQUENCIES = {"azimuths": 8, "rho": {"max": 6}, "nu": {"max": 14}}
PLANE = etendue.mitsuba.Placement((0, 0, DISTANCE), (0, 0, 1), (1, 0, 0), WINDOW, FREQUENCIES)


def behind(depth, rays):
    """The spectrum behind fog of an optical depth."""
    turn = mi.ScalarTransform4f()
    scene = {"type": "scene", "light": {"type": "rectangle", "to_world": turn.scale([0.05, 0.05, 1]), "emitter": {"type": "area", "radiance": 1.0}}}
    if depth > 0:
        fog = {"type": "homogeneous", "albedo": 1.0, "sigma_t": depth / LENGTH, "phase": {"type": "hg", "g": G}}
        slab = turn.translate([0, 0, DISTANCE - AFTER - LENGTH / 2]).scale([20, 20, LENGTH / 2])
        scene["fog"] = {"type": "cube", "to_world": slab, "bsdf": {"type": "null"}, "interior": fog}
    integrator = {"type": "volpath", "max_depth": 200, "rr_depth": 200}
    return etendue.mitsuba.record(scene, PLANE, integrator=integrator, rays=rays, progress=False)


def filtered(depth, rho, nu):
    """The factor of the spectrum by theory."""
    a = (1 - G) / np.sqrt(G)
    s = (np.arange(200) + 0.5) / 200 * LENGTH
    gone = 1 - np.exp(-2 * np.pi * a * np.abs(nu + (AFTER + s) * rho))
    return np.exp(-depth * gone.mean())


def main():
    rays = float(sys.argv[2]) if len(sys.argv) > 2 else 2**20
    clear = behind(0, rays)
    # The ridge ν = −d ρ, at the frequencies of the grid.
    ridge = [(i, j) for i, rho in enumerate(clear.rho) for j, nu in enumerate(clear.nu) if rho >= 0 and abs(nu + DISTANCE * rho) < 1e-9]
    figure, axes = plt.subplots(1, 4, figsize=(16, 4), layout="constrained")
    for depth, ax in zip((0, 1, 4), axes):
        (clear if depth == 0 else behind(depth, rays)).plot(ax)
        ax.set(title=f"optical depth {depth}")
    print(f"{'depth':>5} {'ν':>6} {'measured':>18} {'theory':>8}")
    for color, depth in zip(("C0", "C1", "C2", "C3"), (0.5, 1, 2, 4)):
        found = behind(depth, rays)
        ratio = [abs(found.slices[0, i, j] / clear.slices[0, i, j]) for i, j in ridge]
        error = [found.slices_sigma[0, i, j] / abs(clear.slices[0, i, j]) for i, j in ridge]
        nu = [abs(clear.nu[j]) for _, j in ridge]
        theory = [filtered(depth, clear.rho[i], clear.nu[j]) for i, j in ridge]
        axes[3].errorbar(nu, ratio, error, fmt="o", color=color, label=f"optical depth {depth}")
        axes[3].plot(nu, theory, color=color)
        for row in zip(nu, ratio, error, theory):
            print(f"{depth:5} {row[0]:6.2f} {row[1]:9.4f} ± {row[2]:.4f} {row[3]:8.4f}")
    axes[3].set(xlabel="ν along the ridge [cycles/slope]", ylabel="|S| behind fog / |S| without", title="points: Mitsuba, lines: theory")
    axes[3].legend(loc="upper right")
    figure.savefig(sys.argv[1], dpi=96)


main()
