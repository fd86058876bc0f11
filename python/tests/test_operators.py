"""Operators: maps against rays traced in space, lobes against integrals, and chains against photons."""

import numpy as np
import pytest

import etendue
from etendue import lobes
from etendue.operators import Chain, Light, Lobe, Map, Mask, Warp
from etendue.theories import theory

T, B, N = np.eye(3)
ANGLES = np.linspace(0, 1.57, 2000)
RAYS = np.random.default_rng(1).uniform(-1, 1, (4, 50))


def mirror(k, angle):
    """The steps of a mirror of curvature k, from the central ray before it to that behind it."""
    return [Map.incidence(angle), Map.curvature(k, angle), Map.mirror(), Map.back(k, -angle), Map.outgoing(-angle)]


def glass(k, angle, ratio):
    after = np.arcsin(ratio * np.sin(angle))
    return [Map.incidence(angle), Map.curvature(k, angle), Map.refraction(ratio, angle), Map.back(k, after), Map.incidence(after).inverse]


def composed(steps):
    found = steps[0]
    for step in steps[1:]:
        found = step @ found
    return found


def traced(z, k, angle, ratio):
    """A ray that leaves 1 m before a sphere of curvature k, at the plane 0.7 m behind it; a mirror has no ratio of indices."""

    def coming(theta):
        return -np.cos(theta) * T + np.sin(theta) * N, B, -np.sin(theta) * T - np.cos(theta) * N

    x, y, d = coming(angle)
    point, ray = x * z[0] + y * z[1] - d, d + x * z[2] + y * z[3]
    ray = ray / np.linalg.norm(ray)
    center = -N / k
    half, rest = ray @ (point - center), (point - center) @ (point - center) - 1 / k**2
    # The sphere is met at its side about the origin, which is the near one if it is convex.
    point = point + ray * (-half - np.sign(k) * np.sqrt(half**2 - rest))
    normal = k * (point - center)
    cos = -ray @ normal
    if ratio is None:
        ray = ray + 2 * cos * normal
        x, y, d = np.cos(angle) * T + np.sin(angle) * N, B, -np.sin(angle) * T + np.cos(angle) * N
    else:
        ray = ratio * ray + (ratio * cos - np.sqrt(1 - ratio**2 * (1 - cos**2))) * normal
        x, y, d = coming(np.arcsin(ratio * np.sin(angle)))
    ray = ray / (ray @ d)
    point = point + ray * (0.7 - point @ d)
    return np.array([point @ x, point @ y, ray @ x, ray @ y])


SURFACES = {
    "mirror": lambda k, angle, ratio: mirror(k, angle),
    "glass": glass,
}
FAULTS = {
    "none": lambda steps, k, angle: steps,
    "Eq. 9": lambda steps, k, angle: [Map(np.diag([-np.cos(angle), 1, 1, -1]), np.array([0, 0, angle, 0])), *steps[1:]],
    "Eq. 11": lambda steps, k, angle: [steps[0], Map.curvature(-k, angle), *steps[2:]],
    "text of Eq. 19": lambda steps, k, angle: [steps[0], Map.curvature(k), *steps[2:]],
    "no mirror or refraction": lambda steps, k, angle: [*steps[:2], *steps[3:]],
    "angle": lambda steps, k, angle: [*steps[:4], Map.outgoing(-0.9 * angle)],
}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("k, angle", [(0.5, 0.6), (-0.4, 0.3), (-0.5, -0.7)])
@pytest.mark.parametrize("kind, ratio", [("mirror", None), ("glass", 1 / 1.5), ("glass", 1.2)])
def test_maps_are_derivatives_of_rays_in_space(kind, ratio, k, angle, fault):
    steps = FAULTS[fault](SURFACES[kind](k, angle, ratio), k, angle)
    found = composed([Map.travel(1), *steps, Map.travel(0.7)])
    assert abs(traced(np.zeros(4), k, angle, ratio)).max() < 1e-12  # rounding
    h = 1e-5
    true = np.array([traced(h * e, k, angle, ratio) - traced(-h * e, k, angle, ratio) for e in np.eye(4)]).T / (2 * h)
    off = max(abs(found.matrix - true).max(), abs(found.offset).max())
    if fault == "none":
        assert off < 1e-8  # h² = 1e-10 times third derivatives, which are below 100
    else:
        assert off > 1e-2


