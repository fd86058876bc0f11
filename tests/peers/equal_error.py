"""Seconds that Étendue and Mitsuba 3 take to the same error of a plane's slices.

usage: equal_error.py ETENDUE FOLDER [ROUNDS]     e.g. equal_error.py target/release/etendue out/equal_error 7

The job is that of scenes/bench_peer.ron: light through 400 squares, one window, eight slices. The error is the norm
of measured less predicted slices over that of the predicted ones, which are exact. Mitsuba's rays fill a histogram over (x, y, u, v),
whose slices NumPy sums cell by cell; what a cell averages away is divided out. *Aimed* draws points of the light and of the
window, by Mitsuba's samplers; *stock* takes the rays of its area emitter. Neither the start of a program nor compilation is counted.
"""
import json, pathlib, subprocess, sys, time
import mitsuba as mi, numpy as np

mi.set_variant("llvm_ad_mono")
import drjit as dr

ETENDUE, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])
ROUNDS = int(sys.argv[3]) if len(sys.argv) > 3 else 5
HALF_X, HALF_U, PLANE = 0.25, 0.5, 2.0    # window half-widths and the plane's z
SAMPLERS = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"]
BINS = [32, 48, 64]
ERRORS = [0.03, 0.01, 0.003, 0.001]


def etendue(photons, seed):
    """Error and seconds of tracing and transform, and the exact slices."""
    out = FOLDER / "run"
    subprocess.run([ETENDUE, "run", "scenes/bench_peer.ron", "--quiet", "--force", "--out", out,
                    "--photons", str(photons), "--seed", str(seed)], check=False)
    slices = np.load(out / "receiver/slices.npz")
    seconds = json.loads((out / "timing.json").read_text())["seconds"]["trace"]
    return error(slices["measured"], slices["predicted"]), seconds, slices


def error(measured, predicted):
    return np.linalg.norm(measured - predicted) / np.linalg.norm(predicted)


def scene():
    """The squares of the scene as Étendue exports them, and its light."""
    out = FOLDER / "exported"
    subprocess.run([ETENDUE, "export", "--to", "mitsuba", "scenes/bench_peer.ron", "--force", "--out", out], check=True)
    light = {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale([0.5, 0.5, 1]), "emitter": {"type": "area", "radiance": {"type": "spectrum", "value": 1.0}}}
    return mi.load_dict({"type": "scene", "light": light, "squares": {"type": "ply", "filename": str(out / "blockers_0.ply")}})


def hann(t, half):
    return dr.square(dr.cos(0.5 * dr.pi * t / half))


def aimed(sampler):
    """Rays from the light to the window, and what each stands for in dx dy du dv."""
    a, b = sampler.next_2d(), sampler.next_2d()
    o = mi.Point3f(a.x - 0.5, a.y - 0.5, 0)
    p = mi.Point3f((2 * b.x - 1) * HALF_X, (2 * b.y - 1) * HALF_X, PLANE)
    d = p - o
    ray = mi.Ray3f(o, dr.normalize(d))
    ray.maxt = dr.norm(d)
    return ray, p, d.x / d.z, d.y / d.z, (2 * HALF_X / PLANE) ** 2


def stock(sampler):
    """Rays of the area emitter, of equal flux π: cos θ dω is du dv / (1 + u² + v²)²."""
    ray, _ = SCENE.emitters()[0].sample_ray(0.0, sampler.next_1d(), sampler.next_2d(), sampler.next_2d())
    ray.maxt = (PLANE - ray.o.z) / ray.d.z
    u, v = ray.d.x / ray.d.z, ray.d.y / ray.d.z
    return ray, ray(ray.maxt), u, v, dr.select(ray.d.z > 0, dr.pi * dr.square(1 + u * u + v * v), 0)


def histogram(rays, sampler, photons, seed, bins):
    """The windowed light field [x, y, u, v] of some rays, their number, and the seconds it took."""
    sampler = mi.load_dict({"type": sampler, "sample_count": photons})
    photons = sampler.sample_count()    # some samplers round it
    start = time.perf_counter()
    sampler.seed(seed, photons)
    ray, p, u, v, weight = rays(sampler)
    inside = (dr.abs(p.x) < HALF_X) & (dr.abs(p.y) < HALF_X) & (dr.abs(u) < HALF_U) & (dr.abs(v) < HALF_U)
    inside &= ~SCENE.ray_test(ray, inside)
    weight = weight * hann(p.x, HALF_X) * hann(p.y, HALF_X) * hann(u, HALF_U) * hann(v, HALF_U) / photons
    index = mi.UInt(0)
    for value, half in ((p.x, HALF_X), (p.y, HALF_X), (u, HALF_U), (v, HALF_U)):
        index = index * bins + mi.UInt((value + half) / (2 * half) * bins)
    cells = dr.zeros(mi.Float, bins**4)
    dr.scatter_reduce(dr.ReduceOp.Add, cells, weight, index, inside)
    dr.eval(cells)
    dr.sync_thread()
    return np.array(cells), photons, time.perf_counter() - start


