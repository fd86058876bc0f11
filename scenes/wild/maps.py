"""Makes the environment maps of this folder: small_map.exr and big_map.exr (EXR, one channel Y, ZIP)."""

import math
import random
import struct
import zlib


def attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def exr(path, rows):
    """Writes rows of numbers, top first, as half floats, 16 lines to a block."""
    width, height = len(rows[0]), len(rows)
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channel = b"Y\0" + struct.pack("<iB3xii", 1, 0, 1, 1) + b"\0"
    head = struct.pack("<ii", 20000630, 2)
    head += attribute("channels", "chlist", channel)
    head += attribute("compression", "compression", b"\x03")
    head += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box)
    head += attribute("lineOrder", "lineOrder", b"\0")
    head += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    head += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    blocks = []
    for y in range(0, height, 16):
        raw = b"".join(struct.pack(f"<{width}e", *row) for row in rows[y:y + 16])
        # EXR's predictor: even bytes, then odd ones, as differences around 128.
        parts = raw[0::2] + raw[1::2]
        steps = (128 + b - a for a, b in zip(parts, parts[1:]))
        packed = zlib.compress(parts[:1] + bytes(d & 255 for d in steps), 9)
        data = packed if len(packed) < len(raw) else raw
        blocks.append(struct.pack("<ii", y, len(data)) + data)
    at = len(head) + 8 * len(blocks)
    offsets = []
    for block in blocks:
        offsets.append(at)
        at += len(block)
    with open(path, "wb") as file:
        file.write(head + struct.pack(f"<{len(offsets)}Q", *offsets) + b"".join(blocks))


def small():
    """Dark pixels, and one in four a hundred times as bright."""
    draw = random.Random(1)
    return [[10.0 if draw.random() < 0.25 else 0.1 for _ in range(16)] for _ in range(8)]


def big():
    """A sky that is brighter below, with a slow wave around it, in steps of 1/256, and a sun of 1.5 degrees."""
    sun = (0.25, 0.2, 1.0)
    size = math.sqrt(sum(a * a for a in sun))
    rows = []
    for j in range(512):
        latitude = math.pi * (0.5 - (j + 0.5) / 512)
        row = []
        for i in range(1024):
            longitude = 2 * math.pi * (0.5 - (i + 0.5) / 1024)
            to = (math.cos(latitude) * math.sin(longitude), math.sin(latitude),
                  math.cos(latitude) * math.cos(longitude))
            sky = 0.6 - 0.3 * to[1] + 0.1 * math.sin(3 * longitude) * math.cos(latitude)
            angle = math.acos(max(-1.0, min(1.0, sum(a * b for a, b in zip(to, sun)) / size)))
            row.append(round(256 * sky) / 256 + (200.0 if angle < math.radians(0.75) else 0.0))
        rows.append(row)
    return rows


if __name__ == "__main__":
    exr("small_map.exr", small())
    exr("big_map.exr", big())
