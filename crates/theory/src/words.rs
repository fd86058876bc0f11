//! Describes the steps of light in words: maps, masks and numbers.

use crate::geometry::Matrix;
use crate::obstacle::Obstacle;
use etendue_field::{
    AngleTable, Fresnel, Grating, Hole, Mask, Pattern, Reflectance, Shape, Term, Weight, tidy,
};

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

/// Describes the angles of the central ray away from a surface. The latitude is the angle out of the
/// plane of incidence.
pub(crate) fn outgoing([longitude, latitude]: [f64; 2]) -> String {
    let angle = degrees(longitude);
    if latitude.abs() > 1e-9 {
        let aside = degrees(latitude);
        format!("map  outgoing angle {angle}, {aside} out of the plane of incidence")
    } else {
        format!("map  outgoing angle {angle}")
    }
}

/// Describes the BRDFs as text. A single BRDF has a line for each step, and a sum of BRDFs has a
/// line for each term.
pub(crate) fn reflection(reflectance: &Reflectance) -> Vec<String> {
    let terms = &reflectance.terms;
    let sum = terms.iter().enumerate().map(|(i, term)| {
        let steps = term_in_words(term)
            .map(|[_, what]| what)
            .collect::<Vec<_>>();
        let (i, count) = (i + 1, terms.len());
        format!("convolve  with term {i} of {count}: {}", steps.join(", "))
    });
    let mut words: Vec<String> = match &terms[..] {
        [one] => term_in_words(one)
            .map(|[verb, what]| format!("{verb} {what}"))
            .collect(),
        _ => sum.collect(),
    };
    if let Some(texture) = &reflectance.texture {
        words.push(format!("multiply  by the texture {}", varies(texture)));
    }
    words
}

/// Describes a term as text: the factor of the angle of incidence, the lobe, and the factor of the
/// outgoing angle. Each description begins with a verb.
fn term_in_words(term: &Term) -> impl Iterator<Item = [String; 2]> {
    let brdf = &term.brdf;
    let mut lobe = brdf.lobe.name().to_owned();
    if let Some((name, value)) = brdf.lobe.clone().number_mut() {
        lobe += &format!(", {name} {}", number(*value));
    }
    let fresnel = match brdf.fresnel {
        Fresnel::White => None,
        Fresnel::Dielectric { index } => Some(number(index)),
        Fresnel::Conductor { n, k } => Some(format!("{} + {} i", number(n), number(k))),
    };
    let weight = match &term.weight {
        Weight::One => String::new(),
        Weight::Pattern(pattern) => format!(", weighted by {}", varies(pattern)),
        Weight::Rest(pattern) => format!(", weighted by 1 − ({})", varies(pattern)),
    };
    let table = |angle: &str, table: &AngleTable| {
        let values = table.values.len();
        [
            "multiply  by the".to_owned(),
            format!("factor of {angle}, {values} values"),
        ]
    };
    let fresnel = fresnel.map(|index| {
        [
            "multiply  by the".to_owned(),
            format!("Fresnel factor of index {index}"),
        ]
    });
    let incoming = brdf.incoming.as_ref().map(|f| table("θi", f));
    let lobe = format!("BRDF {lobe}, albedo {}{weight}", number(brdf.albedo));
    let outgoing = brdf.outgoing.as_ref().map(|h| table("θo", h));
    let convolved = Some(["convolve  with the".to_owned(), lobe]);
    [fresnel, incoming, convolved, outgoing]
        .into_iter()
        .flatten()
}

fn varies(pattern: &Pattern) -> String {
    match pattern {
        Pattern::Cosine(grating) => formula(grating, ["s", "t"]),
        Pattern::Picture(picture) => {
            let [w, h] = picture.size;
            format!("picture of {} x {} m", number(w), number(h))
        }
        Pattern::Checkerboard { period } => format!("checkerboard of period {} m", number(*period)),
    }
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
