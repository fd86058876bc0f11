"""The light fields of a scene recorded with Mitsuba 3, against those that Étendue's photons measured: docs/mitsuba.md.

usage: mitsuba_light_field.py EXPORTED MEASURED [--planes NAMES] [--rays N] [--seed S]

    etendue export --to mitsuba SCENE.ron --out EXPORTED     scene.xml and planes.json
    etendue measure SCENE.ron --out MEASURED                 PLANE/batches.npz for each plane
"""
import argparse, json, os, pathlib, sys, zlib

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # blocks are too small for more
import mitsuba as mi, numpy as np

mi.set_variant("llvm_ad_mono")
import drjit as dr

ALPHA, FLIPS, BLOCK = 0.01, 19_999, 1024


class Profile:
    """A factor of the window, and random numbers distributed as it."""

    def __init__(self, written):
        (self.kind, value), = written.items()
        self.width, self.half = (value["width"], value["cut"]) if self.kind == "Gaussian" else (value, value)
        nodes, weights = np.polynomial.legendre.leggauss(200)
        self.integral = self.half * np.sum(weights * self(self.half * nodes))

    def __call__(self, t):
        inside = np.abs(t) < self.half
        if self.kind == "Hann":
            return inside * np.cos(0.5 * np.pi * t / self.half) ** 2
        return inside * (np.exp(-np.pi * (t / self.width) ** 2) if self.kind == "Gaussian" else 1.0)

    def draw(self, rng, n):
        kept = np.empty(0)
        while len(kept) < n:
            t = rng.uniform(-self.half, self.half, 2 * n)
            kept = np.append(kept, t[rng.random(2 * n) < self(t)])
        return kept[:n]


class Recorder:
    """Draws rays of a plane's window and asks Mitsuba, backwards, for their radiance."""

    def __init__(self, scene, plane, length):
        self.scene, self.plane = scene, plane
        self.origin, self.x, self.y, self.d = (np.array(plane["frame"][axis]) for axis in "OXYD")
        self.window = [Profile(plane["window"][axis]) for axis in "xyuv"]
        self.light = next((shape for shape in scene.shapes() if shape.is_emitter()), None)
        # The light itself, and what one surface makes of it.
        self.integrator = mi.load_dict({"type": "path", "max_depth": 1 + plane["leg"]})
        # A ray starts a little beside the plane, and so beside what stands in it: towards the light to look at what
        # arrives there, away from it to look at what comes out. The ray is the same.
        self.aside = (1e-4 if plane["side"] == "after" else -1e-4) * length
        if self.light is not None:
            box = self.light.bbox()
            low, high = np.array(box.min)[:2], np.array(box.max)[:2]
            self.center, self.size = 0.5 * (low + high), high - low

    def draw(self, rng, n):
        """Rays [4, n], and window over density. Two of these are drawn: positions, slopes, both by the window, and a point
        of the light; those two that leave the least to chance."""
        volume = [self.window[0].integral * self.window[1].integral, self.window[2].integral * self.window[3].integral]
        distance, position, slope = self.plane["distance"], (0, 1), (2, 3)
        choices = {"window": volume[0] * volume[1]}
        if self.plane["leg"] == 0:
            area = np.prod(self.size)
            choices["slopes"] = area * volume[1]
            choices["positions"] = volume[0] * area / distance**2 if distance > 0 else np.inf
        choice = min(choices, key=choices.get)
        rays = np.array([w.draw(rng, n) for w in self.window])
        drawn = {"window": position + slope, "slopes": slope, "positions": position}[choice]
        if choice != "window":
            at_light = self.center[:, None] + self.size[:, None] * rng.uniform(-0.5, 0.5, (2, n))
            if choice == "slopes":
                rays[:2] = at_light + distance * rays[2:]
            else:
                rays[2:] = (rays[:2] - at_light) / distance
        # The density is the window where the window was drawn by: the rest of it is left.
        left = np.prod([w(t) for i, (w, t) in enumerate(zip(self.window, rays)) if i not in drawn], axis=0)
        return rays, choices[choice] * left * np.ones(n)

    def radiance(self, rays, seed):
        n = rays.shape[1]
        x, y, u, v = rays[:, :, None]
        direction = self.d + u * self.x + v * self.y
        start = self.origin + x * self.x + y * self.y + self.aside * direction
        back = -direction / np.linalg.norm(direction, axis=1, keepdims=True)
        ray = mi.RayDifferential3f(mi.Point3f(start.T.astype("f4")), mi.Vector3f(back.T.astype("f4")))
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, n)
        # Light is followed to the surface the path visits, and not to what lies beyond its edge.
        active = mi.Bool(True)
        if self.plane["leaves"] is not None:
            leaves = next(s for s in self.scene.shapes() if s.id() == self.plane["leaves"])
            active = self.scene.ray_intersect(ray).shape == mi.ShapePtr(leaves)
        found, _, _ = self.integrator.sample(self.scene, sampler, ray, None, active)
        return np.array(dr.select(active, found[0], 0), float).reshape(-1) * np.ones(n)

    def slices(self, rng, n):
        """Slices [K, ρ ≥ 0, ν] of one batch of n rays, and how many of them carry light."""
        rays, window_over_density = self.draw(rng, n)
        weight = window_over_density * self.radiance(rays, int(rng.integers(2**31))) / n
        if self.plane["quantity"] == "DifferentialIrradiance":
            weight /= (1 + rays[2] ** 2 + rays[3] ** 2) ** 2
        kept = weight != 0
        return transform(rays[:, kept], weight[kept], self.plane["frequencies"]), np.count_nonzero(kept)


