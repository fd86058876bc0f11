"""Light fields by Mitsuba's integrators, against Étendue's photons. Needs Mitsuba 3 and LLVM; without them, these tests are skipped."""

import re
from pathlib import Path

import etendue
import etendue.mitsuba
import numpy as np
import pytest

mi = pytest.importorskip("mitsuba")
try:
    mi.set_variant("llvm_ad_mono")
    mi.Float(1.0) + mi.Float(2.0)
except Exception as error:
    pytest.skip(f"Mitsuba cannot compile: {error}", allow_module_level=True)

# One in a thousand: seeds are fixed, so each test passes or fails for good.
LEVEL = 1e-3
EDGES = (-0.02, 0.08)
# Slopes up to 0.9, at which faults in angles show.
WINDOW = {"x": {"Hann": 0.5}, "u": {"Hann": 0.9}}
FREQUENCIES = {"azimuths": 4, "rho": {"max": 12}, "nu": {"max": 12}}
PLANE = etendue.mitsuba.Placement((0, 0, 2), (0, 0, 1), (1, 0, 0), WINDOW, FREQUENCIES)


@pytest.fixture(scope="module", autouse=True)
def variant():
    # Tests of other modules leave another one.
    mi.set_variant("llvm_ad_mono")


@pytest.fixture(scope="module")
def photons():
    low, high = EDGES
    slit = [
        {"HalfPlane": {"axis": "X", "edge": low, "opaque": "Below"}},
        {"HalfPlane": {"axis": "X", "edge": high, "opaque": "Above"}},
    ]
    scene = {
        "light": {"Rectangle": {"center": [0, 0, 0], "size": [2, 2]}},
        "blockers": [{"Shapes": {"name": "slit", "center": [0, 0, 1], "shapes": slit}}],
        "surfaces": [{"Rectangle": {"name": "floor", "center": [0, 0, 2], "size": [6, 6]}}],
        "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["floor"]},
        "planes": [{"name": "floor", "at": {"Before": "floor"}}],
        "window": WINDOW,
        "frequencies": FREQUENCIES,
    }
    return etendue.run(scene, photons=2**20)["floor"]


@pytest.fixture(scope="module")
def scene():
    """The same scene for Mitsuba."""
    turn = mi.ScalarTransform4f()
    low, high = EDGES

    def screen(edge, side):
        place = turn.translate([edge + side * 5, 0, 1]).scale([5, 5, 1])
        return {"type": "rectangle", "to_world": place, "bsdf": {"type": "diffuse", "reflectance": 0.0}}

    light = {"type": "rectangle", "to_world": turn, "emitter": {"type": "area", "radiance": 1.0}}
    return mi.load_dict({"type": "scene", "light": light, "below": screen(low, -1), "above": screen(high, 1)}, optimize=False)


def p(scene, photons, plane=PLANE, integrator="direct"):
    found = etendue.mitsuba.record(scene, plane, integrator=integrator, rays=2**19)
    return etendue.difference(found, photons).p_value


def test_mitsuba_and_photons_agree(scene, photons):
    assert p(scene, photons) > LEVEL


def test_an_axis_the_wrong_way_is_rejected(scene, photons):
    turned = etendue.mitsuba.Placement((0, 0, 2), (0, 0, 1), (-1, 0, 0), WINDOW, FREQUENCIES)
    assert p(scene, photons, turned) < LEVEL


def test_a_cosine_too_many_is_rejected(scene, photons):
    """The radiance comes from an integrator of the user's."""

    class Cosine(mi.SamplingIntegrator):
        power = 1

        def sample(self, scene, sampler, ray, medium=None, active=True):
            hit = scene.ray_intersect(mi.Ray3f(ray))
            return hit.emitter(scene).eval(hit) * mi.Frame3f.cos_theta(hit.wi) ** self.power, hit.is_valid(), []

    integrator = Cosine(mi.Properties())
    assert p(scene, photons, integrator=integrator) < LEVEL
    integrator.power = 0
    assert p(scene, photons, integrator=integrator) > LEVEL


def test_angles_in_place_of_slopes_are_rejected(scene, photons, monkeypatch):
    radiance = etendue.mitsuba._radiance

    def bent(mi, scene, integrator, medium, color, start, along, seed):
        u, v = along[:2] / along[2]
        away = -np.array([np.tan(u), np.tan(v), np.ones_like(u)])
        return radiance(mi, scene, integrator, medium, color, start, away / np.linalg.norm(away, axis=0), seed)

    monkeypatch.setattr(etendue.mitsuba, "_radiance", bent)
    assert p(scene, photons) < LEVEL


def test_a_pixel_of_a_world_agrees_with_etendue(tmp_path):
    """All three planes of a probe: light at the camera, light that leaves the surface, and light that arrives there."""
    world = Path(__file__).parents[2] / "scenes" / "worlds" / "knot.xml"
    own = etendue.probe(world, (200, 120), out=tmp_path, window=31, rays=2**18, photons=2**14)
    loaded = mi.load_file(str(world), optimize=False)
    theirs = etendue.mitsuba.probe(loaded, (200, 120), window=31, azimuths=4, rays=2**18)
    assert list(theirs) == ["camera", "leaving_1", "arriving_1"]
    for name in ("camera", "leaving_1"):
        assert etendue.difference(theirs[name], own.measured(name)).p_value > LEVEL / 3, name
    # Étendue widens the window of arriving light by the curvature of the surface, which is zero here.
    assert etendue.difference(theirs["arriving_1"], own.measured("arriving_1")).p_value > LEVEL / 3


