//! Environments defined in scene files, compared with their definition: axes, pixels and lobes.

use super::check::{SecondCheck, if_planted, largest, relative};
use super::pattern::Levels;
use super::vector::{Axes, Vector, angle, aside, direction, scale, times};
use super::world::{World, triple};
use crate::hostile::dice::Dice;
use etendue_field::Light;
use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::rc::Rc;
use tempfile::TempDir;

/// Directions per scene.
const EACH: u32 = 20;

const MAP: &[&str] = &[
    "turned by 90°",
    "wrong sign of longitude",
    "upside down",
    "the way light goes",
    "centres at corners",
    "axes of the world",
];
const LOBES: &[&str] = &["the way light goes", "axes of the world", "2 σ² for σ²"];

/// The file name of a map.
pub(super) const FILE: &str = "sky.exr";

pub(super) fn checks(folder: &Rc<TempDir>, map: &Levels) -> Vec<SecondCheck> {
    let (of_map, of_lobes, map) = (Rc::clone(folder), Rc::clone(folder), map.clone());
    vec![
        SecondCheck {
            name: "environment map of a file",
            rounds: [150, EACH],
            tolerance: (1e-12, "rounding of angles and levels"),
            faults: MAP,
            difference: Box::new(move |dice, fault| mapped(dice, fault, of_map.path(), &map)),
        },
        SecondCheck {
            name: "environment of spherical Gaussians",
            rounds: [150, EACH],
            tolerance: (1e-11, "rounding of unit vectors, 4/σ times, σ ≥ 10⁻³"),
            faults: LOBES,
            difference: Box::new(move |dice, fault| lobed(dice, fault, of_lobes.path())),
        },
    ]
}

/// The axes of a map, in which Y is `up`, Z is the component of `front` orthogonal to Y,
/// and X = Y × Z.
fn axes(dice: &mut Dice) -> (Axes, String) {
    let up = direction(dice);
    let tilt = dice.between(0.3, 2.8);
    let front = aside(dice, up, tilt);
    // In these axes D is up and X points to the front, so Y = D × X is the axis X of the map.
    let text = format!("up: {}, front: {}", triple(up), triple(times(3.0, front)));
    (Axes::new([0.0; 3], up, front), text)
}

/// The components of a direction along the map's axes X, up and front.
fn seen(axes: &Axes, from: Vector, fault: &str) -> Vector {
    if fault == "axes of the world" {
        return from;
    }
    let [front, x, up] = axes.components(from);
    [x, up, front]
}

/// The direction from which light comes, opposite to the direction in which light
/// travels.
fn origin(along: Vector, fault: &str) -> Vector {
    if_planted(fault, "the way light goes", along, times(-1.0, along))
}

/// The radiance of the scene's light along a direction of the world.
fn fast(world: &World, light: &Light, along: Vector) -> f64 {
    let Light::Environment { environment } = light else {
        return f64::NAN;
    };
    environment.radiance(world.light.components(along).into())
}

fn mapped(dice: &mut Dice, fault: &str, folder: &Path, map: &Levels) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let (axes, text) = axes(dice);
    let brightness = scale(dice, 0.1, 10.0);
    world.lamp = format!(
        "Environment(center: {}, {text}, scale: {brightness:?}, map: File(\"{FILE}\"))",
        triple(world.light.origin)
    );
    let scene = world.scene(folder);
    largest(EACH, || {
        let along = direction(dice);
        let second = map.radiance(seen(&axes, origin(along, fault), fault), fault);
        relative(fast(&world, &scene.light, along), brightness * second)
    })
}

