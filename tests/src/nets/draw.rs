//! Generates random scenes as the texts of scene files. The scenes together use all features of
//! scene files.
//!
//! Each scene is a function of the number of the scene. Sizes are in metres and slopes are
//! tangents, as in any scene file.

use crate::hostile::dice::Dice;
use etendue_transform::random::Stream;

/// The kind of a scene. It determines the elements between the light and the plane of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BlockerKind {
    /// A plane perpendicular to the central ray, behind masks.
    Across,
    /// A plane as in `Across`, but lit by a point light.
    PointAcross,
    /// Irradiance at a receiver, including the cosine of incidence.
    Cosine,
    /// Light that a diffuse receiver reflects.
    Diffuse,
    /// Light as in `Diffuse`, from a point light.
    PointDiffuse,
    /// Behind a mirror.
    Mirror,
    /// A plane behind a refracting surface.
    Refraction,
    /// A plane behind a thin lens.
    Lens,
    /// A scene of another kind whose light is replaced by a projector or a beam.
    Picture,
    /// Light that a BRDF reflects.
    Brdf,
    /// Light of an environment that a BRDF reflects.
    Sky,
}

impl BlockerKind {
    /// Each kind, with its name and the number of its scenes: 130 scenes are of kinds with a closed
    /// form, and 70 of kinds without.
    pub(super) const ALL: [(Self, &'static str, usize); 11] = [
        (Self::Across, "area light, masks", 40),
        (Self::PointAcross, "point, masks", 20),
        (Self::Cosine, "area light, masks, cosine", 20),
        (Self::Diffuse, "area light, masks, diffuse", 30),
        (Self::PointDiffuse, "point, masks, diffuse", 20),
        (Self::Mirror, "mirror", 14),
        (Self::Refraction, "interface", 10),
        (Self::Lens, "thin lens", 8),
        (Self::Picture, "projector or beam", 8),
        (Self::Brdf, "BRDF", 22),
        (Self::Sky, "BRDF, environment", 8),
    ];

    pub(super) fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(kind, ..)| *kind == self);
        found.map_or("", |(_, name, _)| name)
    }

    /// Checks whether a closed form exists; the nets' prediction is then compared with it.
    pub(super) fn is_chain(self) -> bool {
        matches!(
            self,
            Self::Across | Self::PointAcross | Self::Cosine | Self::Diffuse | Self::PointDiffuse
        )
    }
}

/// The seed of all scenes. This seed was fixed in advance, and not chosen by the results that it
/// gives.
const SEED: u64 = 1;

/// The random numbers of a scene.
pub(super) fn dice(number: u64) -> Dice {
    Dice::of(Stream::Jitter, SEED, number)
}

/// A scene of a kind, as the text of its file.
pub(super) fn scene(kind: BlockerKind, dice: &mut Dice) -> String {
    let [x, u] = [dice.between(0.15, 0.5), dice.between(0.15, 0.45)];
    let window = match dice.below(4) {
        0 => format!("(x: Box({x}), u: Hann({u}))"),
        1 => format!("(x: Gaussian(width: {x}, cut: {x}), u: Hann({u}))"),
        _ => format!("(x: Hann({x}), u: Hann({u}))"),
    };
    // The frequencies of a plane are five steps along each axis.
    let [rho, nu] = [x, u].map(|half| 2.4 / half);
    let frequencies = format!("(azimuths: 2, rho: (max: {rho}), nu: (max: {nu}))");
    let light = light(kind, dice);
    let (surface, name, planes) = if kind.is_chain() {
        parallel(kind, dice)
    } else {
        smooth(kind, dice)
    };
    let blockers = blockers(kind, dice);
    format!(
        "(light: {light}, blockers: [{blockers}], surfaces: [{surface}],\n\
         path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"{name}\"]),\n\
         planes: [{planes}], window: {window}, frequencies: {frequencies})"
    )
}

fn light(kind: BlockerKind, dice: &mut Dice) -> String {
    let size = dice.between(0.05, 0.5);
    let point = "Point(center: (0, 0, 0))".to_owned();
    match kind {
        BlockerKind::PointAcross | BlockerKind::PointDiffuse => point,
        BlockerKind::Sky => {
            let lobe = |dice: &mut Dice| {
                let [x, y] = [dice.between(-0.6, 0.6), dice.between(-0.6, 0.6)];
                let width = dice.between(0.05, 0.5);
                format!("(from: ({x}, {y}, -1), width: {width}, radiance: 1)")
            };
            let lobes = [lobe(dice), lobe(dice)].join(", ");
            format!("Environment(center: (0, 0, 0), map: Lobes([{lobes}]))")
        }
        BlockerKind::Picture if dice.below(2) == 0 => {
            format!("Beam(center: (0, 0, 0), image: (width: ({size}, 0.2)))")
        }
        BlockerKind::Picture => {
            format!("Projector(center: (0, 0, 0), image: (width: ({size}, 0.2)))")
        }
        _ => match dice.below(4) {
            0 => format!("Disc(center: (0, 0, 0), radius: {})", 0.5 * size),
            1 => {
                let exponent = dice.between(1.0, 30.0).round();
                let bulb = ["Disc", "Square"][dice.below(2)];
                format!("Spot(center: (0, 0, 0), bulb: {bulb}({size}), exponent: {exponent})")
            }
            _ => {
                let other = dice.between(0.05, 0.5);
                format!("Rectangle(center: (0, 0, 0), size: ({size}, {other}))")
            }
        },
    }
}

