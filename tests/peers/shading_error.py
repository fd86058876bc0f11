"""Errors of pictures of few shading samples, for each method that says where samples go: a Markdown table.

usage: shading_error.py ETENDUE SCENE... --reference DIR [--samples 20000,40000] [--methods uniform,predicted,variance,reference] [--ladder 0.5,1,2,4,8,16,32]
       e.g. shading_error.py target/release/etendue scenes/worlds/creatures.xml --reference out/references --flip --seeds 4

A reference is DIR/NAME/picture.npz, as `etendue render scenes/worlds/NAME.xml --samples 1024 --seed 1000 --out DIR/NAME` leaves it: many paths for
each pixel, and a seed that no other picture here has. Pictures are made at its size. Columns:
* relMSE: mean of (x - r)² / (r² + ε²), with ε = 0.01 of the reference's mean radiance; "less noise" is without the reference's own share, which
  its standard errors tell; "best 99.9 %" leaves out the thousandth of pixels with the largest errors. With --crop, relMSE counts only pixels inside.
* FLIP: mean HDR-FLIP (Andersson et al. 2021), the one channel as three equal ones (package flip-evaluator).
* shading samples and seconds: what `timing.json` and `picture.json` say; where they are silent, what was asked for, and the clock of the whole
  program, in brackets.
The second table says how many times as many shading samples, and how many times the seconds, the baseline needs for a method's relMSE, less
noise, at the first number of samples; and the baseline's relMSE over the method's at equal seconds. The baseline runs at a ladder of multiples of that
number, and between its steps errors follow a power law. Beyond the ladder there is only a bound. The method `plain` takes paths through all pixels alike, at
least two each. Figures are means over the seeds.
"""
import argparse, json, pathlib, shlex, subprocess, sys, time
import numpy as np

EPSILON = 0.01     # of the reference's mean radiance: darker pixels count as if they had it
WORST = 0.001      # share of pixels that the trimmed mean leaves out
FIRST_SEED = 1
# Names under which the files may say how many shading samples were taken.
USED = ["shading_samples_used", "shading_samples"]


class Reference:
    """A picture of many samples, with its standard errors."""

    def __init__(self, path, crop):
        arrays = np.load(path)
        left, top, width, height = crop or (0, 0, *arrays["radiance"].shape[::-1])
        self.crop = np.s_[top : top + height, left : left + width]
        self.shape = arrays["radiance"].shape
        least = EPSILON * arrays["radiance"].mean()
        self.radiance, self.error = arrays["radiance"][self.crop], arrays["error"][self.crop]
        self.scale = self.radiance**2 + least**2
        self.floor = float((self.error**2 / self.scale).mean())
        self.relative_error = float((self.error / np.sqrt(self.scale)).mean())

    def errors(self, picture, flip):
        """The numbers of the first table."""
        picture = picture[self.crop]
        each = np.sort(((picture - self.radiance) ** 2 / self.scale).ravel())
        kept = each[: len(each) - round(WORST * len(each))]
        found = {"relmse": each.mean(), "less": each.mean() - self.floor, "kept": kept.mean()}
        if flip is not None:
            as_rgb = lambda p: np.repeat(np.maximum(p, 0)[..., None], 3, 2).astype(np.float32)
            found["flip"] = flip.evaluate(as_rgb(self.radiance), as_rgb(picture), "HDR", applyMagma=False)[1]
        return found


def told(folder, names):
    """The first of some numbers that the files of a picture say, or None."""
    for file in ["timing.json", "picture.json"]:
        if (folder / file).exists():
            tree = json.loads((folder / file).read_text())
            for name in names:
                if isinstance(tree.get(name), (int, float)):
                    return tree[name]
    return None


def seconds_of(folder):
    """Seconds of all stages in timing.json, or None: {"seconds": {stage: s}}, where a stage `total` holds the others."""
    path = folder / "timing.json"
    if not path.exists():
        return None
    stages = json.loads(path.read_text()).get("seconds")
    if isinstance(stages, dict):
        return stages.get("total", sum(stages.values()))
    return stages


def run(args, scene, reference, method, samples, seed):
    """One picture: its errors, shading samples and seconds, and whether the files told the latter two."""
    h, w = reference.shape
    folder = args.out / scene.stem
    if method == "plain":
        each = max(2, round(samples / (w * h)))
        what, asked = ["--samples", str(each)], each * w * h
    else:
        what, asked = ["--shading-samples", str(samples), "--method", method], samples
    command = [args.etendue, "render", scene, "--size", f"{w}x{h}", *what, "--seed", str(seed), "--out", folder, "--force", "--quiet", *shlex.split(args.more)]
    start = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True)
    clock = time.perf_counter() - start
    if done.returncode:
        sys.exit(f"{shlex.join(map(str, command))}\n{done.stderr}")
    found = reference.errors(np.load(folder / "picture.npz")["radiance"], args.flip)
    used, seconds = told(folder, USED), seconds_of(folder)
    found["used"], found["seconds"] = asked if used is None else used, clock if seconds is None else seconds
    return found, (used is not None, seconds is not None)


