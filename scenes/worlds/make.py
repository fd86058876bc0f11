"""Makes the meshes and pictures of the worlds in this folder, with NumPy alone: python3 make.py [NAME ...]

Each is named after its file. Meshes stand on z = 0 and face +x. Skies are OpenEXR files, whose poles a scene turns up with `rotate x 90`.
"""
import pathlib, sys
import numpy as np
from surfaces import patch, polygonise, spline, tube, union, unit, write_ply

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "wild"))
from maps import exr


def both(points):
    """The points of a limb, and those of the same limb on the other side."""
    points = np.asarray(points, float)
    return [points, points * [1, -1, 1, 1]]


def foot(x, y, toe, spread):
    """Three toes in front of an ankle."""
    turns = np.radians([-spread, 0, spread])
    return [[[x, y, 0.10, 0.085], [x + 1.5 * toe * np.cos(a), y + 1.5 * toe * np.sin(a), 0.065, 0.06],
             [x + 2.4 * toe * np.cos(a), y + 2.4 * toe * np.sin(a), 0.05, 0.045]] for a in turns]


def plates(points, heights):
    """Spikes in a row, each from a place of the back outwards."""
    return [[[x, y, z - 0.1, 0.09], [x - 0.35 * h, y, z + 0.55 * h, 0.06], [x - 0.6 * h, y, z + h, 0.03]]
            for (x, y, z), h in zip(points, heights)]


def grazer():
    """On four legs: a long neck and tail, a row of spikes down the back."""
    back = [[-2.35, 0.45, 0.22, 0.03], [-1.85, 0.42, 0.24, 0.075], [-1.3, 0.16, 0.52, 0.17], [-0.75, 0.0, 0.92, 0.36],
            [-0.1, 0.0, 1.06, 0.50], [0.5, 0.0, 1.12, 0.40], [0.92, -0.03, 1.42, 0.25], [1.15, -0.12, 1.85, 0.18],
            [1.38, -0.24, 2.16, 0.17]]
    head = [[1.34, -0.22, 2.16, 0.19], [1.58, -0.34, 2.17, 0.17], [1.84, -0.46, 2.06, 0.105]]
    fore = [[0.52, 0.28, 0.95, 0.20], [0.60, 0.38, 0.55, 0.13], [0.56, 0.40, 0.14, 0.10]]
    hind = [[-0.62, 0.26, 0.85, 0.25], [-0.50, 0.38, 0.48, 0.15], [-0.66, 0.40, 0.14, 0.10]]
    toes = [toe for x in (0.58, -0.64) for y in (0.40, -0.40) for toe in foot(x, y, 0.09, 40)]
    spikes = plates([[-1.3, 0.16, 0.62], [-1.0, 0.05, 0.90], [-0.65, 0, 1.22], [-0.25, 0, 1.45], [0.15, 0, 1.50], [0.52, 0, 1.45], [0.80, -0.02, 1.55],
                     [0.96, -0.08, 1.80]], [0.16, 0.24, 0.32, 0.38, 0.36, 0.28, 0.20, 0.15])
    horns = [[[1.36, -0.24 + s * 0.10, 2.28, 0.06], [1.28, -0.24 + s * 0.17, 2.44, 0.045], [1.24, -0.22 + s * 0.2, 2.58, 0.028]] for s in (1, -1)]
    eyes = [[[1.55 + 0.07 * s, -0.33 + s * 0.135, 2.24, 0.05], [1.57 + 0.07 * s, -0.34 + s * 0.14, 2.24, 0.05]] for s in (1, -1)]
    body = [tube(part, 0.05) for part in [back, head, *both(fore), *both(hind)]]
    small = [tube(part, 0.02) for part in [*toes, *spikes, *horns, *eyes]]
    return polygonise(union([union(body, 0.06), *small], 0.025), [-2.5, -0.8, -0.1], [2.1, 0.8, 2.75], 0.0285)


