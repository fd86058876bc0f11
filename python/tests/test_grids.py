"""Spectra of light fields on grids against closed forms, photons and Mitsuba; the wedge of depths against subsampled views."""

import itertools
import warnings
from pathlib import Path

import etendue
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]

HALF = {"x": 0.8, "y": 0.7, "u": 0.4, "v": 0.45}
WINDOW = {name: {"Hann": half} for name, half in HALF.items()}


def centred(count, spacing):
    return (np.arange(count) - (count - 1) / 2) * spacing


X, U = centred(32, 0.05), centred(128, 1 / 160)
FLAT = {"rho": {"max": 9}, "nu": {"max": 60}}


def kernel(half, frequency):
    """The transform of a Hann window."""
    t = 2 * half * frequency
    safe = np.where(abs(abs(t) - 1) < 1e-9, 0.0, t)
    return half * np.where(safe == t, np.sinc(t) / (1 - safe**2), 0.5)


def cosines(depth, cycles, seed):
    """A texture at a depth as waves: amplitude, frequency in x and in u, for cycles and their negatives."""
    random = np.random.default_rng(seed)
    waves = [(random.uniform(0.2, 1) * np.exp(2j * np.pi * random.random()), k) for k in cycles]
    return [(a, k, -depth * k) for a, k in waves] + [(a.conjugate(), -k, depth * k) for a, k in waves]


def product(first, second):
    return [(a * b, p + r, q + s) for (a, p, q), (b, r, s) in itertools.product(first, second)]


NEAR, FAR = cosines(1.5, (2.1, 4.3, 6.2), 1), cosines(4.0, (1.7, 3.9, 6.6), 2)
MASK = [(0.5, 0, 0), (0.25, 0.9, -1.5 * 0.9), (0.25, -0.9, 1.5 * 0.9)]
SCENES = {
    "one plane": NEAR,
    "two planes": NEAR + FAR,
    # A cosine grating of the near plane in front of the far plane.
    "occluder": product(MASK, NEAR) + product([(a if p == 0 else -a, p, q) for a, p, q in MASK], FAR),
}


def rendered(waves, x=X, u=U, pixel=0.0):
    """Point samples, or means over pixels of the given width."""
    return sum((a * np.sinc(q * pixel) * np.exp(2j * np.pi * (p * x[:, None] + q * u))).real for a, p, q in waves)


def closed(waves, rho, nu, pixel=0.0):
    parts = (a * np.sinc(q * pixel) * np.outer(kernel(HALF["x"], rho - p), kernel(HALF["u"], nu - q)) for a, p, q in waves)
    return sum(parts)


def measured(field, x=X, u=U, **options):
    return etendue.grid_spectrum(field, x=x, u=u, window=WINDOW, frequencies=FLAT, **options)


def distance(found, truth):
    return np.linalg.norm(found - truth) / np.linalg.norm(truth)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("pixel", [0.0, 1 / 160])
def test_spectra_have_their_closed_forms(scene, pixel):
    waves = SCENES[scene]
    found = measured(rendered(waves, pixel=pixel))
    assert found.slices.shape == (1, 31, 97) and found.spacing == pytest.approx({"x": 0.05, "u": 1 / 160})
    truth = closed(waves, found.rho, found.nu, pixel)
    # Replicas of the sidelobes of the window, which fall with the third power of frequency: 5 to 10 frequencies away at 20/m.
    assert distance(found.slices[0], truth) < 1e-3
    assert distance(found.slices[0], truth.conj()) > 0.5


def test_the_low_pass_of_pixels_can_be_divided_out():
    # Content at 26 cycles per slope loses 17 %.
    u = centred(64, 1 / 80)
    field = rendered(SCENES["two planes"], u=u, pixel=1 / 80)
    arguments = {"x": X, "u": u, "window": WINDOW, "frequencies": {"rho": {"max": 9}, "nu": {"max": 38}}}
    with_box = etendue.grid_spectrum(field, **arguments, box="u")
    truth = closed(SCENES["two planes"], with_box.rho, with_box.nu)
    # The window spreads a wave over ± 2.5 cycles, along which the low-pass changes by 1 %.
    assert distance(with_box.slices[0], truth) < 0.02
    assert distance(etendue.grid_spectrum(field, **arguments).slices[0], truth) > 0.03


