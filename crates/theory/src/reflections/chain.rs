//! The first-order chain, which consists of affine maps between scattering surfaces and the lobes
//! of these surfaces.

use crate::geometry::{AffineMap, Matrix};
use crate::obstacle::{LegRay, normal};
use crate::path::{Interaction, Observed, PathSurface};
use crate::rays::Incidence;
use crate::scattering::{local, reflection};
use crate::words::{self, degrees};
use etendue_field::{Frame, Specular};
use glam::DVec3;

/// The path of the central ray, with first-order maps of the rays near the central ray.
///
/// Local coordinates at a scattering surface are (s, t, θ, φ): positions along T and B in metres,
/// and two angles about the local normal. The angles are the longitude and latitude of a direction
/// away from the surface. T lies in the plane of incidence.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflectionChain {
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
    /// Longitude of the direction from which the central ray comes.
    pub incidence: f64,
    /// Longitude and latitude of the direction in which the central ray leaves.
    pub outgoing: [f64; 2],
}

/// Returns the chain of a system up to a plane; `None` if the central ray does not arrive at the
/// plane.
///
/// The maps of the chain are the derivatives of the exact rays.
#[must_use]
pub fn chain(view: &Observed) -> Option<ReflectionChain> {
    let scatterers = scatterers(view)?;
    let maps = (0..=scatterers.len()).map(|leg| map(view, &scatterers, leg));
    Some(ReflectionChain {
        maps: maps.collect::<Option<_>>()?,
        steps: steps(view, &scatterers)?,
        scatterers,
    })
}

/// Returns the largest difference between the maps of a chain and the derivatives of the exact
/// rays, in metres or radians, or as a ratio of these. The difference is zero for the chain that
/// [`chain`] returns.
#[must_use]
pub fn defect(view: &Observed, tried: &ReflectionChain) -> Option<f64> {
    let traced = chain(view)?;
    let pairs = tried.maps.iter().zip(&traced.maps);
    Some(pairs.fold(0.0, |most, (a, b)| a.apart(b, &[1.0; 4]).max(most)))
}

impl ReflectionChain {
    /// Returns the map z' = A z from the light to the plane, for rays that every scatterer reflects
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

fn scatterers(view: &Observed) -> Option<Vec<ScatteringSurface>> {
    let Observed { system, plane } = view;
    let visited = system.before_plane();
    let mut from = DVec3::ZERO;
    let mut found = Vec::new();
    for (number, surface) in visited.iter().enumerate() {
        let hit = surface.hit;
        let arriving = (hit - from).normalize();
        from = hit;
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
            incidence: incidence.theta0,
            outgoing: [longitude, latitude],
        });
    }
    Some(found)
}

/// Returns the map from the light or a scatterer to the next scatterer or the plane.
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
    /// Returns the ray that leaves a surface with the given local coordinates, which are relative
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

/// Returns the direction with a longitude and a latitude about a normal. The angles are measured in
/// the axes of a frame after its D is turned to the normal.
pub(super) fn towards(frame: &Frame, normal: DVec3, [theta, phi]: [f64; 2]) -> DVec3 {
    let [(sin, cos), (up, across)] = [theta, phi].map(libm::sincos);
    let away = DVec3::new(across * sin, up, across * cos);
    frame.turned_to(normal).vector_to_world(away)
}

fn steps(view: &Observed, scatterers: &[ScatteringSurface]) -> Option<Vec<String>> {
    let Observed { system, plane } = view;
    let masks = system.masks.iter().map(|(_, mask)| words::mask("", mask));
    let obstacles = system.obstacles.iter().map(words::obstacle);
    let mut steps: Vec<String> = masks.chain(obstacles).collect();
    let (mut at, mut name) = (DVec3::ZERO, "light");
    let mut scatterers = scatterers.iter().peekable();
    for (number, surface) in system.before_plane().iter().enumerate() {
        let arriving = surface.hit - at;
        steps.push(words::travel(arriving.length(), name, &surface.name));
        let leg = Frame::IDENTITY.turned_to(arriving.normalize());
        let incidence = Incidence::new(&leg, normal(&surface.patch, surface.hit)?);
        let (angle, to) = (degrees(incidence.theta0), &surface.name);
        steps.push(format!("map  incidence {angle} onto {to}"));
        let shape: Matrix<2> = incidence.shape(&surface.patch, surface.hit);
        let curved = words::curvature(shape);
        steps.push(format!("map  curvature {curved}"));
        steps.extend(in_words(&surface.interaction));
        if let Some(scatterer) = scatterers.next_if(|scatterer| scatterer.number == number) {
            steps.push(format!("map  back from local normals, {curved}"));
            let [theta, phi] = scatterer.outgoing.map(degrees);
            steps.push(format!("map  outgoing angles {theta} and {phi}"));
        }
        (at, name) = (surface.hit, &surface.name);
    }
    let beyond = (plane.frame.origin - at).length();
    if beyond > 1e-9 {
        steps.push(words::travel(beyond, name, "plane"));
    }
    Some(steps)
}

fn in_words(interaction: &Interaction) -> Vec<String> {
    const COSINE: &str = "multiply  by the cosine, cos⁺ θ cos² φ";
    const MIRROR: &str = "map  mirror: ℓ̂(Ωx, −Ωθ)";
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
    match interaction {
        Interaction::Specular(Specular::Mirror) => words(&[MIRROR]),
        Interaction::Specular(Specular::Refraction { front, back }) => {
            vec![format!(
                "map  refraction between indices {front} and {back}"
            )]
        }
        Interaction::Specular(Specular::ThinLens { focal_length }) => {
            vec![format!("map  thin lens of focal length {focal_length} m")]
        }
        Interaction::Diffuse { albedo } => {
            let mut all: Vec<String> = words(&[COSINE]);
            all.push(format!(
                "convolve  with the diffuse reflection, albedo {albedo}"
            ));
            all
        }
        Interaction::Reflects(reflectance) => {
            let mut all: Vec<String> = words(&[COSINE, MIRROR]);
            all.extend(reflection(reflectance));
            all
        }
    }
}
