//! Blockers, slides and windows, compared with their definitions. Blockers and slides are written
//! in scene files.

use super::check::{SecondCheck, relative, worse};
use super::pattern::cosine;
use super::textures::grating;
use super::vector::{Vector, between, scale};
use super::world::{World, pair, triple};
use crate::hostile::dice::Dice;
use etendue_field::{Grating, Light, Profile, TwoPlane, Window};
use etendue_scene::Scene;
use std::f64::consts::PI;
use std::path::Path;

/// Points per scene.
const EACH: u32 = 20;

const SHAPES: &[&str] = &[
    "x and y swapped",
    "sizes taken as half-widths",
    "the other half of the plane",
    "from the central ray",
];
const GRATING: &[&str] = &["axes swapped", "from the central ray", "phase subtracted"];
const SQUARES: &[&str] = &[
    "x and y swapped",
    "shifted by half a pitch",
    "sides as long as a pitch",
];
const BARS: &[&str] = &[
    "axes swapped",
    "shifted by half a pitch",
    "as wide as a pitch",
    "from the central ray",
];
const HOLE: &[&str] = &[
    "x and y swapped",
    "opaque inside",
    "from the central ray",
    "size off by a tenth",
];
const SLIDE: &[&str] = &["widths swapped", "axes swapped", "no π"];
const WINDOW: &[&str] = &[
    "cosine not squared",
    "half-width taken as the width",
    "no π",
];

pub(super) fn checks() -> Vec<SecondCheck> {
    let exact = (0.0, "a number of two"); // 0 or 1 on both sides
    let angle = (1e-11, "rounding of 2π f t, up to 10³");
    let slide = (1e-11, "rounding of exponents and angles");
    let check = |name, faults, tolerance, difference: fn(&mut Dice, &str) -> f64| SecondCheck {
        name,
        rounds: [200, EACH],
        tolerance,
        faults,
        difference: Box::new(difference),
    };
    vec![
        check("mask of shapes", SHAPES, exact, shapes),
        check("mask of squares", SQUARES, exact, squares),
        check("mask of bars", BARS, exact, bars),
        check("mask of an aperture", HOLE, exact, aperture),
        check("mask of a grating", GRATING, angle, masked_by_grating),
        check("slide of a projector", SLIDE, slide, slide_of_projector),
        check("window", WINDOW, slide, window),
    ]
}

/// Returns the center of a random layer, both as coordinates along X and Y and as a position in
/// the world.
pub(super) fn layer(dice: &mut Dice, world: &World) -> ([f64; 2], Vector) {
    let [x, y] = [between(dice, -0.5, 0.5), between(dice, -0.5, 0.5)];
    ([x, y], world.light.point([x, y, 0.5]))
}

/// Returns a point relative to the center of a layer, wrong if `fault` is a fault of points.
fn misplaced(at: [f64; 2], center: [f64; 2], fault: &str) -> [f64; 2] {
    match fault {
        "x and y swapped" => [at[1], at[0]],
        "from the central ray" => [at[0] + center[0], at[1] + center[1]],
        _ => at,
    }
}

/// Compares the transmittance of the resolved mask, at points around its center, with the
/// definition of the mask.
pub(super) fn against(
    dice: &mut Dice,
    scene: &Scene,
    center: [f64; 2],
    second: impl Fn([f64; 2]) -> f64,
) -> f64 {
    let each = (0..EACH).map(|_| {
        let at = [between(dice, -1.5, 1.5), between(dice, -1.5, 1.5)];
        let mask = &scene.blockers[0].mask;
        let fast = mask.transmittance(center[0] + at[0], center[1] + at[1]);
        (fast - second(at)).abs()
    });
    each.fold(0.0, worse)
}

/// Checks a layer with a rectangle to the left, a disc to the right, and a half-plane that lies
/// beyond both shapes on any of four sides.
fn shapes(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let (center, origin) = layer(dice, &world);
    let rectangle = [between(dice, -0.6, -0.4), between(dice, -0.2, 0.2)];
    let size = [between(dice, 0.1, 0.3), between(dice, 0.4, 1.0)];
    let disc = [between(dice, 0.4, 0.6), between(dice, -0.2, 0.2)];
    let radius = between(dice, 0.1, 0.3);
    let (axis, is_above) = (dice.below(2), dice.one_in(2));
    let edge = between(dice, 1.0, 1.2) * if is_above { 1.0 } else { -1.0 };
    world.blockers = format!(
        "Shapes(name: \"b\", center: {}, shapes: [Rectangle(center: {}, size: {}), \
         Disc(center: {}, radius: {radius:?}), \
         HalfPlane(axis: {}, edge: {edge:?}, opaque: {})])",
        triple(origin),
        pair(rectangle),
        pair(size),
        pair(disc),
        ["X", "Y"][axis],
        if is_above { "Above" } else { "Below" },
    );
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let [x, y] = misplaced(at, center, fault);
        let part = if fault == "sizes taken as half-widths" {
            1.0
        } else {
            0.5
        };
        let in_rectangle = (x - rectangle[0]).abs() <= part * size[0]
            && (y - rectangle[1]).abs() <= part * size[1];
        let in_disc = (x - disc[0]).hypot(y - disc[1]) <= radius;
        let beyond = if is_above {
            [x, y][axis] >= edge
        } else {
            [x, y][axis] <= edge
        };
        let in_half = beyond != (fault == "the other half of the plane");
        if in_rectangle || in_disc || in_half {
            0.0
        } else {
            1.0
        }
    })
}

