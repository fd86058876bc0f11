"""Sweeps, figures, pictures, probes and imports: in this process, with messages that name arguments of Python."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import etendue
import numpy as np
import pytest

SCENES = Path(__file__).parents[2] / "scenes"
FIG9B = SCENES / "fig9b.ron"
GLOSSY = SCENES / "worlds" / "glossy.xml"
PITCH = {"blockers.0.pitch": [0.1, 0.2]}


@pytest.fixture
def alone(monkeypatch):
    """No process may be started."""

    def refuse(*_arguments, **_named):
        raise AssertionError("a process was started")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    for name in ("fork", "forkpty", "posix_spawn", "posix_spawnp", "system", "execv", "execve", "popen"):
        monkeypatch.setattr(os, name, refuse)


def command(*line):
    arguments = [str(word) for word in line]
    return subprocess.run([sys.executable, "-m", "etendue", *arguments, "--quiet"], check=False, capture_output=True, text=True)


def files(folder):
    """All files of a result, but for the seconds it took."""
    all = (path for path in Path(folder).rglob("*") if path.is_file() and path.name != "timing.json")
    return {str(path.relative_to(folder)): path.read_bytes() for path in all}


def test_a_sweep(alone, tmp_path):
    told = []
    table = etendue.sweep(FIG9B, PITCH, photons=2**14, out=tmp_path / "sweep", progress=told.append)
    assert set(table["blockers.0.pitch"]) == {0.1, 0.2} and "receiver" in table["plane"]
    assert told[-1] == 2
    # What is done is kept: a field with other values runs what is new.
    more = etendue.sweep(FIG9B, {"blockers.0.pitch": "0.1..0.2:3"}, photons=2**14, out=tmp_path / "sweep")
    assert set(more["blockers.0.pitch"]) == {0.1, 0.15, 0.2}
    scene = etendue.Scene(FIG9B, photons=2**14)
    of_scene = etendue.sweep(scene, {"blockers.0.pitch": np.array([0.1, 0.2])}, out=tmp_path / "scene")
    assert np.array_equal(of_scene["measured"], table["measured"], equal_nan=True)
    with pytest.raises(etendue.CannotRun, match="holds a sweep of blockers.0.pitch: choose another folder, or replace it with force=True"):
        etendue.sweep(scene, {"blockers.0.fill": [0.3, 0.4]}, out=tmp_path / "scene")


@pytest.mark.parametrize(
    ("set", "message"),
    [
        ({"blockers.0.pitch": [-1, 0.2]}, r"set=\{'blockers.0.pitch': -1.0\}: blockers\[0\].pitch is -1"),
        ({"blockers.0.pitch": "0.1..x:3"}, r"in set, blockers.0.pitch: `x` is not a number; allowed: 'A..B:N'"),
        ({"blockers.0.pitch": []}, "in set, blockers.0.pitch: there are 0 values"),
        ({"blockers.0.pitch": [0.1, float("nan")]}, "in set, blockers.0.pitch: `NaN` is not a number"),
        ({"blockers.0.pitch": 0.1}, "nothing is swept: blockers.0.pitch=0.1 is one value; give a field several values in the argument set"),
        ({}, "nothing is swept"),
        ({"nowhere": [1, 2]}, "nowhere"),
    ],
)
def test_sweeps_that_cannot_be(alone, tmp_path, set, message):
    with pytest.raises(ValueError, match=message) as raised:
        etendue.sweep(FIG9B, set, out=tmp_path / "out")
    assert "--" not in str(raised.value)
    assert not (tmp_path / "out").exists()


def test_figures(alone, tmp_path):
    told = []
    scene = etendue.Scene(FIG9B, photons=2**14)
    picture = etendue.figure([scene], plane="receiver", out=tmp_path / "one", progress=told.append)
    assert picture == tmp_path / "one/fig9b-receiver/figure.png" and picture.stat().st_size > 10_000
    assert told[-1] == 1
    assert b"etendue figure fig9b.ron --plane receiver --quality print" in (picture.parent / "figure.json").read_bytes()
    half = etendue.Scene(scene.file, name="half", set={"blockers.0.pitch": 0.2})
    both = etendue.figure([scene, half], plane="receiver", quality="draft", out=tmp_path / "two")
    assert both.parent.name == "fig9b-half-receiver"
    assert etendue.figure(["5"], out=tmp_path / "paper").parent.name == "5"
    for arguments, message in [
        ({"scenes": [scene], "plane": "nowhere"}, "has no plane nowhere; it has"),
        ({"scenes": [scene, scene]}, "two scenes are named fig9b"),
        ({"scenes": ["5"], "plane": "receiver"}, "^plane applies only to figures of scenes$"),
        ({"scenes": ["no-figure"]}, "no-figure"),
        ({"scenes": []}, "no scene is given"),
        ({"scenes": [scene], "quality": "best"}, "quality is 'best'; allowed: 'draft', 'print'"),
        ({"scenes": [scene], "style": tmp_path / "none.ron"}, "none.ron: cannot be read"),
    ]:
        with pytest.raises(ValueError, match=message):
            etendue.figure(**arguments, out=tmp_path / "out")
    assert not list((tmp_path / "out").rglob("figure.*"))
    with pytest.raises(TypeError, match="allowed: a sequence"):
        etendue.figure(scene, out=tmp_path / "out")


def test_pictures(alone, tmp_path):
    told = []
    picture = etendue.render(GLOSSY, out=tmp_path / "picture", samples=4, size="16x12", progress=told.append)
    assert picture.radiance.shape == picture.error.shape == (12, 16)
    assert picture.radiance.mean() > 0
    assert told[-1] == 16 * 12
    same = etendue.render(GLOSSY, out=tmp_path / "same", samples=4, size=(16, 12), threads=1)
    assert same.radiance.tobytes() == picture.radiance.tobytes()
    few = etendue.render(GLOSSY, out=tmp_path / "few", shading_samples=40, paths=16, size=(16, 12))
    assert few.radiance.shape == (12, 16) and np.isnan(few.error).all()
    assert (few.folder / "samples.png").exists()
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "picture.png").write_text("mine")
    with pytest.raises(etendue.CannotRun, match="replace them with force=True"):
        etendue.render(GLOSSY, out=tmp_path / "taken", size=(4, 4))


def test_probes(alone, tmp_path):
    found = etendue.probe(GLOSSY, (70, 95), out=tmp_path / "probe", rays=2**12, photons=1.6e4)
    assert found.surfaces[0]["shape"] == "metal"
    assert abs(found.surfaces[0]["curvature"][0] - 1 / 0.7) < 0.01  # by finite differences
    assert found.slices("camera")["measured"].shape == (4, 25, 25)
    assert "bandwidth of the picture" in str(found) and "--" not in str(found)
    assert found.picture["window_pixels"] >= 16
    for pixel, message in [
        ((256, 0), r"pixel is \(256, 0\); allowed: \(0, 0\) to \(255, "),
        ((-1, 0), r"pixel is \(-1, 0\); allowed: two whole numbers"),
        ("1,2", "pixel is '1,2'; allowed: two whole numbers"),
    ]:
        with pytest.raises(ValueError, match=message):
            etendue.probe(GLOSSY, pixel, out=tmp_path / "none")


def test_the_version_is_that_of_the_command():
    done = subprocess.run([sys.executable, "-m", "etendue", "--version"], capture_output=True, text=True, check=True)
    # The commit follows where it is known.
    assert re.fullmatch(rf"etendue {re.escape(etendue.__version__)}( \([0-9a-f]+\))?\n", done.stdout)


def test_imports(alone, tmp_path):
    scene = etendue.import_scene(GLOSSY)
    assert scene.counts["area lights"] >= 1 and scene.has_light
    name, (width, height) = scene.cameras[0]
    assert f"camera {name}: {width} × {height} pixels" in str(scene)
    assert etendue.import_scene(GLOSSY, bounces=2).depth == 2
    triangle = tmp_path / "triangle.obj"
    triangle.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    bare = etendue.import_scene(triangle)
    assert bare.cameras == [] and not bare.has_light
    assert "the scene has no camera: look_from= and look_at= add one" in str(bare)
    assert "the scene has no light: sky= adds one" in str(bare)
    with pytest.raises(etendue.SceneError, match="the scene has no camera: look_from= and look_at= add one"):
        etendue.render(triangle, out=tmp_path / "out")
    seen = etendue.import_scene(triangle, look_from=np.array([0, 0, 3]), look_at=(0.3, 0.3, 0), sky=1)
    assert seen.cameras[0] == ("command", (512, 512)) and seen.has_light
    for file, message in [("none.xml", "none.xml"), ("scene.txt", 'extension "txt"; allowed: gltf')]:
        with pytest.raises(etendue.SceneError, match=message):
            etendue.import_scene(tmp_path / file)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"samples": 1}, "samples is 1; allowed: a whole number from 2 to 4294967295"),
        ({"samples": 4.5}, "samples is 4.5; allowed"),
        ({"samples": 10**30}, "samples is 10+; allowed"),
        ({"size": (0, 4)}, r"size is \(0, 4\); allowed: two whole numbers from 1 to 16384"),
        ({"size": "4by4"}, "size is '4by4'; allowed"),
        ({"camera": "none"}, "camera=none; allowed: "),
        ({"method": "best"}, "method is 'best'; allowed: 'reference', 'auto', 'uniform'"),
        ({"color": "pink"}, "color is 'pink'; allowed: 'luminance', 'red'"),
        ({"sky": -1}, "sky is -1; allowed: a number from 0 to 1e9"),
        ({"look_from": (0, 0, 1)}, "look_from and look_at must be given together"),
        ({"look_from": (0, 0, 1), "look_at": (0, 0, 1)}, "look_from= and look_at= are the same point, or up= is parallel to"),
        ({"look_from": "0,0,1", "look_at": (0, 0, 0)}, "look_from is '0,0,1'; allowed: three numbers"),
        ({"fov": 30}, "up and fov are allowed only together with look_from and look_at"),
        ({"seed": -1}, "seed is -1; allowed"),
        ({"threads": 0}, "threads is 0; allowed: a whole number from 1 to 1024"),
        ({"threads": 10**6}, "threads is 1000000; allowed: a whole number from 1 to 1024"),
    ],
)
def test_arguments_that_cannot_be(alone, tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message):
        etendue.render(GLOSSY, out=tmp_path / "out", **arguments)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("threads", [0, 10**6])
def test_threads_are_checked_everywhere(alone, tmp_path, threads):
    out = tmp_path / "out"
    for call in [
        lambda: etendue.sweep(FIG9B, PITCH, out=out, threads=threads),
        lambda: etendue.figure([FIG9B], out=out, threads=threads),
        lambda: etendue.probe(GLOSSY, (1, 1), out=out, threads=threads),
    ]:
        with pytest.raises(ValueError, match="threads is .*; allowed: a whole number from 1 to 1024"):
            call()
    assert not out.exists()


def test_a_path_is_no_option(alone, tmp_path):
    for call in [
        lambda: etendue.render("--help", out=tmp_path / "out"),
        lambda: etendue.probe("--version", (1, 1), out=tmp_path / "out"),
        lambda: etendue.import_scene("--help"),
        lambda: etendue.sweep("--help", PITCH, out=tmp_path / "out"),
        lambda: etendue.figure(["--help.ron"], out=tmp_path / "out"),
    ]:
        with pytest.raises(etendue.SceneError, match="--help|--version"):
            call()
    assert not (tmp_path / "out").exists()
    with pytest.raises(ValueError, match="photons is 1.5; allowed"):
        etendue.sweep(FIG9B, PITCH, out=tmp_path / "out", photons=1.5)
    with pytest.raises(TypeError, match="unexpected keyword"):
        etendue.render(GLOSSY, out=tmp_path / "out", help=True)


def test_the_command_writes_the_same_bytes(tmp_path):
    a, b = tmp_path / "a", tmp_path / "b"
    etendue.sweep(FIG9B, PITCH, photons=2**14, out=a / "sweep")
    command("sweep", FIG9B, "--set=blockers.0.pitch=0.1,0.2", "--photons=2^14", "--out", b / "sweep")
    etendue.figure([FIG9B], set={"run.photons": 2**14}, quality="draft", plane="receiver", out=a / "figure")
    command("figure", FIG9B, "--set=run.photons=16384", "--quality=draft", "--plane=receiver", "--out", b / "figure")
    etendue.render(GLOSSY, size=(16, 12), samples=4, bounces=1, out=a / "picture")
    command("render", GLOSSY, "--size=16x12", "--samples=4", "--bounces=1", "--out", b / "picture")
    etendue.probe(GLOSSY, (70, 95), rays=2**12, photons=2**14, depth=2, window=8, variance=["lhs"], out=a / "probe")
    command("probe", GLOSSY, "--pixel=70,95", "--rays=2^12", "--photons=2^14", "--depth=2", "--window=8", "--variance=lhs", "--out", b / "probe")
    assert str(etendue.import_scene(GLOSSY)) + "\n" == subprocess.run(
        [sys.executable, "-m", "etendue", "import", GLOSSY], check=True, capture_output=True, text=True
    ).stdout
    ours, theirs = files(a), files(b)
    assert len(ours) > 40 and ours.keys() == theirs.keys()
    assert [name for name in ours if ours[name] != theirs[name]] == []


@pytest.mark.parametrize(
    "call",
    [
        "etendue.render(sys.argv[2], out=out, size=(64, 4096), samples=2**8, progress=told)",
        "etendue.probe(sys.argv[2], (70, 95), out=out, rays=2**32, progress=told)",
        "etendue.figure([etendue.Scene(sys.argv[1], photons=2**32)], out=out, progress=told)",
        "etendue.sweep(sys.argv[1], {'blockers.0.pitch': [0.1, 0.2]}, photons=2**32, out=out, progress=told)",
        "etendue.variance(sys.argv[1], plane='receiver', photons=2**32, progress=told)",
    ],
)
def test_an_interrupt_leaves_nothing(tmp_path, call):
    # A job in the background may ignore interrupts, and its children too.
    code = f"""
import etendue, os, signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
out = sys.argv[3]
def told(n):
    if not told.said: print("on", flush=True); told.said = True
told.said = False
try: {call}
except KeyboardInterrupt: print("off", flush=True)
a = os.times(); time.sleep(0.5); b = os.times(); print(b.user - a.user)
"""
    out = tmp_path / "out"
    with subprocess.Popen([sys.executable, "-c", code, FIG9B, GLOSSY, out], stdout=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        assert run.stdout.readline() == "on\n"
        time.sleep(0.5)
        begun = time.perf_counter()
        run.send_signal(signal.SIGINT)
        assert run.stdout.readline() == "off\n"
        seconds = time.perf_counter() - begun
        # And nothing goes on in the background.
        assert float(run.stdout.readline()) < 0.1
    assert seconds < 2  # a busy machine
    assert not [path for path in out.rglob("*") if path.is_file()], "no lock and no half of a result"
