//! Predicted slices behind specular surfaces.

use super::draw::{RaySampler, RayStrategy};
use super::region::{Finder, Neighbourhood, RayField, neighbourhood};
use crate::geometry::{AffineMap, SpectrumMap};
use crate::light::emitted;
use crate::model::{Over, ShiftedModels};
use crate::nets::{self, DIMENSIONS, Integrand, NetPoints, RayBudget, RayNets, RayNode};
use crate::obstacle::LegRay;
use crate::path::differences::{Differences, DrawnField};
use crate::path::{AtMask, Observed, PathMask, PathSystem, PreparedPath};
use crate::plane::Plane;
use crate::predicted::Predicted;
use etendue_field::{Frame, FrequencyAxis, Mask, SliceGrid, Slices, TwoPlane, Window};
use glam::DVec3;
use std::sync::atomic::{AtomicBool, Ordering};

/// The budget of rays in nets if no projection picture and no moments are requested.
const NO_PICTURES: RayBudget = RayBudget::new(0.0, f64::INFINITY);
/// The maximum number of rays in nets for a projection picture and moments, if slices are computed
/// by a quadrature rule.
const FOR_PICTURES: f64 = 1e6;

/// The prediction from rays followed through the exact geometry, and its derivatives with
/// respect to given parameters.
///
/// For a projector, point or beam, this function uses a midpoint rule if no sharp edge cuts the
/// light and the rule converges. In all other cases, it uses nets of rays. Derivatives are central
/// differences between two predictions from the same sampled rays, so the derivatives are accurate
/// to about a per cent. The result is bitwise identical on any number of threads.
pub(crate) fn predict(
    view: &Observed,
    moved: &[ShiftedModels<Observed>],
    over: Over<'_>,
    budget: RayBudget,
) -> Predicted {
    let Observed { system, plane } = view;
    let observed = (system, Some(plane));
    let path = PreparedPath::new(system);
    let field = exact_field(view, &path);
    let way = neighbourhood(system, plane).and_then(|lands| {
        Some((
            lands,
            best(&field, observed, &lands, (over.0, over.1), budget)?,
        ))
    });
    let of_pictures = RayBudget::new(budget.nodes.min(FOR_PICTURES), 0.0);
    let budgets = [budget, of_pictures];
    let found = summed(&field, observed, way, over, budgets);
    let of = |view| ExactRays::new(view, over.0, way?.1);
    // Without parameters, no rays are prepared for their derivatives.
    let own = if moved.is_empty() { None } else { of(view) };
    match own {
        Some(own) => Differences::new(&own, moved, of).complete(found, over),
        None => Predicted {
            derivatives: vec![Slices::zeros(*over.1); moved.len()],
            ..found
        },
    }
}

/// Calls `then` with the rays that [`predict`] sums over nets.
pub(crate) fn with_rays(
    view: &Observed,
    over: Over<'_>,
    budget: RayBudget,
    then: &mut dyn FnMut(&dyn RayNets),
) {
    let path = PreparedPath::new(&view.system);
    let field = exact_field(view, &path);
    if let Some(draw) = sampler(view, &field, (over.0, over.1), budget) {
        let drawn = SampledField::new(field, &draw, over.0);
        then(&nets::SampledNets::new(&drawn, budget));
    }
}

/// The best sampler of a view's rays, or `None` if no ray arrives.
fn sampler<'a>(
    view: &'a Observed,
    field: &impl RayField,
    (window, grid): (&Window, &SliceGrid),
    budget: RayBudget,
) -> Option<RaySampler<'a>> {
    let Observed { system, plane } = view;
    let observed = (system, Some(plane));
    let lands = neighbourhood(system, plane)?;
    let strategy = best(field, observed, &lands, (window, grid), budget)?;
    RaySampler::new(observed, window, &lands, strategy)
}

/// A ray of the light that is aimed at a window.
#[derive(Clone, Copy, Debug)]
pub struct LightRay {
    /// Position and slopes (x, y, u, v) at the light.
    pub start: [f64; 4],
    /// The coordinates at which the ray arrives at the plane.
    pub arrival: [f64; 4],
    /// The light that the ray brings, before the window, in units that are the same for all rays.
    pub light: f64,
}