def test_maps_compose_invert_and_act_on_spectra():
    a, b = composed(mirror(-0.5, 0.6)), Map.travel(0.4) @ Map.rotation(0.3) @ Map.lens(0.8)
    for found, true in [((a @ b)(*RAYS), a(*b(*RAYS))), ((a.inverse @ a)(*RAYS), RAYS), ((Map.rotation(0.1) @ Map.rotation(0.2)).matrix,
                        Map.rotation(0.3).matrix)]:
        assert np.allclose(found, true, atol=1e-13)  # rounding
    # theory.md (26), and the phase Ω·z, which a map keeps.
    assert np.allclose(a.matrix, [[-1, 0, 0, 0], [0, 1, 0, 0], [1 / np.cos(0.6), 0, -1, 0], [0, -np.cos(0.6), 0, 1]], atol=1e-15)
    omega = np.array([1.0, -2, 3, 0.5])
    assert np.allclose(omega @ RAYS, np.array(b.of_spectra(*omega)) @ np.array(b(*RAYS)), atol=1e-12)  # rounding
    assert np.allclose(b.covariance(np.cov(RAYS)), np.cov(b(*RAYS)), atol=1e-13)  # rounding
    # A thin lens images distance 2f onto 2f; an angle of slopes and back is exact.
    assert (Map.travel(1) @ Map.lens(0.5) @ Map.travel(1)).matrix[0, 2] == 0
    flat = Chain(lambda x, y, u, v: u + 10 * v, [Warp.to_angles(), Warp.to_slopes()])
    assert np.allclose(flat.radiance(*RAYS), RAYS[2] + 10 * RAYS[3], atol=1e-13)  # rounding
    # Directions turn rigidly: on a tilted plane, the slopes of a direction are those of its turned components.
    found = Chain(lambda x, y, u, v: u, [Warp.to_angles(), Map.incidence(0.4)]).radiance(0, 0, 0.1, 0.2)
    omega = np.array([np.cos(0.2) * np.sin(0.1), -np.sin(0.2), np.cos(0.2) * np.cos(0.1)])
    x, d = np.array([np.cos(0.4), 0, -np.sin(0.4)]), np.array([np.sin(0.4), 0, np.cos(0.4)])
    assert np.isclose(found, omega @ x / (omega @ d), atol=1e-14)  # rounding
    assert not a.matrix.flags.writeable


@pytest.mark.parametrize("lobe, albedo, error", [
    (Lobe.lambertian(0.7), 0.7, 2e-3),
    (Lobe.phong(200, 0.4), 0.4, 8e-3),  # the integral without the cosine is 0.4; the mean cosine of the lobe is 1 − 1/200
    (Lobe.ggx(0.05), 1, 2e-2),  # smooth microfacets shadow little, but the tail of GGX is long
    (Lobe.beckmann(0.1), 1, 5e-3),  # smooth microfacets shadow almost nothing
    (Lobe.table(ANGLES, 201 / 2 / np.pi * np.cos(ANGLES) ** 200), 1, 8e-3),  # as Phong
])  # fmt: skip
def test_lobes_reflect_what_they_say(lobe, albedo, error):
    # Reciprocity: light from everywhere, seen along the normal, is the albedo of the lobe.
    white = Chain(Light.environment(lambda u, v: 1.0), [Mask.cosine(), Map.mirror(), lobe.sampled(2**14)])
    found = white.radiance(np.arange(3.0), 0, 0, 0)
    assert abs(found - albedo).max() < error
    if lobe.name[:3] not in ("Lam", "tab"):
        assert lobe.brdf(*np.array([0.2, 0.1, 0.3, -0.2])) == pytest.approx(lobe.brdf(*np.array([-0.3, 0.2, -0.2, -0.1])), rel=1e-12)


def test_lobes_are_unbiased_within_boxes_and_blocks(monkeypatch):
    lit = Light.environment(lambda u, v: (abs(u) < 0.1) & (abs(v - 0.2) < 0.1))
    few = Lobe.phong(30).sampled(4, ((-0.3, 0.3), (-0.2, 0.5)))
    rays = (np.linspace(-1, 1, 16000), 0.3, 0.05, 0.1)
    found = Chain(lit, [few]).radiance(*rays)
    u, v = (np.add.outer([center - 0.1], 0.2 * (np.arange(200) + 0.5) / 200) for center in (0, 0.2))
    true = 0.04 * few.brdf(u.T, v, np.array(0.05), np.array(0.1)).mean()
    assert abs(found.mean() - true) < 4 * found.std() / np.sqrt(found.size) < 0.05 * true  # four standard errors
    monkeypatch.setattr(lobes, "BLOCK", 1000)
    assert np.array_equal(found, Chain(lit, [few]).radiance(*rays))
    # Two lobes: the second sees constant light.
    twice = Chain(Light.environment(lambda u, v: 1.0), [Mask.cosine(), Lobe.lambertian(0.5), Mask.cosine(), Lobe.lambertian(0.5)])
    assert abs(twice.radiance(np.arange(400.0), 0, 0, 0).mean() - 0.25) < 2e-3  # 400 · 32 nodes


