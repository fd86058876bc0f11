//! Samples a path from the light to the plane, for a point of the unit cube.

use super::aim::DirectionCoordinates;
use super::direction::OutgoingDirections;
use super::guide::{Conditional, Gaussian, HeavyTailedGaussian};
use super::sky::SkyRays;
use crate::light::{emitted, point_of};
use crate::nets::{DIMENSIONS, RayNode};
use crate::obstacle::LegRay;
use crate::path::local;
use crate::path::{
    AtMask, Observed, PatchExtent, PathChain, PathSurface, PreparedPath, SAME_DISTANCE,
    ScatteringSurface, chain,
};
use etendue_field::{EmittedRays, Light, TwoPlane, Window};
use glam::DVec3;
use std::f64::consts::TAU;

/// Paths of a light field.
#[derive(Debug)]
pub(super) struct FieldPaths<'a> {
    view: &'a Observed,
    window: &'a Window,
    pub(super) occluders: PreparedPath<'a>,
    chain: PathChain,
    start: PathStart<'a>,
    /// For each scatterer, the Gaussian of the outgoing directions that reach the window.
    guides: Vec<Conditional>,
    /// The coordinates by which rays are aimed, for the leg from the light and for the leg from
    /// each scatterer.
    aims: Vec<DirectionCoordinates>,
}

/// The sampling of the light's rays.
#[derive(Debug)]
enum PathStart<'a> {
    /// Positions in a beam are drawn. The Gaussian describes the rays that reach the window.
    Beam(Conditional),
    /// Directions from points of the light are drawn. The Gaussian describes the rays that reach
    /// the window.
    Points(Conditional),
    Sky(Box<SkyRays<'a>>),
}

impl<'a> PathStart<'a> {
    /// `guide` is the Gaussian of the light that arrives at the first scatterer and reaches the
    /// window. `aim` contains the coordinates of the leg from the light.
    fn new(
        view: &'a Observed,
        chain: &PathChain,
        guide: &Gaussian<4>,
        aim: DirectionCoordinates,
    ) -> Option<Self> {
        let light = &view.system.light;
        let at_light = || of_light(&guide.before(&chain.maps[0])?, light);
        Some(match light.rays() {
            EmittedRays::OfSky(environment) => {
                let first = chain.scatterers.first()?;
                let surface = &view.system.surfaces[first.number];
                let is_aimed_at_it = matches!(aim, DirectionCoordinates::Patch { .. });
                let guide = if is_aimed_at_it { *guide } else { at_light()? };
                let has_lobe = surface.width(surface.hit).is_some();
                let rays = SkyRays::new(environment, &guide, (first, has_lobe), aim)?;
                Self::Sky(Box::new(rays))
            }
            EmittedRays::Parallel(_) => Self::Beam(at_light()?.given([2, 3])?),
            EmittedRays::OfShape(_) | EmittedRays::OfPoint(_) | EmittedRays::Listed(_) => {
                Self::Points(at_light()?.given([0, 1])?)
            }
        })
    }
}

/// A path through the exact geometry, and the corresponding path in the chain.
pub(super) struct DrawnPath {
    pub(super) exact: RayNode,
    pub(super) first_order: RayNode,
}

/// A path under construction.
struct PathState {
    ray: LegRay,
    /// Flux divided by the sampling density.
    flux: f64,
    /// The weight in the chain: radiance times the volume that the path represents.
    radiance: f64,
    /// Coordinates of the ray in the chain.
    at: [f64; 4],
    /// The point of the surface at the end of the leg at which the leg is aimed.
    target: Option<DVec3>,
}

impl<'a> FieldPaths<'a> {
    /// The paths of a light field; `None` if the chain does not determine a guide. Rays of
    /// the last leg are aimed by angles.
    pub(super) fn new(view: &'a Observed, window: &'a Window) -> Option<Self> {
        let chain = chain(view)?;
        let mut guides = Vec::new();
        let mut guide = Gaussian::of_window(window);
        for (scatterer, map) in chain.scatterers.iter().zip(&chain.maps[1..]).rev() {
            guide = guide.before(map)?;
            guides.push(guide.given([0, 1])?);
            let surface = &view.system.surfaces[scatterer.number];
            guide = on_surface(&guide, surface, scatterer)?;
        }
        guides.reverse();
        let legs = 0..chain.maps.len();
        let aims = legs.map(|leg| DirectionCoordinates::new(&view.system, &chain.scatterers, leg));
        let aims: Vec<DirectionCoordinates> = aims.collect();
        let start = PathStart::new(view, &chain, &guide, aims[0])?;
        Some(Self {
            view,
            window,
            aims,
            occluders: PreparedPath::new(&view.system),
            chain,
            start,
            guides,
        })
    }