/// Returns at most `most` rays of those that [`Model::predict`](crate::Model::predict) follows
/// behind specular surfaces. The rays are the same in every run.
#[must_use]
pub fn sampled(
    view: &Observed,
    (window, grid): (&Window, &SliceGrid),
    most: usize,
) -> Vec<LightRay> {
    let path = PreparedPath::new(&view.system);
    let field = exact_field(view, &path);
    let budget = RayBudget::new(most as f64, 0.0);
    let Some(draw) = sampler(view, &field, (window, grid), budget) else {
        return Vec::new();
    };
    let mut net = NetPoints::new(0, DIMENSIONS);
    let ray = |at: [f64; DIMENSIONS]| {
        let (start, density) = draw.draw(&at)?;
        let (arrival, light) = field(start)?;
        let light = light / density;
        (light > 0.0 && light.is_finite()).then_some(LightRay {
            start,
            arrival,
            light,
        })
    };
    (0..most).filter_map(|_| ray(net.point())).collect()
}

/// The prediction of a first-order chain over the same rays. [`chain`](super::chain())
/// returns such a chain.
///
/// The map moves the radiance of ray z at the light to A z + t, where A is the transpose of the
/// map's matrix and t is the map's phase. The map also multiplies the spectrum by the map's factor,
/// so F = factor · ∫ ℓ(z) W(A z + t) e^(−2πi Ω·(A z + t)) dz. Masks and obstacles
/// are tested with the first-order rays of each leg, and surfaces of the path stop no light. For a
/// plane on a surface that is lit by an environment, z contains angles instead of slopes.
#[must_use]
pub fn linear(
    view: &Observed,
    over: Over<'_>,
    map: &SpectrumMap<4>,
    budget: RayBudget,
) -> Predicted {
    let system = &view.system;
    // In the first-order chain, the map gives the landing point of each ray.
    let mapped = (system, None);
    let path = PreparedPath::new(system);
    let rays = map.rays();
    let lands = (rays.offset, rays.matrix);
    let field = linear_field(view, &path, map);
    let way =
        best(&field, mapped, &lands, (over.0, over.1), budget).map(|strategy| (lands, strategy));
    summed(&field, mapped, way, over, [budget, NO_PICTURES])
}

/// The exact rays of a light field, sampled by one strategy.
struct ExactRays<'a> {
    plane: &'a Plane,
    path: PreparedPath<'a>,
    draw: RaySampler<'a>,
    window: &'a Window,
}

impl<'a> ExactRays<'a> {
    /// Returns `None` if no ray arrives.
    fn new(view: &'a Observed, window: &'a Window, strategy: RayStrategy) -> Option<Self> {
        let Observed { system, plane } = view;
        let lands = neighbourhood(system, plane)?;
        Some(Self {
            plane,
            path: PreparedPath::new(system),
            draw: RaySampler::new((system, Some(plane)), window, &lands, strategy)?,
            window,
        })
    }
}

impl DrawnField for ExactRays<'_> {
    fn path(&self) -> &PreparedPath<'_> {
        &self.path
    }

    fn draw(&self, at: &[f64; DIMENSIONS], at_mask: AtMask<'_>) -> Option<RayNode> {
        let (ray, density) = self.draw.draw(at)?;
        let (z, weight) = exact(self.plane, &self.path, ray, at_mask)?;
        windowed(self.window, z, weight / density)
    }
}

/// A ray whose weight is multiplied by the window.
fn windowed(window: &Window, z: [f64; 4], weight: f64) -> Option<RayNode> {
    let [x, y, u, v] = z;
    let weight = weight * window.value(&TwoPlane { x, y, u, v });
    weight.is_finite().then_some(RayNode { z, weight })
}

fn exact_field<'a>(view: &'a Observed, path: &'a PreparedPath<'a>) -> impl RayField + 'a {
    move |ray| exact(&view.plane, path, ray, &mut path.at_mask())
}

/// A ray's coordinates at a plane and its contribution, as a [`RayField`].
fn exact(
    plane: &Plane,
    path: &PreparedPath<'_>,
    ray: [f64; 4],
    at_mask: AtMask<'_>,
) -> Option<([f64; 4], f64)> {
    let flux = emitted(&path.system.light, ray);
    if flux <= 0.0 {
        return None;
    }
    let (ray, mut passes) = path.follow(ray, at_mask)?;
    passes *= path.leaves(&ray, plane.along(&ray)?, at_mask);
    let (z, per_flux) = plane.coordinates(&ray)?;
    // Light starts in the plane z = 0, so parts of a surface behind this plane are dark. On a
    // curved surface no check is needed, because the point where a ray meets the surface is always
    // ahead of the ray's start.
    let on_first_leg = plane.is_arriving() && path.system.visited == 0 && plane.patch.is_none();
    let lit = !on_first_leg || plane.frame.to_world(DVec3::new(z[0], z[1], 0.0)).z > 0.0;
    lit.then_some((z, passes * flux * per_flux))
}

