"""The package against the command, and against NumPy."""

import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import etendue
import numpy as np
import pytest

SCENES = Path(__file__).parents[2] / "scenes"
FIG9B = SCENES / "fig9b.ron"


@pytest.fixture(scope="module")
def result():
    return etendue.run(FIG9B, photons=2**18, set={"blockers.0.pitch": 0.1})


def test_arrays_are_those_of_the_command(result, tmp_path):
    line = ["run", str(FIG9B), "--photons=2^18", "--set=blockers.0.pitch=0.1", "--quiet", f"--out={tmp_path / 'b'}"]
    code = subprocess.run([sys.executable, "-m", "etendue", *line], check=False).returncode
    assert code == {"pass": 0, "fail": 1, "undecided": 4}[result.verdict]
    folder = result.save(tmp_path / "a")
    summary = json.loads((folder / "summary.json").read_bytes())
    for name in ["summary.json", *summary["files"]]:
        assert (folder / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name
    for plane in result.values():
        stored = np.load(folder / plane.name / "slices.npz")
        for name in ("measured", "predicted", "sigma", "rho", "nu", "azimuth"):
            assert getattr(plane.slices, name).tobytes() == stored[name].tobytes(), name
        stored = np.load(folder / plane.name / "radial.npz")
        assert plane.radial.measured.tobytes() == stored["power"].tobytes()
        assert plane.radial.sigma.tobytes() == stored["sigma_predicted"].tobytes()


def test_arrays_are_taken_over(result):
    """NumPy holds the memory that Rust has allocated: the array is a view of it, and is made once."""
    measured = result["receiver"].slices.measured
    assert not measured.flags.owndata and "PySliceContainer" in type(measured.base).__name__
    assert measured is result["receiver"].slices.measured
    assert measured.flags.writeable and measured.flags.c_contiguous


def test_parts_merge_to_the_whole(result):
    scene = etendue.Scene(FIG9B, photons=2**18, set={"blockers.0.pitch": 0.1})
    parts = [etendue.measure(scene, batches=range(i, 64, 3)) for i in (2, 0, 1)]
    parts = [pickle.loads(pickle.dumps(part)) for part in parts]
    merged = etendue.compare(etendue.merge(parts), etendue.predict(scene))
    assert merged.summary == result.summary
    assert merged["receiver"].slices.measured.tobytes() == result["receiver"].slices.measured.tobytes()
    with pytest.raises(etendue.SceneError, match="batch 0 is in both"):
        etendue.merge([parts[1], parts[1]])
    with pytest.raises(ValueError, match="different scenes"):
        etendue.merge([parts[0], etendue.measure(scene.file | {"run": {"photons": 2**18, "seed": 2}}, batches=[1])])


def test_results_are_pickled(result):
    again = pickle.loads(pickle.dumps(result))
    assert again.summary == result.summary
    assert again["receiver"].slices.predicted.tobytes() == result["receiver"].slices.predicted.tobytes()
    prediction = pickle.loads(pickle.dumps(etendue.predict(result.scene)))
    assert etendue.compare(etendue.measure(result.scene), prediction).summary == result.summary


def test_a_damaged_part_is_refused():
    part = etendue.measure(FIG9B, photons=2**16, batches=[3])
    whole = pickle.dumps(part)
    at = whole.index(b"PK\x03\x04")
    harmed = whole[: at + 9000] + bytes([whole[at + 9000] ^ 255]) + whole[at + 9001 :]
    with pytest.raises(etendue.SceneError):
        pickle.loads(harmed)


def test_all_faults_at_once():
    with pytest.raises(etendue.SceneError) as raised:
        etendue.check(FIG9B, set={"blockers.0.pitch": -1, "run.alpha": 2, "light.center": (0, 0, 0)})
    assert len(raised.value.faults) == 2
    assert any("set={'blockers.0.pitch': -1}: blockers[0].pitch is -1" in fault for fault in raised.value.faults)
    assert "--" not in str(raised.value)
    with pytest.raises(etendue.SceneError, match="in set, blockers.7") as raised:
        etendue.check(FIG9B, set={"blockers.7.pitch": 1})
    with pytest.raises(etendue.SceneError, match="photons=2: ") as raised:
        etendue.Scene(FIG9B, photons=2)
    assert isinstance(raised.value, ValueError)
    for wrong in ({"photons": -1}, {"photons": 1.5}, {"seed": -1}):
        with pytest.raises(ValueError, match="allowed: a whole number"):
            etendue.Scene(FIG9B, **wrong)
    assert etendue.Scene(FIG9B, set={"blockers.0.pitch": np.float64(0.125)}).file["blockers"][0]["JitteredSquares"]["pitch"] == 0.125
    with pytest.raises(etendue.SceneError, match="cannot read"):
        etendue.check("nowhere.ron")


def test_a_tree_is_a_scene():
    file = etendue.Scene(FIG9B).file
    file["run"] = {"photons": 2**16}
    file["planes"] = [{"name": "half", "at": {"Distance": 0.5}}]
    result = etendue.run(file)
    assert list(result) == ["half"] and result.verdict == "pass"
    assert result.summary["photons"] == 2**16


def test_own_photons_come_back():
    """The photons of a plane, given to the estimator as anybody's, have the measured spectrum."""
    scene = etendue.Scene(FIG9B, photons=2**16)
    light = etendue.photons(scene, "receiver")
    assert light.rays.shape == (light.batch.size, 5) and light.emitted == 2**16
    x, y, u, v, weight = light.rays.T
    file = scene.file
    own = {"window": file["window"], "frequencies": file["frequencies"], "batch": light.batch}
    found = etendue.spectrum(x, y, u, v, weight / 2**16, **own)
    plane = etendue.run(scene)["receiver"]
    slices = plane.slices
    # The transform is exact to 2e-7 of the sum of weights, twice.
    assert np.abs(found.slices - slices.measured).max() < 4e-7 * np.abs(slices.measured).max()
    assert found.variation_nu is not None
    assert np.isclose(found.variation_nu[0], plane.report["variation_95"]["nu"]["measured"], rtol=1e-4)  # interpolated in the same slices
    # Errors are from the same batches by the same estimator.
    assert np.allclose(found.slices_sigma, slices.sigma, rtol=1e-4)
    # Groups may have any numbers.
    renamed = etendue.spectrum(x, y, u, v, weight / 2**16, **(own | {"batch": light.batch.astype(np.int64) * 2**40 - 7}))
    assert np.array_equal(renamed.slices_sigma, found.slices_sigma)


def test_errors_are_those_of_chance():
    """Over seeds, a frequency's distance from the truth is its stated error."""
    window = {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}
    frequencies = {"azimuths": 1, "rho": {"max": 4}, "nu": {"max": 4}}
    found = []
    for seed in range(60):
        x, y, u, v = np.random.default_rng(seed).uniform(-0.5, 0.5, (4, 4000))
        s = etendue.spectrum(x, y, u, v, window=window, frequencies=frequencies)
        found.append((s.slices[0, 4, 4].real, s.slices_sigma[0, 4, 4]))
    values, errors = np.array(found).T
    # Four standard errors of a standard deviation from 60 values: 4 / sqrt(2 · 59) = 0.37.
    assert abs(values.std(ddof=1) / np.sqrt((errors**2).mean()) - 1) < 0.37
    # ∫ of four Hann windows over uniform density is (1/2)⁴; four standard errors of the mean of 60.
    assert abs(values.mean() - 4000 / 16) < 4 * values.std() / np.sqrt(60)


def test_rays_that_cannot_be():
    window, frequencies = {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}, {"rho": {"max": 4}, "nu": {"max": 4}}
    four = [np.zeros(100)] * 4
    for change, message in [
        ({"weight": np.ones(99)}, "weight has 99 numbers and x 100"),
        ({"weight": np.full(100, np.nan)}, "finite"),
        ({"weight": np.full(100, 1e200)}, "largest number"),
        ({"batches": 200}, "batches is 200 for 100 rays"),
        ({"batches": 1}, "batches is 1"),
        ({"batch": np.full(100, 0.5)}, "a whole number for each of 100"),
        ({"batch": np.full(100, 2**31)}, "1 different"),
        ({"window": {"x": {"Hann": -1}, "u": {"Hann": 1}}}, "window.x"),
    ]:
        with pytest.raises(ValueError, match=message):
            etendue.spectrum(*four, **{"window": window, "frequencies": frequencies, **change})


@pytest.mark.parametrize("threads", [0, -1, 1025, 10**6, 10**30, 1.5, "2"])
def test_threads_that_cannot_be(threads):
    window, frequencies = {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}, {"rho": {"max": 4}, "nu": {"max": 4}}
    four = [np.zeros(100)] * 4
    measured = etendue.measure(FIG9B, photons=64)
    for call in [
        lambda: etendue.run(FIG9B, photons=64, threads=threads),
        lambda: etendue.measure(FIG9B, photons=64, threads=threads),
        lambda: etendue.predict(FIG9B, threads=threads),
        lambda: etendue.compare(measured, threads=threads),
        lambda: etendue.spectrum(*four, window=window, frequencies=frequencies, threads=threads),
    ]:
        with pytest.raises(ValueError, match="threads is .*; allowed: a whole number from 1 to 1024"):
            call()


@pytest.mark.parametrize("batch", [1.5, -1, 64, "1"])
def test_batches_that_cannot_be(batch):
    for call in [
        lambda: etendue.measure(FIG9B, photons=2**16, batches=[batch]),
        lambda: etendue.photons(FIG9B, "receiver", photons=2**16, batches=[batch]),
    ]:
        with pytest.raises(ValueError, match="one of batches is .*; allowed: a whole number from 0 to 63"):
            call()


def test_an_interrupt_ends_a_billion_photons():
    code = (
        "import etendue, sys, time\n"
        "def told(n):\n"
        "    if n and not told.said: print('on', flush=True); told.said = True\n"
        "told.said = False\n"
        "try: etendue.run(sys.argv[1], photons=2**30, progress=told)\n"
        "except KeyboardInterrupt: print('off', flush=True)\n"
        "import os; time.sleep(0.3); a = os.times(); time.sleep(0.5); b = os.times(); print(b.user - a.user)\n"
    )
    with subprocess.Popen([sys.executable, "-c", code, FIG9B], stdout=subprocess.PIPE, text=True) as run:
        assert run.stdout.readline() == "on\n"
        time.sleep(0.5)
        begun = time.perf_counter()
        run.send_signal(signal.SIGINT)
        assert run.stdout.readline() == "off\n"
        seconds = time.perf_counter() - begun
        # And nothing goes on in the background.
        assert float(run.stdout.readline()) < 0.1
    print(f"interrupted after {1000 * seconds:.0f} ms")
    assert seconds < 1  # a busy machine; the figure is printed


def test_other_threads_go_on():
    counted = 0
    thread = threading.Thread(target=etendue.run, args=(FIG9B,), kwargs={"photons": 2**21})
    thread.start()
    while thread.is_alive():
        counted += 1
        time.sleep(0.01)
    assert counted > 3


def test_progress_and_pictures(result):
    told = []
    etendue.measure(FIG9B, photons=2**16, progress=told.append)
    assert told[-1] == 2**16
    html = result._repr_html_()
    assert "<table>" in html and "receiver" in html and "<script" not in html
    assert "verdict" in str(result) and "pass" in repr(result["light"])
    plane = result["receiver"]
    data = plane.to_xarray()
    assert data.measured.dims == ("azimuth", "rho", "nu") and data.rho.units == "cycles/m"
    assert data.power.shape == (data.rho.size, data.nu.size)
    import matplotlib

    matplotlib.use("Agg")
    assert plane.plot().get_xlabel().startswith("ρ")
    with pytest.raises(KeyError, match="there are light"):
        result["nowhere"]


def test_types_are_those_of_the_schema(tmp_path):
    here = Path(__file__).parents[1]
    out = tmp_path / "types.py"
    schema = here.parent / "docs" / "scene.schema.json"
    subprocess.run([sys.executable, here / "write_types.py", schema, out], check=True)
    assert out.read_text() == (here / "etendue" / "types.py").read_text()


def test_a_result_of_another_scene_stays(result, tmp_path):
    result.save(tmp_path / "a")
    result.save(tmp_path / "a")
    other = etendue.run(FIG9B, photons=2**14)
    with pytest.raises(etendue.CannotRun, match="another scene.*force=True"):
        other.save(tmp_path / "a")
    assert os.listdir(tmp_path) == ["a"]


def test_pairs_show_changes_below_the_noise(result):
    """Blockers whose sides are 0.1 % wider, with the seed of the other scene and with another one."""
    wide = {"blockers.0.pitch": 0.1, "blockers.0.fill": 0.6006}
    summary = result.summary
    for seed, paired in ((summary["seed"], True), (summary["seed"] + 1, False)):
        other = etendue.run(etendue.Scene(FIG9B, photons=summary["photons"], seed=seed, set=wide))
        found = etendue.difference(result["receiver"], other["receiver"])
        assert found.paired == paired
        # One in a thousand, since the seeds are fixed.
        assert (found.p_value > 1e-3) != paired
        assert np.nanmean(found.z**2) == pytest.approx(found.chi2_per_dof, rel=0.02)
    same = etendue.difference(result["receiver"], result["receiver"])
    assert same.difference == same.noise == 0 and same.p_value is None


def test_a_fit_finds_fields_of_the_scene():
    """A measurement, the same in a file, and photons of a renderer, whose planes are told by name or stand alone."""
    free = ["surfaces.0.center.2", "blockers.0.fill"]
    scene = etendue.Scene(FIG9B, photons=2**16, set={"planes": '[(name: "receiver", at: Before("floor"))]'})
    found = etendue.fit(scene, etendue.measure(scene), free, set={free[0]: 2.2})
    for field, true in zip(free, (2.0, 0.6)):
        # Four errors, since the seed is fixed.
        assert abs(found[field].value - true) < 4 * found[field].error
        assert found[field].bound < found[field].error
    assert found.verdict == "pass" and found[free[0]].start == 2.2 and found.correlations.shape == (2, 2)
    light = etendue.photons(scene, "receiver")
    x, y, u, v, weight = light.rays.T
    own = {"window": scene.file["window"], "frequencies": scene.file["frequencies"], "batch": light.batch}
    rays = etendue.spectrum(x, y, u, v, weight / 2**16, **own)
    of_rays = etendue.fit(scene, rays, free, set={free[0]: 2.2})
    assert of_rays[free[0]].value == pytest.approx(found[free[0]].value, abs=found[free[0]].error)
    with pytest.raises(etendue.SceneError, match="free=blockers.0.hight"):
        etendue.fit(scene, rays, ["blockers.0.hight"])
    with pytest.raises(TypeError, match="sequence of paths"):
        etendue.fit(scene, rays, "blockers.0.fill")


def test_two_measurements_differ_by_noise_alone(result):
    """Photons of another seed agree, and rays of the user's too; light that is a fifth too bright does not."""
    scene = etendue.Scene(FIG9B, photons=2**18, seed=2, set={"blockers.0.pitch": 0.1})
    other = etendue.run(scene)["receiver"]
    # One in a thousand, since the seeds are fixed.
    assert etendue.difference(result["receiver"], other).p_value > 1e-3
    light = etendue.photons(scene, "receiver")
    x, y, u, v, weight = light.rays.T
    own = {"window": scene.file["window"], "frequencies": scene.file["frequencies"], "batch": light.batch}
    for factor, agrees in ((1.0, True), (1.2, False)):
        found = etendue.spectrum(x, y, u, v, factor * weight / 2**18, **own)
        assert (etendue.difference(found, result["receiver"]).p_value > 1e-3) == agrees
    with pytest.raises(ValueError, match="same frequencies"):
        etendue.difference(result["receiver"], result["leaving"])


WINDOW, FREQUENCIES = {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}, {"rho": {"max": 4}, "nu": {"max": 4}}
LIGHT = {"Rectangle": {"center": [0, 0, 0], "size": [0.2, 0.2]}}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"window": {"x": {"Han": 1}, "u": {"Hann": 1}}}, "window.x: unknown variant `Han`.*did you mean Hann"),
        ({"window": {"x": {"Hann": "a"}, "u": {"Hann": 1}}}, "window.x: "),
        ({"window": {"x": {"Hann": 1}}}, "window: missing field `u`"),
        ({"window": {**WINDOW, "z": {"Hann": 1}}}, "window.z: unknown field"),
        ({"window": {"x": {"Hann": float("nan")}, "u": {"Hann": 1}}}, "window.x.Hann is nan"),
        ({"window": {"x": {"Hann": {0.5}}, "u": {"Hann": 1}}}, "window.x.Hann is {0.5}; allowed: numbers, texts"),
        ({"window": None}, "window: invalid type"),
        ({"frequencies": {"rho": {}, "nu": {"max": 4}}}, "frequencies.rho: missing field `max`"),
        ({"frequencies": {"rho": {"max": "a"}, "nu": {"max": 4}}}, "frequencies.rho.max: "),
        ({"frequencies": {**FREQUENCIES, "azimuths": 1.5}}, "frequencies.azimuths: "),
    ],
)
def test_faults_name_the_argument(change, message):
    """And not a line of a text that the user has not written."""
    words = {"window": WINDOW, "frequencies": FREQUENCIES, **change}
    grid = np.linspace(-0.6, 0.6, 12)
    field = {"light_field": np.zeros((12,) * 4), **dict.fromkeys("xyuv", grid)}
    for call in (lambda: etendue.spectrum(*np.zeros((4, 100)), **words), lambda: etendue.grid_spectrum(**field, **words)):
        with pytest.raises((ValueError, TypeError), match=message) as raised:
            call()
        assert not any(word in str(raised.value) for word in ("line ", "column ", "--"))


