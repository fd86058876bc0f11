//! Blockers, slides and windows, compared with their definitions. Blockers and slides are written
//! in scene files.

use super::check::{SecondCheck, if_planted, largest, relative};
use super::pattern::cosine;
use super::plain::is_in_hole;
use super::textures::grating;
use super::vector::scale;
use super::world::{World, pair, triple};
use crate::hostile::dice::Dice;
use etendue_field::{Grating, Light, Profile, TwoPlane, Window};
use etendue_scene::{HoleFile, Scene};
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

/// A world with a wall, the center of a random layer before the wall as coordinates along X
/// and Y, and the text of the layer's name and center.
pub(super) fn layer(dice: &mut Dice) -> (World, [f64; 2], String) {
    let world = World::new(dice).with_wall(1.0);
    let [x, y] = [dice.between(-0.5, 0.5), dice.between(-0.5, 0.5)];
    let center = triple(world.light.point([x, y, 0.5]));
    (world, [x, y], format!("name: \"b\", center: {center}"))
}

/// A point relative to the center of a layer, wrong if `fault` is a fault of points.
pub(super) fn misplaced(at: [f64; 2], center: [f64; 2], fault: &str) -> [f64; 2] {
    match fault {
        "x and y swapped" | "axes swapped" => [at[1], at[0]],
        "left and right swapped" => [-at[0], at[1]],
        "flipped" => [at[0], -at[1]],
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
    let mask = &scene.blockers[0].mask;
    largest(EACH, || {
        let at = [dice.between(-1.5, 1.5), dice.between(-1.5, 1.5)];
        let fast = mask.transmittance(center[0] + at[0], center[1] + at[1]);
        (fast - second(at)).abs()
    })
}

/// Checks a layer with a rectangle to the left, a disc to the right, and a half-plane that lies
/// beyond both shapes on any of four sides.
fn shapes(dice: &mut Dice, fault: &str) -> f64 {
    let (mut world, center, place) = layer(dice);
    let rectangle = [dice.between(-0.6, -0.4), dice.between(-0.2, 0.2)];
    let size = [dice.between(0.1, 0.3), dice.between(0.4, 1.0)];
    let disc = [dice.between(0.4, 0.6), dice.between(-0.2, 0.2)];
    let radius = dice.between(0.1, 0.3);
    let (axis, is_above) = (dice.below(2), dice.one_in(2));
    let edge = dice.between(1.0, 1.2) * if is_above { 1.0 } else { -1.0 };
    world.blockers = format!(
        "Shapes({place}, shapes: [Rectangle(center: {}, size: {}), \
         Disc(center: {}, radius: {radius:?}), \
         HalfPlane(axis: {}, edge: {edge:?}, opaque: {})])",
        pair(rectangle),
        pair(size),
        pair(disc),
        ["X", "Y"][axis],
        if is_above { "Above" } else { "Below" },
    );
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let [x, y] = misplaced(at, center, fault);
        let part = if_planted(fault, "sizes taken as half-widths", 1.0, 0.5);
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
    let (mut world, center, place) = layer(dice);
    let count = (1 + dice.below(8), 1 + dice.below(8));
    let (pitch, fill) = (dice.between(0.1, 0.4), dice.between(0.2, 0.9));
    world.blockers =
        format!("JitteredSquares({place}, count: {count:?}, pitch: {pitch:?}, fill: {fill:?})");
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let [x, y] = misplaced(at, center, fault);
        let shift = if_planted(fault, "shifted by half a pitch", 0.5 * pitch, 0.0);
        let side = if_planted(fault, "sides as long as a pitch", pitch, fill * pitch);
        let within = |at: f64, count: usize| {
            (0..count).any(|i| {
                let middle = (i as f64 - (count as f64 - 1.0) / 2.0) * pitch;
                (at - middle).abs() <= side / 2.0
            })
        };
        let is_opaque = within(x + shift, count.0) && within(y, count.1);
        if is_opaque { 0.0 } else { 1.0 }
    })
}

/// Checks bars. They are endless along one axis, and centred at the center of the layer.
fn bars(dice: &mut Dice, fault: &str) -> f64 {
    let (mut world, center, place) = layer(dice);
    let (axis, count) = (dice.below(2), 1 + dice.below(8));
    let (pitch, fill) = (dice.between(0.1, 0.4), dice.between(0.2, 0.9));
    world.blockers = format!(
        "Bars({place}, axis: {}, count: {count}, pitch: {pitch:?}, fill: {fill:?})",
        ["X", "Y"][axis],
    );
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let shift = if_planted(fault, "shifted by half a pitch", 0.5 * pitch, 0.0);
        let at = misplaced(at, center, fault)[axis] + shift;
        let width = if_planted(fault, "as wide as a pitch", pitch, fill * pitch);
        let first = -0.5 * (count as f64 - 1.0) * pitch;
        let is_in = |i: usize| (at - first - i as f64 * pitch).abs() <= 0.5 * width;
        if (0..count).any(is_in) { 0.0 } else { 1.0 }
    })
}

