"""The spectra that `etendue probe` measures on fig10's surface as a mesh, against those of the bench: docs/mitsuba.md.

usage: fig10_probe.py MEASURED PROBED...

    etendue measure tests/peers/scenes/fig10_probe.ron --out MEASURED
    etendue probe scenes/worlds/fig10.xml --pixel 31,31 --window 63 --seed S --out PROBED      once for each of many seeds S
"""
import json, pathlib, sys

import numpy as np

from slices import judge

measured, probed = pathlib.Path(sys.argv[1]), [pathlib.Path(folder) for folder in sys.argv[2:]]
if len(probed) < 8:
    sys.exit("signs of at least 8 differences are needed: give as many folders of probes, of different seeds")
index = json.loads((probed[0] / "probe.json").read_text(encoding="utf-8"))
level = 1 - 0.99 ** (1 / len(index["planes"]))
print(f"{'plane':12} {'difference':>10} {'noise':>8} {'p':>7}   level {level:.5f}")
passed = True
for plane in index["planes"]:
    name = plane["report"]["name"]
    bench = np.load(measured / name / "batches.npz")["slices"]
    # As many groups of the bench's batches as there are probes.
    groups = np.array([group.mean(0) for group in np.array_split(bench[: len(bench) // len(probed) * len(probed)], len(probed))])
    slices = np.array([np.load(folder / name / "slices.npz")["measured"] for folder in probed])
    slices = slices[:, :, slices.shape[2] // 2 :]
    if slices.shape != groups.shape:
        sys.exit(f"{name}: probed on other frequencies than measured")
    # Where the probe's X goes the other way, Y does too: all frequencies are negative.
    if name == "arriving_1":
        slices = slices.conj()
    difference, noise, p = judge(slices, groups, np.random.default_rng(1))
    passed &= p >= level
    print(f"{name:12} {difference:10.2e} {noise:8.1e} {p:7.4f}")
sys.exit(0 if passed else 1)
