//! Generates the mesh of a sphere with a relief.

use crate::fault::{Fault, fault};
use crate::mesh::Mesh;
use glam::DVec3;
use std::f64::consts::PI;

impl Mesh {
    /// A smooth, closed, star-shaped surface around the origin, which has lobes around the
    /// z axis. The surface is a sphere plus a sectoral harmonic. The radius of the surface is r(θ,
    /// φ) = `radius` · (1 + `relief` · sinˡθ · cos lφ) with l = `lobes`.
    ///
    /// The angle θ steps through `rings` bands, and the angle φ steps through 2 `rings` segments.
    /// Each pole is one vertex and no vertex is doubled at φ = 0, so the surface is watertight.
    /// The mesh has 2 `rings`(`rings` − 1) + 2 vertices and 4 `rings`(`rings` − 1) triangles (50
    /// 624 for 113 rings), which face outward. Vertices lie on the smooth surface, whose volume
    /// for l ≥ 1 is R³(4π/3 + 2π relief² (2l)!!/(2l+1)!!). The volume of the mesh is smaller than
    /// the volume of the smooth surface, by an amount proportional to rings⁻².
    ///
    /// # Errors
    /// When there are fewer than four segments per lobe, or when [`Self::new`] refuses
    /// the mesh.
    ///
    /// # Panics
    /// With fewer than two rings.
    pub fn star(radius: f64, relief: f64, lobes: u32, rings: u32) -> Result<Self, Fault> {
        assert!(rings > 1, "a star with {rings} rings");
        if lobes > rings / 2 {
            let allowed = format!("0 to {}, half the rings", rings / 2);
            return Err(fault("lobes", lobes, allowed));
        }
        let lobe = f64::from(lobes);
        let point = |theta: f64, phi: f64| {
            let r =
                radius * (1.0 + relief * libm::pow(libm::sin(theta), lobe) * libm::cos(lobe * phi));
            let (sin, cos) = libm::sincos(theta);
            r * DVec3::new(sin * libm::cos(phi), sin * libm::sin(phi), cos)
        };
        let segments = 2 * rings;
        let step = PI / f64::from(rings);
        // sin π is not exactly zero in f64, so the poles are set explicitly. The poles have a
        // relief only for l = 0.
        let pole = point(0.0, 0.0).z;
        let mut vertices = vec![DVec3::new(0.0, 0.0, pole)];
        for ring in 1..rings {
            let theta = f64::from(ring) * step;
            vertices.extend((0..segments).map(|s| point(theta, f64::from(s) * step)));
        }
        vertices.push(DVec3::new(0.0, 0.0, -pole));
        Self::new(vertices, triangles(rings, segments))
    }
}

/// The triangles of the caps about the two poles, and two triangles for each cell between
/// the caps.
fn triangles(rings: u32, segments: u32) -> Vec<[u32; 3]> {
    let at = |ring: u32, segment: u32| 1 + (ring - 1) * segments + segment % segments;
    let (north, south) = (0, at(rings, 0));
    let mut triangles = Vec::new();
    for s in 0..segments {
        triangles.push([north, at(1, s), at(1, s + 1)]);
    }
    for ring in 1..rings - 1 {
        for s in 0..segments {
            let (a, b) = (at(ring, s), at(ring, s + 1));
            let (c, d) = (at(ring + 1, s), at(ring + 1, s + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    for s in 0..segments {
        triangles.push([south, at(rings - 1, s + 1), at(rings - 1, s)]);
    }
    triangles
}
