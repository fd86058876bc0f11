//! Steps in words, as those of `describe`.

use crate::geometry::Matrix;
use etendue_field::Mask;

/// A number to six decimals, without those that are zero.
pub(crate) fn number(x: f64) -> String {
    let rounded = (x * 1e6).round() / 1e6;
    let sign = if rounded < 0.0 { "−" } else { "" };
    format!("{sign}{}", rounded.abs())
}

/// An angle in degrees.
pub(crate) fn degrees(radians: f64) -> String {
    let rounded = (radians.to_degrees() * 1e3).round() / 1e3;
    format!("{}°", number(rounded))
}

pub(super) fn travel(distance: f64, from: &str, to: &str) -> String {
    let sign = if distance < 0.0 { '−' } else { '+' };
    let size = number(distance.abs());
    let distance = number(distance);
    format!("map  travel {distance} m, {from} to {to}: ℓ̂(Ωx, Ωu {sign} {size} Ωx)")
}

pub(super) fn turn(angle: f64, into: &str) -> String {
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

pub(crate) fn mask(mask: &Mask) -> String {
    match mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => format!(
            "multiply  visibility of {}",
            crate::parallel::words::opaque(shapes, half_planes.len())
        ),
        Mask::Grating(grating) => {
            format!(
                "multiply  grating {}",
                crate::parallel::words::formula(grating, ["x", "y"])
            )
        }
    }
}