def test_the_notebook():
    """Fog has the angular cut-off of theory. Frequencies of the ridge are 2 cycles/slope apart."""
    nbclient = pytest.importorskip("nbclient")
    import nbformat

    notebook = nbformat.read(Path(__file__).parents[2] / "docs" / "mitsuba.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 4
    said, _, hair = "".join(output.get("text", "") for output in outputs).partition("no hair")
    # Hair adds frequencies across it alone.
    (bare, along), (across, same) = ([float(x) for x in row] for row in re.findall(r"([0-9.]+) % across, ([0-9.]+) % along", hair))
    assert across > 1.3 * bare and abs(same - along) < 0.1 * along
    rows = [[float(number) for number in line.split()] for line in said.splitlines()[1:]]
    assert len(rows) == 5
    assert all(abs(measured - theory) < 0.25 for _, measured, theory in rows)  # an eighth of the step between frequencies of the ridge


@pytest.mark.parametrize("name", ["fog", "motion"])
def test_notebooks_of_theories(name):
    """Right theories pass and planted faults fail, in motion with the most rays."""
    nbclient = pytest.importorskip("nbclient")
    import nbformat

    notebook = nbformat.read(Path(__file__).parents[2] / "docs" / f"{name}.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=600).execute()
    said = "".join(output.get("text", "") for cell in notebook.cells for output in cell.get("outputs", []))
    lines = [line for line in said.rpartition("2^19 rays")[2].splitlines() if "the theory" in line or "planted" in line]
    assert len(lines) > 4
    for line in lines:
        assert line.endswith("fail" if "planted" in line else "pass"), said


@pytest.mark.parametrize(("page", "found", "wrong"), [("close-light", 4, 0), ("shape-from-reflection", 6, 2), ("depth-from-defocus", 7, 0)])
def test_notebooks_of_inverse_rendering(page, found, wrong):
    """Each scene is found, and no roughness of a wrong lobe explains the light."""
    nbclient = pytest.importorskip("nbclient")
    import nbformat

    notebook = nbformat.read(Path(__file__).parents[2] / "docs" / f"{page}.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=600).execute()
    said = "".join(output.get("text", "") for cell in notebook.cells for output in cell.get("outputs", []))
    fits = re.findall(r"((?:^.* start .*\n)+)(pass|fail), p", said, re.MULTILINE)
    off = [abs(float(number)) for fit, verdict in fits if verdict == "pass" for number in re.findall(r"\(([-+.0-9]+) σ\)", fit)]
    assert len(off) == found and max(off) < 4, said
    assert sum(verdict == "fail" for _, verdict in fits) == wrong, said


@pytest.mark.parametrize("integrator", ["prb", "direct_projective"])
def test_integrators_for_derivatives_see_the_same_light(integrator, scene, photons):
    assert p(scene, photons, integrator=integrator) > LEVEL


@pytest.mark.parametrize("kind", ["path", "volpath", "volpathmis", "prb", "prb_basic", "prb_projective"])
def test_light_that_arrives_has_met_one_surface_less(kind):
    """The depth of a scene's integrator is found in its description, and reduced by one unless it is unlimited."""
    for depth, shorter in ((6, 5), (-1, -1)):
        words = etendue.mitsuba._words(mi.load_dict({"type": kind, "max_depth": depth, "rr_depth": 7}))
        assert words == {"type": kind, "max_depth": depth, "rr_depth": 7}
        assert etendue.mitsuba._shorter(words)["max_depth"] == shorter


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "llvm_ad_spectral", "llvm_ad_mono_polarized"])
def test_every_kind_of_variant_sees_the_same_light(variant, scene, photons):
    try:
        mi.set_variant(variant)
        turn = mi.ScalarTransform4f()
        low, high = EDGES
        words = {"type": "scene"}
        for name, edge, side in (("below", low, -1), ("above", high, 1)):
            place = turn.translate([edge + side * 5, 0, 1]).scale([5, 5, 1])
            words[name] = {"type": "rectangle", "to_world": place, "bsdf": {"type": "diffuse", "reflectance": 0.0}}
        radiance = {"type": "d65"} if "spectral" in variant else 1.0
        words["light"] = {"type": "rectangle", "to_world": turn, "emitter": {"type": "area", "radiance": radiance}}
        assert p(words, photons) > LEVEL
    finally:
        mi.set_variant("llvm_ad_mono")


def test_faults_in_words(scene):
    with pytest.raises(ValueError, match="x_axis is"):
        p(scene, None, etendue.mitsuba.Placement((0, 0, 2), (0, 0, 1), (0, 0, 3), WINDOW, FREQUENCIES))
    with pytest.raises(ValueError, match="integrator is"):
        p(scene, None, integrator="ptracer")
    with pytest.raises(ValueError, match="batches is 3"):
        etendue.mitsuba.record(scene, PLANE, integrator="direct", batches=3)
    with pytest.raises(ValueError, match="color is 'red'"):
        etendue.mitsuba.record(scene, PLANE, integrator="direct", color="red", rays=1024)
    with pytest.raises(ValueError, match="no surface is at the origin"):
        plane = etendue.mitsuba.Placement((0, 0, 2), (0, 0, 1), (1, 0, 0), WINDOW, FREQUENCIES, on_surface=True)
        etendue.mitsuba.record(scene, plane, integrator="direct")
    with pytest.raises(ValueError, match="sensor is 0"):
        etendue.mitsuba.probe(scene, (0, 0))