/// Tests blocking squares on a regular grid around the centre of the layer.
fn squares(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let (center, origin) = layer(dice, &world);
    let count = [1 + dice.below(8), 1 + dice.below(8)];
    let (pitch, fill) = (between(dice, 0.1, 0.4), between(dice, 0.2, 0.9));
    world.blockers = format!(
        "JitteredSquares(name: \"b\", center: {}, count: ({}, {}), pitch: {pitch:?}, \
         fill: {fill:?})",
        triple(origin),
        count[0],
        count[1],
    );
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let at = match fault {
            "x and y swapped" => [at[1], at[0]],
            "shifted by half a pitch" => [at[0] + 0.5 * pitch, at[1]],
            _ => at,
        };
        let side = if fault == "sides as long as a pitch" {
            pitch
        } else {
            fill * pitch
        };
        let within = |axis: usize| {
            (0..count[axis]).any(|i| {
                let middle = (i as f64 - (count[axis] as f64 - 1.0) / 2.0) * pitch;
                (at[axis] - middle).abs() <= side / 2.0
            })
        };
        if within(0) && within(1) { 0.0 } else { 1.0 }
    })
}

/// Checks bars. They are endless along one axis, and centred at the center of the layer.
fn bars(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let (center, origin) = layer(dice, &world);
    let (axis, count) = (dice.below(2), 1 + dice.below(8));
    let (pitch, fill) = (between(dice, 0.1, 0.4), between(dice, 0.2, 0.9));
    world.blockers = format!(
        "Bars(name: \"b\", center: {}, axis: {}, count: {count}, pitch: {pitch:?}, fill: {fill:?})",
        triple(origin),
        ["X", "Y"][axis],
    );
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let at = match fault {
            "axes swapped" => at[1 - axis],
            "shifted by half a pitch" => at[axis] + 0.5 * pitch,
            "from the central ray" => at[axis] + center[axis],
            _ => at[axis],
        };
        let width = if fault == "as wide as a pitch" {
            pitch
        } else {
            fill * pitch
        };
        let first = -0.5 * (count as f64 - 1.0) * pitch;
        let is_in = |i: usize| (at - first - i as f64 * pitch).abs() <= 0.5 * width;
        if (0..count).any(is_in) { 0.0 } else { 1.0 }
    })
}

/// Checks apertures. A point is in a polygon if a line from the point to the right crosses its
/// edges an odd number of times.
fn aperture(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let (center, origin) = layer(dice, &world);
    let middle = [between(dice, -0.3, 0.3), between(dice, -0.3, 0.3)];
    let size = [between(dice, 0.4, 1.6), between(dice, 0.4, 1.6)];
    let count = 3 + dice.below(6);
    let corners: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let angle = 2.0 * PI * (i as f64 + between(dice, 0.0, 0.6)) / count as f64;
            let (sin, cos) = angle.sin_cos();
            [
                middle[0] + 0.5 * size[0] * cos,
                middle[1] + 0.5 * size[1] * sin,
            ]
        })
        .collect();
    let kind = dice.below(3);
    let hole = match kind {
        0 => format!(
            "Disc(center: {}, radius: {:?})",
            pair(middle),
            0.5 * size[0]
        ),
        1 => format!("Rectangle(center: {}, size: {})", pair(middle), pair(size)),
        _ => {
            let corners: Vec<String> = corners.iter().map(|corner| pair(*corner)).collect();
            format!("Polygon(corners: [{}])", corners.join(", "))
        }
    };
    world.blockers = format!(
        "Aperture(name: \"b\", center: {}, hole: {hole})",
        triple(origin)
    );
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let [x, y] = misplaced(at, center, fault);
        let factor = if fault == "size off by a tenth" {
            1.1
        } else {
            1.0
        };
        let [x, y] = [(x - middle[0]) / factor, (y - middle[1]) / factor];
        let is_inside = match kind {
            0 => x.hypot(y) <= 0.5 * size[0],
            1 => x.abs() <= 0.5 * size[0] && y.abs() <= 0.5 * size[1],
            _ => {
                let crossed = (0..count).filter(|i| {
                    let [a, b] = [corners[*i], corners[(i + 1) % count]]
                        .map(|p| [p[0] - middle[0], p[1] - middle[1]]);
                    (a[1] > y) != (b[1] > y)
                        && a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x
                });
                crossed.count() % 2 == 1
            }
        };
        let is_open = is_inside != (fault == "opaque inside");
        if is_open { 1.0 } else { 0.0 }
    })
}

