//! Computes the normals at the vertices of a smooth mesh.

use super::Resolver;
use super::triangles::{MeshPlacement, others};
use etendue_meshfile::Mesh;
use glam::DVec3;

/// The smallest allowed cosine of the angle between the normal of a vertex and the normals of the
/// triangles around it. It is the cosine of 89.4°.
///
/// An interpolated normal is a weighted mean of the normals of three vertices, with weights from 0
/// to 1. The component of each vertex normal along the normal of the triangle is at least the
/// smallest allowed cosine. The component of the mean is therefore also at least this cosine, so
/// the mean cannot vanish or point to the other side of the triangle. The error of each weight is
/// at most 4e-4 (`triangles.rs`), so at least eight tenths of the component along the triangle's
/// normal remain.
///
/// The same limit applies to a ratio at each vertex. To form the ratio, take the area-weighted
/// normals of the triangles around the vertex. The ratio is the length of their sum divided by the
/// sum of their lengths. This ratio is the area-weighted mean of the cosines, so if the ratio is
/// below the limit, the cosine of at least one triangle is below the limit too. A mesh that passes
/// the test of the cosines therefore also passes the test of the ratio.
const MIN_NORMAL: f64 = 0.01;

impl Resolver<'_> {
    /// The normal of each vertex, the area-weighted mean of the normals of the triangles
    /// around it. The normal of a vertex without triangles is zero.
    pub(super) fn normals(&mut self, at: &MeshPlacement<'_>, mesh: &Mesh) -> Option<Vec<DVec3>> {
        let mut sums = vec![(DVec3::ZERO, 0.0); mesh.vertices().len()];
        for (corners, indices) in mesh.corners().zip(mesh.triangles()) {
            let normal = across(corners);
            for i in indices {
                let (sum, lengths) = &mut sums[*i as usize];
                *sum += normal;
                *lengths += normal.length();
            }
        }
        let share = |(sum, lengths): &(DVec3, f64)| sum.length() / lengths;
        let cancel = (0u32..).zip(&sums);
        let cancel: Vec<u32> = cancel
            .filter(|(_, sum)| share(sum) < MIN_NORMAL)
            .map(|(i, _)| i)
            .collect();
        if let Some(first) = cancel.first() {
            let field = at.field(&format!("vertex {}", at.number(*first)));
            let left = share(&sums[*first as usize]);
            let value = format!(
                "without a normal: the normals of its triangles cancel. The length of their sum is only {left:.1e} of the sum of their lengths"
            );
            let allowed = format!(
                "vertices of a smooth surface, where this share is at least {MIN_NORMAL}{}",
                others(cancel.len())
            );
            self.faults.add(field, value, allowed);
        }
        let normals: Vec<DVec3> = sums
            .iter()
            .map(|sum| {
                if share(sum) >= MIN_NORMAL {
                    sum.0.normalize()
                } else {
                    DVec3::ZERO
                }
            })
            .collect();
        self.one_side(at, mesh, &normals)?;
        cancel.is_empty().then_some(normals)
    }

    /// Checks that the normal of each vertex is on the same side as the normals of the triangles
    /// around it.
    fn one_side(&mut self, at: &MeshPlacement<'_>, mesh: &Mesh, normals: &[DVec3]) -> Option<()> {
        let mut turned = Vec::new();
        for (corners, indices) in mesh.corners().zip(mesh.triangles()) {
            let normal = across(corners).normalize();
            let cosines = indices.map(|i| (i, normals[i as usize].dot(normal)));
            // If a vertex has no normal, the fault has been reported already.
            let turned_here = |(i, cosine): &(u32, f64)| {
                *cosine < MIN_NORMAL && normals[*i as usize] != DVec3::ZERO
            };
            let here = cosines.into_iter().filter(turned_here);
            turned.extend(here.map(|(i, cosine)| (i, cosine, *indices)));
        }
        let Some(&(vertex, cosine, triangle)) = turned.first() else {
            return Some(());
        };
        let field = at.field(&format!("vertex {}", at.number(vertex)));
        let value = format!(
            "on a fold: its normal differs by {:.1}° from the normal of {}",
            libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees(),
            at.triangle(triangle)
        );
        let allowed = format!(
            "vertices of a smooth surface, with normals at most {:.1}° from the normals of their triangles, which all have the same winding{}",
            libm::acos(MIN_NORMAL).to_degrees(),
            others(turned.len())
        );
        self.faults.add(field, value, allowed);
        None
    }
}

/// A vector along the normal of a triangle; its length is twice the triangle's area.
fn across([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}