def powers(phase, count):
    """exp(−i m phase), m = 0 .. count, [count + 1, n]."""
    table = np.ones((count + 1, len(phase)), complex)
    step = np.exp(-1j * phase)
    for m in range(count):
        np.multiply(table[m], step, out=table[m + 1])
    return table


def transform(rays, weight, grid):
    """S(ρ, ν) = Σ w exp(−2πi (ρ (x cos φ + y sin φ) + ν (u cos φ + v sin φ))) at φ = πk/K."""
    rho, nu = grid["rho"], grid["nu"]
    sums = np.zeros((grid["azimuths"], rho["half"] + 1, 2 * nu["half"] + 1), complex)
    for start in range(0, len(weight), BLOCK):
        x, y, u, v = rays[:, start : start + BLOCK]
        w = weight[start : start + BLOCK]
        for k in range(grid["azimuths"]):
            c, s = np.cos(np.pi * k / grid["azimuths"]), np.sin(np.pi * k / grid["azimuths"])
            spatial = w * powers(2 * np.pi * rho["spacing"] * (c * x + s * y), rho["half"])
            angular = powers(2 * np.pi * nu["spacing"] * (c * u + s * v), nu["half"])
            angular = np.concatenate([angular[:0:-1].conj(), angular])
            sums[k] += spatial @ angular.T
    return sums


def judge(recorded, measured, rng):
    """Relative difference, its noise, and p by random signs of the batches' differences, over the independent half."""
    half = recorded.shape[3] // 2
    independent = np.ones(recorded.shape[1:], bool)
    independent[:, 0, :half] = False
    residual = (recorded - measured)[:, independent]
    batches = len(residual)
    size = np.linalg.norm(measured.mean(0)[independent]) or 1.0
    difference = np.linalg.norm(residual.mean(0)) / size
    noise = np.sqrt(np.sum(residual.var(0, ddof=1)) / batches) / size
    scale = np.sum(np.abs(residual) ** 2, axis=0)
    normal = residual / np.sqrt(np.where(scale > 0, scale, 1))
    products = (normal @ normal.conj().T).real
    signs = rng.choice([-1.0, 1.0], (FLIPS, batches))
    flipped = np.sum((signs @ products) * signs, axis=1)
    return difference, noise, (1 + np.sum(flipped >= products.sum())) / (FLIPS + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("exported", type=pathlib.Path, help="folder with scene.xml and planes.json")
    parser.add_argument("measured", type=pathlib.Path, help="folder with PLANE/batches.npz")
    parser.add_argument("--planes", help="names, separated by commas; all planes unless given")
    parser.add_argument("--rays", type=float, default=4e6, help="rays for each plane; 4e6 unless given")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    planes = json.loads((asked.exported / "planes.json").read_text())["planes"]
    length = max(plane["distance"] for plane in planes)
    if asked.planes:
        names = asked.planes.split(",")
        if unknown := set(names) - {plane["name"] for plane in planes}:
            parser.error(f"no such plane: {', '.join(sorted(unknown))}")
        planes = [plane for plane in planes if plane["name"] in names]
    # Not optimized: shapes of one material would become one shape.
    scene = mi.load_file(str(asked.exported / "scene.xml"), optimize=False)
    level = 1 - (1 - ALPHA) ** (1 / len(planes))
    print(f"{'plane':24} {'rays':>9} {'with light':>10} {'difference':>10} {'noise':>8} {'p':>7}   level {level:.5f}")
    passed = True
    for plane in planes:
        recorder = Recorder(scene, plane, length)
        if recorder.light is None and plane["leg"] == 0:
            print(f"{plane['name']:24} no ray hits a point light")
            continue
        measured = np.load(asked.measured / plane["name"] / "batches.npz")["slices"]
        grid = plane["frequencies"]
        if measured.shape[1:] != (grid["azimuths"], grid["rho"]["half"] + 1, 2 * grid["nu"]["half"] + 1):
            parser.error(f"{plane['name']}: measured on other frequencies than exported")
        rng = np.random.default_rng([asked.seed, zlib.crc32(plane["name"].encode())])
        batch = max(1, int(asked.rays) // len(measured))
        recorded, lit = zip(*(recorder.slices(rng, batch) for _ in measured))
        difference, noise, p = judge(np.array(recorded), measured, rng)
        passed &= p >= level
        rays = batch * len(measured)
        print(f"{plane['name']:24} {rays:9} {sum(lit):10} {difference:10.2e} {noise:8.1e} {p:7.4f}", flush=True)
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
