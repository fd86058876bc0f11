"""Prints results/grids.md: wedges of light fields that Mitsuba renders, against their depths and against fewer views.

usage: python python/validation/grids.py > results/grids.md
"""

import time
import warnings

import etendue
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
T = mi.ScalarTransform4f
VIEWS, SPACING, PIXELS, TAN = 65, 0.01, 320, 0.4
REPLICATES, SAMPLES = 4, 16
X = (np.arange(VIEWS) - (VIEWS - 1) / 2) * SPACING
# Columns go to the right, and light that comes from the right goes to the left.
U = -(np.arange(PIXELS) + 0.5 - PIXELS / 2) * 2 * TAN / PIXELS
ARGUMENTS = {
    "u": U, "window": {"x": {"Hann": 0.325}, "u": {"Hann": 0.4}}, "frequencies": {"rho": {"max": 50}, "nu": {"max": 200}}, "box": "u",
}


def texture(seed, finest):
    """A picture of random waves, of at most one cycle per `finest` of its sides."""
    random = np.random.default_rng(seed)
    side = 512
    f = np.fft.fftfreq(side, 1 / side)
    spectrum = np.fft.fft2(random.standard_normal((side, side))) * (np.hypot(f, f[:, None]) < 1 / finest)
    picture = np.fft.ifft2(spectrum).real
    picture = 0.5 + 0.15 * picture / picture.std()
    return {"type": "bitmap", "bitmap": mi.Bitmap(np.clip(picture, 0.02, 1).astype("f4")[..., None]), "raw": True}


def card(depth, seed, cells=0.005, center=0.0, size=(4.0, 4.0), turn=0.0, **material):
    """A rectangle at a depth whose finest waves have the length 2 · size · cells; it shines unless it has a material."""
    pose = T().translate([center, 0, -depth]).rotate([0, 1, 0], turn).scale([size[0], size[1], 1])
    looks = material or {"emitter": {"type": "area", "radiance": texture(seed, cells)}, "bsdf": {"type": "diffuse", "reflectance": 0.0}}
    return {"type": "rectangle", "to_world": pose, **looks}


def bars(depth, seed, pitch, width, cells=0.1):
    return [card(depth, seed + k, cells, (k - 8) * pitch, (width / 2, 4.0)) for k in range(17)]


def ball(depth, radius, seed, center=0.0):
    painted = {"type": "diffuse", "reflectance": texture(seed, 0.02)}
    return {"type": "sphere", "center": [center, 0, -depth], "radius": radius, "bsdf": painted}


LAMP = {"type": "constant", "radiance": 1.0}
SCENES = {
    "a card": ((2, 2), [card(2, 1)]),
    "two cards, side by side": ((1.5, 4), [card(1.5, 1, 0.008, -2.0, (2, 4)), card(4, 2)]),
    "a slanted card": ((1.3, 4.3), [card(2, 3, 0.006, 0, (3, 3), 45)]),
    "bars before a card": ((1.2, 3), [*bars(1.2, 10, 0.4, 0.15), card(3, 4)]),
    "fine bars before a card": ((1, 2.5), [*bars(1, 30, 0.12, 0.05), card(2.5, 5)]),
    "three layers": ((1, 5), [*bars(1, 50, 0.5, 0.1), *bars(2, 70, 0.6, 0.3), card(5, 6)]),
    "two close layers": ((1.6, 1.8), [*bars(1.6, 90, 0.3, 0.15), card(1.8, 7)]),
    "a far range": ((5, 20), [*bars(5, 110, 2.0, 0.8), card(20, 8, 0.005, 0, (16, 16))]),
    "a painted ball before a card": ((1.5, 4), [LAMP, ball(2.25, 0.75, 9), card(4, 10)]),
    "three painted balls": (
        (1.2, 6), [LAMP, ball(1.5, 0.3, 11, -0.4), ball(2.5, 0.5, 12, 0.3), ball(4.5, 1, 13, -0.9), card(6, 14, size=(6, 6))]
    ),
    "a card in a mirror": ((2.4, 3.6), [card(3, 0, turn=10, size=(1, 1), bsdf={"type": "conductor"}), card(-3, 15, turn=180)]),
}