/// Checks gratings. Their transmittance is ½ (1 + m cos(2π f t + p)), where t is measured from the
/// center.
fn masked_by_grating(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let (center, origin) = layer(dice, &world);
    let grating = grating(dice);
    world.blockers = format!(
        "Grating(name: \"b\", center: {}, {})",
        triple(origin),
        words(&grating)
    );
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let at = match fault {
            "axes swapped" => [at[1], at[0]],
            "from the central ray" => [at[0] + center[0], at[1] + center[1]],
            _ => at,
        };
        cosine(&grating, at, fault)
    })
}

fn words(grating: &Grating) -> String {
    let Grating {
        axis,
        frequency,
        modulation,
        phase,
    } = grating;
    let axis = ["X", "Y"][*axis];
    format!("axis: {axis}, frequency: {frequency:?}, modulation: {modulation:?}, phase: {phase:?}")
}

/// Checks slides. Their picture is exp(−π u²/w²) along both axes, times the grating.
fn slide_of_projector(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let widths = [scale(dice, 0.03, 0.3), scale(dice, 0.03, 0.3)];
    let grating = grating(dice);
    world.lamp = format!(
        "Projector(center: {}, image: (width: {}, grating: ({})))",
        triple(world.light.origin),
        pair(widths),
        words(&grating)
    );
    let scene = world.scene(Path::new("."));
    let Light::Projector { image, .. } = scene.light else {
        return f64::NAN;
    };
    let widths = match fault {
        "widths swapped" => [widths[1], widths[0]],
        _ => widths,
    };
    let pi = if fault == "no π" { 1.0 } else { PI };
    let each = (0..EACH).map(|_| {
        let at = [between(dice, -0.3, 0.3), between(dice, -0.3, 0.3)];
        let gauss = |axis: usize| (-pi * (at[axis] / widths[axis]).powi(2)).exp();
        let through = match fault {
            "axes swapped" => cosine(&grating, [at[1], at[0]], fault),
            _ => cosine(&grating, at, fault),
        };
        (image.value(at[0], at[1]) - gauss(0) * gauss(1) * through).abs()
    });
    each.fold(0.0, worse)
}

/// Checks windows with the profiles defined in docs/conventions.md, section Window.
fn window(dice: &mut Dice, fault: &str) -> f64 {
    let profiles = [0; 4].map(|_| match dice.below(3) {
        0 => Profile::Hann(scale(dice, 0.1, 1.0)),
        1 => Profile::Box(scale(dice, 0.1, 1.0)),
        _ => Profile::Gaussian {
            width: scale(dice, 0.1, 1.0),
            cut: scale(dice, 0.1, 1.0),
        },
    });
    let [x, y, u, v] = profiles;
    let fast = Window { x, y, u, v };
    let half = if fault == "half-width taken as the width" {
        0.5
    } else {
        1.0
    };
    let power = if fault == "cosine not squared" { 1 } else { 2 };
    let pi = if fault == "no π" { 1.0 } else { PI };
    let value = |profile: &Profile, t: f64| {
        let (end, inside) = match *profile {
            Profile::Hann(h) => (h * half, (PI * t / (2.0 * h * half)).cos().powi(power)),
            Profile::Box(h) => (h * half, 1.0),
            Profile::Gaussian { width, cut } => (cut * half, (-pi * t * t / (width * width)).exp()),
        };
        if t.abs() < end { inside } else { 0.0 }
    };
    let each = (0..EACH).map(|_| {
        // Most rays are inside the window, and some are outside.
        let at = profiles.map(|profile| profile.half_width() * between(dice, -1.05, 1.05));
        let second: f64 = profiles.iter().zip(at).map(|(p, t)| value(p, t)).product();
        let [x, y, u, v] = at;
        relative(fast.value(&TwoPlane { x, y, u, v }) + 1e-6, second + 1e-6)
    });
    each.fold(0.0, worse)
}
