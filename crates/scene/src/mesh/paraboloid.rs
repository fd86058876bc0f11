//! The mesh of a paraboloid.

use super::shared::Mesh;
use crate::fault::{Fault, fault};
use glam::DVec3;

impl Mesh {
    /// A smooth open surface through the origin, z = −(k₁ x² + k₂ y²)/2 over |x|, |y| ≤ `half`, facing along z.
    ///
    /// `cells` × `cells` squares of two triangles, all cut along the same diagonal: inside, the triangles around a vertex lie
    /// point-symmetrically, and its normal by their areas is good to the square of a cell. Vertices lie on the surface.
    ///
    /// # Errors
    /// Curvatures outside ±10⁶, a half-width outside 10⁻⁹ to 10⁸, cells outside 1 to 2048.
    pub fn paraboloid(curvatures: [f64; 2], half: f64, cells: u32) -> Result<Self, Fault> {
        if !curvatures.iter().all(|k| (-1e6..=1e6).contains(k)) {
            return Err(fault(
                "curvatures",
                format!("{curvatures:?}"),
                "-1e6 to 1e6",
            ));
        }
        if !(1e-9..=1e8).contains(&half) {
            return Err(fault("half", format!("{half:?}"), "1e-9 to 1e8"));
        }
        if !(1..=2048).contains(&cells) {
            return Err(fault("cells", cells, "1 to 2048"));
        }
        let [k, l] = curvatures;
        let along = |i: u32| half * (2.0 * f64::from(i) / f64::from(cells) - 1.0);
        let mut vertices = Vec::new();
        for j in 0..=cells {
            let y = along(j);
            vertices.extend((0..=cells).map(|i| {
                let x = along(i);
                DVec3::new(x, y, -0.5 * (k * x * x + l * y * y))
            }));
        }
        let at = |i: u32, j: u32| j * (cells + 1) + i;
        let mut triangles = Vec::new();
        for j in 0..cells {
            for i in 0..cells {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Self::new(vertices, triangles)
    }
}
