"""The error of a mean: predicted and found, in this process, as by the command."""

import json
import pickle
import subprocess
import sys
from pathlib import Path

import etendue
import numpy as np
import pytest

SCENES = Path(__file__).parents[2] / "scenes" / "variance"
SOFT = SCENES / "soft_shadow.ron"
SPOT = SCENES / "spot_disc.ron"


def lattice(count):
    generator = np.array([1, 182_667, 469_891, 498_753])
    return np.arange(count)[:, None] * generator % count / count


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    path = tmp_path_factory.mktemp("points") / "long.npy"
    np.save(path, lattice(4096))
    samplers = ["sobol", "padded", lattice(64), path]
    return etendue.variance(SOFT, samplers=samplers, counts=[16, 64], unshifted=True, photons=2**18, shifts=100)


def test_predictions_are_found(found):
    assert list(found) == ["sobol", "padded xu+yv", "padded xy+uv", "array 2", "long.npy"]
    assert found.plane == "receiver" and len(found.power) == 15
    for value, other in [(found.mean, found.mean_by_photons)]:
        assert abs(value[0] - other[0]) < 4 * np.hypot(value[1], other[1])
    # The radiance is 0 or 1, and exact.
    assert abs(found.variance[0] - found.mean[0] * (1 - found.mean[0])) < 4 * found.variance[1]
    assert found.noise[0] == 0 and 0.8 < found.inside < 1
    assert abs(sum(share for share, _ in found.power.values()) - found.inside) < 1e-9
    for sampler in found.values():
        for curve in (sampler.shifted, sampler.unshifted):
            if curve is None:
                continue
            known = ~curve.undecided
            assert (abs(curve.ratio - 1) < 4.5 * curve.ratio_error)[known].all(), sampler.name
            assert np.allclose(curve.ratio, curve.predicted / curve.found)
            assert np.allclose(curve.gain, curve.counts * curve.predicted / found.variance[0])
    sobol = found["sobol"]
    assert sobol.shifted.counts.tolist() == [16, 64] and sobol.unshifted is not None
    assert sobol.shifted.slope < -1 and sobol.shifted.slope_found[1] > 0
    assert len(sobol.worse) == 2 and sobol.worse[1]["worst"][0]["ratio"] > 1
    assert found["array 2"].unshifted is None and found["array 2"].shifted.counts.tolist() == [64]
    # A lattice has peaks beyond the measured frequencies.
    assert found["long.npy"].shifted.undecided.tolist() == [True] and found.undecided
    assert "--" not in str(found) and "sobol, not shifted" in str(found)
    with pytest.raises(KeyError, match="no sampler 'halton'; there are sobol, padded"):
        found["halton"]


def test_points_on_the_light_are_coordinates():
    # The shadow of a half-plane depends on x and on the point of the light along x.
    found = etendue.variance(SOFT, samplers=["sobol"], counts=[256], light_points=True, photons=2**18, shifts=100)
    along, across = [sum(found.power[axes][0] for axes in ((a,), (b,), (a, b))) for a, b in ("xu", "yv")]
    assert along > 0.85 and abs(across) < 0.01 and found.report["light_points"]
    curve = found["sobol"].shifted
    assert abs(curve.ratio[0] - 1) < 4.5 * curve.ratio_error[0]
    with pytest.raises(etendue.SceneError, match="points on the light cannot be coordinates"):
        etendue.variance(SPOT, plane="leaving", light_points=True)


def test_results_are_pickled_and_drawn(found):
    again = pickle.loads(pickle.dumps(found))
    assert again.report == found.report and str(again) == str(found)
    assert np.array_equal(again["sobol"].shifted.found, found["sobol"].shifted.found)
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    for unshifted, names in [(False, list(found)), (True, ["sobol", "padded xu+yv", "padded xy+uv"])]:
        ax = found.plot(pyplot.figure().gca(), unshifted=unshifted)
        assert [text.get_text() for text in ax.get_legend().get_texts()] == names


