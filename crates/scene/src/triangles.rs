//! The triangles of a mesh in a scene.

use etendue_bvh::{MeshHierarchy, SearchMemory};
use etendue_field::enclosing;
use glam::DVec3;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// The triangles of a mesh, in the frame at the light, with one hierarchy that all rays traverse.
/// Clones share the triangles and the hierarchy.
#[derive(Clone)]
pub struct Triangles(Arc<SharedTriangles>);

struct SharedTriangles {
    corners: Vec<[DVec3; 3]>,
    bounds: [DVec3; 2],
    hierarchy: MeshHierarchy,
}

impl Triangles {
    /// Builds the hierarchy over triangles with the corners `corners`. `origins` is the largest
    /// coordinate of the starting point of any ray.
    #[must_use]
    pub fn new(corners: Vec<[DVec3; 3]>, origins: f64) -> Self {
        let bounds = |i: usize| enclosing(&corners[i]);
        Self(Arc::new(SharedTriangles {
            hierarchy: MeshHierarchy::new(corners.len(), origins, bounds),
            bounds: enclosing(corners.as_flattened()),
            corners,
        }))
    }

    /// The lowest and the highest corner of the triangles' bounding box.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        self.0.bounds
    }

    /// Calls [`MeshHierarchy::along`] for the triangles that a ray may meet.
    #[inline]
    pub fn along(
        &self,
        start: DVec3,
        direction: DVec3,
        range: [f64; 2],
        meet: impl FnMut(usize) -> f64,
    ) {
        self.0.hierarchy.along(start, direction, range, meet);
    }

    /// Calls [`MeshHierarchy::any`] for the triangles that a ray may meet.
    #[inline]
    pub fn any(
        &self,
        memory: &mut SearchMemory,
        start: DVec3,
        direction: DVec3,
        from: f64,
        meets: impl FnMut(usize) -> bool,
    ) -> bool {
        let hierarchy = &self.0.hierarchy;
        hierarchy.any(memory, start, direction, from, meets)
    }
}

impl Deref for Triangles {
    type Target = [[DVec3; 3]];

    fn deref(&self) -> &Self::Target {
        &self.0.corners
    }
}

impl PartialEq for Triangles {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for Triangles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}
