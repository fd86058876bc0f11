//! Conversion of meshes of any scene format to meshes of a world.

use etendue_meshfile::DetailedMesh;
use etendue_world::Triangles;
use glam::{DMat3, DVec2, DVec3};

/// Says why a mesh is left out or refused.
pub(crate) const NO_AREA: &str = "has no triangle with an area above 0";

/// Says what [`MeshParts::mend_normals`] does.
pub(crate) const MENDED: &str =
    "approximated: vertices without a normal use the normal of a triangle";

/// The parts of a mesh from which [`Triangles`] will be made.
#[derive(Debug)]
pub(crate) struct MeshParts {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) corners: Vec<[u32; 3]>,
    pub(crate) normals: Option<Vec<DVec3>>,
    pub(crate) uvs: Option<Vec<DVec2>>,
}

impl From<DetailedMesh> for MeshParts {
    fn from(mesh: DetailedMesh) -> Self {
        Self {
            vertices: mesh.vertices,
            corners: mesh.triangles,
            normals: mesh.normals,
            uvs: mesh.uvs,
        }
    }
}

impl MeshParts {
    /// The approximate size in memory, in bytes.
    pub(crate) fn bytes(&self) -> u64 {
        let vertex = size_of::<[DVec3; 2]>() + size_of::<DVec2>();
        let all = self.vertices.len() * vertex + size_of_val(self.corners.as_slice());
        all as u64
    }

    /// Drops triangles of zero area, which no ray hits. Returns, for each triangle, whether it was
    /// kept.
    pub(crate) fn drop_empty(&mut self) -> Vec<bool> {
        let vertices = &self.vertices;
        let has_area = |corners: &[u32; 3]| across(vertices, *corners) != DVec3::ZERO;
        let kept: Vec<bool> = self.corners.iter().map(has_area).collect();
        let mut is_kept = kept.iter();
        self.corners.retain(|_| is_kept.next() == Some(&true));
        kept
    }

    /// Computes each vertex normal as a sum over the adjacent triangles (Thürmer and Wüthrich
    /// 1998). The weight of a triangle's normal is the angle of the triangle at the vertex.
    ///
    /// Angles are measured after the map `linear` is applied, which is the linear part of the
    /// mesh's placement.
    pub(crate) fn smooth(&mut self, linear: DMat3) {
        let placed: Vec<DVec3> = self.vertices.iter().map(|v| linear * *v).collect();
        let mut sums = vec![DVec3::ZERO; placed.len()];
        for corners in &self.corners {
            let normal = across(&placed, *corners).normalize_or_zero();
            for k in 0..3 {
                let [a, b, c] = [k, (k + 1) % 3, (k + 2) % 3].map(|i| placed[corners[i] as usize]);
                sums[corners[k] as usize] += normal * angle(b - a, c - a);
            }
        }
        // The transpose of the placement maps normals of the world to local coordinates. The sign
        // compensates the flip of triangle normals by a mirroring placement.
        let sign = 1.0_f64.copysign(linear.determinant());
        let back = linear.transpose() * sign;
        let normals = sums
            .into_iter()
            .map(|sum| (back * sum).normalize_or(DVec3::X));
        self.normals = Some(normals.collect());
    }

    /// Flips triangles that face away from their normals, because the normals define the front.
    pub(crate) fn face_normals(&mut self) {
        let Some(normals) = &self.normals else {
            return;
        };
        for corners in &mut self.corners {
            let mean: DVec3 = corners.iter().map(|i| normals[*i as usize]).sum();
            if across(&self.vertices, *corners).dot(mean) < 0.0 {
                corners.swap(1, 2);
            }
        }
    }

    /// Gives each vertex without a normal the normal of a triangle; returns whether any vertex
    /// had no normal.
    pub(crate) fn mend_normals(&mut self) -> bool {
        let Some(normals) = &mut self.normals else {
            return false;
        };
        let mut mended = false;
        for corners in &self.corners {
            for corner in corners {
                let normal = &mut normals[*corner as usize];
                if normal.length_squared() < f64::MIN_POSITIVE {
                    *normal = across(&self.vertices, *corners);
                    mended = true;
                }
            }
        }
        // Vertices that belong to no triangle get an arbitrary normal.
        for normal in normals {
            *normal = normal.normalize_or(DVec3::X);
        }
        mended
    }

    /// Flips vertex normals that point away from the front of the adjacent triangles; returns the
    /// number of flipped normals.
    pub(crate) fn turn_normals(&mut self) -> usize {
        let Some(normals) = &mut self.normals else {
            return 0;
        };
        let mut fronts = vec![DVec3::ZERO; normals.len()];
        for corners in &self.corners {
            for corner in corners {
                fronts[*corner as usize] += across(&self.vertices, *corners).normalize_or_zero();
            }
        }
        let mut turned = 0;
        for (normal, front) in normals.iter_mut().zip(fronts) {
            if normal.dot(front) < 0.0 {
                *normal = -*normal;
                turned += 1;
            }
        }
        turned
    }

    /// The triangles of the mesh, or `None` if the mesh has no triangles or has arrays that
    /// do not match in size.
    pub(crate) fn finish(self) -> Option<Triangles> {
        if self.corners.is_empty() {
            return None;
        }
        Triangles::new(self.vertices, self.corners, self.normals, self.uvs)
    }
}

/// A normal of a triangle; the length of this normal is twice the triangle's area.
fn across(vertices: &[DVec3], corners: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|i| vertices[i as usize]);
    (b - a).cross(c - a)
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b))
}