def hunter():
    """On two legs: a heavy head with jaws, small arms, a tail held high, crests above the eyes."""
    back = [[-2.3, -0.5, 1.52, 0.03], [-1.8, -0.36, 1.36, 0.08], [-1.2, -0.12, 1.24, 0.17], [-0.6, 0.0, 1.22, 0.32],
            [0.0, 0.0, 1.30, 0.44], [0.5, 0.0, 1.52, 0.36], [0.80, 0.02, 1.86, 0.25], [0.98, 0.06, 2.18, 0.23]]
    skull = [[0.95, 0.06, 2.22, 0.24], [1.22, 0.10, 2.28, 0.22], [1.52, 0.14, 2.20, 0.155], [1.74, 0.17, 2.15, 0.10]]
    jaw = [[1.02, 0.07, 2.06, 0.15], [1.30, 0.11, 1.93, 0.11], [1.60, 0.15, 1.87, 0.075]]
    leg = [[-0.12, 0.27, 1.15, 0.30], [0.10, 0.36, 0.82, 0.21], [-0.12, 0.38, 0.45, 0.11], [0.0, 0.38, 0.12, 0.095]]
    arm = [[0.55, 0.27, 1.42, 0.11], [0.68, 0.36, 1.20, 0.075], [0.90, 0.33, 1.14, 0.055], [1.02, 0.28, 1.20, 0.035]]
    toes = [toe for y in (0.38, -0.38) for toe in foot(0.03, y, 0.14, 32)]
    crests = [[[1.10 + 0.02 * s, 0.09 + s * 0.13, 2.40, 0.055], [0.98, 0.08 + s * 0.16, 2.52, 0.05], [0.84, 0.06 + s * 0.18, 2.58, 0.03]] for s in (1, -1)]
    eyes = [[[1.20, 0.10 + s * 0.20, 2.33, 0.05], [1.22, 0.10 + s * 0.205, 2.33, 0.05]] for s in (1, -1)]
    nose = [[[1.66, 0.16, 2.26, 0.05], [1.70, 0.165, 2.31, 0.035]]]
    spikes = plates([[-0.9, -0.04, 1.44], [-0.55, 0, 1.52], [-0.15, 0, 1.68], [0.2, 0, 1.80]], [0.14, 0.18, 0.2, 0.17])
    body = [tube(part, 0.05) for part in [back, skull, jaw, *both(leg), *both(arm)]]
    small = [tube(part, 0.02) for part in [*toes, *crests, *eyes, *nose, *spikes]]
    return polygonise(union([union(body, 0.05), *small], 0.025), [-2.5, -0.9, -0.1], [2.0, 0.9, 2.75], 0.0285)


def sky(radiance):
    """Rows of a map of 256 × 128 pixels: the radiance from unit vectors [n, 3] in a frame with z up."""
    latitude = np.pi * (0.5 - (np.arange(128) + 0.5) / 128)
    longitude = 2 * np.pi * (0.5 - (np.arange(256) + 0.5) / 256)
    a, b = np.meshgrid(latitude, longitude, indexing="ij")
    toward = np.stack([np.cos(a) * np.sin(b), -np.cos(a) * np.cos(b), np.sin(a)], -1)
    return radiance(toward.reshape(-1, 3)).reshape(128, 256).tolist()


def glow(toward, azimuth, height, width):
    """A soft round light: 1 in its middle, falling with the Gaussian of a width; degrees. Azimuth 0 is +x, 90 is +y."""
    a, h = np.radians([azimuth, height])
    middle = np.array([np.cos(h) * np.cos(a), np.cos(h) * np.sin(a), np.sin(h)])
    return np.exp((toward @ middle - 1) / np.radians(width) ** 2)


def step(x, low, high):
    """0 below, 1 above, smooth between."""
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def pane(toward, azimuths, heights, soft):
    """A window between two azimuths and two heights, with soft edges; degrees."""
    azimuth = np.degrees(np.arctan2(toward[:, 1], toward[:, 0]))
    height = np.degrees(np.arcsin(np.clip(toward[:, 2], -1, 1)))
    middle, half = np.mean(azimuths), (azimuths[1] - azimuths[0]) / 2
    off = np.abs((azimuth - middle + 180) % 360 - 180)
    return step(half - off, -soft, soft) * step(height, heights[0] - soft, heights[0] + soft) * step(-height, -heights[1] - soft, -heights[1] + soft)


