"""How much of the power of a shadow's spectrum lies in the wedge that its blockers' distances span (Egan et al. 2011; Mehta et al. 2012), measured and predicted.

usage: wedge.py PLANE NEAREST FARTHEST [AZIMUTH]        e.g. wedge.py out/two_layers/receiver 0.6 1.4

PLANE is the folder of a plane in a result of `etendue run`; distances are from there to the blockers, in metres; the slice is that of number AZIMUTH (0). A
blocker at distance d from a plane puts its frequencies on the line ν = -d ρ, so that blockers between two distances fill a wedge. The window blurs it: a
frequency counts as inside when it is within the window's first zero of the wedge (2 cycles over the width of a Hann window), and frequencies within that
of the origin, where light has its mean, are left out.
"""
import json, pathlib, sys

import numpy as np

plane, nearest, farthest = pathlib.Path(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
azimuth = int(sys.argv[4]) if len(sys.argv) > 4 else 0
slices = np.load(plane / "slices.npz")
summary = json.loads((plane.parent / "summary.json").read_text(encoding="utf-8"))
window = summary["scene_file"]["window"]
half = [next(iter(window[axis].values())) for axis in "xu"]
zero = [2 / (2 * h) for h in half]
rho, nu = np.meshgrid(slices["rho"], slices["nu"], indexing="ij")
is_core = (np.abs(rho) < zero[0]) & (np.abs(nu) < zero[1])
ends = np.stack([nu + d * rho for d in (nearest, farthest)])
reach = np.stack([zero[1] + d * zero[0] for d in (nearest, farthest)])[:, None, None]
is_inside = (np.abs(ends) < reach).any(0) | (np.sign(ends[0]) != np.sign(ends[1]))
for name in ["measured", "predicted"]:
    power = np.abs(slices[name][azimuth]) ** 2
    if name == "measured":
        power = power - slices["sigma"][azimuth] ** 2
    power = np.where(is_core, 0, power)
    print(f"{name:9}  in the wedge {power[is_inside].sum() / power.sum():.4f}  outside {power[~is_inside].sum() / power.sum():.4f}")
total = (~is_core).sum()
print(f"of the frequencies of the slice the wedge has {(is_inside & ~is_core).sum() / total:.4f}")
