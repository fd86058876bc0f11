//! Faults in the holes of apertures. One hole is a polygon, so nets of rays predict the light behind
//! it, and comparisons include the error of these nets.

use super::{NONE, judged, p_values};
use crate::report::Row;
use crate::scenes::traced;
use etendue_field::{ConvexPolygon, Hole, Mask, ProjectionGrid, VirtualPlane};
use etendue_predict::chain;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::{Chain, Model, Operator, RayBudget};

/// The name of the scene in which the faults are planted.
pub(super) const SCENE: &str = "iris";

/// About as many rays as a run with four million photons has.
const BUDGET: RayBudget = RayBudget::new(4e6, 1e-3);

/// The name of a fault, and the change of a chain that plants it.
type HoleFault = (&'static str, fn(&mut Chain));

/// A row for the scene without a fault, and a row for each fault.
pub(super) fn rows(scene: &Scene) -> Vec<Row> {
    let sound = traced(scene);
    let changes: [HoleFault; 4] = [
        (NONE, |_| ()),
        ("hole of the stop 1 % too wide", |c| {
            scale_hole(c, "stop", 1.01);
        }),
        ("hole of the iris 1 % too wide", |c| {
            scale_hole(c, "iris", 1.01);
        }),
        ("hole of the iris turned by 90 degrees", |c| {
            each_hole(c, "iris", turned);
        }),
    ];
    let rows = changes.iter().map(|(name, change)| {
        let planes = scene.planes.iter().enumerate();
        let each = planes.map(|(i, plane)| {
            let mut changed = chain(scene, plane);
            change(&mut changed);
            let is_changed = *name == NONE || changed != chain(scene, plane);
            let found = is_changed.then(|| of_chain(scene, &sound, (i, plane), &changed));
            found.unwrap_or_default()
        });
        judged(scene, name, &each.collect::<Vec<_>>())
    });
    rows.collect()
}

/// The p-values of a plane that a chain predicts.
fn of_chain(
    scene: &Scene,
    measurement: &Measurement,
    (index, plane): (usize, &VirtualPlane),
    chain: &Chain,
) -> [Option<f64>; 2] {
    let picture = ProjectionGrid::new(&plane.window, 1);
    let found = chain.predict(&[], (&plane.window, &plane.grid, &picture), BUDGET);
    p_values(
        scene,
        measurement,
        (index, &found.slices, &found.replicates),
    )
}

/// Changes the hole of the aperture with the given name.
fn each_hole(chain: &mut Chain, aperture: &str, change: impl Fn(&Hole) -> Hole) {
    for operator in &mut chain.operators {
        if let Operator::Visibility {
            name,
            mask: Mask::Aperture(hole),
        } = operator
            && name == aperture
        {
            *hole = change(hole);
        }
    }
}

/// Scales the hole of the aperture with the given name about the central ray.
fn scale_hole(chain: &mut Chain, aperture: &str, factor: f64) {
    each_hole(chain, aperture, |hole| hole.mapped(factor, [0.0; 2]));
}

/// Turns the corners of a polygon by 90 degrees about the central ray.
fn turned(hole: &Hole) -> Hole {
    match hole {
        Hole::Polygon(polygon) => {
            let corners = polygon.corners().iter().map(|[x, y]| [-y, *x]);
            let turned = ConvexPolygon::new(corners.collect());
            Hole::Polygon(turned.expect("a turned polygon is convex"))
        }
        Hole::Shape(_) => hole.clone(),
    }
}
