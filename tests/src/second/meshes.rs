//! Compares hits of triangles with solutions of linear equations. Compares meshes that serve as
//! smooth surfaces with the paraboloids from which they are sampled.

use super::check::{SecondCheck, if_planted, largest, worse};
use super::vector::{Axes, Vector, aside, cross, direction, distance, dot, plus, times, unit};
use super::world::{World, triple};
use crate::hostile::dice::Dice;
use etendue_field::{Frame, TwoPlane, interpolated_normal, triangle_distance};
use etendue_scene::Scene;
use glam::DVec3;
use std::f64::consts::TAU;
use std::path::Path;

/// Directions per hit.
const EACH: u32 = 50;

const TRIANGLE: &[&str] = &["normals in another order", "u and v swapped"];
const CURVATURE: &[&str] = &["axes swapped", "hollow instead of convex", "scale left out"];
const NORMAL: &[&str] = &["axes swapped", "hollow instead of convex"];

pub(super) fn checks() -> Vec<SecondCheck> {
    vec![
        SecondCheck {
            name: "triangle: distance and normal",
            rounds: [4000, 1],
            tolerance: (1e-11, "rounding over the cosine of a ray that grazes"),
            faults: TRIANGLE,
            difference: Box::new(triangle),
        },
        SecondCheck {
            name: "mesh: curvatures and their axes",
            rounds: [20, EACH],
            tolerance: (
                1e-2,
                "share of the larger: fitted over r, six edges, (k r)² = 0.01",
            ),
            faults: CURVATURE,
            difference: Box::new(curvatures),
        },
        SecondCheck {
            name: "mesh: normal at the central hit",
            rounds: [20, 1],
            tolerance: (
                1e-4,
                "radians: interpolated over an edge of 0.013, (k edge)² / 2",
            ),
            faults: NORMAL,
            difference: Box::new(|dice, fault| Hill::new(dice, fault).normal()),
        },
    ]
}

/// Checks the hit of a ray with a triangle in front of it, which some rays miss.
fn triangle(dice: &mut Dice, fault: &str) -> f64 {
    let corners = [0; 3].map(|_| plus([0.0, 0.0, 2.0], 1.0, direction(dice)));
    let normals = [0; 3].map(|_| {
        let tilt = dice.between(0.0, 0.5);
        aside(dice, [0.0, 0.0, 1.0], tilt)
    });
    let [x, y, u, v] = [0; 4].map(|_| dice.between(-0.4, 0.4));
    let fast = triangle_distance(&corners.map(DVec3::from), &TwoPlane { x, y, u, v });
    let [u, v] = if_planted(fault, "u and v swapped", [v, u], [u, v]);
    // Cramer's rule solves a + p (b − a) + q (c − a) = (x, y, 0) + d (u, v, 1) for p, q and d.
    let [a, b, c] = corners;
    let (ab, ac, back) = (plus(b, -1.0, a), plus(c, -1.0, a), [-u, -v, -1.0]);
    let right = plus([x, y, 0.0], -1.0, a);
    let volume = |p: Vector, q: Vector, r: Vector| dot(p, cross(q, r));
    let whole = volume(ab, ac, back);
    let p = volume(right, ac, back) / whole;
    let q = volume(ab, right, back) / whole;
    let d = volume(ab, ac, right) / whole;
    let is_inside = p >= 0.0 && q >= 0.0 && p + q <= 1.0;
    let (Some(fast), true) = (fast, is_inside) else {
        return if fast.is_some() == is_inside {
            0.0
        } else {
            1.0
        };
    };
    let order = if_planted(fault, "normals in another order", [1, 2, 0], [0, 1, 2]);
    let [n0, n1, n2] = order.map(|i: usize| normals[i]);
    let normal = plus(plus(times(1.0 - p - q, n0), p, n1), q, n2);
    let point = plus(plus(a, p, ab), q, ac);
    let smooth = interpolated_normal(
        &corners.map(DVec3::from),
        &normals.map(DVec3::from),
        point.into(),
    );
    worse((fast - d).abs(), distance(smooth.to_array(), unit(normal)))
}