def slices(cells, bins, grid):
    """The slices of a histogram at the frequencies of Étendue, and the seconds they took."""
    start = time.perf_counter()
    cells = cells.reshape(bins**2, bins**2)
    found = np.empty(grid["predicted"].shape, complex)
    middle = (np.arange(bins) + 0.5) * 2 / bins - 1
    for k, azimuth in enumerate(grid["azimuth"]):
        factors = []
        for along, half in ((grid["rho"], HALF_X), (grid["nu"], HALF_U)):
            axes = []
            for part in (np.cos(azimuth), np.sin(azimuth)):
                f = along * part
                axes.append(np.exp(-2j * np.pi * np.outer(f, half * middle)) / np.sinc(f * 2 * half / bins)[:, None])
            factors.append((axes[0][:, :, None] * axes[1][:, None, :]).reshape(len(along), -1))
        found[k] = factors[0] @ cells @ factors[1].T
    return found, time.perf_counter() - start


def mitsuba(rays, sampler, photons, seed, bins, grid):
    """Photons, error and seconds."""
    cells, photons, seconds = histogram(rays, sampler, photons, seed, bins)
    found, took = slices(cells, bins, grid)
    return photons, error(found, grid["predicted"]), seconds + took


def line(x, y, weights):
    """y = a + b x by weighted least squares, with a and b ≥ 0; b is NaN where y does not grow with x."""
    a, b = np.linalg.lstsq(np.stack([weights, weights * x], 1), weights * y, rcond=None)[0]
    if a < 0:
        return 0.0, np.sum(weights**2 * x * y) / np.sum((weights * x) ** 2)
    return a, b if b > 0 else np.nan


def seconds_to(results, target):
    """Seconds to an error: its square is that of the histogram and noise like 1/photons, time a start and as much for each photon."""
    photons, errors, seconds = np.array(results).T
    floor, noise = line(1 / photons, errors**2, 1 / errors**2)
    begin, each = line(photons, seconds, 1 / seconds)
    return begin + each * noise / (target**2 - floor) if target**2 > floor else np.inf


FOLDER.mkdir(parents=True, exist_ok=True)
SCENE = scene()
grid = etendue(2**18, 1)[2]
jobs = [("Étendue", "net", 0, n) for n in range(18, 25, 2)]
jobs += [("aimed", sampler, bins, n) for sampler in SAMPLERS for bins in BINS for n in (20, 22, 24)]
jobs += [("stock", "independent", bins, n) for bins in BINS for n in (20, 22, 24)]
found = {}
for round in range(ROUNDS + 1):
    for who, sampler, bins, n in jobs:
        if who == "Étendue":
            result = (2**n, *etendue(2**n, round)[:2])
        else:
            result = mitsuba(aimed if who == "aimed" else stock, sampler, 2**n, round, bins, grid)
        if round > 0:    # the first warms up
            found.setdefault((who, sampler, bins), {}).setdefault(n, []).append(result)
medians = {job: [np.median(np.array(each), axis=0) for each in of.values()] for job, of in found.items()}
print("| rays | sampler | cells along an axis | photons | error | seconds |\n|---|---|---|---|---|---|")
for (who, sampler, bins), results in medians.items():
    for photons, error_, seconds in results:
        print(f"| {who} | {sampler} | {bins or ''} | {photons:.2e} | {100 * error_:.3f} % | {seconds:.3f} |")
heads = "".join(f" to {100 * target:g} % |" for target in ERRORS)
print(f"\n| rays | sampler | cells along an axis |{heads}\n|---|---|---|{'---|' * len(ERRORS)}")
ours = [seconds_to(medians["Étendue", "net", 0], target) for target in ERRORS]
for (who, sampler, bins), results in medians.items():
    ratios = [seconds_to(results, target) / our for target, our in zip(ERRORS, ours)]
    text = [f"{our:.3g} s" for our in ours] if who == "Étendue" else ["never" if np.isinf(r) else "–" if np.isnan(r) else f"{r:.2g} ×" for r in ratios]
    print(f"| {who} | {sampler} | {bins or ''} | {' | '.join(text)} |")