def hall(toward):
    """A dim hall: tall windows on the left, one behind the camera, a soft lamp, a pale ceiling, a dark floor."""
    z = toward[:, 2]
    light = 0.12 + 0.22 * step(z, -0.1, 0.9) + 0.05 * step(-z, -0.05, 0.3)
    light += 0.25 * np.exp(-((z - 0.02) / 0.07) ** 2)
    for middle in (118, 146, 174, 202, 230):
        light += 3.6 * (pane(toward, [middle - 8, middle - 1], [8, 52], 1.5) + pane(toward, [middle + 1, middle + 8], [8, 52], 1.5))
    light += 1.8 * pane(toward, [-75, -45], [15, 50], 3)
    light += 42 * glow(toward, 20, 46, 4.5) + 1.2 * glow(toward, 60, 20, 18)
    return light


def knot():
    """A tube around a torus knot that winds three times one way and twice the other; its radius varies along it."""
    def middle(t):
        a = 2 * np.pi * t
        r = 1.0 + 0.42 * np.cos(3 * a)
        return np.stack([r * np.cos(2 * a), r * np.sin(2 * a), 0.42 * np.sin(3 * a)], -1)
    def of(uv):
        t, b = uv[:, 0], 2 * np.pi * uv[:, 1]
        along = unit(middle(t + 1e-4) - middle(t - 1e-4))
        side = unit(np.cross(along, unit(middle(t) * [1, 1, 0])))
        up = np.cross(side, along)
        radius = 0.20 + 0.05 * np.cos(2 * np.pi * 10 * t)
        return middle(t) + radius[:, None] * (np.cos(b)[:, None] * side + np.sin(b)[:, None] * up)
    return patch(of, [440, 40], [True, True])[:3]


def sheet():
    """A square of 4 m with waves that grow shorter to one side."""
    def of(uv):
        x, y = 4 * uv.T - 2
        z = 0.10 * np.sin(2.2 * x + 0.6 * np.sin(1.7 * y)) + 0.05 * np.sin(3.1 * y + 0.5 * x * x + 2 * x) + 0.012 * (1 + x / 2) * np.sin(14 * y + 3 * np.sin(2 * x))
        return np.stack([x, y, z], 1)
    return patch(of, [120, 120], [False, False])[:3]