def job(args, scene, reference, method, samples):
    """Means over the seeds; the spread of relMSE is that of one picture."""
    results = [run(args, scene, reference, method, samples, FIRST_SEED + k) for k in range(args.seeds)]
    mean = {name: float(np.mean([found[name] for found, _ in results])) for name in results[0][0]}
    mean["spread"] = float(np.std([found["relmse"] for found, _ in results], ddof=1)) if args.seeds > 1 else None
    return mean, results[0][1]


def between(x, xs, ys):
    """y at x by power laws between neighbours of a ladder; `None` beyond it."""
    order = np.argsort(xs)
    xs, ys = np.log(np.array(xs, float)[order]), np.log(np.array(ys, float)[order])
    return float(np.exp(np.interp(np.log(x), xs, ys))) if xs[0] <= np.log(x) <= xs[-1] else None


def needed(target, ladder):
    """Where on a ladder relMSE first falls to a target, counted in steps with fractions; or `None`, and whether that would be below "<" or beyond ">" it."""
    errors = [step["less"] for step in ladder]
    if errors[0] <= target:
        return None, "<"
    for k, (a, b) in enumerate(zip(errors, errors[1:])):
        if b <= target:
            # Below the reference's noise an error may come out negative: then the step itself.
            return k + (np.log(a / target) / np.log(a / b) if b > 0 else 1.0), ""
    return None, ">"


def at(step, ladder, name):
    """A quantity between two steps of a ladder, by a power law."""
    values = np.log([max(rung[name], 1e-300) for rung in ladder])
    return float(np.exp(np.interp(step, range(len(values)), values)))


def compare(method, ladder):
    """The row of the second table: how many times the samples and seconds the baseline needs, and its error at equal seconds."""
    if method["less"] <= 0:
        return ["below noise"] * 3
    step, bound = needed(method["less"], ladder)
    end = 0 if bound == "<" else len(ladder) - 1
    where = end if step is None else step
    row = [f"{bound} {at(where, ladder, name) / method[name]:.3g}".strip() for name in ("used", "seconds")]
    same_time = between(method["seconds"], [rung["seconds"] for rung in ladder], [max(rung["less"], 1e-300) for rung in ladder])
    return row + ["beyond the ladder" if same_time is None else f"{same_time / method['less']:.3g}"]


def line(cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def numbers(kind):
    return lambda text: [kind(float(part)) for part in text.split(",")]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etendue")
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--reference", type=pathlib.Path, required=True)
    parser.add_argument("--samples", type=numbers(int), default=[20000])
    parser.add_argument("--methods", type=lambda text: text.split(","), default=["uniform", "predicted", "variance", "reference"])
    parser.add_argument("--baseline", default="uniform")
    parser.add_argument("--ladder", type=numbers(float), default=[0.5, 1, 2, 4, 8, 16, 32])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--flip", action="store_true")
    parser.add_argument("--crop", type=numbers(int), help="left, top, width and height in pixels of the part that counts")
    parser.add_argument("--more", default="", help="further arguments of `etendue render`")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/shading_error"))
    args = parser.parse_args()
    args.ladder = sorted(args.ladder)
    if args.flip:
        import flip_evaluator
        args.flip = flip_evaluator
    else:
        args.flip = None
    return args


def main():
    args = arguments()
    heads = ["scene", "method", "asked for", "shading samples", "relMSE", "± of one picture", "less noise", f"best {100 * (1 - WORST):g} %"]
    heads += ["FLIP"] * (args.flip is not None) + ["seconds"]
    notes, rows = [], []
    line(heads)
    line(["---"] * len(heads))
    for scene in args.scenes:
        reference = Reference(args.reference / scene.stem / "picture.npz", args.crop)
        notes.append(f"{scene.stem}: the reference's mean relative standard error is {100 * reference.relative_error:.2f} %, its share of relMSE {reference.floor:.2e}")
        found = {}
        def result(method, samples):
            if (method, samples) in found:
                return found[method, samples]
            mean, (has_used, has_seconds) = job(args, scene, reference, method, samples)
            cells = [scene.stem, method, str(samples), f"{mean['used']:.0f}" if has_used else f"({mean['used']:.0f})", f"{mean['relmse']:.3e}"]
            cells += ["" if mean["spread"] is None else f"{mean['spread']:.1e}", f"{mean['less']:.3e}", f"{mean['kept']:.3e}"]
            cells += ([f"{mean['flip']:.4f}"] if args.flip is not None else []) + [f"{mean['seconds']:.2f}" if has_seconds else f"({mean['seconds']:.2f})"]
            line(cells)
            found[method, samples] = mean
            return mean
        for method in args.methods:
            for samples in args.samples:
                result(method, samples)
        others = [method for method in args.methods if method != args.baseline]
        if others and args.baseline in args.methods:
            ladder = [result(args.baseline, round(args.samples[0] * factor)) for factor in args.ladder]
            rows += [[scene.stem, method, *compare(found[method, args.samples[0]], ladder)] for method in others]
    if rows:
        print()
        line(["scene", "method", f"{args.baseline}: times the samples for its relMSE", "times the seconds", "relMSE over its own at equal seconds"])
        line(["---"] * 5)
        for row in rows:
            line(row)
    print()
    print("\n".join(notes))


main()