def scene(lamp, surface, at, u=0.15, rho=10, blockers=()):
    return {
        "light": {"Rectangle": {"center": [0, 0, 0], "size": [lamp, lamp]}},
        "blockers": list(blockers),
        "surfaces": [surface],
        "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["s"]},
        "planes": [{"name": "p", "at": at}],
        "window": {"x": {"Hann": 0.15}, "u": {"Hann": u}},
        "frequencies": {"azimuths": 2, "rho": {"max": rho}, "nu": {"max": 10}},
    }


def smooth(event, angle=0.0, k=0.0):
    form = {"Sphere": k} if k else "Plane"
    facing = [np.sin(angle), 0, -np.cos(angle)]
    return {"Smooth": {"name": "s", "center": [0, 0, 1], "facing": facing, "form": form, "aperture": 0.9, "event": event}}


def floor(albedo=0.0):
    return {"Rectangle": {"name": "s", "center": [0, 0, 1], "size": [4, 4], "albedo": albedo}}


def glossy(lobe):
    lobe = lobe.sampled(16)
    surface = [Map.incidence(0.7), Map.curvature(0.3, 0.7), Mask.cosine(), Map.mirror(), lobe, Map.back(0.3, -0.7), Map.outgoing(-0.7)]
    return Chain(Light.rectangle(0.2), [Map.travel(1), Warp.to_angles(), *surface, Warp.to_slopes(), Map.travel(0.2)])


SLIT = {"Aperture": {"name": "slit", "center": [0, 0, 0.5], "hole": {"Rectangle": {"center": [0.02, 0], "size": [0.1, 0.3]}}}}
BARS = {"Bars": {"name": "bars", "center": [0.01, 0, 0.5], "axis": "X", "count": 3, "pitch": 0.06, "fill": 0.5}}
GRATING = {"Grating": {"name": "grating", "center": [0, 0, 0.5], "axis": "Y", "frequency": 8, "modulation": 0.8, "phase": 0.5}}
DIFFUSE = Lobe.lambertian(0.5).sampled(16, ((-0.7, 0.7), (-0.7, 0.7)))
PHONG = {"Reflects": {"brdf": {"lobe": {"Phong": 200}}}}
GGX = {"Reflects": {"brdf": {"lobe": {"Ggx": 0.1}}}}
BECKMANN = {"Reflects": {"brdf": {"lobe": {"Beckmann": 0.1}}}}


SHIFTED_BARS = [Map.travel(0.5), Mask.pattern(lambda x, y: Mask.bars(3, 0.06, 0.5).factor(x - 0.01, y, x, y)), Map.travel(0.5)]


def masked(mask):
    return Chain(Light.rectangle(0.3), [Map.travel(0.5), mask, Map.travel(0.5)])


