//! Estimates the curvatures of a mesh.

use crate::scene::{Hit, MeshObject};
use etendue_field::{Frame, Patch};
use glam::DVec3;

/// Vertices are used if they lie within this radius around a hit. The unit is the longest edge of
/// the triangle that was hit.
const EDGES: f64 = 6.0;

impl MeshObject {
    /// The least-squares paraboloid through the vertices around a hit. The axes of the
    /// paraboloid's frame are the principal directions at the hit, its curvatures are the
    /// principal curvatures, and its normal is on the side from which the light comes. Returns
    /// `None` if there are too few vertices.
    #[must_use]
    pub fn osculating(&self, hit: &Hit) -> Option<Patch> {
        let [a, b, c] = self.triangles[self.nearest(hit)?];
        let edge = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let corners = self.triangles.as_flattened();
        let near = corners
            .iter()
            .filter(|p| p.distance(hit.point) < EDGES * edge);
        let near: Vec<DVec3> = near.copied().collect();
        let mut frame = Frame::new(hit.point, hit.normal, hit.normal.any_orthonormal_vector())?;
        // The plane perpendicular to the interpolated normal is slightly tilted against the
        // tangent plane, so the fit is repeated in the tangent plane.
        for _ in 0..2 {
            let [_, s, t, ..] = quadric(&frame, &near, edge)?;
            frame = frame.turned_to((frame.d - s * frame.x - t * frame.y).normalize());
        }
        let [h, _, _, ss, st, tt] = quadric(&frame, &near, edge)?;
        // The principal axes of h = … + ½ (ss s² + 2 st s t + tt t²). The sign of curvatures is
        // reversed, because convex surfaces have positive curvatures.
        let angle = 0.5 * libm::atan2(2.0 * st, ss - tt);
        let (sin, cos) = libm::sincos(angle);
        let along = cos * frame.x + sin * frame.y;
        let curvature = |c: f64, s: f64| -(ss * c * c + 2.0 * st * c * s + tt * s * s);
        let far = corners
            .iter()
            .map(|p| p.distance(hit.point))
            .fold(0.0, f64::max);
        Some(Patch {
            frame: Frame::new(hit.point + h * frame.d, frame.d, along)?,
            curvature: [curvature(cos, sin), curvature(-sin, cos), 0.0],
            aperture: far,
        })
    }

    /// Checks whether light arrives at a hit from the side opposite to the mesh's normals.
    #[must_use]
    pub fn is_met_on_its_back(&self, hit: &Hit) -> bool {
        let nearest = self.nearest(hit);
        nearest.is_some_and(|i| self.normal(i, hit.point).dot(hit.normal) < 0.0)
    }

    /// The triangle whose centroid is nearest to a hit.
    fn nearest(&self, hit: &Hit) -> Option<usize> {
        let distance = |i: &usize| {
            let middle: DVec3 = self.triangles[*i].iter().sum::<DVec3>() / 3.0;
            middle.distance_squared(hit.point)
        };
        (0..self.triangles.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// Fits a quadratic h(s, t) to points (s, t, h) by least squares. Returns h, ∂h/∂s, ∂h/∂t, ∂²h/∂s²,
/// ∂²h/∂s∂t and ∂²h/∂t² at the origin of a frame.
fn quadric(frame: &Frame, points: &[DVec3], unit: f64) -> Option<[f64; 6]> {
    let rows = points.iter().map(|point| {
        let DVec3 { x, y, z } = frame.to_local(*point) / unit;
        [1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y, z]
    });
    let [h, s, t, ss, st, tt] = least_squares(rows)?;
    Some([h * unit, s, t, ss / unit, st / unit, tt / unit])
}

/// The least-squares solution x of a · x = b over rows [a, b]. Returns `None` if the rows
/// do not determine x.
fn least_squares<const N: usize, const M: usize>(
    rows: impl Iterator<Item = [f64; M]>,
) -> Option<[f64; N]> {
    // The normal equations, augmented by their right-hand side.
    let mut m = [[0.0; M]; N];
    for row in rows {
        for (i, line) in m.iter_mut().enumerate() {
            for (entry, value) in line.iter_mut().zip(row) {
                *entry += row[i] * value;
            }
        }
    }
    // Gaussian elimination; the matrix is symmetric and positive definite, so no pivoting is
    // needed.
    for i in 0..N {
        let pivot = m[i][i];
        if pivot <= 1e-9 {
            return None;
        }
        let line = m[i].map(|entry| entry / pivot);
        for (k, other) in m.iter_mut().enumerate() {
            let factor = other[i];
            if k != i {
                other
                    .iter_mut()
                    .zip(line)
                    .for_each(|(entry, value)| *entry -= factor * value);
            }
        }
        m[i] = line;
    }
    Some(m.map(|line| line[N]))
}
