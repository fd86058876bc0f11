//! Converts smooth surfaces to fine meshes, because Mitsuba has whole spheres and cylinders, but no
//! pieces of spheres or cylinders around a vertex.

use etendue_field::Patch;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Minimum and maximum number of rings of triangles.
const RINGS: [usize; 2] = [16, 256];
/// Maximum distance of the triangles from the surface, relative to the aperture. The distance is
/// larger for patches that already have the maximum number of rings.
const NEAR: f64 = 1e-5;
/// The number of corners of ring i, divided by i. With 6 corners, the length of triangles at the
/// edge is about equal to their width, because 2π/6 ≈ 1.
const SECTORS: usize = 6;
/// The number of corners of the edge of a flat patch. The edge deviates from a circle by
/// (π/512)²/2 = 2·10⁻⁵ of its radius.
const EDGE: usize = 512;

/// A patch as triangles.
#[derive(Debug)]
pub(super) struct PatchMesh {
    pub(super) vertices: Vec<MeshVertex>,
    /// Triangles, counterclockwise seen from the front of the patch.
    pub(super) faces: Vec<[u32; 3]>,
    /// Maximum distance of the triangles from the patch, in metres.
    pub(super) error: f64,
}

/// A vertex of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshVertex {
    pub(super) point: DVec3,
    /// Unit normal.
    pub(super) normal: DVec3,
    /// Texture coordinates.
    pub(super) uv: DVec2,
}

/// The mesh of a patch; its texture coordinates are (s, t).
pub(super) fn mesh(patch: &Patch) -> PatchMesh {
    if patch.curvature.iter().all(|k| *k == 0.0) {
        return rings(patch, 1, EDGE);
    }
    let [mut count, most] = RINGS;
    loop {
        let mesh = rings(patch, count, (SECTORS * count).max(EDGE));
        if mesh.error <= NEAR * patch.aperture || count >= most {
            return mesh;
        }
        count *= 2;
    }
}

/// The centre of the patch, and rings of corners around this centre.
fn rings(patch: &Patch, rings: usize, sectors: usize) -> PatchMesh {
    let vertex = |r: f64, turn: f64| {
        let (sin, cos) = libm::sincos(TAU * turn);
        let uv = DVec2::new(r * cos, r * sin);
        let point = patch.point(uv.x, uv.y);
        let normal = patch.normal(point);
        MeshVertex { point, normal, uv }
    };
    // A hemisphere is steep at its edge. Rings are closer together near the edge, because they are
    // evenly spaced on the sphere.
    let steep = (patch.aperture * patch.curvature[2].abs()).min(1.0);
    let radius = |share: f64| {
        if steep > 0.0 {
            patch.aperture * libm::sin(share * libm::asin(steep)) / steep
        } else {
            patch.aperture * share
        }
    };
    let mut vertices = vec![vertex(0.0, 0.0)];
    for ring in 1..=rings {
        let r = if ring == rings {
            patch.aperture
        } else {
            radius(ring as f64 / rings as f64)
        };
        vertices.extend((0..sectors).map(|sector| vertex(r, sector as f64 / sectors as f64)));
    }
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a patch has at most some 200,000 corners"
    )]
    let corner = |ring: usize, sector: usize| match ring {
        0 => 0,
        _ => (1 + (ring - 1) * sectors + sector % sectors) as u32,
    };
    let mut faces = Vec::new();
    for sector in 0..sectors {
        for ring in 0..rings {
            let [a, b] = [corner(ring, sector), corner(ring, sector + 1)];
            let [c, d] = [corner(ring + 1, sector), corner(ring + 1, sector + 1)];
            faces.push([a, c, d]);
            if ring > 0 {
                faces.push([a, d, b]);
            }
        }
    }
    let error = faces
        .iter()
        .map(|face| off(patch, face.map(|i| vertices[i as usize].point)));
    let error = error.fold(0.0, f64::max);
    PatchMesh {
        vertices,
        faces,
        error,
    }
}

/// The distance between a triangle and the patch, to first order. The distance is evaluated
/// at the centre of the triangle and at the midpoints of its sides.
fn off(patch: &Patch, [a, b, c]: [DVec3; 3]) -> f64 {
    let middles = [
        (a + b + c) / 3.0,
        (a + b) / 2.0,
        (b + c) / 2.0,
        (c + a) / 2.0,
    ];
    let distance = |point: DVec3| {
        let local = patch.frame.to_local(point);
        0.5 * patch.value(local).abs() / patch.gradient(local).length()
    };
    middles.map(distance).into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::Frame;

    fn patch(curvature: [f64; 3], aperture: f64) -> Patch {
        let frame = Frame::new(
            DVec3::new(0.1, -0.2, 1.0),
            DVec3::new(0.6, 0.1, -0.8),
            DVec3::Y,
        );
        Patch {
            frame: frame.unwrap(),
            curvature,
            aperture,
        }
    }

    #[test]
    fn triangles_face_as_the_patch_and_lie_on_it() {
        for (curvature, aperture) in [
            ([0.5; 3], 0.6),
            ([-0.5, 0.0, -0.5], 0.9),
            ([-0.6, 0.4, 0.0], 0.6),
            ([0.0; 3], 1.2),
        ] {
            let patch = patch(curvature, aperture);
            let mesh = mesh(&patch);
            assert!(
                mesh.error <= NEAR * aperture,
                "{curvature:?}: {}",
                mesh.error
            );
            for face in &mesh.faces {
                let [a, b, c] = face.map(|i| mesh.vertices[i as usize]);
                let wound = (b.point - a.point).cross(c.point - a.point);
                assert!(wound.dot(a.normal) > 0.0 && wound.dot(patch.frame.d) > 0.0);
            }
            let widest = mesh
                .vertices
                .iter()
                .map(|v| v.uv.length())
                .fold(0.0, f64::max);
            assert!((widest - aperture).abs() < 1e-12); // rounding
            for vertex in &mesh.vertices {
                let local = patch.frame.to_local(vertex.point);
                assert!((local.truncate() - vertex.uv).length() < 1e-12); // rounding
            }
        }
    }

    /// At the vertical edge of a hemisphere, triangles are as accurate as elsewhere.
    #[test]
    fn half_a_ball_is_met_as_well() {
        let mesh = mesh(&patch([10.0 / 3.0; 3], 0.3));
        assert!(mesh.error < 5e-5 * 0.3, "{}", mesh.error);
    }
}