# A scene, its chain, and faults: an index of the chain, and what replaces the operator there.
CHAINS = {
    "slit": (scene(0.3, floor(), {"Before": "s"}, 0.3, blockers=[SLIT]), masked(Mask.rectangle((0.1, 0.3), (0.02, 0))),
             [(0, Map.travel(-0.5)), (1, Mask.rectangle((0.1, 0.3))), (1,)]),
    "bars": (scene(0.3, floor(), {"Before": "s"}, 0.3, rho=20, blockers=[BARS]),
             Chain(Light.rectangle(0.3), [*SHIFTED_BARS]),
             [(1, Mask.bars(3, 0.06, 0.5)), (2, Map.travel(0.6))]),
    "grating": (scene(0.3, floor(), {"Before": "s"}, 0.3, rho=20, blockers=[GRATING]), masked(Mask.grating(8, 0.8, 0.5, "y")),
                [(1, Mask.grating(8, 0.8, 0.5)), (1, Mask.grating(8, 0.8, -0.5, "y"))]),
    "concave mirror": (scene(0.1, smooth("Mirror", 0.3, -0.5), {"Distance": 1.7}),
                       Chain(Light.rectangle(0.1), [Map.travel(1), *mirror(-0.5, 0.3), Map.travel(0.7)]),
                       [(2, Map.curvature(0.5, 0.3)), (5, Map.outgoing(-0.2))]),
    "lens": (scene(0.1, smooth({"ThinLens": 0.5}), {"Distance": 1.5}),
             Chain(Light.rectangle(0.1), [Map.travel(1), Map.lens(0.5), Map.travel(0.5)]), [(1, Map.lens(-0.5)), (1, Map.lens(0.45))]),
    "glass": (scene(0.1, smooth({"Refraction": {"front": 1, "back": 1.5}}, 0.3, 0.5), {"Distance": 1.5}),
              Chain(Light.rectangle(0.1), [Map.travel(1), *glass(0.5, 0.3, 1 / 1.5), Map.travel(0.5), Mask.constant(2.25)]),
              [(7,), (3, Map.refraction(1 / 1.4, 0.3))]),
    "diffuse": (scene(1, floor(0.5), {"After": "s"}, 0.3, 6),
                Chain(Light.rectangle(1), [Map.travel(1), Mask.cosine("slopes"), Map.incidence(0), Map.mirror(), DIFFUSE, Map.outgoing(0)]),
                [(1,)]),
    "Phong": (scene(0.2, smooth(PHONG, 0.7, 0.3), {"Distance": 1.2}, 0.2), glossy(Lobe.phong(200)),
              [(4,), (6, Lobe.phong(120).sampled(16))]),
    "GGX": (scene(0.2, smooth(GGX, 0.7, 0.3), {"Distance": 1.2}, 0.2), glossy(Lobe.ggx(0.1)),
            [(6, Lobe.beckmann(0.1).sampled(16))]),
    "Beckmann": (scene(0.2, smooth(BECKMANN, 0.7, 0.3), {"Distance": 1.2}, 0.2), glossy(Lobe.beckmann(0.1)),
                 [(6, Lobe.ggx(0.1).sampled(16))]),
}  # fmt: skip


@pytest.mark.parametrize("name", CHAINS)
def test_chains_agree_with_photons_and_faults_do_not(name):
    of, right, faults = CHAINS[name]
    measured = etendue.measure(of, photons=2**18, threads=1)
    for chain, verdict in [(right, "pass"), *((right.replace(*fault), "fail") for fault in faults)]:
        # `compare` would double the points until the theory has little noise, which takes longer and is not needed here.
        # The longer chains have a lobe, and less noise at each point.
        points = 2**11 if len(chain) > 8 else 2**13
        prediction = theory(measured.scene, {"p": chain.radiance}, points=points)
        assert etendue.compare(measured, prediction, threads=1).verdict == verdict, str(chain)


@pytest.mark.parametrize("name", ["slit", "bars", "grating", "concave mirror", "lens", "glass"])
def test_chains_of_scenes_agree_with_photons(name):
    scene = etendue.Scene(CHAINS[name][0], photons=2**16)
    chain, measured = Chain.of_plane(scene, "p"), etendue.measure(scene, threads=1)
    for tried, verdict in [(chain, "pass"), (chain.replace(0, Map.travel(0.4)), "fail"), (chain.replace(0), "fail")]:
        assert etendue.compare(measured, theory(scene, {"p": tried.radiance}), threads=1).verdict == verdict, str(tried)


def test_chains_of_scenes_that_are_none_are_refused():
    for name, message in [("diffuse", "convolve  with the diffuse"), ("Phong", "no chain of maps")]:
        with pytest.raises(ValueError, match=message):
            Chain.of_plane(etendue.Scene(CHAINS[name][0]), "p")
    scene = etendue.Scene(CHAINS["slit"][0])
    with pytest.raises(KeyError, match="no plane 'q'; there are p"):
        Chain.of_plane(scene, "q")
    point = scene.file | {"light": {"Point": {"center": [0, 0, 0]}}}
    with pytest.raises(ValueError, match="the light is a Point"):
        Chain.of_plane(etendue.Scene(point), "p")
    spot = scene.file | {"light": {"Spot": {"center": [0, 0, 0], "bulb": {"Disc": 0.1}, "exponent": 20}}}
    chain = Chain.of_plane(etendue.Scene(spot), "p")[:0]
    assert chain.radiance([0.0, 0.0, 0.2], 0, [0.0, 0.5, 0.0], 0) == pytest.approx([1, 1.25**-10, 0])


