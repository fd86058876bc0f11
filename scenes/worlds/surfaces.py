"""Smooth closed surfaces as triangles with normals: zeros of a field, and patches of two parameters. Lengths are metres.

A field is a function of points [n, 3] that is negative inside. Its zeros become triangles by surface nets (Gibson 1998): one vertex in each
cell of a grid that the surface goes through, moved onto the surface along the field's gradient, which gives the normal too.
"""
import numpy as np


def tube(points, blend):
    """A field around a curve through points (x, y, z, radius): a soft union of spheres along it, without kinks."""
    centers = spline(np.asarray(points, float), 0.6 * blend)
    steps = np.linalg.norm(np.diff(centers[:, :3], axis=0), axis=1)
    # Each sphere counts by its share of the way, so that the radius does not depend on how many there are.
    shares = (np.append(steps, steps[-1]) + np.append(steps[0], steps)) / 2 / (blend * np.sqrt(2 * np.pi))
    def field(p):
        total = np.zeros(len(p))
        for (x, y, z, radius), share in zip(centers, shares):
            away = np.sqrt((p[:, 0] - x) ** 2 + (p[:, 1] - y) ** 2 + (p[:, 2] - z) ** 2)
            total += share * np.exp(np.clip((radius - away) / blend, -300, 300))
        return -blend * np.log(total + 1e-300)
    return field


def spline(points, spacing):
    """Catmull and Rom's curve through points, at about equal steps."""
    padded = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    found = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:]):
        count = max(2, int(np.ceil(np.linalg.norm((c - b)[:3]) / spacing)))
        t = np.arange(count)[:, None] / count
        found.append(b + t * ((c - a) / 2 + t * (a - 2.5 * b + 2 * c - d / 2 + t * (1.5 * (b - c) + (d - a) / 2))))
    return np.vstack(found + [points[-1:]])


def union(fields, blend):
    """The soft union of fields: where they meet, they merge over about the width `blend`."""
    def field(p):
        least = np.array([f(p) for f in fields])
        lowest = least.min(0)
        return lowest - blend * np.log(np.exp((lowest - least) / blend).sum(0))
    return field


def gradient(field, p, step):
    """The gradient of a field, by central differences."""
    return np.stack([field(p + e) - field(p - e) for e in np.eye(3) * step], 1) / (2 * step)


def polygonise(field, low, high, cell):
    """Vertices, normals and triangles of a field's zeros within a box."""
    axes = [np.arange(a, b + cell, cell) for a, b in zip(low, high)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    values = np.concatenate([field(slab.reshape(-1, 3)) for slab in grid]).reshape(grid.shape[:3])
    inside = values < 0
    if inside[[0, -1]].any() or inside[:, [0, -1]].any() or inside[:, :, [0, -1]].any():
        raise ValueError("the surface leaves its box")
    cells = np.array(inside.shape) - 1
    sums, counts = np.zeros((*cells, 3)), np.zeros(cells)
    quads = []
    for axis in range(3):
        size = list(inside.shape)
        size[axis] -= 1
        at = np.argwhere(np.take(inside, range(size[axis]), axis) != np.take(inside, range(1, size[axis] + 1), axis))
        end = at + np.eye(3, dtype=int)[axis]
        a, b = values[tuple(at.T)], values[tuple(end.T)]
        crossing = grid[tuple(at.T)] + np.eye(3)[axis] * (cell * a / (a - b))[:, None]
        s, t = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
        around = [at - s - t, at - t, at, at - s]
        for corner in around:
            np.add.at(sums, tuple(corner.T), crossing)
            np.add.at(counts, tuple(corner.T), 1)
        quad = np.stack(around, 1)
        quads.append(np.where((a < 0)[:, None, None], quad, quad[:, ::-1]))
    is_met = counts > 0
    number = np.cumsum(is_met).reshape(is_met.shape) - 1
    p = sums[is_met] / counts[is_met][:, None]
    for _ in range(6):    # Newton's method along the gradient, never by more than half a cell
        g = gradient(field, p, 0.2 * cell)
        step = -g * (field(p) / (g**2).sum(1))[:, None]
        length = np.linalg.norm(step, axis=1, keepdims=True)
        p = p + step * np.minimum(1, 0.5 * cell / np.maximum(length, 1e-12))
    quads = number[tuple(np.moveaxis(np.vstack(quads), -1, 0))]
    return p, unit(gradient(field, p, 0.2 * cell)), halves(p, quads)


def halves(p, quads):
    """Two triangles of each quadrangle, cut along its shorter diagonal."""
    a, b, c, d = (p[quads[:, k]] for k in range(4))
    first = (np.linalg.norm(a - c, axis=1) <= np.linalg.norm(b - d, axis=1))[:, None, None]
    cuts = [quads[:, [[0, 1, 2], [0, 2, 3]]], quads[:, [[1, 2, 3], [1, 3, 0]]]]
    return np.where(first, *cuts).reshape(-1, 3)


def patch(of, counts, closed):
    """Vertices, normals, triangles and texture coordinates of a surface of two parameters in 0 to 1; `closed` says along which it comes back to its start."""
    u, v = (np.arange(n + 1) / n for n in counts)
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), -1).reshape(-1, 2)
    p = of(uv)
    step = 1e-4
    # One-sided at borders, where there is no surface beyond; on closed ways the parameter goes on.
    low = [np.where(c, uv[:, k] - step, np.maximum(uv[:, k] - step, 0)) for k, c in enumerate(closed)]
    high = [np.where(c, uv[:, k] + step, np.minimum(uv[:, k] + step, 1)) for k, c in enumerate(closed)]
    along = of(np.stack([high[0], uv[:, 1]], 1)) - of(np.stack([low[0], uv[:, 1]], 1))
    across = of(np.stack([uv[:, 0], high[1]], 1)) - of(np.stack([uv[:, 0], low[1]], 1))
    i, j = np.meshgrid(np.arange(counts[0]), np.arange(counts[1]), indexing="ij")
    at = (i * (counts[1] + 1) + j).ravel()
    quads = np.stack([at, at + counts[1] + 1, at + counts[1] + 2, at + 1], 1)
    return p, unit(np.cross(along, across)), halves(p, quads), uv


def unit(v):
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def write_ply(path, p, n, triangles, uv=None):
    """A binary PLY file with 32-bit floats."""
    columns, names = [p, n], ["x", "y", "z", "nx", "ny", "nz"]
    if uv is not None:
        columns, names = columns + [uv], names + ["u", "v"]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(p)}"]
    head += [f"property float {name}" for name in names]
    head += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    faces = np.empty(len(triangles), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"], faces["corners"] = 3, triangles
    path.write_bytes("\n".join(head).encode() + b"\n" + np.hstack(columns).astype("<f4").tobytes() + faces.tobytes())
    print(f"{path.name}: {len(p)} vertices, {len(triangles)} triangles, {path.stat().st_size / 1e6:.2f} MB")