def test_four_dimensions():
    x, y, u, v = centred(17, 0.1), centred(13, 0.11), centred(24, 1 / 29), centred(28, 1 / 31)
    kx, ky, depth = 1.3, 2.1, 3.0
    axes = np.meshgrid(x, y, u, v, indexing="ij")
    phase = kx * (axes[0] - depth * axes[2]) + ky * (axes[1] - depth * axes[3])
    found = etendue.grid_spectrum(
        np.cos(2 * np.pi * phase).astype(np.float32), x=x, y=y, u=u, v=v,
        window=WINDOW, frequencies={"rho": {"max": 3}, "nu": {"max": 12}, "azimuths": 6},
    )
    rho, nu = found.rho[:, None], found.nu
    for azimuth, one in zip(found.azimuth, found.slices):
        c, s = np.cos(azimuth), np.sin(azimuth)
        truth = sum(
            0.5 * kernel(HALF["x"], rho * c - k * kx) * kernel(HALF["y"], rho * s - k * ky)
            * kernel(HALF["u"], nu * c + k * depth * kx) * kernel(HALF["v"], nu * s + k * depth * ky)
            for k in (1, -1)
        )
        # Replicas of sidelobes, as above, with half as many views.
        assert abs(one - truth).max() < 1e-3 * 0.5 * np.prod([*HALF.values()])
    # The estimator of rays, which is exact to 1e-7 of the sum of weights.
    weight = np.cos(2 * np.pi * phase).ravel() * np.prod([*found.spacing.values()])
    rays = etendue.spectrum(*(axis.ravel() for axis in axes), weight, window=WINDOW,
                            frequencies={"rho": {"max": 3}, "nu": {"max": 12}, "azimuths": 6})
    assert np.array_equal(rays.rho, found.rho) and abs(rays.slices - found.slices).max() < 1e-6 * np.prod([*HALF.values()])


def share(field, depths=(1.4, 4.2), x=X, u=U, **options):
    return measured(field, x, u).wedge(*depths, **options).inside[0]


@pytest.mark.parametrize("scene", ["one plane", "two planes"])
def test_the_wedge_holds_its_power(scene):
    field = rendered(SCENES[scene])
    # Beyond the main lobe, a Hann window has 0.05 % of its power along each axis.
    assert share(field) > 0.998
    wedge = measured(field).wedge(1.4, 4.2)
    assert wedge.inside_bare[0] < wedge.inside[0] and wedge.replicas[0] < 2e-3


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("depths too near", {"depths": (0.4, 0.6)}),
        ("depths too far", {"depths": (4, np.inf)}),
        ("sign of depth", {"u": -U}),
        ("spacing of views", {"x": 2 * X}),
        ("spacing of pixels", {"u": 2 * U}),
        ("focus", {"focus": 2.0}),
    ],
)
def test_the_wedge_sees_faults(name, fault):
    field, depths = rendered(NEAR), (1.4, 1.6)
    assert share(field, depths) > 0.998
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        assert share(field, **{"depths": depths, **fault}) < 0.9


def test_cameras_that_converge():
    focus = 2.0
    # A pixel sees the point at depth `focus` that is opposite the middle of the array.
    waves = [(a, p + q / focus, q) for a, p, q in SCENES["two planes"]]
    assert share(rendered(waves), focus=focus) > 0.998
    assert share(rendered(waves), focus=-focus) < 0.9 and share(rendered(waves)) < 0.9


def noisy(level, random):
    return rendered(SCENES["two planes"]) + level * random.standard_normal((X.size, U.size))


