//! The first-order chain, which consists of an affine map onto the surface, the lobe, and an affine
//! map off the surface.

use crate::geometry::{AffineMap, Matrix};
use crate::obstacle::LegRay;
use crate::path::Observed;
use crate::path::PathSystem;
use crate::plane::Plane;
use crate::rays::Incidence;
use crate::words::{self, degrees, number};
use etendue_field::{
    AngleTable, Frame, Fresnel, Lobe, Orientation, Pattern, Quantity, Reflectance, Term, Weight,
};
use glam::DVec3;

/// The path of the central ray, and the first-order maps of neighbouring rays.
///
/// Local coordinates are (s, t, θ, φ), which are positions along T and B and angles to the local
/// normals. T lies in the plane of incidence.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatteringChain {
    /// The map from (x, y, u, v) at the light to local coordinates of the direction of incidence.
    /// This map consists of the steps travel, incidence and curvature.
    pub onto: AffineMap<4>,
    /// The map from local coordinates of the outgoing direction to coordinates of the plane. This
    /// map consists of the steps back, outgoing angle and travel.
    pub off: AffineMap<4>,
    /// Longitude θ₀ of the direction from which the central ray arrives.
    pub incidence: f64,
    /// Longitude θ₁ and latitude of the direction in which the central ray leaves.
    pub outgoing: [f64; 2],
    /// The surface's shape operator along (T, B) at the point that the central ray hits, per metre.
    /// The operator is positive for convex surfaces.
    pub curvature: Matrix<2>,
    /// Distance of the surface from the light, metres.
    pub distance: f64,
    /// The axes (T, B, N) at the point where the central ray hits the surface.
    pub frame: Frame,
    /// Descriptions of the steps, in the order of propagation.
    pub steps: Vec<String>,
}

/// Returns the chain of a system up to a plane on or beyond its surface, or `None` if the central
/// ray does not arrive at the plane.
///
/// The chain's maps are the derivatives of the exact rays. Apart from rotations of the axes, the
/// maps equal the corrected maps of Durand et al. 2005, Eqs. 9–11 and 19 (docs/theory.md, section
/// 7), as the tests verify.
#[must_use]
pub fn chain(view: &Observed) -> Option<ScatteringChain> {
    let Observed { system, plane } = view;
    let central = LegRay {
        point: DVec3::ZERO,
        direction: DVec3::Z,
    };
    let (patch, _) = system.scatterer();
    let (distance, normal) = central.met(patch)?;
    let arriving = Frame::IDENTITY.travelled(distance);
    let incidence = Incidence::new(&arriving, normal);
    let frame = Frame {
        origin: arriving.origin,
        x: incidence.t,
        y: incidence.b,
        d: incidence.n,
    };
    let arrives = |[x, y, u, v]: [f64; 4]| {
        let ray = LegRay::new([x, y, u, v]);
        let (distance, normal) = ray.met(patch)?;
        let point = ray.point + ray.direction * distance;
        Some(local(&frame, point, normal, -ray.direction))
    };
    let leaves = |z: [f64; 4]| {
        let leaving = system.leaving(plane, z)?;
        Some(local(
            &frame,
            leaving.point,
            leaving.normal,
            leaving.direction,
        ))
    };
    let onto = AffineMap::touching(arrives)?;
    let off = AffineMap::touching(leaves)?.inverse()?;
    let [.., longitude, latitude] = leaves([0.0; 4])?;
    let outgoing = [longitude, latitude];
    let curvature = incidence.shape(patch, arriving.origin);
    let mut steps = steps(system, plane, &incidence, distance, outgoing);
    if plane.quantity == Quantity::DifferentialIrradiance {
        let cosine = match plane.orientation {
            Orientation::Orthogonal => "multiply  by the cosine, G = (1 + u² + v²)⁻²",
            _ => "multiply  by the cosine, cos⁺ θ cos² φ",
        };
        steps.push(cosine.to_owned());
    }
    Some(ScatteringChain {
        onto,
        off,
        incidence: incidence.theta0,
        outgoing,
        curvature,
        distance,
        frame,
        steps,
    })
}