/// Checks apertures.
fn aperture(dice: &mut Dice, fault: &str) -> f64 {
    let (mut world, center, place) = layer(dice);
    let middle = [dice.between(-0.3, 0.3), dice.between(-0.3, 0.3)];
    let size = [dice.between(0.4, 1.6), dice.between(0.4, 1.6)];
    let count = 3 + dice.below(6);
    let corners: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let angle = 2.0 * PI * (i as f64 + dice.between(0.0, 0.6)) / count as f64;
            let (sin, cos) = angle.sin_cos();
            [
                middle[0] + 0.5 * size[0] * cos,
                middle[1] + 0.5 * size[1] * sin,
            ]
        })
        .collect();
    let radius = 0.5 * size[0];
    let (text, hole) = match dice.below(3) {
        0 => (
            format!("Disc(center: {}, radius: {radius:?})", pair(middle)),
            HoleFile::Disc {
                center: middle,
                radius,
            },
        ),
        1 => (
            format!("Rectangle(center: {}, size: {})", pair(middle), pair(size)),
            HoleFile::Rectangle {
                center: middle,
                size,
            },
        ),
        _ => {
            let texts: Vec<String> = corners.iter().map(|corner| pair(*corner)).collect();
            let text = format!("Polygon(corners: [{}])", texts.join(", "));
            (text, HoleFile::Polygon { corners })
        }
    };
    world.blockers = format!("Aperture({place}, hole: {text})");
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        let at = misplaced(at, center, fault);
        let factor = if_planted(fault, "size off by a tenth", 1.1, 1.0);
        let at = [0, 1].map(|i: usize| middle[i] + (at[i] - middle[i]) / factor);
        let is_open = is_in_hole(&hole, at) != (fault == "opaque inside");
        if is_open { 1.0 } else { 0.0 }
    })
}

/// Checks gratings. Their transmittance is ½ (1 + m cos(2π f t + p)), where t is measured from the
/// center.
fn masked_by_grating(dice: &mut Dice, fault: &str) -> f64 {
    let (mut world, center, place) = layer(dice);
    let grating = grating(dice);
    world.blockers = format!("Grating({place}, {})", words(&grating));
    let scene = world.scene(Path::new("."));
    against(dice, &scene, center, |at| {
        cosine(&grating, misplaced(at, center, fault), fault)
    })
}

pub(super) fn words(grating: &Grating) -> String {
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
    let widths = if_planted(fault, "widths swapped", [widths[1], widths[0]], widths);
    let pi = if_planted(fault, "no π", 1.0, PI);
    largest(EACH, || {
        let at = [dice.between(-0.3, 0.3), dice.between(-0.3, 0.3)];
        let gauss = |axis: usize| (-pi * (at[axis] / widths[axis]).powi(2)).exp();
        let through = cosine(&grating, misplaced(at, [0.0; 2], fault), fault);
        (image.value(at[0], at[1]) - gauss(0) * gauss(1) * through).abs()
    })
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
    largest(EACH, || {
        // Most rays are inside the window, and some are outside.
        let at = profiles.map(|profile| profile.half_width() * dice.between(-1.05, 1.05));
        let second: f64 = profiles
            .iter()
            .zip(at)
            .map(|(p, t)| value(p, t, fault))
            .product();
        let [x, y, u, v] = at;
        relative(fast.value(&TwoPlane { x, y, u, v }) + 1e-6, second + 1e-6)
    })
}

/// The value of a profile of a window.
pub(super) fn value(profile: &Profile, t: f64, fault: &str) -> f64 {
    let half = if_planted(fault, "half-width taken as the width", 0.5, 1.0);
    let power = if_planted(fault, "cosine not squared", 1, 2);
    let pi = if_planted(fault, "no π", 1.0, PI);
    let (end, inside) = match *profile {
        Profile::Hann(h) => (h * half, (PI * t / (2.0 * h * half)).cos().powi(power)),
        Profile::Box(h) => (h * half, 1.0),
        Profile::Gaussian { width, cut } => (cut * half, (-pi * t * t / (width * width)).exp()),
    };
    if t.abs() < end { inside } else { 0.0 }
}