@pytest.mark.parametrize(
    ("scene", "set", "message"),
    [
        (3, None, "scene is 3; allowed: the path"),
        ("(\n  light: 1\n)", None, "scene is the text of a scene"),
        ({"lihgt": 1}, None, "lihgt: unknown field.*did you mean light"),
        ({"light": LIGHT}, None, "missing field `path`"),
        ({"light": {"Rectangl": {}}}, None, "light: unknown variant.*did you mean Rectangle"),
        (FIG9B, "blockers.0.pitch=1", "set is 'blockers.0.pitch=1'; allowed: a mapping"),
        (FIG9B, {"light.center": None}, "in set, light.center: None; allowed"),
        (FIG9B, {"window.x": {"Hann": 0.5}}, "in set, window.x: {'Hann': 0.5}; allowed: .*'Hann"),
        (FIG9B, {"window.x": "Hnn(0.5)"}, "in set, window.x=Hnn.*did you mean Hann"),
        (FIG9B, {"blockers.0.ptch": 1}, "in set, blockers.0.ptch=1: no field"),
    ],
)
def test_faults_name_the_field(scene, set, message):
    with pytest.raises((ValueError, TypeError), match=message) as raised:
        etendue.check(scene, set=set)
    assert not any(word in str(raised.value) for word in ("line ", "column ", "--"))


def test_trees_may_have_numbers_of_numpy():
    window = {"x": {"Hann": np.float32(0.5)}, "u": {"Hann": np.int64(1)}}
    scene = {**etendue.Scene(FIG9B).file, "window": window, "light": {"Rectangle": {"center": np.zeros(3), "size": (0.2, 0.2)}}}
    assert etendue.Scene(scene).file["window"]["x"] == {"Hann": 0.5}
