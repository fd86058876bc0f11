"""A scene of Mitsuba 3 as `etendue render` sees it and as Mitsuba does: a z-test for each pixel.

usage: mitsuba_pictures.py ETENDUE SCENE [--against OTHER.xml] [--coats] [--more ARGUMENTS] [--root DIR] [--samples N] [--bounces N] [--out DIR]
       e.g. mitsuba_pictures.py target/release/etendue cbox.xml --bounces 1
            mitsuba_pictures.py target/release/etendue tests/peers/scenes/room.pbrt --against tests/peers/scenes/room.xml

With --against, SCENE may have any format: Mitsuba renders OTHER.xml, which holds the same. --more goes to `etendue render`.
With --coats, Mitsuba renders rough plastic with the exact transmittance of its coat (etendue_bsdfs.py); its own table is up to 2 % off.
Both trace paths through at most 64 x 64 pixels, with a box for a filter, and count in one number: luminance (llvm_ad_mono). z is the difference over its
standard error. A picture passes when no |z| is beyond what one in a hundred pictures reaches by chance (Sidak 1967), and the mean of z is
within 3.3 standard errors of 0, so that many small differences are seen too. Exit code 1 says it does not.
"""
import argparse, json, math, pathlib, shlex, subprocess, sys, tempfile
import mitsuba as mi, numpy as np
from statistics import NormalDist

mi.set_variant("llvm_ad_mono")
import drjit as dr
import etendue_bsdfs    # registers BSDFs  # noqa: F401

SIDE = 64
LEVEL = 0.01
BLOCKS = 64    # a pixel's mean is tested, not its samples: sixteen means of them tell its error


def size_of(scene):
    """Pixels across and down: as many as fit into 64 x 64 and have the shape of the file's; all pixels if the sides share no factor, as 683 x 512."""
    w, h = (int(n) for n in scene.sensors()[0].film().size())
    w, h = w // math.gcd(w, h), h // math.gcd(w, h)
    return [n * max(1, SIDE // max(w, h)) for n in (w, h)]


def ours(args, size, folder):
    command = [args.etendue, "render", args.scene, "--size", f"{size[0]}x{size[1]}", "--samples", str(args.samples), "--out", folder, "--force", "--quiet", *shlex.split(args.more)]
    for name in ["root", "bounces"]:
        if getattr(args, name) is not None:
            command += [f"--{name}", str(getattr(args, name))]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    arrays = np.load(folder / "picture.npz")
    return arrays["radiance"], arrays["error"], json.loads((folder / "picture.json").read_text())


def theirs(args, scene, made):
    depth = made["depth"]
    integrator = mi.load_dict({"type": "path", "max_depth": -1 if depth is None else depth + 1, "rr_depth": 1000, "hide_emitters": made["hides_sources"]})
    sensor = scene.sensors()[0]
    w, h = made["size"]
    means = []
    for block in range(BLOCKS):
        each = max(1, args.samples // BLOCKS)
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(block, w * h * each)
        pixel = dr.arange(mi.UInt32, w * h * each) // each
        place = mi.Point2f(pixel % w, pixel // w) + sampler.next_2d()
        ray, weight = sensor.sample_ray_differential(0, sampler.next_1d(), place / mi.Point2f(w, h), sampler.next_2d())
        radiance, _, _ = integrator.sample(scene, sampler, ray)
        sums = dr.zeros(mi.Float, w * h)
        dr.scatter_reduce(dr.ReduceOp.Add, sums, mi.Float((weight * radiance)[0]), pixel)
        means.append(np.array(sums) / each)
    means = np.array(means)
    return means.mean(0).reshape(h, w), (means.std(0, ddof=1) / np.sqrt(BLOCKS)).reshape(h, w)


def load(path, has_coats, root):
    if not has_coats:
        return mi.load_file(str(path))
    with tempfile.TemporaryDirectory() as folder:
        for file in root.rglob("*"):
            to = pathlib.Path(folder) / file.relative_to(root)
            if file.suffix == ".xml":
                to.write_text(file.read_text().replace('"roughplastic"', '"etendue_coat"'))
            elif file.is_dir():
                to.mkdir()
            else:
                to.symlink_to(file.resolve())
        return mi.load_file(str(pathlib.Path(folder) / path.relative_to(root)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etendue")
    parser.add_argument("scene")
    parser.add_argument("--against")
    parser.add_argument("--coats", action="store_true")
    parser.add_argument("--more", default="")
    parser.add_argument("--root")
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--bounces", type=int)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/pictures"))
    args = parser.parse_args()
    folder = args.out / pathlib.Path(args.scene).stem
    path = pathlib.Path(args.against or args.scene)
    scene = load(path, args.coats, pathlib.Path(args.root or path.parent))
    a, sa, made = ours(args, size_of(scene), folder)
    b, sb = theirs(args, scene, made)
    sigma = np.hypot(sa, sb)
    same = np.isclose(a, b, rtol=1e-5, atol=1e-9 * b.mean())    # where neither is noisy Mitsuba's 32 bits are left, and it has no 10^-40
    z = np.where(same, 0, (a - b) / np.where(sigma > 0, sigma, np.nan))
    np.savez(folder / "compared.npz", ours=a, theirs=b, z=z)
    lit = ~same
    largest = NormalDist().inv_cdf(1 - (1 - (1 - LEVEL) ** (1 / max(1, lit.sum()))) / 2)
    mean = z[lit].mean() * np.sqrt(lit.sum()) if lit.any() else 0.0
    passes = bool(np.nanmax(np.abs(z)) < largest and abs(mean) < 3.3 and not np.isnan(z).any())
    print(f"{pathlib.Path(args.scene).stem:45} depth {made['depth']}  mean {b.mean():9.5f}  off {(a - b).mean() / max(b.mean(), 1e-300):9.2e}"
          f"  noise {np.sqrt((sigma**2).mean()) / max(b.mean(), 1e-300):8.2e}  max |z| {np.nanmax(np.abs(z)):5.2f} of {largest:.2f}"
          f"  mean z {mean:5.2f}  rms z {np.sqrt(np.nanmean(z[lit]**2)) if lit.any() else 0:.3f}  {'pass' if passes else 'FAIL'}")
    sys.exit(0 if passes else 1)


main()
