"""Windows, slices and the test of two sets of batches, in NumPy alone: what the scripts that compare light fields share."""
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # blocks are too small for more
import numpy as np

FLIPS, BLOCK = 19_999, 1024


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


def powers(phase, count):
    """exp(−i m phase), m = 0 .. count, [count + 1, n]."""
    table = np.ones((count + 1, len(phase)), complex)
    step = np.exp(-1j * phase)
    for m in range(count):
        np.multiply(table[m], step, out=table[m + 1])
    return table


def transform(rays, weight, grid):
    """S(ρ, ν) = Σ w exp(−2πi (ρ (x cos φ + y sin φ) + ν (u cos φ + v sin φ))) at φ = πk/K, [K, ρ ≥ 0, ν]."""
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