impl Levels {
    /// The radiance of a map from the direction with components (x, up, front). In a map
    /// with w columns, the centre of column i is at longitude π (1 − (2 i + 1)/w), counted from
    /// the front towards x. In a map with h rows, the centre of row j is at latitude π (½ − (j +
    /// ½)/h). The map is interpolated bilinearly, and periodically in longitude. Between the
    /// centre of an outermost row and the adjacent pole, the value of that row is used.
    fn radiance(&self, [x, up, front]: Vector, fault: &str) -> f64 {
        let longitude = angle([0.0, 0.0, 1.0], [x, 0.0, front]) * x.signum();
        let latitude = PI / 2.0 - angle([0.0, 1.0, 0.0], [x, up, front]);
        let [w, h] = [self.width as f64, self.height as f64];
        let longitude = match fault {
            "turned by 90°" => longitude + PI / 2.0,
            "wrong sign of longitude" => -longitude,
            "centres at corners" => longitude + PI / w,
            _ => longitude,
        };
        let latitude = if_planted(fault, "upside down", -latitude, latitude);
        let row = |j: usize| {
            // The two columns adjacent to the direction. The last column of the map precedes the
            // first column.
            let columns = (0..=self.width).map(|i| {
                let right = PI * (1.0 - (2.0 * i as f64 + 1.0) / w);
                let past = (right + TAU / w - longitude).rem_euclid(TAU) / (TAU / w);
                (i, past)
            });
            let place = columns.min_by(|a, b| a.1.total_cmp(&b.1));
            let (right, share) = place.unwrap_or((0, 0.0));
            let left = (right + self.width - 1) % self.width;
            (1.0 - share) * self.level(left, j) + share * self.level(right % self.width, j)
        };
        let centre = |j: usize| PI * (0.5 - (j as f64 + 0.5) / h);
        let below = (0..self.height).find(|j| centre(*j) <= latitude);
        match below {
            Some(0) => row(0),
            None => row(self.height - 1),
            Some(j) => {
                let share = (centre(j - 1) - latitude) / (centre(j - 1) - centre(j));
                (1.0 - share) * row(j - 1) + share * row(j)
            }
        }
    }
}

fn lobed(dice: &mut Dice, fault: &str, folder: &Path) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let (axes, text) = axes(dice);
    let brightness = scale(dice, 0.1, 10.0);
    let lobes: Vec<(Vector, f64, f64)> = (0..2)
        .map(|_| {
            let tilt = dice.between(0.0, 1.0);
            let from = aside(dice, times(-1.0, world.light.d), tilt);
            (from, scale(dice, 1e-3, 3.0), scale(dice, 0.1, 10.0))
        })
        .collect();
    let words: Vec<String> = lobes
        .iter()
        .map(|(from, width, radiance)| {
            let from = triple(times(2.0, seen(&axes, *from, "")));
            format!("(from: {from}, width: {width:?}, radiance: {radiance:?})")
        })
        .collect();
    world.lamp = format!(
        "Environment(center: {}, {text}, scale: {brightness:?}, map: Lobes([{}]))",
        triple(world.light.origin),
        words.join(", ")
    );
    let scene = world.scene(folder);
    largest(EACH, || {
        let (from, width, _) = lobes[dice.below(2)];
        let tilt = width * dice.between(0.0, 4.0);
        let along = times(-1.0, aside(dice, from, tilt));
        let second: f64 = lobes
            .iter()
            .map(|(middle, width, radiance)| {
                // The planted fault uses the numbers in the file as directions of the world.
                let middle = if_planted(
                    fault,
                    "axes of the world",
                    seen(&axes, *middle, ""),
                    *middle,
                );
                let gamma = angle(middle, origin(along, fault));
                let fall = 2.0 * (gamma / 2.0).sin().powi(2);
                let squared = width * width * if_planted(fault, "2 σ² for σ²", 2.0, 1.0);
                radiance * (-fall / squared).exp()
            })
            .sum();
        // The constant 1e-9 is added to both radiances, because a relative difference has no
        // meaning where both lobes vanish.
        relative(
            fast(&world, &scene.light, along) + 1e-9,
            brightness * second + 1e-9,
        )
    })
}
