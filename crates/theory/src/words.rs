//! Describes the steps of light in words: maps, masks and numbers.

use crate::geometry::Matrix;
use crate::obstacle::Obstacle;
use etendue_field::{Grating, Hole, Mask, Shape, tidy};

/// Formats a number to six decimals, without trailing zeros.
pub(crate) fn number(x: f64) -> String {
    let rounded = (x * 1e6).round() / 1e6;
    let sign = if rounded < 0.0 { "−" } else { "" };
    format!("{sign}{}", rounded.abs())
}

/// Formats an angle in degrees.
pub(crate) fn degrees(radians: f64) -> String {
    let rounded = (radians.to_degrees() * 1e3).round() / 1e3;
    format!("{}°", number(rounded))
}

pub(crate) fn travel(distance: f64, from: &str, to: &str) -> String {
    let sign = if distance < 0.0 { '−' } else { '+' };
    let size = number(distance.abs());
    let distance = number(distance);
    format!("map  travel {distance} m, {from} to {to}: ℓ̂(Ωx, Ωu {sign} {size} Ωx)")
}

pub(crate) fn turn(angle: f64, into: &str) -> String {
    format!("map  axes turned by {} into {into}", degrees(angle))
}

pub(crate) fn curvature([[a, b], [c, d]]: Matrix<2>) -> String {
    let off_diagonal = b.abs().max(c.abs());
    let [a, b, c, d] = [a, b, c, d].map(number);
    if off_diagonal < 1e-9 {
        format!("κ = diag({a}, {d}) m⁻¹")
    } else {
        format!("κ = ({a}, {b}; {c}, {d}) m⁻¹")
    }
}

/// Describes the effect of a mask. The text `named`, such as "bars: ", precedes the description.
pub(crate) fn mask(named: &str, mask: &Mask) -> String {
    match mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => {
            let opaque = opaque(shapes, half_planes.len());
            format!("multiply  by the visibility of {named}{opaque}")
        }
        Mask::Aperture(hole) => {
            let hole = match hole {
                Hole::Shape(Shape::Rectangle(_)) => "a rectangle".to_owned(),
                Hole::Shape(Shape::Disc(_)) => "a disc".to_owned(),
                Hole::Polygon(polygon) => {
                    format!("a polygon of {} corners", polygon.corners().len())
                }
            };
            format!("multiply  by the hole of {named}{hole}, opaque elsewhere")
        }
        Mask::Grating(grating) => {
            let formula = formula(grating, ["x", "y"]);
            format!("multiply  by the grating {named}{formula}")
        }
    }
}

pub(crate) fn obstacle(obstacle: &Obstacle) -> String {
    let name = &obstacle.name;
    let legs = match obstacle.until {
        Some(_) => "the legs before it",
        None => "any leg",
    };
    format!("multiply  by the visibility of {name} on {legs}")
}

/// Describes opaque shapes, e.g. "4 opaque rectangles, 1 half-plane".
fn opaque(shapes: &[Shape], half_planes: usize) -> String {
    let discs = shapes
        .iter()
        .filter(|s| matches!(s, Shape::Disc(_)))
        .count();
    let kinds = [
        (shapes.len() - discs, "rectangle"),
        (discs, "disc"),
        (half_planes, "half-plane"),
    ];
    let mut present = kinds.into_iter().filter(|(count, _)| *count > 0);
    let plural = |count| if count == 1 { "" } else { "s" };
    let Some((count, kind)) = present.next() else {
        return "nothing opaque".into();
    };
    let first = format!("{count} opaque {kind}{}", plural(count));
    present.fold(first, |text, (count, kind)| {
        format!("{text}, {count} {kind}{}", plural(count))
    })
}

/// Formats a grating, e.g. "½(1 + 0.9 cos(2π 5 x + 0.3))".
pub(crate) fn formula(grating: &Grating, names: [&str; 2]) -> String {
    let Grating {
        axis,
        frequency,
        modulation,
        phase,
    } = grating;
    let t = names[*axis];
    let (sign, size) = (if *phase < 0.0 { '−' } else { '+' }, tidy(phase.abs()));
    format!("½(1 + {modulation} cos(2π {frequency} {t} {sign} {size}))")
}
