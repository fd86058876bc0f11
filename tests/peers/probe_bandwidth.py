"""Hold the bandwidths of `etendue probe` against pictures known in closed form.

usage: python3 tests/peers/probe_bandwidth.py PROGRAM [CASE ...]

Needs NumPy and Pillow.
Each case is a plane with a texture under an even sky, or a mirror under a sky with a pattern, seen by a pinhole.
Its picture is a formula, evaluated here on a lattice of directions and transformed by an FFT.
Prints a Markdown table: the largest bandwidth of the picture less its mean as printed and by the definition, and that of all power.
For a picture of one frequency the last column is the ratio of the samples that `probe` advises to two for each cycle of that frequency.
The exit code is 1 if a printed bandwidth differs from its definition by more than 4 % and four standard errors, or if fewer samples than two for each cycle are advised.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

SIZE = np.array([400, 300])
FOV = 40.0
PIXEL = (210, 140)
SLOPE = 2 * np.tan(np.radians(FOV / 2)) / SIZE[0]
AZIMUTHS = 40
# The cells of the printed spectrum spread its power by up to 3 %.
CELLS = 0.04
# `probe` reports no bandwidth below this multiple of that of the window.
SMOOTH = 1.9
# Metres and pixels across a texture; pixels of a sky.
TEXTURE = (4.0, 4096)
SKY = (4096, 2048)

HEAD = f"""<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="{FOV}"/>
  <transform name="to_world"><lookat origin="0,0,0" target="0,0,1" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="{SIZE[0]}"/><integer name="height" value="{SIZE[1]}"/><rfilter type="box"/></film>
</sensor>
"""
FILE = '<string name="filename" value="picture.png"/>'
RAW = FILE + '<boolean name="raw" value="true"/>'


def write(folder, values):
    """Write values from 0 to 1 as a grey picture of 8 bits."""
    grey = np.uint8(np.clip(np.round(255 * values), 0, 255))
    Image.fromarray(np.repeat(grey[..., None], 3, axis=2)).save(folder / "picture.png")


class Plane:
    """A diffuse plane with a texture, turned about the vertical axis."""

    def __init__(self, texture, degrees=11.65, distance=2.042, frequency=None, turn=0.0):
        self.texture, self.angle, self.distance = texture, np.radians(180 + degrees), distance
        # Of a texture of one frequency: cycles per metre, and the direction in which it varies.
        self.frequency, self.turn = frequency, np.radians(turn)

    def write(self, folder):
        side, count = TEXTURE
        x = (np.arange(count) + 0.5) / count * side - side / 2
        write(folder, self.texture(*np.meshgrid(x, x)))
        turn = np.degrees(self.angle)
        (folder / "scene.xml").write_text(
            f"""{HEAD}<emitter type="constant"><rgb name="radiance" value="1"/></emitter>
<shape type="rectangle">
  <transform name="to_world"><scale value="{side / 2}"/><rotate y="1" angle="{turn}"/><translate z="{self.distance}"/></transform>
  <bsdf type="twosided"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">{RAW}</texture></bsdf></bsdf>
</shape></scene>"""
        )

    def picture(self, directions):
        x, n = self.axes()
        middle = np.array([0, 0, self.distance])
        points = directions * (n @ middle / (directions @ n))[..., None] - middle
        return self.texture(points @ x, points[..., 1])

    def axes(self):
        sin, cos = np.sin(self.angle), np.cos(self.angle)
        return np.array([cos, 0, -sin]), np.array([sin, 0, cos])


class Mirror(Plane):
    """A mirror under a sky whose radiance is a function of direction."""

    def write(self, folder):
        columns, rows = SKY
        turn, polar = np.meshgrid((np.arange(columns) + 0.5) / columns * 2 * np.pi, (np.arange(rows) + 0.5) / rows * np.pi)
        directions = np.stack([np.sin(polar) * np.sin(turn), np.cos(polar), -np.sin(polar) * np.cos(turn)], axis=-1)
        radiance = self.texture(directions)
        # A sky is decoded from sRGB.
        write(folder, np.where(radiance < 0.0031308, 12.92 * radiance, 1.055 * radiance ** (1 / 2.4) - 0.055))
        (folder / "scene.xml").write_text(
            f"""{HEAD}<emitter type="envmap">{FILE}</emitter>
<shape type="rectangle">
  <transform name="to_world"><scale value="20"/><rotate y="1" angle="{np.degrees(self.angle)}"/><translate z="{self.distance}"/></transform>
  <bsdf type="conductor"><string name="material" value="none"/></bsdf>
</shape></scene>"""
        )

    def picture(self, directions):
        _, n = self.axes()
        d = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
        return self.texture(d - 2 * (d @ n)[..., None] * n)


def wave(frequency, contrast=1.0, degrees=0.0):
    """A texture that varies as a cosine, in cycles per metre."""
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    return lambda x, y: 0.5 + 0.5 * contrast * np.cos(2 * np.pi * frequency * (x * cos + y * sin))


def sky(frequency):
    """A sky that varies as a cosine of the direction's x, in cycles per unit."""
    return lambda d: 0.5 + 0.5 * np.cos(2 * np.pi * frequency * d[..., 0])


