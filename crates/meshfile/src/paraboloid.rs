//! Generates the mesh of a paraboloid.

use crate::fault::Fault;
use crate::mesh::Mesh;
use glam::DVec3;

impl Mesh {
    /// A smooth open surface through the origin, z = −(k₁ x² + k₂ y²)/2 over |x|, |y| ≤
    /// `half`, facing along z.
    ///
    /// The mesh has `cells` × `cells` squares, each cut into two triangles along the same
    /// diagonal. The triangles around an inner vertex are point-symmetric, so the error of the
    /// area-weighted normal is proportional to the square of the cell size. All vertices lie
    /// exactly on the paraboloid.
    ///
    /// # Errors
    /// When [`Self::new`] refuses the mesh, for example without cells or with vertices that are not
    /// finite.
    pub fn paraboloid(curvatures: [f64; 2], half: f64, cells: u32) -> Result<Self, Fault> {
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