def test_errors_are_those_of_noise():
    random = np.random.default_rng(5)
    # Noise of one level, and of a level that differs between samples.
    truth = measured(rendered(SCENES["two planes"]))
    assert not truth.slices_sigma.any() and truth.wedge(1.4, 4.2).inside[1] == 0 and truth.sample.noise_dof is None
    for level in (0.5, 0.2 + 0.6 * random.random((X.size, U.size))):
        found = [measured(noisy(level, random), noise=level) for _ in range(40)]
        z = np.array([abs(one.slices - truth.slices) / one.slices_sigma for one in found])
        # 40 draws of about 400 independent numbers: 1.1 % is one standard deviation.
        assert abs(np.mean(z**2) - 1) < 0.04
        z = np.array([(one.power - truth.power) / one.power_sigma for one in found])
        # Errors are up to √3 too large where noise is above the signal.
        assert 0.55 < z.std() < 1.05
        for name in ("inside", "aliased"):
            wedges = [one.wedge(1.4, 1.6) for one in found]
            pairs = np.array([wedge.inside if name == "inside" else wedge.aliased(0.2) for wedge in wedges])
            # 40 values give the spread to 11 %, and errors may be √3 too large.
            assert 0.7 < np.sqrt(np.mean(pairs[:, 1] ** 2)) / pairs[:, 0].std() < 1.9, name


def test_errors_are_those_of_replicates():
    random = np.random.default_rng(6)
    truth = measured(rendered(SCENES["two planes"]))
    found = [measured([noisy(2.0, random) for _ in range(16)], replicates=True) for _ in range(30)]
    z = np.array([abs(one.slices - truth.slices) / one.slices_sigma for one in found])
    # The mean of t² with 15 degrees of freedom is 15/13; complex numbers have 30, and 30/28.
    assert abs(np.mean(z**2) - 1.09) < 0.06
    single = measured(rendered(SCENES["two planes"]), noise=0.5)
    # 30 estimates from 16 replicates, of a number that noise of the same level on the mean determines.
    dof = np.mean([one.sample.noise_dof for one in found])
    assert abs(dof / single.sample.noise_dof - 1) < 0.25
    p = [etendue.difference(found[k], found[k + 1]).p_value for k in range(0, 30, 2)]
    assert min(p) > 0.002 and np.mean(p) > 0.25
    assert etendue.difference(found[0], measured(rendered(NEAR), noise=0.5)).p_value < 1e-6
    shares = np.array([one.wedge(1.4, 1.6).inside for one in found])
    # 30 values give the spread to 13 %, and errors may be √2 too large.
    assert 0.65 < np.sqrt(np.mean(shares[:, 1] ** 2)) / shares[:, 0].std() < 1.9


def texture(random, depth, x, u, highest):
    k = random.uniform(0.3, highest, 40)
    return rendered([(0.5 * a, p, -depth * p) for a, p in zip(np.exp(2j * np.pi * random.random(40)), k)], x, u)


@pytest.mark.parametrize("views", [2, 3, 4])
def test_aliased_power_is_that_of_fewer_views(views):
    random = np.random.default_rng(views)
    x, u = centred(96, 0.02), centred(192, 1 / 200)
    field = sum(texture(random, depth, x, u, 9.0) for depth in (0.8, 1.2, 2.7))
    arguments = {"u": u, "window": {"x": {"Hann": 0.96}, "u": {"Hann": 0.48}}, "frequencies": {"rho": {"max": 25}, "nu": {"max": 40}}}
    fine = etendue.grid_spectrum(field, x=x, **arguments)
    wedge = fine.wedge(0.8, 2.7)
    aliased = wedge.aliased(views * 0.02)[0]
    middle = sum(wedge.inverse_depths) / 2
    f = fine.rho[:, None] + middle * fine.nu
    kept = abs(f - np.round(f * 0.02) / 0.02) < 0.5 / (views * 0.02)
    # Both ends of the period are one frequency.
    kept[0] = False
    counted = (abs(fine.rho[:, None]) >= 1 / 0.96) | (abs(fine.nu) >= 1 / 0.48)
    counted[0] = False
    errors = []
    for begin in range(views):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            few = etendue.grid_spectrum(field[begin::views], x=x[begin::views], **arguments)
        errors.append((abs(few.slices[0] - fine.slices[0])[kept] ** 2).sum() / (abs(fine.slices[0])[counted] ** 2).sum())
    # Averaged over where the first view is, replicas add in power; the few sidelobes beyond ± 40 are left out.
    assert abs(np.mean(errors) - aliased) < 1e-3 * aliased + 1e-6
    if views == 4:
        assert aliased > 0.05


