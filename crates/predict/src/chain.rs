//! Derives the chain from the scene: the steps that light takes between parallel planes.

use etendue_field::{Mask, Quantity, Shape, Side, VirtualPlane};
use etendue_scene::{Object, Scene};
use etendue_theory::{Chain, Operator, Source};

/// The chain that leads from the light to a virtual plane. The chain contains travels,
/// visibilities and diffuse reflections in the order of the central ray. It omits everything else
/// on the way, which [`Applicability`](crate::Applicability) reports.
#[must_use]
pub fn chain(scene: &Scene, plane: &VirtualPlane) -> Chain {
    let mut walk = ChainWalk {
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
    for leg in &scene.path.legs[1..=plane.leg] {
        let Some(hit) = leg.leaves else { continue };
        let name = scene.name_of(hit.object).to_owned();
        let albedo = match hit.object {
            Object::Surface(i) => Some(scene.surfaces[i].albedo),
            Object::Mesh(i) => scene.meshes[i].albedo,
            Object::Patch(_) => None,
        };
        let Some(albedo) = albedo else { continue };
        walk.travel(&name, leg.start);
        let cosine = Operator::Cosine { name: name.clone() };
        walk.operators
            .extend([cosine, Operator::Diffuse { name, albedo }]);
    }
    walk.travel(&plane.name, plane.distance);
    if plane.leg == 0 && plane.quantity == Quantity::DifferentialIrradiance {
        let name = plane.name.clone();
        walk.operators.push(Operator::Cosine { name });
    }
    Chain {
        source: Source {
            name: "light".to_owned(),
            light: scene.light.clone(),
        },
        operators: walk.operators,
    }
}

/// The names, distances and masks of the objects across the path. These objects include
/// surfaces beside the central ray, because such surfaces also stop light.
fn obstacles(scene: &Scene) -> Vec<(&str, f64, Mask)> {
    let blockers = scene.blockers.iter();
    let blockers = blockers.map(|layer| (layer.name.as_str(), layer.distance, layer.mask.clone()));
    let surfaces = scene.surfaces.iter().filter_map(|surface| {
        let (distance, rectangle) = surface.across()?;
        let mask = Mask::Opaque {
            shapes: vec![Shape::Rectangle(rectangle)],
            half_planes: Vec::new(),
        };
        Some((surface.name.as_str(), distance, mask))
    });
    let mut obstacles: Vec<_> = blockers.chain(surfaces).collect();
    obstacles.sort_by(|(_, a, _), (_, b, _)| a.total_cmp(b));
    obstacles
}

/// Checks whether light meets an object at `distance` on the first leg, on its way to the plane.
#[must_use]
pub fn stands_before(distance: f64, scene: &Scene, plane: &VirtualPlane) -> bool {
    // A layer may stand behind a further light.
    if distance <= 0.0 {
        return false;
    }
    if plane.leg > 0 {
        return distance < scene.path.first_hit();
    }
    match plane.side {
        Side::Before => distance < plane.distance,
        Side::After => distance <= plane.distance,
    }
}

/// The chain of the central ray up to its current point.
struct ChainWalk {
    at: String,
    distance: f64,
    operators: Vec<Operator>,
}

impl ChainWalk {
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