def test_a_function_is_a_light_and_may_change_its_arguments():
    def light(x, y, u, v):
        x -= u
        return x

    chain = Chain(light, [Map.travel(1), Mask.pattern(lambda x, y: x), Lobe.lambertian(np.pi).sampled(2)])
    again = chain.radiance(*RAYS)
    assert np.array_equal(again, chain.radiance(*RAYS)) and chain.radiance(0, 0, 0, 0).shape == ()
    assert chain.radiance(np.zeros((3, 1)), np.zeros(2), 0, 0).shape == (3, 2) and chain.radiance([], [], [], []).shape == (0,)


def test_chains_print_and_change():
    chain = Chain(Light.rectangle((0.2, 0.1)), [Map.travel(1), Mask.bars(5, 0.1, 0.5), Map.travel(0.5)])
    lines = str(chain).splitlines()
    assert lines[0] == "source    rectangle 0.2 x 0.1 m, radiance 1" and len(lines) == 4
    assert lines[1].startswith("map       travel 1 m ") and lines[1].endswith("(Eq. 3)")
    assert chain[1].name.startswith("5 bars") and np.array_equal(chain(0.1, 0, 0, 0), chain.radiance(0.1, 0, 0, 0))
    with pytest.raises(IndexError, match="the chain has 3 operators"):
        chain.replace(9)
    assert len(chain[:2]) == 2 and len(chain.then(Map.mirror())) == 4
    assert [operator.name for operator in chain.replace(-1).operators] == [operator.name for operator in chain.operators[:2]]
    assert "travel 1 m @ lens, f = 2 m" in repr(Map.travel(1) @ Map.lens(2))


@pytest.mark.parametrize("wrong, message", [
    (lambda: Map(np.eye(3)), "matrix of affine map is float64 of shape"),
    (lambda: Map(np.zeros((4, 4))), "has no inverse"),
    (lambda: Map(1j * np.eye(4)), "complex128"),
    (lambda: Map(np.eye(4), np.full(4, np.nan)), "offset of affine map"),
    (lambda: Map.travel(np.inf), "distance is inf"),
    (lambda: Map.travel("1"), "distance is '1'"),
    (lambda: Map.travel([1, 2]), "distance is int64 of shape"),
    (lambda: Map.lens(0), "focal_length is 0"),
    (lambda: Map.incidence(1.6), "angle is 1.6 rad"),
    (lambda: Map.curvature([1, 2, 3]), "curvature is int64 of shape"),
    (lambda: Map.refraction(1.5, 1), "total reflection"),
    (lambda: Map.mirror().covariance(np.eye(3)), "the covariance is float64 of shape"),
    (lambda: Map.mirror()(1, 2, 3, 4j), "v is complex128"),
    (lambda: Mask.bars(0, 1, 1), "count is 0"),
    (lambda: Mask.grating(5, axis="z"), "axis is 'z'"),
    (lambda: Mask.rectangle((1, 2, 3)), "size is int64 of shape"),
    (lambda: Mask.cosine("degrees"), "of is 'degrees'"),
    (lambda: Light.gaussian(0, 1), "position is 0"),
    (lambda: Lobe.phong(-1), "exponent is -1"),
    (lambda: Lobe.ggx(np.nan), "roughness is nan"),
    (lambda: Lobe.table([1, 0], [1, 1]), "ascending"),
    (lambda: Lobe.table([0, 1], [1]), "values is"),
    (lambda: Lobe.lambertian(1).sampled(0), "nodes is 0"),
    (lambda: Lobe.lambertian(1).sampled(8, ((1, 0), (0, 1))), "from a lower"),
    (lambda: Chain(Light.rectangle(1), [Map.travel]), "a list of maps"),
    (lambda: Chain(Light.rectangle(1), Map.mirror()), "a list of maps"),
    (lambda: Map.mirror() @ Mask.constant(1), "not with Mask"),
    (lambda: Mask.bars(3, 1, 1.5), "fill is 1.5"),
    (lambda: Lobe.ggx(2), "roughness is 2"),
    (lambda: Chain(Light.rectangle(1)).radiance("x", 0, 0, 0), "x is"),
])  # fmt: skip
def test_wrong_numbers_are_refused(wrong, message):
    with pytest.raises((TypeError, ValueError), match=message):
        wrong()