def test_advice_on_views():
    random = np.random.default_rng(3)
    x, u = centred(96, 0.02), centred(192, 1 / 200)
    field = sum(texture(random, depth, x, u, 9.0) for depth in (0.8, 1.2, 2.7))
    found = etendue.grid_spectrum(
        field, x=x, u=u, window={"x": {"Hann": 0.96}, "u": {"Hann": 0.48}}, frequencies={"rho": {"max": 25}, "nu": {"max": 40}}
    )
    for limit in (0.01, 0.1):
        wedge = found.wedge(0.8, 2.7, limit=limit)
        spacing = wedge.spacing[0]
        assert wedge.aliased(spacing)[0] <= limit < wedge.aliased(1.1 * spacing)[0] and wedge.spacing[1] == 0
        assert wedge.chai_spacing == pytest.approx(1 / (wedge.cutoff[0] * (1 / 0.8 - 1 / 2.7)))
        assert "of the power; views at most" in repr(wedge)
    assert wedge.aliased(0.02)[0] == 0
    # Textures have up to 9 cycles/m, so slopes up to 22; the window adds 2.
    assert 15 < found.wedge(0.8, 2.7).cutoff[0] < 24.5
    assert found.wedge(1.2, 1.2).chai_spacing == np.inf


SCENE = {
    "light": {"Rectangle": {"center": [0, 0, 0], "size": [0.2, 0.2]}},
    "surfaces": [{"Rectangle": {"name": "floor", "center": [0, 0, 2], "size": [4, 4]}}],
    "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["floor"]},
    "planes": [{"name": "middle", "at": {"Distance": 1}}],
    "window": {"x": {"Hann": 0.4}, "u": {"Hann": 0.4}},
    "frequencies": {"azimuths": 4, "rho": {"max": 5}, "nu": {"max": 5}},
    "run": {"photons": 2**18},
}


def test_photons_on_a_grid():
    result = etendue.run(SCENE, threads=1)
    slices = result["middle"].slices
    light = etendue.photons(SCENE, "middle", seed=2)
    count, edges = 24, np.linspace(-0.4, 0.4, 25)
    grid = 0.5 * (edges[1:] + edges[:-1])
    batches = 16
    # The batches of photons are independent; four of them make a replicate.
    replicates = []
    for part in range(batches):
        own = light.rays[light.batch % batches == part]
        replicates.append(np.histogramdd(own[:, :4], [edges] * 4, weights=own[:, 4])[0])
    replicates = np.array(replicates, dtype=np.float32) * (batches / light.emitted / (0.8 / count) ** 4)
    arguments = {"window": SCENE["window"], "frequencies": SCENE["frequencies"], "replicates": True, "box": "xyuv"}
    found = etendue.grid_spectrum(replicates, x=grid, y=grid, u=grid, v=grid, **arguments)
    assert np.array_equal(found.rho, slices.rho) and np.array_equal(found.azimuth, slices.azimuth)
    # Cells of 1/24 of the window move each photon by 0.3 of 1/24: the window is off by (π/24)²/12 of its curvature along each axis.
    bias = 4 * (np.pi / 24) ** 2 / 12
    assert distance(found.slices, slices.measured) < bias + 3 * result["middle"].report["noise_limit"]
    # A factor of 1.05 or one batch missing is seen.
    assert distance(1.05 * found.slices, slices.measured) > bias + 3 * result["middle"].report["noise_limit"]


