"""Rays per second on a mesh of a million triangles: Étendue against Mitsuba 3, and whether both meet the same places.

usage: rays_per_second.py PROGRAM [ROUNDS] [TRIANGLES] [RAYS]      e.g. rays_per_second.py target/release/examples/rays_per_second 7

PROGRAM is the example `rays_per_second` of etendue-paths. Needs numpy and mitsuba, and LLVM (DRJIT_LIBLLVM_PATH). One thread each, rounds
alternate, and seconds are those of the processor, so that a busy machine matters less.

Two meshes, made here: a bumpy ball seen from outside, and a room with bumpy walls and balls in it, seen from inside. Three kinds of rays: from a
camera, row by row; from where these arrive on, by the cosine (as paths go); and from there to a square light, which ask only whether the way is free.
"""
import os, pathlib, statistics, subprocess, sys, tempfile, time

import mitsuba as mi, numpy as np

mi.set_variant("llvm_ad_mono")
import drjit as dr

SAME = 1e-4  # of the distance: f32 places points of a mesh of size 1 by 1e-7, and a ray along a surface magnifies that
SINGLE = 20_000  # rays that the scalar variant is asked for, one by one


def bumps(p):
    """How far a place on a unit sphere is moved: waves of five lengths."""
    waves = [(4, 0.06), (9, 0.03), (19, 0.015), (41, 0.007), (83, 0.003)]
    return sum(a * np.sin(k * p[:, 0] + 1.3 * k) * np.sin(k * p[:, 1] - 0.7 * k) * np.sin(k * p[:, 2] + k) for k, a in waves)


def cube(n):
    """The faces of a cube from -1 to 1 as n x n squares each: vertices and triangles, which face out."""
    s = np.linspace(-1, 1, n + 1)
    u, v = (x.ravel() for x in np.meshgrid(s, s, indexing="ij"))
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a, b, c, d = i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1
    face = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    vertices, triangles = [], []
    for axis in range(3):
        for side in (-1, 1):
            p = np.empty((len(u), 3))
            p[:, axis], p[:, (axis + 1) % 3], p[:, (axis + 2) % 3] = side, u, v
            triangles.append((face if side > 0 else face[:, ::-1]) + len(vertices) * len(u))
            vertices.append(p)
    return np.concatenate(vertices), np.concatenate(triangles)


def ball(count):
    vertices, triangles = cube(round((count / 12) ** 0.5))
    on_sphere = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    return on_sphere * (1 + bumps(on_sphere))[:, None], triangles


