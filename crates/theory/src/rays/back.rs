//! Rays of a plane across the central ray, followed back to the light as they go.

use super::trace::Ray;
use super::{Element, Plane, System};
use etendue_field::{Frame, Orientation, Specular};
use glam::DVec3;

/// A plane, and the surfaces on the way back from it.
#[derive(Clone, Debug)]
pub(super) struct Back {
    frame: Frame,
    elements: Vec<Element>,
}

impl Back {
    /// `None` on a surface: its coordinates do not say where a ray is.
    pub(super) fn new(system: &System, plane: &Plane) -> Option<Self> {
        (plane.orientation == Orientation::Orthogonal).then(|| Self {
            frame: plane.frame,
            elements: system.elements.clone(),
        })
    }

    /// The ray (x, y, u, v) of the light's plane that arrives at z, and |∂z/∂ray|. `None` where none
    /// does.
    ///
    /// Surfaces keep n² dx dy du dv / (1 + u² + v²)² of rays (docs/theory.md (29)).
    pub(super) fn ray(&self, z: [f64; 4]) -> Option<([f64; 4], f64)> {
        let mut ray = self.last_leg(z);
        let mut spread = 1.0;
        for element in self.elements.iter().rev() {
            let before = element.follow(&ray)?;
            spread *= element.spread(&before, -ray.direction);
            ray = before;
        }
        let travel = -ray.point.z / ray.direction.z;
        // Light begins in the plane z = 0 and goes forward.
        if travel <= 0.0 || ray.direction.z >= 0.0 {
            return None;
        }
        let at = ray.point + travel * ray.direction;
        let [u, v] = [ray.direction.x, ray.direction.y].map(|d| d / ray.direction.z);
        let emission = [at.x, at.y, u, v];
        let widths = secant_squared(z) / secant_squared(emission);
        Some((emission, spread * widths * widths))
    }

    /// The ray back along z, from beyond all that it can meet of the last surface: half of a plane at
    /// an oblique surface lies behind that.
    fn last_leg(&self, [x, y, u, v]: [f64; 4]) -> Ray {
        let point = self.frame.to_world(DVec3::new(x, y, 0.0));
        let along = self.frame.vector_to_world(DVec3::new(u, v, 1.0));
        let along = along.normalize();
        let far = self.elements.last().map_or(0.0, |Element { patch, .. }| {
            4.0 * patch.aperture + (point - patch.frame.origin).length()
        });
        Ray {
            point: point + far * along,
            direction: -along,
        }
    }
}

impl Element {
    /// What dx dy du dv / (1 + u² + v²)² grows by where light comes back along `before` and has left
    /// along `after`.
    fn spread(&self, before: &Ray, after: DVec3) -> f64 {
        let frame = &self.patch.frame;
        match self.event {
            Specular::Mirror => 1.0,
            Specular::Refraction { front, back } => {
                let normal = self.patch.gradient(frame.to_local(before.point));
                let from_front = frame.vector_to_local(before.direction).dot(normal) > 0.0;
                let ratio = if from_front {
                    front / back
                } else {
                    back / front
                };
                ratio * ratio
            }
            // A lens keeps dx dy du dv of its own slopes.
            Specular::ThinLens { .. } => {
                (after.dot(frame.d) / before.direction.dot(frame.d)).powi(4)
            }
        }
    }
}

/// 1 + u² + v².
fn secant_squared([.., u, v]: [f64; 4]) -> f64 {
    1.0 + u * u + v * v
}