def test_the_light_field_of_a_result():
    result = etendue.run(SCENE, threads=1)
    field, slices = result["middle"].light_field, result["middle"].slices
    # It has the window already.
    box = {"x": {"Box": 0.4}, "u": {"Box": 0.4}}
    found = etendue.grid_spectrum(
        field.predicted, x=field.x, u=field.u, window=box,
        frequencies={name: {"max": 5, "spacing": 1.25} for name in ("rho", "nu")}, box="xu",
    )
    assert np.allclose(found.rho, slices.rho)
    assert distance(found.slices[0], slices.predicted[0]) < 0.01


def test_plot(tmp_path):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    found = measured(rendered(NEAR))
    ax = found.plot(pyplot.figure().gca(), found.wedge(1.4, 1.6))
    solid = [line for line in ax.lines if line.get_linestyle() == "-"]
    assert sorted(line.get_xdata()[0] for line in solid) == pytest.approx([60 / 1.6, 60 / 1.4])
    # Replicas are at multiples of 20 cycles/m.
    dashed = np.array([line.get_xdata()[0] for line in ax.lines if line.get_linestyle() == "--"])
    away = (dashed - np.array([60 / 1.6, 60 / 1.4])[:, None]) / 20
    assert dashed.size > 8 and (abs(away - np.round(away)).min(0) < 1e-9).all()
    assert ax.get_xlim()[1] < 10


def test_mitsuba_renders_the_same_wedge():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    transform, x, tan, pixels = mi.ScalarTransform4f, centred(17, 0.06), 0.4, 64
    random = np.random.default_rng(4)
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": 2}}
    for name, depth, left in (("near", 1.5, -3.0), ("far", 4.0, 0.0)):
        # Random columns, 0.15 · depth wide.
        columns = np.tile(random.random((1, int(12 / (0.15 * depth)), 1)).astype("f4"), (2, 1, 1))
        picture = {"type": "bitmap", "bitmap": mi.Bitmap(columns), "raw": True, "filter_type": "nearest"}
        pose = transform().translate([left if name == "near" else 0, 0, -depth]).scale([3 if name == "near" else 6, 3, 1])
        scene[name] = {
            "type": "rectangle", "to_world": pose, "emitter": {"type": "area", "radiance": picture},
            "bsdf": {"type": "diffuse", "reflectance": 0.0},
        }
    loaded = mi.load_dict(scene)
    field = np.zeros((4, x.size, pixels))
    for k, replicate in itertools.product(range(x.size), range(4)):
        sensor = mi.load_dict({
            "type": "perspective", "fov": float(2 * np.degrees(np.arctan(tan))), "fov_axis": "x", "near_clip": 0.01,
            "to_world": transform().look_at([float(x[k]), 0, 0], [float(x[k]), 0, -1], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": pixels, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "luminance"},
            "sampler": {"type": "independent", "sample_count": 8},
        })
        field[replicate, k] = np.array(mi.render(loaded, sensor=sensor, seed=100 * k + replicate))[0, :, 0]
    u = -centred(pixels, 2 * tan / pixels)
    arguments = {"x": x, "window": {"x": {"Hann": 0.5}, "u": {"Hann": 0.4}}, "frequencies": {"rho": {"max": 8}, "nu": {"max": 38}}}
    shares = [
        etendue.grid_spectrum(field, u=slopes, replicates=True, box="u", **arguments).wedge(*depths).inside
        for slopes, depths in ((u, (1.5, 4)), (-u, (1.5, 4)), (u, (0.3, 0.4)))
    ]
    # The edge of the near plane and replicas of the columns, which are sharper than the views resolve, put some percent outside.
    assert shares[0][0] > 0.9 and max(share for share, _ in shares[1:]) < shares[0][0] - 0.2, shares
    assert shares[0][1] < 0.01


GOOD = {"x": X, "u": U, "window": WINDOW, "frequencies": FLAT}
FIELD = rendered(NEAR)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"light_field": FIELD + 0j}, "light_field is complex128 of shape .*allowed: real numbers"),
        ({"light_field": FIELD.astype(object)}, "light_field is object"),
        ({"light_field": FIELD.T}, r"shape \(128, 32\), with {'x': 32, 'u': 128}; allowed"),
        ({"light_field": np.zeros((0, 128)), "x": []}, "x is float64 of shape \\(0,\\); allowed: two or more"),
        ({"light_field": np.where(X[:, None] > 0, np.nan, FIELD)}, "not finite"),
        ({"light_field": 1e200 * FIELD}, "finite numbers below 1e100"),
        ({"y": X}, "allowed: real numbers"),
        ({"x": X**3}, "x has steps from .*allowed: equal steps"),
        ({"x": X + 2}, "no sample of x, 1.225 to 2.775, is inside the window"),
        ({"x": np.zeros(32)}, "x has steps from 0 to 0; allowed"),
        ({"u": np.where(U > 0, U, np.nan)}, "u is float64 .*finite"),
        ({"noise": -1}, "noise is int64 of shape \\(\\); allowed: a number ≥ 0"),
        ({"noise": np.ones(3)}, "noise is float64 of shape \\(3,\\)"),
        ({"noise": np.nan}, "noise is float64"),
        ({"replicates": True}, "allowed: real numbers"),
        ({"light_field": [FIELD] * 3, "replicates": True}, "3 replicates, noise is None; allowed: 4 or more"),
        ({"light_field": [FIELD] * 4, "replicates": True, "noise": 1}, "noise is 1; allowed: 4 or more replicates, without noise"),
        ({"box": "v"}, "box is 'v'; allowed: letters of xu"),
        ({"box": "x", "frequencies": {"rho": {"max": 12}, "nu": {"max": 60}}}, "above half the sampling rate, 10; allowed with box"),
        ({"frequencies": {**FLAT, "azimuths": 2}}, r"azimuths is 2 for \[x, u\]; allowed: 1"),
        ({"window": {"x": {"Hann": -1}, "u": {"Hann": 0.4}}}, "window.x"),
    ],
)
def test_arguments_that_cannot_be(change, message):
    arguments = {"light_field": FIELD, **GOOD, **change}
    with pytest.raises(ValueError, match=message):
        etendue.grid_spectrum(arguments.pop("light_field"), **arguments)