/// Draws up to three masks between the light and z = 0.9. Scenes of the kinds `Picture` and
/// `PointAcross` have at least one opaque mask. Without an opaque mask, a quadrature rule would
/// replace the nets in the prediction of these scenes.
fn blockers(kind: BlockerKind, dice: &mut Dice) -> String {
    if kind == BlockerKind::Sky {
        return String::new();
    }
    let opaque = matches!(kind, BlockerKind::Picture | BlockerKind::PointAcross);
    let count = dice.below(4).max(usize::from(opaque));
    let layer = |i: usize| {
        let z = 0.3 + 0.25 * i as f64 + dice.between(0.0, 0.2);
        let name = format!("name: \"mask {i}\", center: (0, 0, {z})");
        let choice = dice.below(if opaque && i == 0 { 3 } else { 4 });
        match choice {
            0 | 1 => format!("Shapes({name}, shapes: [{}])", shapes(dice, choice == 0)),
            2 => {
                let (edge, axis) = (dice.between(-0.1, 0.1), ["X", "Y"][dice.below(2)]);
                let side = ["Above", "Below"][dice.below(2)];
                let half = format!("HalfPlane(axis: {axis}, edge: {edge}, opaque: {side})");
                format!("Shapes({name}, shapes: [{half}])")
            }
            _ => {
                let (frequency, axis) = (dice.between(1.0, 8.0), ["X", "Y"][dice.below(2)]);
                let [m, p] = [dice.between(0.3, 1.0), dice.between(-3.0, 3.0)];
                let bars = format!("axis: {axis}, frequency: {frequency}");
                format!("Grating({name}, {bars}, modulation: {m}, phase: {p})")
            }
        }
    };
    let layers: Vec<String> = (0..count).map(layer).collect();
    layers.join(", ")
}

/// Draws one to four rectangles or discs, each in its own cell of a two-by-two grid.
fn shapes(dice: &mut Dice, square: bool) -> String {
    let pitch = dice.between(0.1, 0.35);
    let count = 1 + dice.below(4);
    let shape = |i: usize| {
        let [column, row] = [i % 2, i / 2].map(|k| (k as f64 - 0.5) * pitch);
        let [w, h] = [dice.between(0.3, 0.9), dice.between(0.3, 0.9)].map(|share| share * pitch);
        if square {
            format!("Rectangle(center: ({column}, {row}), size: ({w}, {h}))")
        } else {
            format!("Disc(center: ({column}, {row}), radius: {})", 0.5 * w)
        }
    };
    let shapes: Vec<String> = (0..count).map(shape).collect();
    shapes.join(", ")
}

/// A floor, the name of the floor, and a plane at the floor.
fn parallel(kind: BlockerKind, dice: &mut Dice) -> (String, &'static str, String) {
    let z = dice.between(1.1, 2.0);
    let floor = format!("Rectangle(name: \"floor\", center: (0, 0, {z}), size: (20, 20))");
    let plane = match kind {
        BlockerKind::Cosine => "at: Before(\"floor\"), quantity: DifferentialIrradiance".to_owned(),
        BlockerKind::Diffuse | BlockerKind::PointDiffuse if dice.below(2) == 0 => {
            "at: After(\"floor\")".to_owned()
        }
        BlockerKind::Diffuse | BlockerKind::PointDiffuse => {
            format!("at: Distance({})", z + dice.between(0.05, 0.3))
        }
        _ => "at: Before(\"floor\")".to_owned(),
    };
    (floor, "floor", format!("(name: \"plane\", {plane})"))
}

/// A smooth surface, the name of the surface, and a plane behind the surface.
fn smooth(kind: BlockerKind, dice: &mut Dice) -> (String, &'static str, String) {
    let angle = dice.between(0.05, 0.7);
    let event = match kind {
        BlockerKind::Mirror => "Mirror".to_owned(),
        BlockerKind::Refraction => "Refraction(front: 1, back: 1.5)".to_owned(),
        BlockerKind::Lens => format!("ThinLens({})", dice.between(0.4, 2.0)),
        BlockerKind::Picture => {
            ["Mirror", "Refraction(front: 1, back: 1.5)"][dice.below(2)].to_owned()
        }
        _ => brdf(dice),
    };
    let (form, angle) = match dice.below(4) {
        _ if kind == BlockerKind::Lens => ("Plane".to_owned(), 0.0),
        0 => ("Plane".to_owned(), angle),
        1 => (format!("Cylinder({})", dice.between(-0.3, 0.8)), angle),
        2 => {
            let [a, b] = [dice.between(-0.3, 0.8), dice.between(-0.3, 0.8)];
            (format!("Paraboloid({a}, {b})"), angle)
        }
        _ => (format!("Sphere({})", dice.between(-0.3, 0.8)), angle),
    };
    let [x, z] = [angle.sin(), -angle.cos()];
    let surface = format!(
        "Smooth(name: \"surface\", center: (0, 0, 1), facing: ({x}, 0, {z}), form: {form}, \
         aperture: 0.8, event: {event})"
    );
    let plane = if dice.below(2) == 0 {
        "at: After(\"surface\")".to_owned()
    } else {
        format!("at: Distance({})", dice.between(1.1, 1.6))
    };
    (surface, "surface", format!("(name: \"plane\", {plane})"))
}

fn brdf(dice: &mut Dice) -> String {
    let roughness = dice.between(0.05, 0.5);
    let lobe = match dice.below(4) {
        0 => "Lambertian".to_owned(),
        1 => format!("Phong({})", dice.between(5.0, 300.0).round()),
        2 => format!("Beckmann({roughness})"),
        _ => format!("Ggx({roughness})"),
    };
    let texture = match dice.below(3) {
        0 => format!(", texture: Checkerboard({})", dice.between(0.1, 0.4)),
        1 => format!(
            ", texture: Cosine(axis: X, frequency: {}, modulation: 0.9, phase: 0)",
            dice.between(1.0, 6.0)
        ),
        _ => String::new(),
    };
    format!("Reflects(brdf: (lobe: {lobe}){texture})")
}
