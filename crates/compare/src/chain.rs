//! The chain read off the scene: the only code that sees both the scene and theory.

use etendue_field::{Rectangle, Side, VirtualPlane};
use etendue_scene::Scene;
use etendue_theory::{Chain, Operator, Source};

/// The chain that leads from the light to a virtual plane: travels and visibilities as the central ray
/// meets them.
#[must_use]
pub fn chain(scene: &Scene, plane: &VirtualPlane) -> Chain {
    let mut walk = Walk {
        at: "light".to_owned(),
        distance: 0.0,
        operators: Vec::new(),
    };
    for obstacle in obstacles(scene) {
        if stands_before(obstacle.distance, plane) {
            walk.travel(obstacle.name, obstacle.distance);
            walk.operators.push(Operator::Visibility {
                name: obstacle.name.to_owned(),
                blockers: obstacle.rectangles.to_vec(),
            });
        }
    }
    walk.travel(&plane.name, plane.distance);
    Chain {
        source: Source {
            name: "light".to_owned(),
            rectangle: scene.light.rectangle,
            radiance: scene.light.radiance,
        },
        operators: walk.operators,
    }
}

/// Rectangles in a plane that stop light.
struct Obstacle<'a> {
    name: &'a str,
    distance: f64,
    rectangles: &'a [Rectangle],
}

/// Blockers, and surfaces: those beside the central ray stop light too. By distance.
fn obstacles(scene: &Scene) -> Vec<Obstacle<'_>> {
    let blockers = scene.blockers.iter().map(|layer| Obstacle {
        name: &layer.name,
        distance: layer.distance,
        rectangles: &layer.rectangles,
    });
    let surfaces = scene.surfaces.iter().map(|surface| Obstacle {
        name: &surface.name,
        distance: surface.distance,
        rectangles: std::slice::from_ref(&surface.rectangle),
    });
    let mut obstacles: Vec<Obstacle<'_>> = blockers.chain(surfaces).collect();
    obstacles.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    obstacles
}

/// Whether light meets what stands at `distance` before it reaches the plane.
#[must_use]
pub fn stands_before(distance: f64, plane: &VirtualPlane) -> bool {
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