    /// The coordinates by which rays of the last leg are aimed at its end, if they are
    /// known.
    pub(super) fn at_plane(&self) -> Option<DirectionCoordinates> {
        DirectionCoordinates::at_plane(self.view, &self.chain.scatterers)
    }

    /// Aims the rays of the last leg by the given coordinates.
    pub(super) fn aim_last_leg(&mut self, aim: DirectionCoordinates) {
        if let Some(last) = self.aims.last_mut() {
            *last = aim;
        }
    }

    /// Checks whether rays of the last leg are aimed at positions at its end.
    pub(super) fn is_aimed_at_plane(&self) -> bool {
        !matches!(self.aims.last(), Some(DirectionCoordinates::Angles))
    }

    /// The number of scatterers of the path.
    pub(super) fn scatterers(&self) -> usize {
        self.chain.scatterers.len()
    }

    /// The path for a point of the unit cube; `None` if the path carries no light.
    pub(super) fn drawn(&self, at: &[f64; DIMENSIONS], at_mask: AtMask<'_>) -> Option<DrawnPath> {
        let system = &self.view.system;
        let mut going = self.begin([at[0], at[1], at[2], at[3]])?;
        let mut scatterers = 0;
        for (leg, surface) in system.before_plane().iter().enumerate() {
            let point = self.arrive(leg, &mut going, at_mask)?;
            if surface.scatters() {
                let r = [at[4 + 2 * scatterers], at[5 + 2 * scatterers]];
                self.scatter(scatterers, point, r, &mut going)?;
                scatterers += 1;
            } else {
                going.ray = surface.turned(&going.ray, point)?;
            }
        }
        self.end(&going, at_mask)
    }

    /// Samples a ray of the light.
    fn begin(&self, [a, b, c, d]: [f64; 4]) -> Option<PathState> {
        let light = &self.view.system.light;
        let (outer, per_area) = match light.shape() {
            Some(shape) => (point_of(shape, [c, d]), shape.area()),
            None => ([0.0; 2], 1.0),
        };
        let map = &self.chain.maps[0];
        let aim = &self.aims[0];
        let mut target = None;
        let (ray, density) = match &self.start {
            PathStart::Sky(rays) => {
                let (ray, density, aimed) = rays.draw([a, b, c, d])?;
                target = aimed;
                (ray, density)
            }
            PathStart::Beam(guide) => {
                let rays = HeavyTailedGaussian::new(&guide.at(outer))?;
                let [x, y] = rays.draw([a, b]);
                ([x, y, 0.0, 0.0], rays.density([x, y]))
            }
            PathStart::Points(guide) => {
                let [x, y] = outer;
                let targets = HeavyTailedGaussian::new(&aim.seen(&guide.at(outer), outer, map))?;
                let at = targets.draw([a, b]);
                let density = targets.density(at);
                if matches!(aim, DirectionCoordinates::Angles) {
                    ([x, y, at[0], at[1]], density)
                } else {
                    let (d, steradians) = aim.direction(DVec3::new(x, y, 0.0), at, None)?;
                    target = aim.target(at);
                    // du dv = dω / cos³.
                    let density = density / steradians * d.z.powi(3);
                    ([x, y, d.x / d.z, d.y / d.z], density)
                }
            }
        };
        let flux = emitted(light, ray) * per_area / density;
        let [.., u, v] = ray;
        (flux > 0.0 && flux.is_finite()).then(|| PathState {
            ray: LegRay::new(ray),
            flux,
            radiance: flux * (1.0 + u * u + v * v).powi(2) * map.det().abs(),
            at: map.apply(ray),
            target,
        })
    }

    /// The point where light meets the surface at the end of a leg. Returns `None` if the
    /// light misses this surface.
    fn arrive(&self, leg: usize, going: &mut PathState, at_mask: AtMask<'_>) -> Option<DVec3> {
        let PathState { ray, .. } = going;
        let end = self.view.system.surfaces[leg].first(ray, ray.start())?;
        let passes = self.occluders.passes(leg, ray, end, at_mask);
        going.flux *= passes;
        going.radiance *= passes;
        let point = ray.at(end);
        // If a ray meets the surface at two points, the ray counts only if it was aimed at the
        // first point.
        let target = going.target.take();
        let is_second = target.is_some_and(|target| is_beside(target, point, end));
        (passes > 0.0 && !is_second).then_some(point)
    }