fn linear_field<'a>(
    view: &'a Observed,
    path: &'a PreparedPath<'a>,
    map: &'a SpectrumMap<4>,
) -> impl RayField + 'a {
    let Observed { system, plane } = view;
    let rays = map.rays();
    let legs = AffineLeg::all(view);
    let is_sky = system.light.environment().is_some();
    let by_angle = is_sky && plane.is_arriving() && system.visited == 0;
    let distance = plane.frame.origin.z;
    move |ray: [f64; 4]| {
        let [.., u, v] = ray;
        let flux = emitted(&system.light, ray);
        if flux <= 0.0 {
            return None;
        }
        let legs = legs.iter().enumerate();
        let passes: f64 = legs.map(|(i, leg)| leg.passes(path, i, ray)).product();
        let radiance = passes * flux * (1.0 + u * u + v * v).powi(2);
        let (ray, per_slope) = if by_angle {
            angles(ray, distance)
        } else {
            (ray, 1.0)
        };
        let z = rays.apply(ray);
        Some((z, map.factor * radiance * per_slope * plane.factor(z)))
    }
}

/// Converts a ray's slopes to angles. The ray's position is shifted such that first-order travel
/// over `distance` with these angles leads to the ray's real landing point. Angles are used if
/// light of an environment arrives on a surface, because the slopes of this light are not small.
/// Also returns dθ dφ divided by du dv.
fn angles([x, y, u, v]: [f64; 4], distance: f64) -> ([f64; 4], f64) {
    let across = (1.0 + u * u).sqrt();
    let (longitude, latitude) = (libm::atan(u), libm::atan(v / across));
    let start = [
        x + distance * (u - longitude),
        y + distance * (v - latitude),
    ];
    // With the cosine c = (1 + u² + v²)^(−1/2), dω = cos φ dθ dφ = du dv c³ and cos φ = c ·
    // `across`.
    let per_slope = 1.0 / (across * (1.0 + u * u + v * v));
    ([start[0], start[1], longitude, latitude], per_slope)
}

/// A leg, and the first-order map about the central ray. This map takes the light's rays to the
/// leg.
struct AffineLeg {
    /// The map from (x, y, u, v) at the light to the coordinates in the leg's frame at the start
    /// of the leg.
    map: AffineMap<4>,
    frame: Frame,
    /// Length of the leg along the central ray, in metres.
    length: f64,
}

impl AffineLeg {
    /// The legs on which light may be stopped, or no legs if there are neither masks nor
    /// obstacles.
    fn all(view: &Observed) -> Vec<Self> {
        let Observed { system, plane } = view;
        let is_open = system.masks.is_empty() && system.obstacles.is_empty();
        let Some(hits) = system.hits().filter(|_| !is_open) else {
            return Vec::new();
        };
        let starts = std::iter::once(Frame::IDENTITY).chain(hits.iter().map(|hit| hit.leaving));
        let leg = |(number, frame): (usize, Frame)| {
            let ray = LegRay {
                point: frame.origin,
                direction: frame.d,
            };
            let length = match hits.get(number) {
                Some(hit) => hit.distance,
                None => plane.along(&ray)?,
            };
            let before = &system.surfaces[..number];
            let map = AffineMap::touching(|emission| {
                let start = LegRay::new(emission);
                let ray = before
                    .iter()
                    .try_fold(start, |ray, element| element.follow(&ray))?;
                ray.across(&frame)
            })?;
            Some(Self { map, frame, length })
        };
        starts.enumerate().filter_map(leg).collect()
    }

    /// The fraction of a ray's light that passes masks and obstacles on this leg; `number`
    /// is the index of the leg.
    fn passes(&self, path: &PreparedPath<'_>, number: usize, ray: [f64; 4]) -> f64 {
        let [x, y, u, v] = self.map.apply(ray);
        let along = DVec3::new(u, v, 1.0);
        let ray = LegRay {
            point: self.frame.to_world(DVec3::new(x, y, 0.0)),
            direction: self.frame.vector_to_world(along.normalize()),
        };
        let length = self.length * along.length();
        path.passes_beside(number, &ray, length, &mut path.at_mask())
    }
}

