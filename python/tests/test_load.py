"""Stored results and measurements, against those in memory."""

import json
import pickle
import subprocess
import sys
from pathlib import Path

import etendue
import numpy as np
import pytest

SCENES = Path(__file__).parents[2] / "scenes"
FIG9B = SCENES / "fig9b.ron"


@pytest.fixture(scope="module")
def result():
    return etendue.run(FIG9B, photons=2**16)


@pytest.fixture(scope="module")
def folder(result, tmp_path_factory):
    return result.save(tmp_path_factory.mktemp("run") / "a")


def command(*line):
    return subprocess.run([sys.executable, "-m", "etendue", *map(str, line)], check=False, capture_output=True).returncode


def test_what_is_loaded_is_what_was_saved(result, folder, tmp_path):
    loaded = etendue.load(folder)
    assert isinstance(loaded, etendue.Result) and list(loaded) == list(result)
    assert loaded.summary == {**result.summary, "files": {}} and loaded.verdict == result.verdict
    for plane, other in zip(loaded.values(), result.values()):
        for group in ("slices", "radial", "light_field"):
            for name, array in vars(getattr(other, group)).items():
                found = getattr(getattr(plane, group), name)
                assert found.shape == array.shape and found.dtype == array.dtype, (group, name)
                if (group, name) == ("light_field", "sigma"):
                    assert np.allclose(found, array, rtol=1e-15, atol=0), plane.name
                else:
                    assert np.array_equal(found, array), (group, name)
        pytest.importorskip("xarray").testing.assert_allclose(plane.to_xarray(), other.to_xarray(), rtol=1e-15)
        assert plane.report == other.report and plane.parameters == other.parameters
        assert "image/png" in plane._repr_html_()
    assert loaded._repr_html_() == result._repr_html_()
    assert loaded.scene.file == result.scene.file
    assert str(loaded).endswith(f"verdict: {result.verdict}")
    again = loaded.save(tmp_path / "b")
    names = ["summary.json", *json.loads((folder / "summary.json").read_text())["files"]]
    assert len(names) > 20
    for name in names:
        assert (again / name).read_bytes() == (folder / name).read_bytes(), name
    assert pickle.loads(pickle.dumps(loaded)).summary == loaded.summary


def test_loaded_results_replace_no_other_scene(folder, tmp_path):
    other = etendue.run(FIG9B, photons=2**14, set={"blockers.0.pitch": 0.1}).save(tmp_path / "b")
    with pytest.raises(etendue.CannotRun, match="another scene.*force=True"):
        etendue.load(folder).save(other)
    etendue.load(folder).save(other, force=True)
    assert (other / "summary.json").read_bytes() == (folder / "summary.json").read_bytes()


def test_arrays_that_are_not_stored_name_their_option(result, folder, tmp_path):
    """Batches of equal random numbers are needed for pairs, and the light field for a picture."""
    with pytest.raises(etendue.CannotRun, match="light/batches.npz: .*--save batches"):
        etendue.difference(etendue.load(folder)["light"], etendue.load(folder)["light"])
    line = ["run", FIG9B, "--photons=2^16", "--quiet"]
    command(*line, "--compact", "--out", tmp_path / "compact")
    compact = etendue.load(tmp_path / "compact")
    with pytest.raises(etendue.CannotRun, match="light/primal.csv: .*without --compact"):
        compact["light"].light_field  # noqa: B018
    assert np.array_equal(compact["light"].slices.measured, result["light"].slices.measured)
    assert "light_field" not in compact["light"].to_xarray()
    command(*line, "--save=batches", "--set=blockers.0.pitch=0.21", "--out", tmp_path / "batches")
    command(*line, "--save=batches", "--out", tmp_path / "other")
    a, b = (etendue.load(tmp_path / name)["receiver"] for name in ("batches", "other"))
    of_memory = etendue.run(FIG9B, photons=2**16, set={"blockers.0.pitch": 0.21})
    found, expected = etendue.difference(a, b), etendue.difference(of_memory["receiver"], result["receiver"])
    assert found.paired and found.p_value == expected.p_value and np.array_equal(found.z, expected.z, equal_nan=True)


def test_parts_of_a_measurement_are_loaded(result, tmp_path):
    for part in ("0..16", "16..64"):
        assert command("measure", FIG9B, "--photons=2^16", "--batches", part, "--quiet", "--out", tmp_path / part) == 0
    parts = [etendue.load(tmp_path / part) for part in ("16..64", "0..16")]
    assert all(isinstance(part, etendue.Measurement) for part in parts) and parts[1].batches == list(range(16))
    assert etendue.compare(etendue.merge(parts)).summary == result.summary


def test_a_scene_with_files_is_read_from_the_copies(tmp_path):
    scene = SCENES / "letter.ron"
    assert command("measure", scene, "--photons=2^12", "--quiet", "--out", tmp_path / "m") == 0
    loaded = etendue.load(tmp_path / "m")
    expected = etendue.compare(etendue.measure(scene, photons=2**12)).summary
    assert etendue.compare(loaded).summary == expected
    result = etendue.load(etendue.run(scene, photons=2**12).save(tmp_path / "r"))
    with pytest.raises(etendue.SceneError, match="letter.png"):
        result.scene  # noqa: B018


def test_what_cannot_be_loaded(folder, tmp_path):
    with pytest.raises(etendue.SceneError, match="no such folder"):
        etendue.load(tmp_path / "nowhere")
    with pytest.raises(etendue.SceneError, match="holds no result"):
        etendue.load(tmp_path)
    changed = etendue.load(folder).save(tmp_path / "changed")
    whole = (changed / "light/slices.npz").read_bytes()
    (changed / "light/slices.npz").write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    with pytest.raises(etendue.SceneError, match="light/slices.npz is damaged"):
        etendue.load(changed)["light"].slices  # noqa: B018
    text = (changed / "summary.json").read_text()
    (changed / "summary.json").write_text(text.replace('"verdict": "pass"', '"verdict": "fail"', 1))
    with pytest.raises(etendue.SceneError, match="was changed after it was written"):
        etendue.load(changed)
