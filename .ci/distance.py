"""How far two result folders are apart: the largest distance of two arrays, relative to the norm of the first.

usage: distance.py A B BOUND            fails beyond BOUND, and where folders hold other files, arrays or verdicts
       distance.py A B BOUND --kept     the same, but B may hold files that are not kept in A

Arrays are those of .npz and .npy files, and the columns of .csv files. Numbers in other files are drawn from these, or
rounded.
"""
import array, ast, csv, json, math, pathlib, struct, sys, zipfile


def npy(data):
    """Shape and values of an array of f64, complex numbers as two, or the bytes of any other."""
    assert data[:6] == b"\x93NUMPY", "no NPY file"
    head, width = (10, "<H") if data[6] == 1 else (12, "<I")
    end = head + struct.unpack(width, data[8:head])[0]
    header = ast.literal_eval(data[head:end].decode())
    if header["descr"] not in ("<f8", "<c16"):
        return str(header), data[end:]
    values = array.array("d", data[end:])
    if sys.byteorder == "big":
        values.byteswap()
    return str(header), values


def number(cell):
    try:
        return float(cell)
    except ValueError:
        return None


def columns(path):
    """Each column of a table: its words, and its numbers."""
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    found = {}
    for name, cells in zip(header, zip(*rows)):
        numbers = [number(cell) for cell in cells]
        words = [cell for cell, n in zip(cells, numbers) if n is None]
        found[name] = str(words), array.array("d", [n for n in numbers if n is not None])
    return found


def arrays(path):
    if path.suffix == ".npy":
        return {"": npy(path.read_bytes())}
    if path.suffix == ".csv":
        return columns(path)
    with zipfile.ZipFile(path) as archive:
        return {name: npy(archive.read(name)) for name in archive.namelist()}


def size(values):
    return math.hypot(*(x for x in values if math.isfinite(x)))


def distance(a, b, least=0.0):
    """Of two arrays, relative to the norm of the first, or to `least`; undefined values must be so in both."""
    if a == b:
        return 0.0
    if a[0] != b[0] or not isinstance(a[1], array.array) or len(a[1]) != len(b[1]):
        return math.inf
    if any(math.isfinite(x) != math.isfinite(y) for x, y in zip(a[1], b[1])):
        return math.inf
    pairs = [(x, y) for x, y in zip(a[1], b[1]) if math.isfinite(x)]
    apart, norm = math.hypot(*(x - y for x, y in pairs)), max(least, size(a[1]))
    return apart / norm if norm > 0 else math.inf if apart > 0 else 0.0


def verdicts(folder):
    index = folder / "summary.json"
    summary = json.loads((index if index.exists() else folder / "figure.json").read_text())
    planes = [(plane.get("name"), plane.get("plane"), plane.get("verdict")) for plane in summary["planes"]]
    return summary.get("verdict"), planes


def main(first, second, bound, kept=""):
    first, second = pathlib.Path(first), pathlib.Path(second)
    files = [sorted(p.relative_to(f) for p in f.rglob("*") if p.is_file()) for f in (first, second)]
    if kept:
        files[1] = [file for file in files[1] if file in files[0]]
    if files[0] != files[1]:
        sys.exit(f"other files: {set(files[0]) ^ set(files[1])}")
    if verdicts(first) != verdicts(second):
        sys.exit(f"verdicts {verdicts(first)} and {verdicts(second)}")
    largest, where = 0.0, "none"
    for file in files[0]:
        if file.suffix not in (".npy", ".npz", ".csv"):
            continue
        a, b = arrays(first / file), arrays(second / file)
        if a.keys() != b.keys():
            sys.exit(f"{file}: other arrays")
        for name in a:
            # The noise of power is a difference of powers, and has their rounding errors.
            is_noise = name in ("shot_noise.npy", "sigma.npy") and "power.npy" in a
            apart = distance(a[name], b[name], size(a["power.npy"][1]) if is_noise else 0.0)
            if apart > largest:
                largest, where = apart, f"{file} {name}".strip()
    print(f"the same verdicts, arrays at most {largest:.1e} of their norm apart ({where})")
    if largest > bound:
        sys.exit(f"more than {bound:.0e}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]), *sys.argv[4:])
