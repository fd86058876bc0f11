//! The chain read off the scene: the only code that sees both the scene and theory.

use etendue_field::{Side, VirtualPlane};
use etendue_scene::{BlockerLayer, Scene};
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
    for layer in scene
        .blockers
        .iter()
        .filter(|layer| stands_before(layer, plane))
    {
        walk.travel(&layer.name, layer.distance);
        walk.operators.push(Operator::Visibility {
            name: layer.name.clone(),
            blockers: layer.rectangles.clone(),
        });
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

/// Whether light meets the layer before it reaches the plane.
#[must_use]
pub fn stands_before(layer: &BlockerLayer, plane: &VirtualPlane) -> bool {
    match plane.side {
        Side::Before => layer.distance < plane.distance,
        Side::After => layer.distance <= plane.distance,
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