/// Returns the largest difference between the maps of the chain `tried` and the derivatives of the
/// exact rays. The difference is zero for the chain that [`chain`] returns.
#[must_use]
pub fn defect(view: &Observed, tried: &ScatteringChain) -> Option<f64> {
    let traced = chain(view)?;
    let onto = tried.onto.apart(&traced.onto, &[1.0; 4]);
    Some(onto.max(tried.off.apart(&traced.off, &[1.0; 4])))
}

impl ScatteringChain {
    /// Returns the map z' = A z from the light to the plane, for rays that the surface reflects in
    /// the mirror direction.
    #[must_use]
    pub fn rays(&self) -> AffineMap<4> {
        self.onto.then(&AffineMap::<4>::mirror()).then(&self.off)
    }
}

/// Returns the local coordinates of a point of the surface and of a direction away from the
/// surface.
pub(crate) fn local(frame: &Frame, point: DVec3, normal: DVec3, away: DVec3) -> [f64; 4] {
    let at = frame.to_local(point);
    let away = frame.turned_to(normal).vector_to_local(away);
    [
        at.x,
        at.y,
        libm::atan2(away.x, away.z),
        libm::asin(away.y.clamp(-1.0, 1.0)),
    ]
}

fn steps(
    system: &PathSystem,
    plane: &Plane,
    incidence: &Incidence,
    distance: f64,
    [theta, phi]: [f64; 2],
) -> Vec<String> {
    let (patch, reflectance) = system.scatterer();
    let name = &system.surfaces[0].name;
    let mut steps = Vec::new();
    let mut at = ("light", 0.0);
    let travel = |from: &str, to: &str, d: f64| {
        format!(
            "map  travel {} m, {from} to {to}: ℓ̂(Ωx, Ωu + {} Ωx)",
            number(d),
            number(d)
        )
    };
    for (next, mask) in system.masks.iter().filter(|(at, _)| *at < distance) {
        steps.push(travel(at.0, "mask", next - at.1));
        steps.push(words::mask("", mask));
        at = ("mask", *next);
    }
    steps.push(travel(at.0, name, distance - at.1));
    steps.push(format!(
        "map  incidence {} onto {name}",
        degrees(incidence.theta0)
    ));
    let shape = incidence.shape(patch, DVec3::Z * distance);
    let curved = words::curvature(shape);
    steps.push(format!("map  curvature {curved}"));
    steps.push("multiply  by the cosine, cos⁺ θ cos² φ".to_owned());
    steps.push("map  mirror: ℓ̂(Ωx, −Ωθ)".to_owned());
    steps.extend(reflection(reflectance));
    steps.extend(system.obstacles.iter().map(words::obstacle));
    if plane.orientation.is_local() {
        return steps;
    }
    steps.push(format!("map  back from local normals, {curved}"));
    if plane.orientation == Orientation::Orthogonal {
        let aside = if phi.abs() > 1e-9 {
            format!(", {} out of the plane of incidence", degrees(phi))
        } else {
            String::new()
        };
        steps.push(format!("map  outgoing angle {}{aside}", degrees(theta)));
        let beyond = (plane.frame.origin - DVec3::Z * distance).length();
        if beyond > 1e-9 {
            steps.push(travel(name, "plane", beyond));
        }
    }
    steps
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
    let lobe = match brdf.lobe {
        Lobe::Lambertian => "Lambertian".to_owned(),
        Lobe::Phong { exponent } => format!("Phong, exponent {}", number(exponent)),
        Lobe::Beckmann { roughness } => format!("Beckmann, roughness {}", number(roughness)),
        Lobe::Ggx { roughness } => format!("GGX, roughness {}", number(roughness)),
    };
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
        Pattern::Cosine(grating) => words::formula(grating, ["s", "t"]),
        Pattern::Picture(picture) => {
            let [w, h] = picture.size;
            format!("picture of {} x {} m", number(w), number(h))
        }
        Pattern::Checkerboard { period } => format!("checkerboard of period {} m", number(*period)),
    }
}