def rendered(shapes):
    """Replicates [replicate, view, pixel] of one row of pixels."""
    scene = {"type": "scene", **{f"shape{k}": shape for k, shape in enumerate(shapes)}, "integrator": {"type": "path", "max_depth": 3}}
    loaded = mi.load_dict(scene)
    field = np.zeros((REPLICATES, VIEWS, PIXELS))
    for k, x in enumerate(X):
        sensor = mi.load_dict({
            "type": "perspective", "fov": float(2 * np.degrees(np.arctan(TAN))), "fov_axis": "x", "near_clip": 0.01,
            "to_world": T().look_at([float(x), 0, 0], [float(x), 0, -1], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": PIXELS, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "luminance"},
            "sampler": {"type": "independent", "sample_count": SAMPLES},
        })
        for replicate in range(REPLICATES):
            field[replicate, k] = np.array(mi.render(loaded, sensor=sensor, seed=replicate * VIEWS + k))[0, :, 0]
    return field


def spectrum(field, x=X):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return etendue.grid_spectrum(field, x=x, replicates=True, **ARGUMENTS)


def folded(field, fine, wedge, step):
    """The power that replicas of every `step`-th view bring into the band of the best filter, averaged over the first view, as a share."""
    middle = sum(wedge.inverse_depths) / 2
    f = fine.rho[:, None] + middle * fine.nu
    whole = abs(fine.rho[:, None] * SPACING) + 0 * f < 0.5 - 1e-9
    kept = whole & (abs(f - np.round(f * SPACING) / SPACING) < 0.5 / (step * SPACING))
    lobe = (abs(fine.rho[:, None]) < 1 / 0.325) & (abs(fine.nu) < 1 / 0.4)
    few = [spectrum(field[:, begin::step], X[begin::step]) for begin in range(step)]

    def unbiased(estimates):
        total = estimates.sum(0)
        count = len(estimates)
        return (abs(total) ** 2 - (abs(estimates) ** 2).sum(0)) / (count * (count - 1))

    errors = [unbiased(one.estimates - fine.estimates)[0][kept].sum() for one in few]
    return np.mean(errors) / unbiased(fine.estimates)[0][whole & ~lobe].sum()


def interpolated(field, wedge, step):
    """The squared error of views between every `step`-th view: linear interpolation at the best depth, as a share of the variation in the
    window. The errors of two halves of the replicates are multiplied, so that their noise adds nothing."""
    middle = sum(wedge.inverse_depths) / 2
    nu = np.fft.fftfreq(PIXELS, U[1] - U[0])
    weights = np.cos(np.pi * X / 0.65) ** 2
    columns = np.cos(np.pi * U / 0.8) ** 2
    mean = np.einsum("rxu,x,u->", field, weights, columns) / (REPLICATES * weights.sum() * columns.sum())
    spectra = np.fft.fft((field - mean) * columns)
    halves = np.array([spectra[::2].mean(0), spectra[1::2].mean(0)])
    error, power = 0.0, 0.0
    for left in range(VIEWS - step):
        for k in range(left, left + step):
            near, far = (halves[:, j] * np.exp(2j * np.pi * nu * (X[j] - X[k]) * middle) for j in (left, left + step))
            away = ((left + step - k) * near + (k - left) * far) / step - halves[:, k]
            error += weights[k] ** 2 * (away[0].conj() * away[1]).real.sum()
            power += weights[k] ** 2 * (halves[0, k].conj() * halves[1, k]).real.sum()
    return error / power


def calibration():
    """The error that is stated over the spread, and the bias in errors, for shares of a noisy epipolar image."""
    random = np.random.default_rng(1)
    x, u = (np.arange(33) - 16) * 0.05, (np.arange(128) - 63.5) / 160
    waves = [(d, k, p) for d in (1.5, 4.0) for k, p in zip(random.uniform(0.5, 6, 8), random.uniform(0, 6.3, 8))]
    truth = sum(np.cos(2 * np.pi * k * (x[:, None] - d * u) + p) for d, k, p in waves)
    arguments = {"x": x, "u": u, "window": {"x": {"Hann": 0.8}, "u": {"Hann": 0.4}}, "frequencies": {"rho": {"max": 9}, "nu": {"max": 60}}}
    exact = etendue.grid_spectrum(truth, **arguments).wedge(1.4, 1.6)
    for level in (0.5, 1.0, 2.0):
        for kind in ("noise", "replicates"):
            found = []
            for _ in range(60):
                if kind == "noise":
                    one = etendue.grid_spectrum(truth + level * random.standard_normal(truth.shape), noise=level, **arguments)
                else:
                    one = etendue.grid_spectrum(truth + 4 * level * random.standard_normal((16, *truth.shape)), replicates=True, **arguments)
                wedge = one.wedge(1.4, 1.6)
                found.append([*wedge.inside, *wedge.aliased(0.2)])
            row = []
            for j, right in ((0, exact.inside[0]), (2, exact.aliased(0.2)[0])):
                values, errors = np.array(found)[:, j], np.array(found)[:, j + 1]
                row.append(f"{right:.3f} | {values.std():.4f} | {np.sqrt(np.mean(errors**2)) / values.std():.2f} "
                           f"| {(values.mean() - right) / (values.std() / np.sqrt(len(values))):+.1f}")
            yield f"| {kind} | {level:g} | {' | '.join(row)} |"


def main():
    print("# Light fields on grids\n")
    print("`python/validation/grids.py` prints this page ([how to](../docs/grids.md)).\n")
    print("## Rendered light fields of known depths\n")
    print(f"Mitsuba {mi.__version__} renders {VIEWS} views, {SPACING} m apart, of {PIXELS} pixels, {REPLICATES} times, {SAMPLES} samples each.")
    print("""
* *inside* is the share of the power in the widened wedge, *bare* that in the wedge itself, and *replicas* that in its replicas.
* *wrong* is the share inside the wedge of depths twice as large.
* *aliased* is the share that is predicted to alias with every 8th view; *found* is what the replicas of every 8th view bring into the
  band of the best filter.
* *advised* is the spacing at which 1 % of the power aliases, beside that of Chai et al.
* *error* is the squared error of linear interpolation at the best depth, as a share of the power, for every n-th view: the advised spacing
  in whole steps. *ideal* is that of the best filter, twice the aliased share. The next two columns are for every 2n-th view.

Edges in front of other surfaces have power outside the wedge, and edges finer than the views resolve alias at the spacing of the grid.
The card in the mirror is seen beyond the depths of the scene.
""")
    print("| scene | depths [m] | inside | bare | replicas | wrong | aliased | found | advised [m] | Chai [m] | n | error | ideal | 2n | ideal |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for name, (depths, shapes) in SCENES.items():
        field = rendered(shapes)
        found = spectrum(field)
        wedge, wrong = found.wedge(*depths), found.wedge(2 * depths[0], 2 * depths[1])
        aliased = wedge.aliased(8 * SPACING)
        step = max(1, int(wedge.spacing[0] / SPACING + 1e-9))
        cells = [name, f"{depths[0]:g}–{depths[1]:g}", f"{wedge.inside[0]:.4f} ± {wedge.inside[1]:.4f}", f"{wedge.inside_bare[0]:.3f}", f"{wedge.replicas[0]:.4f}",
                 f"{wrong.inside[0]:.3f}", f"{aliased[0]:.4f} ± {aliased[1]:.4f}", f"{folded(field, found, wedge, 8):.4f}",
                 f"{wedge.spacing[0]:.3f} ± {wedge.spacing[1]:.3f}", f"{wedge.chai_spacing:.3f}", step]
        for many in (step, 2 * step):
            cells += [f"{interpolated(field, wedge, many):.4f}", f"{2 * wedge.aliased(many * SPACING)[0]:.4f}"]
        print("|", " | ".join(map(str, cells)), "|", flush=True)
    print("\n## Errors of shares\n")
    print("Each row has 60 epipolar images of two planes. The standard deviation of the noise is stated, or comes from 16 replicates.")
    print("*Ratio* is the stated error over the spread, and *bias* is in standard errors of the mean.\n")
    print("| errors from | noise | inside | spread | ratio | bias | aliased | spread | ratio | bias |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for row in calibration():
        print(row, flush=True)
    print("\n## Size\n")
    print("| samples | type | frequencies | noise | seconds, one core |")
    print("|---|---|---|---|---|")
    for views, pixels, highest, noise in ((9, 512, 40, None), (9, 512, 40, 0.1), (9, 512, 255, None), (17, 1024, 40, None)):
        x, u = (np.arange(views) - (views - 1) / 2) * 0.1, (np.arange(pixels) - (pixels - 1) / 2) / pixels
        field = np.random.default_rng(1).integers(0, 256, (views, views, pixels, pixels), dtype=np.uint8)
        begun = time.process_time()
        found = etendue.grid_spectrum(field, x=x, y=x, u=u, v=u, window={"x": {"Hann": views * 0.05}, "u": {"Hann": 0.5}},
                                      frequencies={"rho": {"max": 4.5}, "nu": {"max": highest}}, noise=noise)
        seconds = time.process_time() - begun
        print(f"| {views}² × {pixels}² | uint8 | {' × '.join(map(str, found.slices.shape))} | {noise or 'none'} | {seconds:.0f} |", flush=True)


main()
