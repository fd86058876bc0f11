//! The chain read off the scene: the only code that sees both the scene and theory.

use etendue_field::{Mask, Quantity, Side, VirtualPlane};
use etendue_scene::{MeshObject, Scene, Surface};
use etendue_theory::{Chain, Operator, Source};

/// The chain that leads from the light to a virtual plane: travels, visibilities and reflection as the central ray
/// meets them. Meshes are left out: theory has no word for them (see [`meshes`]).
#[must_use]
pub fn chain(scene: &Scene, plane: &VirtualPlane) -> Chain {
    let mut walk = Walk {
        at: "light".to_owned(),
        distance: 0.0,
        operators: Vec::new(),
    };
    for (name, distance, mask) in obstacles(scene) {
        if stands_before(distance, scene, plane) {
            walk.travel(name, distance);
            walk.operators.push(Operator::Visibility {
                name: name.to_owned(),
                mask,
            });
        }
    }
    if let (1.., Some(surface)) = (plane.reflections, visited(scene)) {
        let name = surface.name.clone();
        walk.travel(&name, surface.distance);
        walk.operators.extend([
            Operator::Cosine { name: name.clone() },
            Operator::Diffuse {
                name,
                albedo: surface.albedo,
            },
        ]);
    }
    walk.travel(&plane.name, plane.distance);
    if plane.quantity == Quantity::DifferentialIrradiance {
        let name = plane.name.clone();
        walk.operators.push(Operator::Cosine { name });
    }
    Chain {
        source: Source {
            name: "light".to_owned(),
            light: scene.light,
        },
        operators: walk.operators,
    }
}

/// The meshes that light may meet before it reaches a plane.
pub fn meshes<'a>(scene: &'a Scene, plane: &VirtualPlane) -> impl Iterator<Item = &'a MeshObject> {
    let end = plane.distance.min(scene.path.length);
    scene.meshes.iter().filter(move |mesh| mesh.extent[0] < end)
}

/// The flat surface that the central ray visits.
pub(crate) fn visited(scene: &Scene) -> Option<&Surface> {
    let visits = &scene.file.path.visits;
    scene.surfaces.iter().find(|s| visits.contains(&s.name))
}

/// What stands across the path, with its distance: blockers, and surfaces, since those beside the central ray stop light too.
fn obstacles(scene: &Scene) -> Vec<(&str, f64, Mask)> {
    let blockers = scene.blockers.iter();
    let blockers = blockers.map(|layer| (layer.name.as_str(), layer.distance, layer.mask.clone()));
    let surfaces = scene.surfaces.iter().map(|surface| {
        let mask = Mask::Opaque {
            shapes: vec![surface.shape()],
            half_planes: Vec::new(),
        };
        (surface.name.as_str(), surface.distance, mask)
    });
    let mut obstacles: Vec<_> = blockers.chain(surfaces).collect();
    obstacles.sort_by(|(_, a, _), (_, b, _)| a.total_cmp(b));
    obstacles
}

/// Whether light meets what stands at `distance` on its way to the plane.
#[must_use]
pub fn stands_before(distance: f64, scene: &Scene, plane: &VirtualPlane) -> bool {
    if plane.reflections > 0 {
        return distance < scene.path.length;
    }
    match plane.side {
        Side::Before => distance < plane.distance,
        Side::After => distance <= plane.distance,
    }
}

/// The central ray on its way.
struct Walk {
    at: String,
    distance: f64,
    operators: Vec<Operator>,
}

impl Walk {
    fn travel(&mut self, to: &str, distance: f64) {
        if distance > self.distance {
            self.operators.push(Operator::Travel {
                from: std::mem::replace(&mut self.at, to.to_owned()),
                to: to.to_owned(),
                distance: distance - self.distance,
            });
            self.distance = distance;
        }
    }
}