def test_the_command_finds_the_same(tmp_path):
    arguments = {"samplers": ["jitter", lattice(8)], "counts": "16..16", "shifts": 20, "frequencies": 4, "photons": 2**15, "seed": 3}
    ours = etendue.variance(SPOT, plane="leaving", unshifted=True, **arguments)
    same = etendue.variance(etendue.Scene(SPOT, photons=2**15, seed=3), plane="leaving", unshifted=True, threads=1, **{
        name: value for name, value in arguments.items() if name not in ("photons", "seed")
    })
    assert same.report == ours.report
    np.save(tmp_path / "array 1.npy", lattice(8))
    line = "--plane=leaving --samplers=jitter,set.npy --counts=16 --shifts=20 --frequencies=4 --photons=2^15 --set=run.seed=3 --unshifted --out=out"
    (tmp_path / "array 1.npy").rename(tmp_path / "set.npy")
    done = subprocess.run(
        [sys.executable, "-m", "etendue", "variance", SPOT, *line.split()], cwd=tmp_path, check=False, capture_output=True, text=True
    )
    assert done.returncode in (0, 4), done.stderr
    theirs = json.loads((tmp_path / "out" / "variance.json").read_text())
    ours.report["samplers"][1]["sampler"] = "set.npy"
    for name, value in ours.report.items():
        assert theirs[name] == value, name
    assert str(ours).replace("array 1", "set.npy") in done.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"plane": None}, "the scene has several planes: select one with plane=; allowed: receiver, leaving"),
        ({"plane": "none"}, "plane=none: the scene has no such plane; allowed: receiver, leaving"),
        ({"samplers": "sobol"}, "samplers is 'sobol'; allowed: a sequence of names"),
        ({"samplers": []}, r"samplers is \[\]; allowed: a sequence"),
        ({"samplers": ["halton"]}, r"samplers\[0\] is 'halton'; allowed: independent, jitter, lhs, sobol, padded, an array of float64"),
        ({"samplers": ["sobol", "sobol"]}, 'samplers has "sobol" twice; allowed'),
        ({"samplers": [np.zeros((4, 3))]}, r"samplers\[0\] has the shape \(4, 3\); allowed: \(N, 4\)"),
        ({"samplers": [np.zeros((4, 4), np.float32)]}, r"samplers\[0\] is an array of float32 with the shape \(4, 4\); allowed: .*float64 \[N, 4\]"),
        ({"samplers": ["sobol", np.ones((4, 4))]}, r"samplers\[1\]: point 0 has the coordinate 1; allowed: numbers from 0 to below 1"),
        ({"samplers": [np.zeros((1, 4))]}, r"samplers\[0\]: it has 1 points; allowed: 2 to 65536"),
        ({"samplers": ["missing.npy"]}, "samplers=missing.npy: "),
        ({"samplers": ["jitter"], "counts": 17}, "counts=17: no sampler has sets of so many points; allowed: n.4 for jitter"),
        ({"counts": "1..4"}, "counts is '1..4'; allowed: a whole number, text such as '4..4096', or a sequence"),
        ({"counts": [4.5]}, r"counts is \[4.5\]; allowed"),
        ({"shifts": 1}, "shifts is 1; allowed: a whole number from 10 to 1000000"),
        ({"frequencies": 17}, "frequencies is 17; allowed: a whole number from 2 to 16"),
        ({"unshifted": "yes"}, "unshifted is 'yes'; allowed: True or False"),
        ({"set": {"light": "Point(center: (0, 0, 0))"}}, "receiver sees a point.*allowed: light with an area"),
        ({"method": "guess"}, "method is 'guess'; allowed"),
        ({"threads": 0}, "threads is 0; allowed"),
    ],
)
def test_arguments_that_cannot_be(tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=message) as raised:
        etendue.variance(SPOT, **{"plane": "receiver", "photons": 2**14, **arguments})
    assert "--" not in str(raised.value)
    assert not list(tmp_path.iterdir())