/// A mesh sampled from z = −(k x² + l y²)/2 and scaled by `scale`, and a point on it at which the
/// central ray arrives from above.
struct Hill {
    light: Axes,
    scene: Scene,
    curvature: [f64; 2],
    scale: f64,
    /// The coordinates of the point before scaling.
    at: [f64; 2],
}

impl Hill {
    /// A random mesh; the planted fault is in the second implementation, not in the
    /// scene.
    fn new(dice: &mut Dice, fault: &str) -> Self {
        let tilt = dice.between(0.0, 0.8);
        let down = aside(dice, [0.0, 0.0, -1.0], tilt);
        let mut world = World::new(dice);
        world.turn_to(down);
        let [k, l] = [dice.between(-1.0, 1.0), dice.between(-1.0, 1.0)];
        let scale = dice.between(0.5, 2.0);
        let at = [dice.between(-0.1, 0.1), dice.between(-0.1, 0.1)];
        let height = -0.5 * (k * at[0] * at[0] + l * at[1] * at[1]);
        let hit = world.light.point([0.0, 0.0, 3.0]);
        let center = plus(hit, -scale, [at[0], at[1], height]);
        world.surfaces = format!(
            "Mesh(name: \"it\", center: {}, mesh: Paraboloid(curvatures: ({k:?}, {l:?}), \
             half: 0.5, cells: 80), scale: {scale:?}, event: Mirror)",
            triple(center)
        );
        let scene = world.scene(Path::new("."));
        let (curvature, scale) = match fault {
            "axes swapped" => ([l, k], scale),
            "hollow instead of convex" => ([-k, -l], scale),
            "scale left out" => ([k, l], 1.0),
            _ => ([k, l], scale),
        };
        Self {
            light: world.light,
            scene,
            curvature,
            scale,
            at,
        }
    }

    /// The slopes of the paraboloid at the hit.
    fn slopes(&self) -> [f64; 2] {
        [0, 1].map(|i| -self.curvature[i] * self.at[i])
    }

    fn normal(&self) -> f64 {
        let [p, q] = self.slopes();
        let normal = self.light.components(unit([-p, -q, 1.0]));
        let hit = self.scene.path.legs[1].leaves;
        hit.map_or(1.0, |hit| distance(hit.normal.to_array(), normal))
    }

    /// The curvature of the normal section along (dx, dy, p dx + q dy): the second
    /// fundamental form divided by the first (do Carmo 1976, section 3.3). The returned curvature
    /// is positive if the surface is convex.
    fn along(&self, [dx, dy]: [f64; 2]) -> (Vector, f64) {
        let [p, q] = self.slopes();
        let [k, l] = self.curvature;
        let rise = p * dx + q * dy;
        let first = dx * dx + dy * dy + rise * rise;
        let second = (k * dx * dx + l * dy * dy) / (1.0 + p * p + q * q).sqrt();
        ([dx, dy, rise], second / first / self.scale)
    }
}

fn curvatures(dice: &mut Dice, fault: &str) -> f64 {
    let hill = Hill::new(dice, fault);
    let hit = hill.scene.path.legs[1].leaves;
    let fitted = hit.and_then(|hit| hill.scene.meshes[0].osculating(&hit));
    let Some(patch) = fitted else {
        return f64::NAN;
    };
    let Frame { x, y, .. } = patch.frame;
    let larger = hill.curvature[0].abs().max(hill.curvature[1].abs()) / hill.scale;
    largest(EACH, || {
        let around = dice.between(0.0, TAU);
        let (tangent, second) = hill.along([around.cos(), around.sin()]);
        let tangent: DVec3 = hill.light.components(unit(tangent)).into();
        let [a, b] = [tangent.dot(x), tangent.dot(y)];
        let [k, l, _] = patch.curvature;
        // Euler's formula for normal curvature (1760), divided by the squared length of the
        // tangent's projection onto the fitted plane.
        let fast = (k * a * a + l * b * b) / (a * a + b * b);
        (fast - second).abs() / larger
    })
}
