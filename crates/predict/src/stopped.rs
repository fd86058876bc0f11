//! Measures the light that objects stop on its way to a plane.

use crate::applicability::Applicability;
use etendue_field::{FrequencyAxis, ProjectionGrid, SliceGrid, VirtualPlane};
use etendue_theory::path::PathSystem;
use etendue_theory::{Model, Observed, RayBudget};

/// The rays of each sum. Its error is some per cent, but sums with the same rays differ by less.
const BUDGET: RayBudget = RayBudget::new(8e3, 0.0);
/// Smaller shares are not reported, because the sums may be that far off.
const LEAST: f64 = 0.01;
/// If a path has more objects around it, they are not measured, because each of them takes a sum.
const MOST_OBJECTS: usize = 16;

/// The surfaces of the path, and the objects beside it, that stop light on its way to a
/// plane, each with its share of the light in the window: of the light that would arrive without
/// this object. The masks of the scene are not among them. The list is empty if the theory of a path
/// does not apply.
#[must_use]
pub fn stopped(plane: &VirtualPlane, applicability: &Applicability) -> Vec<(String, f64)> {
    const ONE: FrequencyAxis = FrequencyAxis {
        half: 1,
        spacing: 1.0,
    };
    let Some(view) = applicability.theory.path() else {
        return Vec::new();
    };
    let grid = SliceGrid {
        azimuths: 1,
        rho: ONE,
        nu: ONE,
    };
    let picture = ProjectionGrid::new(&plane.window, 1);
    let over = (&plane.window, &grid, &picture);
    let light = |view: &Observed| {
        let mut sum = 0.0;
        view.with_rays(over, BUDGET, &mut |nets| {
            let count = nets.count();
            for net in 0..count {
                nets.emit(net, &mut |_, weight| sum += weight / count as f64);
            }
        });
        sum
    };
    let without = |change: &dyn Fn(&mut PathSystem)| {
        let mut open = view.clone();
        change(&mut open.system);
        light(&open)
    };
    let PathSystem {
        surfaces,
        obstacles,
        ..
    } = &view.system;
    if surfaces.len() + obstacles.len() > MOST_OBJECTS {
        return Vec::new();
    }
    let all = light(view);
    let of_surfaces = surfaces.iter().enumerate().map(|(i, surface)| {
        let open = without(&|system| system.surfaces[i].occludes = false);
        (surface.name.clone(), open)
    });
    let of_obstacles = obstacles.iter().enumerate().map(|(i, obstacle)| {
        let open = without(&|system| drop(system.obstacles.remove(i)));
        (obstacle.name.clone(), open)
    });
    let each = of_surfaces.chain(of_obstacles);
    let shares = each.map(|(name, open)| (name, 1.0 - all / open));
    shares.filter(|(_, share)| *share >= LEAST).collect()
}
