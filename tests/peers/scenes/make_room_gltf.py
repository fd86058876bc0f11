"""Writes room.gltf: the buffer of a few meshes, and the JSON that names them. Its equal for Mitsuba is room_gltf.xml, by hand."""
import base64, json, math, pathlib, struct, zlib

BUFFER, VIEWS, ACCESSORS = bytearray(), [], []
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3"}


def view(data):
    while len(BUFFER) % 4:
        BUFFER.append(0)
    VIEWS.append({"buffer": 0, "byteOffset": len(BUFFER), "byteLength": len(data)})
    BUFFER.extend(data)
    return len(VIEWS) - 1


def accessor(rows, code, component):
    width = len(rows[0])
    data = b"".join(struct.pack(f"<{width}{code}", *row) for row in rows)
    made = {"bufferView": view(data), "componentType": component, "count": len(rows), "type": KINDS[width]}
    if width == 3:
        made |= {"min": [min(c) for c in zip(*rows)], "max": [max(c) for c in zip(*rows)]}
    ACCESSORS.append(made)
    return len(ACCESSORS) - 1


def png(rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    h, w = len(rows), len(rows[0])
    raw = b"".join(b"\0" + b"".join(bytes(p) for p in row) for row in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


def primitive(places, corners, material, normals=None, uvs=None):
    made = {"attributes": {"POSITION": accessor(places, "f", 5126)}, "indices": accessor([[i] for i in corners], "H", 5123), "material": material}
    if normals:
        made["attributes"]["NORMAL"] = accessor(normals, "f", 5126)
    if uvs:
        made["attributes"]["TEXCOORD_0"] = accessor(uvs, "f", 5126)
    return {"primitives": [made]}


def ball(n=12):
    """A sphere of triangles, with normals."""
    places = []
    for i in range(n + 1):
        for j in range(2 * n + 1):
            theta, phi = math.pi * i / n, math.pi * j / n
            places.append([math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi)])
    corners = []
    for i in range(n):
        for j in range(2 * n):
            a, b = i * (2 * n + 1) + j, (i + 1) * (2 * n + 1) + j
            corners += [a, b, b + 1, a, b + 1, a + 1]
    return places, corners


# Facing Z, u to the right, v down: the first row of the picture is at the top.
SQUARE = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
UVS = [[0, 1], [1, 1], [1, 0], [0, 0]]
MATTE = {"KHR_materials_specular": {"specularFactor": 0}}
places, corners = ball()
# A wedge of three faces, lopsided, so that a mirror shows.
WEDGE = [[0, 0, 0], [1, 0, 0], [0, 0.6, 0], [0, 0, 1.4]]
WEDGE_CORNERS = [0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3]
LEVELS = [[(255, 20, 60), (90, 90, 90), (200, 190, 40), (10, 60, 240)], [(30, 120, 30), (250, 250, 250), (128, 0, 128), (60, 60, 60)],
          [(188, 188, 188), (5, 5, 5), (240, 120, 0), (0, 160, 160)]]
half = math.sqrt(0.5)
file = {
    "asset": {"version": "2.0"},
    "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_specular", "KHR_materials_emissive_strength", "KHR_texture_transform"],
    "scene": 0,
    "scenes": [{"nodes": [0, 1, 2, 3, 4, 5, 6, 8, 9]}],
    "nodes": [
        {"name": "floor", "mesh": 0, "rotation": [-half, 0, 0, half], "scale": [3, 3, 3]},
        {"name": "wall", "mesh": 1, "translation": [0, 1.5, -3], "scale": [3, 1.5, 1]},
        {"name": "lamp", "mesh": 2, "matrix": [0.6, 0, 0, 0, 0, 0, 0.5, 0, 0, -1, 0, 0, 0.5, 2.6, 0.2, 1]},
        {"name": "ball", "mesh": 3, "translation": [-1.1, 0.8, -0.6], "scale": [0.8, 0.8, 0.8]},
        {"name": "wedge", "mesh": 4, "translation": [0.6, 0.01, 0.3]},
        {"name": "mirrored", "mesh": 4, "translation": [0.3, 0.01, -1.6], "scale": [-1, 1.5, 1]},
        {"name": "arm", "translation": [0, 1.4, 4.6], "rotation": [0, math.sin(0.1), 0, math.cos(0.1)], "children": [7]},
        {"name": "eye", "camera": 0, "rotation": [math.sin(-0.08), 0, 0, math.cos(-0.08)], "scale": [2, 2, 2]},
        {"name": "bulb", "translation": [-1.5, 1.8, 1.5], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"name": "sun", "rotation": [-half, 0, 0, half], "extensions": {"KHR_lights_punctual": {"light": 1}}},
    ],
    "meshes": [
        primitive(SQUARE, [0, 1, 2, 0, 2, 3], 0),
        primitive(SQUARE, [0, 1, 2, 0, 2, 3], 1, uvs=UVS),
        primitive(SQUARE, [0, 1, 2, 0, 2, 3], 2),
        primitive(places, corners, 3, normals=places),
        primitive(WEDGE, WEDGE_CORNERS, 4),
    ],
    "materials": [
        {"pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.5, 0.4, 1], "metallicFactor": 0}, "extensions": MATTE},
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [1, 0.8], "offset": [0.1, 0.1]}}},
                                  "metallicFactor": 0}, "extensions": MATTE},
        {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}, "emissiveFactor": [1, 0.8, 0.5],
         "extensions": MATTE | {"KHR_materials_emissive_strength": {"emissiveStrength": 9}}},
        {"pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0.4}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.5, 0.7, 1], "metallicFactor": 0}, "extensions": MATTE},
    ],
    "textures": [{"source": 0, "sampler": 0}],
    "samplers": [{"wrapS": 33071, "wrapT": 33071}],
    "images": [{"mimeType": "image/png", "bufferView": view(png(LEVELS))}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1.3333333, "znear": 0.01}}],
    "extensions": {"KHR_lights_punctual": {"lights": [
        {"type": "point", "intensity": 2.5, "color": [0.9, 1, 0.8]},
        {"type": "directional", "intensity": 0.4},
    ]}},
}
file |= {"bufferViews": VIEWS, "accessors": ACCESSORS,
         "buffers": [{"byteLength": len(BUFFER), "uri": "data:application/octet-stream;base64," + base64.b64encode(BUFFER).decode()}]}
here = pathlib.Path(__file__).parent
(here / "room.gltf").write_text(json.dumps(file, indent=1) + "\n")
(here / "room_gltf.png").write_bytes(png(LEVELS))
with open(here / "room_ball.obj", "w") as out:
    out.writelines(f"v {x:.9g} {y:.9g} {z:.9g}\nvn {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in places)
    out.writelines("f " + " ".join(f"{k + 1}//{k + 1}" for k in corners[i:i + 3]) + "\n" for i in range(0, len(corners), 3))
