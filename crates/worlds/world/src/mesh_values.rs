//! Numbers that belong to the vertices or to the triangles of a mesh.

use crate::texture_point::TexturePoint;
use crate::triangles::Triangles;
use std::sync::Arc;

/// Numbers that belong to the vertices or to the triangles of a mesh.
///
/// Numbers of vertices are interpolated linearly over each triangle. Numbers of triangles are
/// constant on each triangle.
#[derive(Clone, Debug)]
pub struct MeshValues {
    mesh: Arc<Triangles>,
    values: Arc<[f64]>,
    is_of_vertices: bool,
}

impl MeshValues {
    /// The numbers of a mesh. Returns `None` unless there is one number for each vertex or,
    /// if they do not belong to vertices, for each triangle.
    #[must_use]
    pub fn new(mesh: Arc<Triangles>, values: Vec<f64>, is_of_vertices: bool) -> Option<Self> {
        let count = match is_of_vertices {
            true => mesh.vertices().len(),
            false => mesh.corners().len(),
        };
        (values.len() == count).then(|| Self {
            mesh,
            values: values.into(),
            is_of_vertices,
        })
    }

    /// All numbers, in the order of the vertices or triangles.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns these numbers with the function `of` applied to each.
    #[must_use]
    pub fn mapped(&self, of: impl Fn(f64) -> f64) -> Self {
        Self {
            values: self.values.iter().map(|value| of(*value)).collect(),
            ..self.clone()
        }
    }

    /// The number at a point of the mesh.
    pub(crate) fn value(&self, point: &TexturePoint) -> f64 {
        if !self.is_of_vertices {
            return self.values.get(point.triangle).copied().unwrap_or(0.0);
        }
        let Some(corners) = self.mesh.corners().get(point.triangle) else {
            return 0.0;
        };
        let [p, q, r] = corners.map(|corner| self.values[corner as usize]);
        let [b, c] = point.weights.to_array();
        (1.0 - b - c) * p + b * q + c * r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};

    /// Two triangles that share the edge from vertex 0 to vertex 2.
    fn square() -> Arc<Triangles> {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y];
        let corners = vec![[0, 1, 2], [0, 2, 3]];
        Arc::new(Triangles::new(vertices, corners, None, None).unwrap())
    }

    fn at(values: &MeshValues, triangle: usize, weights: [f64; 2]) -> f64 {
        values.value(&TexturePoint {
            triangle,
            weights: DVec2::from(weights),
            ..TexturePoint::default()
        })
    }

    #[test]
    fn numbers_of_vertices_are_interpolated() {
        let values = MeshValues::new(square(), vec![1.0, 2.0, 4.0, 8.0], true).unwrap();
        for (triangle, weights, expected) in [
            (0, [0.0, 0.0], 1.0),
            (0, [1.0, 0.0], 2.0),
            (0, [0.0, 1.0], 4.0),
            (1, [1.0, 0.0], 4.0),
            (1, [0.0, 1.0], 8.0),
            (1, [0.25, 0.5], 5.25),
        ] {
            let found = at(&values, triangle, weights);
            assert!(
                (found - expected).abs() < 1e-12,
                "{triangle} {weights:?}: {found}"
            );
        }
    }

    #[test]
    fn numbers_of_triangles_are_constant() {
        let values = MeshValues::new(square(), vec![3.0, 5.0], false).unwrap();
        for weights in [[0.0, 0.0], [0.25, 0.5]] {
            assert!((at(&values, 0, weights) - 3.0).abs() < 1e-12);
            assert!((at(&values, 1, weights) - 5.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_number_of_values_must_fit() {
        assert!(MeshValues::new(square(), vec![1.0; 2], true).is_none());
        assert!(MeshValues::new(square(), vec![1.0; 4], false).is_none());
    }
}