def turned(profile, counts):
    """A surface of revolution: `profile` are points (radius, z) from its foot, outside up and inside down."""
    points = spline(np.asarray(profile, float), 0.004)
    ways = np.append(0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    def of(uv):
        radius, z = (np.interp(uv[:, 1] * ways[-1], ways, points[:, k]) for k in range(2))
        a = 2 * np.pi * uv[:, 0]
        return np.stack([radius * np.cos(a), radius * np.sin(a), z], 1)
    return patch(of, counts, [True, False])


def vase():
    """A vase with a narrow neck and a wide lip, 0.42 m high."""
    return turned([[0.004, 0.003], [0.060, 0.002], [0.078, 0.012], [0.088, 0.040], [0.118, 0.100], [0.130, 0.160], [0.112, 0.225], [0.068, 0.285], [0.044, 0.330],
                   [0.046, 0.370], [0.072, 0.408], [0.084, 0.418], [0.080, 0.424], [0.062, 0.412], [0.036, 0.370], [0.034, 0.330]], [100, 100])


def bowl():
    """A shallow bowl, 0.24 m wide."""
    return turned([[0.004, 0.004], [0.040, 0.003], [0.050, 0.010], [0.060, 0.018], [0.095, 0.040], [0.117, 0.078], [0.121, 0.084], [0.117, 0.087], [0.110, 0.080], [0.086, 0.046],
                   [0.050, 0.026], [0.004, 0.020]], [96, 70])[:3]


def pear():
    """A pear with a stalk, 0.13 m high."""
    flesh = tube([[0, 0, 0.036, 0.033], [0.001, 0, 0.058, 0.034], [0.003, 0, 0.085, 0.022], [0.004, 0, 0.102, 0.016]], 0.004)
    stalk = tube([[0.004, 0, 0.108, 0.0045], [0.006, 0, 0.124, 0.003], [0.011, 0.002, 0.138, 0.0045]], 0.002)
    return polygonise(union([flesh, stalk], 0.002), [-0.05, -0.05, -0.01], [0.05, 0.05, 0.16], 0.0019)


def weave():
    """A cloth of bands and dots, 128 × 128 reflectances, linear."""
    y, x = np.meshgrid(np.arange(128) / 128, np.arange(128) / 128, indexing="ij")
    wave = 0.5 + 0.5 * np.cos(2 * np.pi * 4 * y)
    dots = step(0.16 - np.hypot((4 * x) % 1 - 0.5, (4 * y) % 1 - 0.5), -0.03, 0.03)
    fine = 0.04 * np.cos(2 * np.pi * 32 * x) * np.cos(2 * np.pi * 32 * y)
    return (0.30 + 0.22 * wave - 0.22 * dots + fine).tolist()


def pawn():
    """A chess pawn with a collar, 1 m high."""
    return turned([[0.01, 0.004], [0.26, 0.002], [0.30, 0.03], [0.29, 0.09], [0.20, 0.15], [0.155, 0.20], [0.115, 0.36], [0.095, 0.52], [0.11, 0.565], [0.175, 0.585], [0.18, 0.605],
                   [0.12, 0.625], [0.115, 0.65], [0.17, 0.70], [0.195, 0.79], [0.17, 0.885], [0.10, 0.945], [0.01, 0.962]], [48, 90])[:3]


def blossom():
    """A ball with eight soft petals and a bud, 0.9 m high."""
    turns = np.arange(8) * np.pi / 4
    petals = [tube([[0, 0, 0.45, 0.20], [0.26 * np.cos(a), 0.26 * np.sin(a), 0.40 + 0.10 * np.cos(2 * a), 0.13], [0.40 * np.cos(a), 0.40 * np.sin(a), 0.36 + 0.2 * np.cos(2 * a), 0.07]], 0.03)
              for a in turns]
    stem = tube([[0, 0, 0.06, 0.16], [0, 0, 0.2, 0.08], [0, 0, 0.6, 0.15], [0, 0, 0.80, 0.09]], 0.03)
    return polygonise(union([*petals, stem], 0.025), [-0.6, -0.6, -0.2], [0.6, 0.6, 1.1], 0.026)


def evening(toward):
    """An evening: a low soft sun, clouds in bands, a bright horizon and dark hills."""
    z = toward[:, 2]
    azimuth = np.arctan2(toward[:, 1], toward[:, 0])
    hills = 0.05 + 0.035 * np.sin(3 * azimuth + 1) + 0.02 * np.sin(8 * azimuth)
    clouds = step(np.sin(9 * z + 1.2 * np.sin(2 * azimuth) + 0.8 * np.sin(5 * azimuth + 6 * z)), 0.1, 0.9) * step(z, 0.08, 0.35)
    above = 0.35 + 0.75 * np.exp(-np.maximum(z, 0) / 0.18) + 0.55 * clouds + 2.2 * glow(toward, 205, 22, 22)
    return step(z, hills - 0.04, hills + 0.04) * above + 0.10 + 45 * glow(toward, 205, 27, 4)


MADE = {
    "grazer.ply": grazer,
    "hunter.ply": hunter,
    "hall.exr": lambda: sky(hall),
    "knot.ply": knot,
    "sheet.ply": sheet,
    "vase.ply": vase,
    "bowl.ply": bowl,
    "pear.ply": pear,
    "weave.exr": weave,
    "pawn.ply": pawn,
    "blossom.ply": blossom,
    "evening.exr": lambda: sky(evening),
}


def main():
    for name in sys.argv[1:] or MADE:
        made = MADE[name]()
        if name.endswith(".ply"):
            write_ply(HERE / name, *made)
        else:
            exr(HERE / name, made)


main()