def room(count):
    """Half of the triangles are the walls, the others twelve balls of several sizes."""
    vertices, triangles = cube(round((count / 24) ** 0.5))
    parts = [(3 * vertices * (1 + 0.3 * bumps(vertices))[:, None], triangles[:, ::-1])]
    rng = np.random.default_rng(3)
    for _ in range(12):
        p, t = ball(count // 24)
        parts.append((p * rng.uniform(0.3, 0.7) + rng.uniform(-2, 2, 3), t))
    starts = np.cumsum([0] + [len(p) for p, _ in parts])
    return np.concatenate([p for p, _ in parts]), np.concatenate([t + start for (_, t), start in zip(parts, starts)])


CASES = {"ball": (ball, [0.3, -2.6, 1.4], [0, 0, 0], 0.5, [4, -3, 5]), "room": (room, [2.6, -2.6, 2.4], [-1, 0.8, -0.7], 1.0, [0, 0, 2.5])}


def write_ply(path, vertices, triangles):
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    faces = np.empty(len(triangles), [("n", "u1"), ("corners", "<i4", 3)])
    faces["n"], faces["corners"] = 3, triangles
    path.write_bytes(head.encode() + vertices.astype("<f4").tobytes() + faces.tobytes())


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def camera(eye, target, half, side):
    """Rays of a square picture, row by row: [rays, (origin, direction, end)]."""
    z = unit(np.subtract(target, eye))
    x = unit(np.cross(z, [0, 0, 1]))
    y = np.cross(x, z)
    s = half * ((np.arange(side) + 0.5) / side * 2 - 1)
    v, u = (a.ravel() for a in np.meshgrid(-s, s, indexing="ij"))
    return rays(np.broadcast_to(eye, (side**2, 3)), unit(z + u[:, None] * x + v[:, None] * y), np.inf)


def rays(origins, directions, ends):
    all = np.empty((len(origins), 7), np.float32)
    all[:, :3], all[:, 3:6], all[:, 6] = origins, directions, ends
    return all


def onward(seen, t, normals, light):
    """Rays from where `seen` arrive: by the cosine about the normal, and to a square light."""
    hit = np.isfinite(t)
    seen, t, normals = seen[hit].astype(float), t[hit, None], normals[hit].astype(float)
    normals *= -np.sign(np.sum(normals * seen[:, 3:6], 1, keepdims=True))
    origins = seen[:, :3] + t * seen[:, 3:6] + 1e-4 * normals
    rng = np.random.default_rng(1)
    # A point of a unit sphere on the tip of the normal: the direction to it is distributed as the cosine.
    bounced = unit(normals + 0.999999 * unit(rng.normal(size=normals.shape)))
    to = np.asarray(light) + rng.uniform(-0.5, 0.5, normals.shape) * [1, 1, 0] - origins
    distance = np.linalg.norm(to, axis=1)
    return rays(origins, bounced, np.inf), rays(origins, to / distance[:, None], distance)


class Mitsuba:
    """The LLVM variant: all rays at once."""

    def __init__(self, ply):
        self.mesh = mi.load_dict({"type": "ply", "filename": str(ply)})
        self.build()
        self.sets = {}

    def build(self):
        start = time.process_time()
        self.scene = mi.load_dict({"type": "scene", "mesh": self.mesh})
        dr.sync_thread()
        return time.process_time() - start

    def load(self, name, all):
        o, d, end = all[:, :3].T.copy(), all[:, 3:6].T.copy(), all[:, 6].copy()
        ray = mi.Ray3f(mi.Point3f(o), mi.Vector3f(d))
        ray.maxt = mi.Float(end)
        dr.eval(ray)
        self.sets[name] = ray

    def trace(self, name, kind):
        """Processor seconds, and distances (of rays that ask only: 0 if something is met)."""
        ray, coherent = self.sets[name], name == "camera"
        start = time.process_time()
        if kind == "free":
            found = self.scene.ray_test(ray, coherent=coherent)
        else:
            found = self.scene.ray_intersect_preliminary(ray, coherent=coherent)
            found = dr.select(found.is_valid(), found.t, dr.inf)
        dr.eval(found)
        dr.sync_thread()
        seconds = time.process_time() - start
        return seconds, np.where(np.array(found), 0.0, np.inf) if kind == "free" else np.array(found)

    def normals(self, name):
        return np.array(self.scene.ray_intersect(self.sets[name]).n).T


class Scalar:
    """The scalar variant, asked from Python: what a call takes that meets nothing is taken off."""

    def __init__(self, ply):
        mi.set_variant("scalar_rgb")
        self.scene = mi.load_dict({"type": "scene", "mesh": {"type": "ply", "filename": str(ply)}})
        self.sets = {}
        mi.set_variant("llvm_ad_mono")

    def load(self, name, all):
        mi.set_variant("scalar_rgb")
        chosen = all[:: max(1, len(all) // SINGLE)].tolist()
        far = [[1e3, 1e3, 1e3, 1, 0, 0, row[6]] for row in chosen]
        self.sets[name] = [[mi.Ray3f(r[:3], r[3:6], r[6], 0, []) for r in rows] for rows in (chosen, far)]
        mi.set_variant("llvm_ad_mono")

    def trace(self, name, kind):
        ask = self.scene.ray_test if kind == "free" else self.scene.ray_intersect_preliminary
        seconds = []
        for rows in self.sets[name]:
            start = time.process_time()
            for ray in rows:
                ask(ray)
            seconds.append(time.process_time() - start)
        return (seconds[0] - seconds[1]) / len(self.sets[name][0])


class Etendue:
    def __init__(self, program, ply):
        environment = dict(os.environ, RAYON_NUM_THREADS="1")
        self.process = subprocess.Popen([program, ply], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
        self.bytes = float(self.ask("build").split()[1])  # later ones find memory that is there already
        self.files = {}

    def ask(self, line):
        print(line, file=self.process.stdin, flush=True)
        return self.process.stdout.readline()

    def build(self):
        return float(self.ask("build").split()[0])

    def load(self, path, all):
        all.tofile(path)
        self.files[path.name] = path

    def trace(self, name, kind):
        path = self.files[name]
        seconds = float(self.ask(f"{kind} {path}"))
        return seconds, np.fromfile(f"{path}.met", "<f8")


def agree(mine, theirs, kind):
    """The share of rays on which both find the same: the distance, or whether there is anything."""
    if kind == "free":
        return np.mean(mine == theirs)
    both = np.isinf(mine) & np.isinf(theirs)
    with np.errstate(invalid="ignore"):
        return np.mean(both | (np.abs(mine - theirs) <= SAME * theirs))


def case(name, program, rounds, triangles, side, folder):
    make, eye, target, half, light = CASES[name]
    vertices, corners = make(triangles)
    ply = folder / f"{name}.ply"
    write_ply(ply, vertices, corners)
    llvm, scalar, ours = Mitsuba(ply), Scalar(ply), Etendue(program, ply)
    sets = {"camera": camera(eye, target, half, side)}
    llvm.load("camera", sets["camera"])
    _, t = llvm.trace("camera", "first")
    sets["bounce"], sets["shadow"] = onward(sets["camera"], t, llvm.normals("camera"), light)
    for kind, all in sets.items():
        llvm.load(kind, all), scalar.load(kind, all), ours.load(folder / kind, all)
    build = [[contender.build() for contender in (ours, llvm)] for _ in range(rounds)]
    mine, theirs = (statistics.median(column) for column in zip(*build))
    print(f"\n{name}, {len(corners)} triangles: building {mine:.2f} s, Mitsuba {theirs:.2f} s, ratio of speeds {statistics.median(b / a for a, b in build):.2f};", end=" ")
    print(f"{len(corners) / mine / 1e6:.2f} and {len(corners) / theirs / 1e6:.2f} M triangles a second; {ours.bytes / len(corners):.0f} bytes a triangle")
    for rays_of, all in sets.items():
        kind = "free" if rays_of == "shadow" else "first"
        llvm.trace(rays_of, kind), ours.trace(rays_of, kind)  # compiles
        seconds = []
        for _ in range(rounds):
            (a, met), (b, expected) = ours.trace(rays_of, kind), llvm.trace(rays_of, kind)
            seconds.append([a / len(all), b / len(all), scalar.trace(rays_of, kind)])
        a, b, c = (1e-6 / statistics.median(column) for column in zip(*seconds))
        to_llvm, to_scalar = (statistics.median(row[i] / row[0] for row in seconds) for i in (1, 2))
        print(f"{rays_of:7} {len(all):8} rays, M a second: Étendue {a:5.2f}, Mitsuba LLVM {b:5.2f}, scalar {c:5.2f};", end=" ")
        print(f"ratio to LLVM {to_llvm:.2f}, to scalar {to_scalar:.2f}; hits {np.mean(np.isfinite(expected)):.3f}, agree {agree(met, expected, kind):.6f}", flush=True)


def main(program, rounds=7, triangles=1_000_000, rays=1 << 20):
    dr.set_thread_count(1)
    with tempfile.TemporaryDirectory() as folder:
        for name in CASES:
            case(name, program, int(rounds), int(triangles), int(int(rays) ** 0.5), pathlib.Path(folder))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