    /// Samples a direction away from a scatterer, and updates the weight.
    fn scatter(
        &self,
        number: usize,
        point: DVec3,
        r: [f64; 2],
        going: &mut PathState,
    ) -> Option<()> {
        let scatterer = &self.chain.scatterers[number];
        let surface = &self.view.system.surfaces[scatterer.number];
        let normal = surface.lit_side(point, going.ray.direction)?;
        let from = -going.ray.direction;
        let [s, t, from_theta, from_phi] = local(&scatterer.frame, point, normal, from);
        let [theta0, phi0] = scatterer.outgoing;
        let width = surface.width(point);
        let center = match width {
            Some(_) => [-from_theta - theta0, -from_phi - phi0],
            None => [-theta0, -phi0],
        };
        let (aim, map) = (&self.aims[number + 1], &self.chain.maps[number + 1]);
        let directions = OutgoingDirections {
            aim,
            map,
            scatterer,
            next: self.view.system.surfaces.get(scatterer.number + 1),
            point,
            normal,
        };
        let mirrored = width.map(|_| 2.0 * normal.dot(from) * normal - from);
        let lobe = (Gaussian::round(center, width), mirrored);
        let sampled = directions.draw(r, [s, t], &self.guides[number], lobe)?;
        let (to, per_density) = (sampled.direction, 1.0 / sampled.density);
        let [.., longitude, latitude] = local(&scatterer.frame, point, normal, to);
        let value = surface.value(point, normal, [from, to]);
        going.flux *= value * normal.dot(to).max(0.0) * per_density;
        going.ray = LegRay {
            point,
            direction: to,
        };
        going.target = sampled.target;
        let [s, t, from_theta, from_phi] = going.at;
        let cosine = libm::cos(from_theta).max(0.0) * libm::cos(from_phi).powi(2);
        let foot = scatterer.frame.to_world(DVec3::new(s, t, 0.0));
        let lobe = surface.kernel(
            foot,
            scatterer.incidence,
            [[from_theta, from_phi], [longitude, latitude]],
        );
        // dθ dφ = dω / cos φ.
        let per_angle = per_density / libm::cos(latitude);
        going.radiance *= cosine * lobe * per_angle * map.det().abs();
        going.at = map.apply([s, t, longitude - theta0, latitude - phi0]);
        (going.flux > 0.0 || going.radiance > 0.0).then_some(())
    }

    /// Follows the last leg, to the plane.
    fn end(&self, going: &PathState, at_mask: AtMask<'_>) -> Option<DrawnPath> {
        let PathState {
            ray,
            flux,
            radiance,
            at,
            target,
        } = going;
        let plane = &self.view.plane;
        let length = plane.along(ray)?;
        if target.is_some_and(|target| is_beside(target, ray.at(length), length)) {
            return None;
        }
        let passes = self.occluders.leaves(ray, length, at_mask);
        if passes == 0.0 {
            return None;
        }
        let exact = plane.coordinates(ray).map(|(z, per_flux)| RayNode {
            z,
            weight: passes * flux * per_flux * self.seen(z),
        });
        let first_order = RayNode {
            z: *at,
            weight: passes * radiance * plane.factor(*at) * self.seen(*at),
        };
        Some(DrawnPath {
            exact: exact.unwrap_or(RayNode::DARK),
            first_order,
        })
    }

    fn seen(&self, [x, y, u, v]: [f64; 4]) -> f64 {
        self.window.value(&TwoPlane { x, y, u, v })
    }
}

/// Checks whether a ray that was aimed at `target` met a surface at another point.
fn is_beside(target: DVec3, point: DVec3, length: f64) -> bool {
    target.distance(point) > SAME_DISTANCE * length
}

/// Standard deviation of the angles of incidence in a guide, in radians. It applies if the light
/// and the surface do not narrow these angles.
const FRONT: f64 = 0.6;

/// The guide for incident light at a surface, given the guide for outgoing light.
fn on_surface(
    guide: &Gaussian<4>,
    surface: &PathSurface,
    scatterer: &ScatteringSurface,
) -> Option<Gaussian<4>> {
    let width = surface.width(surface.hit);
    // This is the variance of positions along an axis of a rectangle or a disc.
    let variance = match surface.extent {
        PatchExtent::Rectangle([x, y]) => (x * x + y * y) / 24.0,
        PatchExtent::Whole => 0.25 * surface.patch.aperture * surface.patch.aperture,
    };
    let middle = scatterer.frame.to_local(surface.patch.frame.origin);
    let front = 1.0 / (FRONT * FRONT);
    let edge = 1.0 / variance;
    guide
        .before_lobe(width, scatterer.outgoing)
        .narrowed([middle.x, middle.y, 0.0, 0.0], [edge, edge, front, front])
}

/// Restricts the guide for rays that reach the window to the rays that the light emits.
fn of_light(guide: &Gaussian<4>, light: &Light) -> Option<Gaussian<4>> {
    let Some(image) = light.image() else {
        return Some(*guide);
    };
    let [a, b] = image.width.map(|width| TAU / (width * width));
    let precisions = if light.is_distant() {
        [a, b, 0.0, 0.0]
    } else {
        [0.0, 0.0, a, b]
    };
    guide.narrowed([0.0; 4], precisions)
}
