"""What planes, azimuths, surfaces and triangles cost a photon, as lines through counts of instructions.

usage: costs.py PROGRAM          e.g. costs.py target/release/etendue

Needs valgrind. Instructions are the same on a busy machine; each line is a least-squares fit, with the largest distance of
a count from it. What its photons do not cost, transforms and the start of the program,
is told by a batch of half as many.
"""
import pathlib, re, subprocess, sys, tempfile

PROGRAM = sys.argv[1]
BATCHES = 64


def scene(planes=1, azimuths=8, mirrors=0, rectangles=0):
    """Light 1 m before a floor; planes at the same place, rectangles beside the way, or mirrors on it."""
    surfaces, visits = [], []
    for i in range(mirrors):
        # Stairs: forward, aside, forward.
        step, facing = i // 2, "(1, 0, -1)" if i % 2 == 0 else "(-1, 0, 1)"
        center = f"({step + i % 2}, 0, {step + 1})"
        surfaces.append(f'Smooth(name: "m{i}", center: {center}, facing: {facing}, form: Plane, aperture: 0.4, event: Mirror)')
        visits.append(f'"m{i}"')
    for i in range(rectangles):
        surfaces.append(f'Rectangle(name: "r{i}", center: (3, 0, {0.3 + 0.02 * i}), size: (0.1, 0.1), albedo: 0.5)')
    if not mirrors:
        surfaces.append('Rectangle(name: "floor", center: (0, 0, 1), size: (6, 6), albedo: 0.5)')
        visits.append('"floor"')
    at = f'After("m{mirrors - 1}")' if mirrors else 'Before("floor")'
    all_planes = ", ".join(f'(name: "p{i}", at: {at})' for i in range(planes))
    return f"""(
    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2), radiance: 1.0),
    surfaces: [{", ".join(surfaces)}],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [{", ".join(visits)}]),
    planes: [{all_planes}],
    window: {"(x: Hann(0.1), u: Hann(0.05))" if mirrors else "(x: Hann(0.5), u: Hann(0.5))"},
    frequencies: (azimuths: {azimuths}, rho: (max: 8), nu: (max: 16)),
    run: (photons: 4194304, seed: 1, batches: {BATCHES}),
)"""


def count(folder, text, photons):
    """Instructions of one batch of `photons`."""
    file = pathlib.Path(folder) / "scene.ron"
    file.write_text(text)
    with tempfile.TemporaryDirectory(dir=folder) as out:
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", PROGRAM, "measure", str(file)]
        command += ["--photons", str(photons * BATCHES), "--batches", "0..1", "--threads", "1", "--quiet", "--out", f"{out}/m"]
        done = subprocess.run(command, capture_output=True, text=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not found:
        sys.exit(done.stderr)
    return int(found.group(1))


def cost(folder, **what):
    """Instructions of a photon, and those of a batch beside its photons, in thousands."""
    text = scene(**what)
    few, many = (count(folder, text, n) for n in (1 << 14, 1 << 15))
    each = (many - few) / (1 << 14)
    return each, (few - each * (1 << 14)) / 1e3


def line(xs, ys):
    """Intercept, slope, and the largest distance from the line."""
    n, mx, my = len(xs), sum(xs) / len(xs), sum(ys) / len(ys)
    slope = sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sum((x - mx) ** 2 for x in xs)
    start = my - slope * mx
    return start, slope, max(abs(y - start - slope * x) for x, y in zip(xs, ys))


with tempfile.TemporaryDirectory() as folder:
    for what, values in {
        "planes": [1, 2, 4, 8],
        "azimuths": [4, 8, 16, 32],
        "mirrors": [1, 2, 3, 4],
        "rectangles": [1, 2, 4, 8, 16],
    }.items():
        costs = [cost(folder, **{what: n}) for n in values]
        print(f"\n{what}: " + ", ".join(f"{n}: {each:.0f}" for n, (each, _) in zip(values, costs)) + " instructions a photon")
        for name, index in (("a photon", 0), ("a batch and the start, thousands", 1)):
            start, slope, off = line(values, [c[index] for c in costs])
            print(f"  {name}: {start:.0f} + {slope:.1f} × {what}, within {off:.0f}")