CASES = {
    "8 cycles/m, contrast 1": Plane(wave(8), frequency=8),
    "contrast 0.2": Plane(wave(8, 0.2), frequency=8),
    "turned by 33°": Plane(wave(8, 1, 33), frequency=8, turn=33),
    "seen under 50°": Plane(wave(6), 50, frequency=6),
    "4 m away": Plane(wave(8), distance=4.0, frequency=8),
    "5 and 12 cycles/m": Plane(lambda x, y: (wave(5)(x, y) + wave(12)(x, y)) / 2),
    "6 along x, 10 along y": Plane(lambda x, y: (wave(6)(x, y) + wave(10, 1, 90)(x, y)) / 2, 0),
    "an edge": Plane(lambda x, y: np.where(x > 0, 0.9, 0.1)),
    "an oblique edge": Plane(lambda x, y: np.where(x + 0.7 * y > 0, 0.9, 0.1)),
    "mirror, sky of 10.5 cycles": Mirror(sky(10.5), 0, frequency=10.5),
    "mirror at 30°, 10.5 cycles": Mirror(sky(10.5), 30, frequency=10.5),
    "even": Plane(lambda x, y: 0.5 + 0 * x),
    "slow: 0.2 cycles/m": Plane(wave(0.2)),
}


def frame():
    """The direction through the pixel, and the directions to the right and up across it."""
    right, down = (np.array(PIXEL) + 0.5 - SIZE / 2) * SLOPE
    d = np.array([-right, -down, 1.0])
    d /= np.linalg.norm(d)
    x = np.array([-1.0, 0, 0])
    x -= d * (d @ x)
    x /= np.linalg.norm(x)
    return d, x, np.cross(x, d)


def defined(case, half):
    """The largest bandwidth over directions, by its definition: of the picture less its mean, and of all power."""
    count, points = 257, 1024
    slope = np.linspace(-half, half, count)
    u, v = np.meshgrid(slope, slope)
    d, x, y = frame()
    picture = case.picture(d + u[..., None] * x + v[..., None] * y)
    window = np.cos(np.pi * u / (2 * half)) ** 2 * np.cos(np.pi * v / (2 * half)) ** 2
    mean = (picture * window).sum() / window.sum()
    frequency = np.fft.fftfreq(points, slope[1] - slope[0])
    across, along = np.meshgrid(frequency, frequency)
    inside = np.hypot(across, along) <= 6.125 / half
    found = []
    for values in ((picture - mean) * window, picture * window):
        power = np.abs(np.fft.fft2(values, (points, points)))[inside] ** 2
        each = []
        for azimuth in np.pi * np.arange(AZIMUTHS) / AZIMUTHS:
            distance = np.abs(across[inside] * np.cos(azimuth) + along[inside] * np.sin(azimuth))
            order = np.argsort(distance)
            below = np.cumsum(power[order])
            each.append(distance[order][np.searchsorted(below, 0.95 * below[-1])])
        found.append(max(each))
    return found


def local_frequency(case):
    """The frequency of a wave at the pixel, cycles per unit slope, by its phase."""
    d, x, y = frame()
    step = 1e-5
    phases = []
    for axis in (x, y):
        ends = np.stack([d - step * axis, d + step * axis])
        if isinstance(case, Mirror):
            _, n = case.axes()
            ends = ends / np.linalg.norm(ends, axis=-1, keepdims=True)
            place = (ends - 2 * (ends @ n)[..., None] * n)[..., 0]
            phases.append(case.frequency * np.diff(place)[0])
        else:
            x_axis, n = case.axes()
            middle = np.array([0, 0, case.distance])
            points = ends * (n @ middle / (ends @ n))[..., None] - middle
            # The texture's own phase, by its gradient along both axes.
            steps = np.array([np.diff(points @ x_axis)[0], np.diff(points[..., 1])[0]])
            phases.append(case.frequency * (steps @ [np.cos(case.turn), np.sin(case.turn)]))
    return np.hypot(*phases) / (2 * step)


def main():
    program, *wanted = sys.argv[1:]
    print("| picture | window, pixels | printed | by definition | all power, printed | by definition | samples over 2 a cycle |")
    print("|---|---|---|---|---|---|---|")
    wrong = []
    for name, case in CASES.items():
        if wanted and name not in wanted:
            continue
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            case.write(folder)
            arguments = ["--pixel", "{},{}".format(*PIXEL), "--rays", "2^18", "--photons", "2^12", "--quiet", "--out", folder / "out"]
            # Few photons leave the comparison undecided: exit code 4.
            done = subprocess.run([program, "probe", folder / "scene.xml", *arguments], capture_output=True, text=True)
            if done.returncode not in (0, 1, 4):
                sys.exit(f"{name}: {done.stderr}")
            found = json.loads((folder / "out/probe.json").read_text())["picture"]
        half = 0.5 * found["window_pixels"] * SLOPE
        varying, whole = defined(case, half)
        largest = found["largest"]
        ratio = ""
        if largest is None:
            limit = SMOOTH * max(found["window"])
            printed = f"below {limit:.2f}"
            is_right = varying < limit
        else:
            value, error = largest
            printed = f"{value:.2f} ± {error:.2f}"
            is_right = abs(value - varying) < CELLS * varying + 4 * error
            if case.frequency is not None:
                samples = value / local_frequency(case)
                ratio = f"{samples:.3f}"
                is_right &= samples > 1
        if not is_right:
            wrong.append(name)
        print(f"| {name} | {found['window_pixels']:.0f} | {printed} | {varying:.2f} | {max(found['all_power']):.2f} | {whole:.2f} | {ratio} |")
    if wrong:
        sys.exit("wrong: " + ", ".join(wrong))


if __name__ == "__main__":
    main()