/// The grid for nets that compute only projection pictures and moments, because slices are
/// computed by a quadrature rule.
const NO_FREQUENCIES: SliceGrid = SliceGrid {
    azimuths: 1,
    rho: NO_FREQUENCY,
    nu: NO_FREQUENCY,
};
const NO_FREQUENCY: FrequencyAxis = FrequencyAxis {
    half: 1,
    spacing: 1.0,
};

fn summed(
    field: &impl RayField,
    observed: (&PathSystem, Option<&Plane>),
    way: Option<(Neighbourhood, RayStrategy)>,
    (window, grid, picture): Over<'_>,
    [of_slices, of_pictures]: [RayBudget; 2],
) -> Predicted {
    let draw =
        way.and_then(|(lands, strategy)| RaySampler::new(observed, window, &lands, strategy));
    let (system, _) = observed;
    let (Some((lands, _)), Some(draw)) = (way, draw) else {
        return Predicted::dark(grid, picture, 0);
    };
    let drawn = SampledField::new(field, &draw, window);
    let by_nets = |grid, budget| nets::sums(&drawn, (window, grid), picture.bins, budget);
    let is_grating = |one: &PathMask| matches!(one.mask, Mask::Grating(_));
    let is_open = system.masks.iter().all(is_grating) && system.obstacles.is_empty();
    if system.light.has_extent() || !is_open {
        return by_nets(grid, of_slices);
    }
    let pictures = by_nets(&NO_FREQUENCIES, of_pictures);
    // A surface that stops light leaves an edge, which a quadrature rule may miss.
    if drawn.stops.load(Ordering::Relaxed) {
        return by_nets(grid, of_slices);
    }
    let finder = Finder {
        field,
        window,
        emission: system.emission(),
        neighbourhood: lands,
    };
    let by_rule = finder.slices(grid, nets::work_of_nets(grid, of_slices).steps);
    // If a quadrature rule finds no light, the window may still contain light, so nets are used.
    match by_rule.filter(|(slices, _)| !slices.is_dark()) {
        Some((slices, error)) => Predicted {
            slices,
            replicates: Vec::new(),
            error: Some(error),
            ..pictures
        },
        None => by_nets(grid, of_slices),
    }
}

/// The sampling strategy that has the smallest error in a trial.
fn best(
    field: &impl RayField,
    observed: (&PathSystem, Option<&Plane>),
    lands: &Neighbourhood,
    (window, grid): (&Window, &SliceGrid),
    budget: RayBudget,
) -> Option<RayStrategy> {
    let tried = RayStrategy::ALL.iter().filter_map(|&strategy| {
        let draw = RaySampler::new(observed, window, lands, strategy)?;
        let drawn = SampledField::new(field, &draw, window);
        Some((nets::trial(&drawn, (window, grid), budget), strategy))
    });
    let best = tried.min_by(|(a, _), (b, _)| a.total_cmp(b));
    best.map(|(_, strategy)| strategy)
}

/// A light field together with the strategy by which its rays are sampled.
struct SampledField<'a> {
    field: Box<dyn RayField + 'a>,
    draw: &'a RaySampler<'a>,
    window: &'a Window,
    /// Whether a ray towards the window has been stopped.
    stops: AtomicBool,
}

impl<'a> SampledField<'a> {
    fn new(field: impl RayField + 'a, draw: &'a RaySampler<'a>, window: &'a Window) -> Self {
        Self {
            field: Box::new(field),
            draw,
            window,
            stops: AtomicBool::new(false),
        }
    }

    fn node(&self, at: &[f64; DIMENSIONS]) -> RayNode {
        let arrives = self.draw.draw(at).and_then(|(ray, density)| {
            let (z, weight) = (self.field)(ray)?;
            if weight == 0.0 && windowed(self.window, z, 1.0)?.weight > 0.0 {
                self.stops.store(true, Ordering::Relaxed);
            }
            windowed(self.window, z, weight / density)
        });
        arrives.unwrap_or(RayNode::DARK)
    }
}

impl Integrand for SampledField<'_> {
    fn nodes(&self, at: &[f64; DIMENSIONS], _: &[bool], nodes: &mut [RayNode]) {
        nodes[0] = self.node(at);
    }
}
