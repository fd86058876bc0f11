//! The first-order chain of a path on which surfaces scatter light. It consists of affine maps
//! between these surfaces and of their lobes.

use super::{Interaction, Observed, PathMask, PathSurface};
use crate::geometry::{AffineMap, Matrix};
use crate::obstacle::{LegRay, normal};
use crate::path::rays::Incidence;
use crate::words::{self, degrees};
use etendue_field::{Frame, Orientation, Quantity, Specular};
use glam::DVec3;

/// The path of the central ray, with first-order maps of the rays near the central ray.
///
/// Local coordinates at a scattering surface are (s, t, θ, φ): positions along T and B in metres,
/// and two angles about the local normal. The angles are the longitude and latitude of a direction
/// away from the surface. T lies in the plane of incidence.
#[derive(Clone, Debug, PartialEq)]
pub struct PathChain {
    /// The scattering surfaces, in the order in which light meets them.
    pub scatterers: Vec<ScatteringSurface>,
    /// The affine maps, one more than there are scatterers. The first map takes (x, y, u, v) at the
    /// light to local coordinates of the direction of incidence at the first scatterer. Each later
    /// map takes local coordinates of the outgoing direction at a scatterer to the next scatterer;
    /// these coordinates are relative to the central ray. The last map leads to the coordinates of
    /// the plane.
    pub maps: Vec<AffineMap<4>>,
    /// Descriptions of the steps, in the order of propagation.
    pub steps: Vec<String>,
}

/// A scattering surface at the point where the central ray meets it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatteringSurface {
    /// Index of the surface among the surfaces of the path.
    pub number: usize,
    /// The axes (T, B, N) at the central ray's hit, with N on the side from which light is
    /// scattered.
    pub frame: Frame,
    /// The surface's shape operator along (T, B), per metre. It is positive for convex surfaces.
    pub curvature: Matrix<2>,
    /// Longitude of the direction from which the central ray comes.
    pub incidence: f64,
    /// Longitude and latitude of the direction in which the central ray leaves.
    pub outgoing: [f64; 2],
}

/// The chain of a system up to a plane; `None` if the central ray does not arrive at the
/// plane.
///
/// The maps of the chain are the derivatives of the exact rays. Apart from rotations of the axes, the
/// maps equal the corrected maps of Durand et al. 2005, Eqs. 9–11 and 19 (docs/theory.md, section
/// 7), as the tests verify.
#[must_use]
pub fn chain(view: &Observed) -> Option<PathChain> {
    let scatterers = scatterers(view)?;
    let maps = (0..=scatterers.len()).map(|leg| map(view, &scatterers, leg));
    Some(PathChain {
        maps: maps.collect::<Option<_>>()?,
        steps: steps(view, &scatterers)?,
        scatterers,
    })
}

/// The largest difference between the maps of a chain and the derivatives of the exact
/// rays, in metres or radians, or as a ratio of these. The difference is zero for the chain that
/// [`chain`] returns.
#[must_use]
pub fn defect(view: &Observed, tried: &PathChain) -> Option<f64> {
    let traced = chain(view)?;
    let pairs = tried.maps.iter().zip(&traced.maps);
    Some(pairs.fold(0.0, |most, (a, b)| a.apart(b, &[1.0; 4]).max(most)))
}

impl PathChain {
    /// The map z' = A z from the light to the plane, for rays that every scatterer reflects
    /// in the mirror direction.
    #[must_use]
    pub fn rays(&self) -> AffineMap<4> {
        let mut maps = self.maps.iter();
        let first = maps.next().copied().unwrap_or_else(AffineMap::identity);
        maps.fold(first, |rays, map| {
            rays.then(&AffineMap::<4>::mirror()).then(map)
        })
    }
}

/// The local coordinates of a point of a surface and of a direction away from the surface.
/// `frame` has the axes at the central ray's hit.
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

fn scatterers(view: &Observed) -> Option<Vec<ScatteringSurface>> {
    let Observed { system, plane } = view;
    let visited = system.before_plane();
    let mut from = DVec3::ZERO;
    let mut found = Vec::new();
    for (number, surface) in visited.iter().enumerate() {
        let hit = surface.hit;
        let arriving = (hit - from).normalize();
        from = hit;
        // Light changes its direction here, but its spectrum is not convolved.
        if !surface.scatters() {
            continue;
        }
        let leaving = match visited.get(number + 1) {
            Some(next) => (next.hit - hit).normalize(),
            None => plane.ray([0.0; 4])?.0.direction,
        };
        let normal = surface.lit_side(hit, arriving)?;
        let leg = Frame::IDENTITY.turned_to(arriving);
        let leg = Frame { origin: hit, ..leg };
        let incidence = Incidence::new(&leg, normal);
        let frame = Frame {
            origin: hit,
            x: incidence.t,
            y: incidence.b,
            d: incidence.n,
        };
        let [.., longitude, latitude] = local(&frame, hit, normal, leaving);
        found.push(ScatteringSurface {
            number,
            frame,
            curvature: incidence.shape(&surface.patch, hit),
            incidence: incidence.theta0,
            outgoing: [longitude, latitude],
        });
    }
    Some(found)
}