@pytest.mark.parametrize("arguments", [(0, 1), (2, 1), (np.inf, np.inf), (np.nan, 1), (-1, 1)])
def test_depths_that_cannot_be(arguments):
    with pytest.raises(ValueError, match="allowed: 0 < d_min ≤ d_max"):
        measured(FIELD).wedge(*arguments)


def test_faults_of_wedges_and_warnings():
    found = measured(FIELD)
    for options in ({"focus": 0}, {"limit": 1}, {"limit": np.nan}, {"focus": np.nan}):
        with pytest.raises(ValueError, match="allowed: a focus other than 0"):
            found.wedge(1, 2, **options)
    with pytest.raises(ValueError, match="spacing is 0; allowed"):
        found.wedge(1, 2).aliased(0)
    with pytest.raises(ValueError, match="no power"):
        measured(0 * FIELD).wedge(1, 2)
    with pytest.warns(UserWarning, match="along x reach 12.5, above half the sampling rate, 10"):
        etendue.grid_spectrum(FIELD, x=X, u=U, window=WINDOW, frequencies={"rho": {"max": 12.5}, "nu": {"max": 60}})
    with pytest.warns(UserWarning, match="u is from .* counts as 0 where there is no sample"):
        etendue.grid_spectrum(FIELD[:, :64], x=X, u=U[:64], window=WINDOW, frequencies=FLAT)
    # Types of numbers, and memory that is not contiguous.
    for field in (np.asfortranarray(FIELD), np.repeat(FIELD, 2, axis=1)[:, ::2], FIELD.astype("f4"), FIELD.astype(">f8")):
        assert np.allclose(measured(field).slices, found.slices, atol=1e-6)
    assert np.allclose(measured(FIELD > 0).slices, measured((FIELD > 0).astype(np.uint8)).slices)
