"""Measured bandwidth behind pixels against what decides where shading samples go: a table, and a scatter plot of each scene.

usage: bandwidth_shares.py ETENDUE SCENE... --out DIR [--map 40x25] [--window 64] [--rays 2^15] [--samples 20000] [--size 800x500]
       e.g. bandwidth_shares.py target/release/etendue scenes/worlds/creatures.xml --out out/shares

`etendue probe --map` measures the frequency below which 95 % of the power in a window about each pixel of a lattice lies. `etendue render` with each
method leaves the criterion's bandwidth and the samples a pixel that it asks for. Both are averaged over the middle of the same windows: the
criterion by its root mean square, samples by their mean. Only pixels count whose measured bandwidth is above 1.2 times the window's own. Columns:
* under-predicted: share of pixels whose criterion is below the measured bandwidth.
* rank correlation: Spearman's, of samples asked for and measured bandwidth.
* too few samples: share of pixels with less than half the samples they would have if samples followed measured bandwidths (to the power 4/3, as
  the methods do), both scaled to the same sum over all these pixels.
The scatter plot is criterion (up) over measured bandwidth (across), cycles per pixel, with logarithmic axes and the line of equality.
"""
import argparse, pathlib, subprocess
import numpy as np
from PIL import Image, ImageDraw

METHODS = ["uniform", "variance", "predicted", "weighted"]
LEAST = 1.2     # of the window's own bandwidth: less is the window, not the light
POWER = 4 / 3   # samples go with the bandwidth to this power


def means(layer, lattice, reach, power):
    """Means of layer**power over squares about the pixels of a lattice, to 1/power; NaN is left out."""
    h, w = layer.shape
    rows, columns = lattice
    found = np.full(lattice, np.nan)
    for j in range(rows):
        for i in range(columns):
            y, x = (2 * j + 1) * h // (2 * rows), (2 * i + 1) * w // (2 * columns)
            part = layer[max(y - reach, 0) : y + reach + 1, max(x - reach, 0) : x + reach + 1]
            part = part[np.isfinite(part)]
            if part.size:
                found[j, i] = (part**power).mean() ** (1 / power)
    return found


def ranks(values):
    return np.argsort(np.argsort(values))


def scatter(path, measured, predicted, name):
    """Dots on logarithmic axes, and the line of equality."""
    side, edge = 480, 60
    both = np.concatenate([measured, predicted])
    low, high = 10 ** np.floor(np.log10(both.min())), 10 ** np.ceil(np.log10(both.max()))
    place = lambda x: edge + (side - 2 * edge) * np.log(x / low) / np.log(high / low)
    image = Image.new("RGB", (side, side), "white")
    draw = ImageDraw.Draw(image)
    draw.rectangle([edge, edge, side - edge, side - edge], outline="black")
    draw.line([edge, side - edge, side - edge, edge], fill="grey")
    for m, p in zip(measured, predicted):
        x, y = place(m), side - place(p)
        draw.ellipse([x - 2, y - 2, x + 2, y + 2], fill="black")
    for decade in range(int(np.log10(low)), int(np.log10(high)) + 1):
        at = place(10.0**decade)
        draw.text((at - 10, side - edge + 6), f"{10.0**decade:g}", fill="black")
        draw.text((edge - 40, side - at - 6), f"{10.0**decade:g}", fill="black")
    draw.text((side // 2 - 110, side - 30), "measured bandwidth, cycles per pixel", fill="black")
    draw.text((edge, 30), f"{name}: criterion over measured bandwidth", fill="black")
    image.save(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etendue")
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--map", default="40x25")
    parser.add_argument("--window", type=int, default=64)
    parser.add_argument("--rays", default="2^15")
    parser.add_argument("--samples", type=int, default=20000)
    parser.add_argument("--size", default="800x500")
    args = parser.parse_args()
    print("| scene | pixels | under-predicted | " + " | ".join(f"{m}: rank correlation | too few samples" for m in METHODS) + " |")
    print("| --- " * (3 + 2 * len(METHODS)) + "|")
    for scene in args.scenes:
        folder = args.out / scene.stem
        call = lambda *words: subprocess.run([args.etendue, *map(str, words), "--quiet", "--force"], check=True)
        call("probe", scene, "--size", args.size, "--map", args.map, "--window", args.window, "--rays", args.rays, "--out", folder / "map")
        probed = np.load(folder / "map/map.npz")
        # Samples along a direction are twice the bandwidth in cycles per pixel.
        measured = 0.5 * probed["samples"]
        is_above = probed["measured"] > LEAST * probed["window"]
        asked, criterion = {}, None
        for method in METHODS:
            call("render", scene, "--size", args.size, "--shading-samples", args.samples, "--method", method, "--paths", 32, "--out", folder / method)
            layers = np.load(folder / method / "picture.npz")
            asked[method] = means(layers["density"], measured.shape, args.window // 4, 1)
            if method == "predicted":
                criterion = means(layers["bandwidth"], measured.shape, args.window // 4, 2)
        told = np.isfinite(measured) & is_above & np.isfinite(criterion) & (criterion > 0)
        for of in asked.values():
            told &= np.isfinite(of)
        m, c = measured[told], criterion[told]
        wanted = m**POWER / (m**POWER).sum()
        cells = [scene.stem, str(told.sum()), f"{(c < m).mean():.2f}"]
        for method in METHODS:
            n = asked[method][told]
            cells.append(f"{np.corrcoef(ranks(n), ranks(m))[0, 1]:.2f}" if np.ptp(n) > 1e-9 * n.max() else "–")
            cells.append(f"{(n / n.sum() < 0.5 * wanted).mean():.2f}")
        print("| " + " | ".join(cells) + " |", flush=True)
        scatter(folder / "scatter.png", m, c, scene.stem)


if __name__ == "__main__":
    main()