/// The map from the light or a scatterer to the next scatterer or the plane.
fn map(view: &Observed, scatterers: &[ScatteringSurface], leg: usize) -> Option<AffineMap<4>> {
    let Observed { system, plane } = view;
    let from = leg.checked_sub(1).map(|before| &scatterers[before]);
    let first = from.map_or(0, |from| from.number + 1);
    let to = scatterers.get(leg);
    let last = to.map_or(system.visited, |to| to.number);
    AffineMap::touching(|z| {
        let start = match from {
            None => LegRay::new(z),
            Some(from) => from.ray(&system.surfaces[from.number], z)?,
        };
        let specular = &system.surfaces[first..last];
        let ray = specular
            .iter()
            .try_fold(start, |ray, surface| surface.follow(&ray))?;
        match to {
            None => Some(plane.coordinates(&ray)?.0),
            Some(to) => {
                let surface = &system.surfaces[to.number];
                let point = surface.met(&ray)?;
                let normal = surface.lit_side(point, ray.direction)?;
                Some(local(&to.frame, point, normal, -ray.direction))
            }
        }
    })
}

impl ScatteringSurface {
    /// The ray that leaves a surface with the given local coordinates, which are relative
    /// to the central ray.
    fn ray(&self, surface: &PathSurface, [s, t, theta, phi]: [f64; 4]) -> Option<LegRay> {
        let foot = self.frame.to_world(DVec3::new(s, t, 0.0));
        let down = LegRay::back(&surface.patch, foot, self.frame.d);
        let (distance, normal) = down.met(&surface.patch)?;
        let normal = normal * normal.dot(self.frame.d).signum();
        let [longitude, latitude] = self.outgoing;
        Some(LegRay {
            point: down.point + distance * down.direction,
            direction: towards(&self.frame, normal, [longitude + theta, latitude + phi]),
        })
    }
}

/// The direction with a longitude and a latitude about a normal. The angles are measured in
/// the axes of a frame after its D is turned to the normal.
pub(crate) fn towards(frame: &Frame, normal: DVec3, [theta, phi]: [f64; 2]) -> DVec3 {
    let [(sin, cos), (up, across)] = [theta, phi].map(libm::sincos);
    let away = DVec3::new(across * sin, up, across * cos);
    frame.turned_to(normal).vector_to_world(away)
}

fn steps(view: &Observed, scatterers: &[ScatteringSurface]) -> Option<Vec<String>> {
    let Observed { system, plane } = view;
    let visited = system.before_plane();
    let mut steps = Vec::new();
    let (mut name, mut travelled) = ("light", 0.0);
    let first_leg = visited.first()?.hit.z;
    for PathMask { distance, mask, .. } in system.masks_before(first_leg) {
        steps.push(words::travel(distance - travelled, name, "mask"));
        steps.push(words::mask("", mask));
        (name, travelled) = ("mask", *distance);
    }
    let mut at = DVec3::Z * travelled;
    let is_on_last = plane.orientation != Orientation::Orthogonal && !plane.is_arriving();
    let mut scatterers = scatterers.iter().peekable();
    for (number, surface) in visited.iter().enumerate() {
        let arriving = surface.hit - at;
        steps.push(words::travel(arriving.length(), name, &surface.name));
        let leg = Frame::IDENTITY.turned_to(arriving.normalize());
        let incidence = Incidence::new(&leg, normal(&surface.patch, surface.hit)?);
        let (angle, to) = (degrees(incidence.theta0), &surface.name);
        steps.push(format!("map  incidence {angle} onto {to}"));
        let curved = words::curvature(incidence.shape(&surface.patch, surface.hit));
        steps.push(format!("map  curvature {curved}"));
        steps.extend(in_words(&surface.interaction));
        let is_last = number + 1 == visited.len();
        if is_last {
            steps.extend(system.obstacles.iter().map(words::obstacle));
        }
        let scatterer = scatterers.next_if(|scatterer| scatterer.number == number);
        let is_local = is_last && is_on_last && plane.orientation.is_local();
        if let Some(scatterer) = scatterer.filter(|_| !is_local) {
            steps.push(format!("map  back from local normals, {curved}"));
            if !(is_last && is_on_last) {
                steps.push(words::outgoing(scatterer.outgoing));
            }
        }
        (at, name) = (surface.hit, &surface.name);
    }
    let beyond = (plane.frame.origin - at).length();
    if !is_on_last && beyond > 1e-9 {
        steps.push(words::travel(beyond, name, "plane"));
    }
    if plane.quantity == Quantity::DifferentialIrradiance {
        let cosine = match plane.orientation {
            Orientation::Orthogonal => "multiply  by the cosine, G = (1 + u² + v²)⁻²",
            _ => COSINE,
        };
        steps.push(cosine.to_owned());
    }
    Some(steps)
}

const COSINE: &str = "multiply  by the cosine, cos⁺ θ cos² φ";

fn in_words(interaction: &Interaction) -> Vec<String> {
    const MIRROR: &str = "map  mirror: ℓ̂(Ωx, −Ωθ)";
    match interaction {
        Interaction::Specular(Specular::Mirror) => vec![MIRROR.to_owned()],
        Interaction::Specular(Specular::Refraction { front, back }) => {
            vec![format!(
                "map  refraction between indices {front} and {back}"
            )]
        }
        Interaction::Specular(Specular::ThinLens { focal_length }) => {
            vec![format!("map  thin lens of focal length {focal_length} m")]
        }
        Interaction::Diffuse { albedo } => vec![
            COSINE.to_owned(),
            format!("convolve  with the diffuse reflection, albedo {albedo}"),
        ],
        Interaction::Reflects(reflectance) => {
            let mut all = vec![COSINE.to_owned(), MIRROR.to_owned()];
            all.extend(words::reflection(reflectance));
            all
        }
    }
}
