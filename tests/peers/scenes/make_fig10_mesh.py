"""Writes scenes/worlds/fig10_receiver.ply: the curved surface of scenes/fig10.ron as triangles with normals, by formulas of its own.

A ball of radius 2 m that faces (0.605186406, 0, -0.796083799) at (0, 0, 1), as far as 0.6 m from its axis there.

usage: make_fig10_mesh.py scenes/worlds/fig10_receiver.ply
"""
import struct, sys

import numpy as np

RADIUS, APERTURE, RINGS, SECTORS = 2.0, 0.6, 24, 96

facing = np.array([0.605186406, 0.0, -0.796083799])
facing /= np.linalg.norm(facing)
side = np.cross([0.0, 1.0, 0.0], facing)
side /= np.linalg.norm(side)
up = np.cross(facing, side)
center = np.array([0.0, 0.0, 1.0]) - RADIUS * facing

normals = [facing]
for ring in range(1, RINGS + 1):
    polar = np.arcsin(APERTURE / RADIUS) * ring / RINGS
    for turn in 2 * np.pi * np.arange(SECTORS) / SECTORS:
        across = np.cos(turn) * side + np.sin(turn) * up
        normals.append(np.cos(polar) * facing + np.sin(polar) * across)
normals = np.array(normals)
vertices = np.hstack([center + RADIUS * normals, normals]).astype("<f4")


def corner(ring, sector):
    return 1 + (ring - 1) * SECTORS + sector % SECTORS if ring else 0


faces = []
for ring in range(RINGS):
    for sector in range(SECTORS):
        outer = corner(ring + 1, sector), corner(ring + 1, sector + 1)
        faces.append((corner(ring, sector), *outer))
        if ring:
            faces.append((corner(ring, sector), outer[1], corner(ring, sector + 1)))

with open(sys.argv[1], "wb") as file:
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    file.write(
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
        f"element face {len(faces)}\nproperty list uchar uint vertex_indices\nend_header\n".encode()
    )
    file.write(vertices.tobytes())
    for face in faces:
        file.write(struct.pack("<B3I", 3, *face))
