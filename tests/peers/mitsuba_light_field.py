"""The light fields of a scene recorded with Mitsuba 3, against those that Étendue's photons measured: docs/mitsuba.md.

usage: mitsuba_light_field.py EXPORTED MEASURED [--planes NAMES] [--rays N] [--seed S] [--fault FAULT]

    etendue export --to mitsuba SCENE.ron --out EXPORTED     scene.xml and planes.json
    etendue measure SCENE.ron --out MEASURED                 PLANE/batches.npz for each plane
"""
import argparse, json, pathlib, re, sys, zlib

import mitsuba as mi, numpy as np

mi.set_variant("llvm_ad_mono")
import etendue_bsdfs
from mitsuba_photons import Photons
from mitsuba_planes import Plane, World
from mitsuba_rays import Rays
from slices import judge

ALPHA = 0.01


def scaled(names, change):
    """Changes each number of these names in a scene file."""
    pattern = re.compile(rf'(name="(?:{names})" value=")([^"]+)(")')
    return lambda text: pattern.sub(lambda m: f"{m[1]}{change(float(m[2]))!r}{m[3]}", text)


# Planted in the exported file, to see that they are seen.
FAULTS = {
    "roughness squared": scaled("alpha", lambda a: a * a),
    "roughness 5 % higher": scaled("alpha", lambda a: 1.05 * a),
    "exponent 5 % higher": scaled("exponent", lambda n: 1.05 * n),
    "albedo 2 % higher": scaled("reflectance|specular_reflectance", lambda a: 1.02 * a),
    "index 2 % higher": scaled("n|eta|int_ior", lambda n: 1.02 * n),
    "k 5 % higher": scaled("k", lambda k: 1.05 * k),
    "no metal": lambda text: re.sub(r'<spectrum name="eta".*?/><spectrum name="k".*?/>', '<string name="material" value="none"/>', text),
    "the other distribution": lambda text: re.sub(
        'value="(ggx|beckmann)"', lambda m: 'value="beckmann"' if m[1] == "ggx" else 'value="ggx"', text),
    "pattern moved by a twentieth": lambda text: re.sub(
        r'(name="to_uv">.*?<translate x=")([^"]+)', lambda m: f"{m[1]}{float(m[2]) + 0.05!r}", text),
    "pattern along the other axis": lambda text: text.replace('name="to_uv">', 'name="to_uv"><rotate angle="90"/>'),
    "map turned by a degree": lambda text: re.sub(
        r'(type="envmap".*?<transform name="to_world">)', r'\1<rotate y="1" angle="1"/>', text),
    "map mirrored": lambda text: re.sub(r'(type="envmap".*?<transform name="to_world">)', r'\1<scale x="-1"/>', text),
    "flat triangles": lambda text: re.sub(r'(smooth_\d+\.ply"/>)', r'\1<boolean name="face_normals" value="true"/>', text),
}


def load(folder, fault):
    """The scene, with a fault if there is one."""
    path = folder / "scene.xml"
    if fault is not None:
        text = path.read_text(encoding="utf-8")
        faulty = FAULTS[fault](text)
        if faulty == text:
            sys.exit(f"nothing in {path} can have this fault: {fault}")
        path = folder / "faulty.xml"
        path.write_text(faulty, encoding="utf-8")
    # Not optimized: shapes of one material would become one shape.
    scene = mi.load_file(str(path), optimize=False)
    if fault is not None:
        path.unlink()
    return scene


def recorder(world, planes):
    """A function of random numbers and a number of rays to slices and lit rays of each plane, and the planes it records."""
    light, = world.scene.emitters()
    kind = light.class_name()
    if kind in ("Projector", "DirectionalArea"):
        return Photons(world, planes).batch, planes
    if kind == "PointLight":
        for plane in planes:
            if plane.leg == 0:
                print(f"{plane.name:24} no ray hits a point light")
        planes = [plane for plane in planes if plane.leg > 0]
    each = [Rays(world, plane) for plane in planes]
    return lambda rng, n: [one.slices(rng, n) for one in each], planes


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("exported", type=pathlib.Path, help="folder with scene.xml and planes.json")
    parser.add_argument("measured", type=pathlib.Path, help="folder with PLANE/batches.npz")
    parser.add_argument("--planes", help="names, separated by commas; all planes unless given")
    parser.add_argument("--rays", type=float, default=4e6, help="rays for each plane; 4e6 unless given")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--fault", choices=FAULTS, help="planted in what Mitsuba loads: " + ", ".join(FAULTS).replace("%", "%%"), metavar="FAULT")
    asked = parser.parse_args()
    exported = json.loads((asked.exported / "planes.json").read_text(encoding="utf-8"))
    written = exported["planes"]
    length = max(plane["distance"] for plane in written)
    if asked.planes:
        names = asked.planes.split(",")
        if unknown := set(names) - {plane["name"] for plane in written}:
            parser.error(f"no such plane: {', '.join(sorted(unknown))}")
        written = [plane for plane in written if plane["name"] in names]
    world = World(load(asked.exported, asked.fault))
    record, planes = recorder(world, [Plane(plane, world, length) for plane in written])
    measured = {}
    for plane in planes:
        measured[plane.name] = np.load(asked.measured / plane.name / "batches.npz")["slices"]
        grid = plane.grid
        if measured[plane.name].shape[1:] != (grid["azimuths"], grid["rho"]["half"] + 1, 2 * grid["nu"]["half"] + 1):
            parser.error(f"{plane.name}: measured on other frequencies than exported")
    batches = min(len(slices) for slices in measured.values())
    size = max(1, int(asked.rays) // batches)
    rng = np.random.default_rng([asked.seed, zlib.crc32(exported["scene"].encode())])
    recorded = [record(rng, size) for _ in range(batches)]
    level = 1 - (1 - ALPHA) ** (1 / len(planes))
    print(f"{'plane':24} {'rays':>9} {'with light':>10} {'difference':>10} {'noise':>8} {'p':>7}   level {level:.5f}")
    passed = True
    for i, plane in enumerate(planes):
        slices, lit = zip(*(batch[i] for batch in recorded))
        difference, noise, p = judge(np.array(slices), measured[plane.name][:batches], rng)
        passed &= p >= level
        print(f"{plane.name:24} {size * batches:9} {sum(lit):10} {difference:10.2e} {noise:8.1e} {p:7.4f}", flush=True)
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
