//! Importance sampling of rays at a plane and of the light. The light is sampled for the point
//! where each ray leaves the surface.
//!
//! Any density that is non-zero wherever there is light gives the same integral. These densities
//! follow the window, the lobe of the BRDF and the light. If two densities are suitable, half of
//! the rays are sampled from each, and all rays are weighted by the mixture of both densities (the
//! balance heuristic, Veach and Guibas 1995).

use super::brdf::narrowest;
use super::exact::Leaving;
use super::incoming::secant;
use crate::geometry::{AffineMap, Matrix, product, times};
use crate::light::{LightPart, LightParts};
use crate::nets::LinearDensity;
use crate::path::{PathChain, PathSystem};
use etendue_field::{EmittedRays, Frame, Shape, Window};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A strategy for sampling rays and parts of the light. No strategy is best for every scene, so
/// several strategies are tried on each scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LightStrategy {
    /// Whether half of the slopes at the plane are sampled about the mirror image of the light.
    pub(super) mirrored: bool,
    /// Whether half of the parts of the light are sampled in proportion to the BRDF's lobe.
    pub(super) by_lobe: bool,
    /// Whether four parts of the light are sampled for each point of the surface.
    pub(super) quarters: bool,
}

impl LightStrategy {
    /// Changes of a strategy, each in a single choice.
    pub(super) const CHOICES: [fn(&mut Self); 3] = [
        |strategy| strategy.mirrored ^= true,
        |strategy| strategy.by_lobe ^= true,
        |strategy| strategy.quarters ^= true,
    ];

    /// This strategy without the choices that have no effect for a system.
    pub(super) fn in_effect(self, system: &PathSystem) -> Self {
        let has_extent = system.light.has_extent();
        let has_lobe = narrowest_of(system).is_some();
        let has_center = system.light.environment().is_none();
        Self {
            mirrored: self.mirrored && has_lobe && has_center,
            by_lobe: self.by_lobe && has_lobe && has_extent,
            quarters: self.quarters && has_extent,
        }
    }

    /// The approximate computing time of a ray with this strategy. The time is relative to
    /// the time of a ray that is sampled by the window and has a single part of the light.
    pub(super) fn time(self) -> f64 {
        if self.quarters { 1.7 } else { 1.0 }
    }
}

/// Samples rays at a plane.
#[derive(Clone, Debug)]
pub(super) struct PlaneRaySampler {
    /// Densities over x, y, u and v that follow the window.
    window: [LinearDensity; 4],
    /// Slopes towards the mirror image of the light's centre.
    mirrored: Option<Mirrored>,
}

/// A density of slopes. The density is centred on the slopes of the light's mirror image, and these
/// slopes depend affinely on the position.
#[derive(Clone, Copy, Debug)]
struct Mirrored {
    /// Constant part of the angles between a ray and the mirror direction. The angles are `first`
    /// plus `at` (x, y) plus `by` (u, v).
    first: [f64; 2],
    at: Matrix<2>,
    by: Matrix<2>,
    inverse: Matrix<2>,
    determinant: f64,
    /// Width of the density about the mirror direction, in radians.
    width: f64,
}

/// Width of the density of slopes about the mirror direction, in widths of the lobe.
const BROADENED: f64 = 1.5;

impl PlaneRaySampler {
    pub(super) fn new(
        system: &PathSystem,
        window: &Window,
        chain: Option<&PathChain>,
        strategy: LightStrategy,
    ) -> Self {
        let profiles = [window.x, window.y, window.u, window.v];
        let chain = chain.filter(|_| strategy.mirrored);
        Self {
            window: profiles.map(|profile| LinearDensity::of(&profile)),
            mirrored: chain.and_then(|chain| Mirrored::new(system, chain)),
        }
    }

    /// A ray (x, y, u, v) at the plane and the density with which it was sampled.
    pub(super) fn draw(&self, [a, b, c, d]: [f64; 4]) -> ([f64; 4], f64) {
        let [along_x, along_y, along_u, along_v] = &self.window;
        let [[x, of_x], [y, of_y]] = [along_x.draw(a), along_y.draw(b)];
        let positions = of_x * of_y;
        let Some(mirrored) = &self.mirrored else {
            let [[u, of_u], [v, of_v]] = [along_u.draw(c), along_v.draw(d)];
            return ([x, y, u, v], positions * of_u * of_v);
        };
        let [u, v] = if c < 0.5 {
            [along_u.quantile(2.0 * c), along_v.quantile(d)]
        } else {
            mirrored.draw([x, y], [2.0 * c - 1.0, d])
        };
        let slopes = along_u.value(u) * along_v.value(v);
        let density = positions * 0.5 * (slopes + mirrored.density([x, y, u, v]));
        ([x, y, u, v], density)
    }
}

impl Mirrored {
    /// Returns `None` if light comes from all directions, or if the slopes at the plane do not
    /// determine the angles on the surface.
    fn new(system: &PathSystem, chain: &PathChain) -> Option<Self> {
        let off = super::back(chain)?;
        let block = |map: &AffineMap<4>, row: usize, column: usize| -> Matrix<2> {
            crate::geometry::from_fn(|i, j| map.matrix[row + i][column + j])
        };
        // `free` is the index of the first of two coordinates that vary among rays from the
        // light's central point or, for a beam, among rays along the beam's axis.
        let free = match system.light.rays() {
            EmittedRays::OfSky(_) => return None,
            EmittedRays::Parallel(_) => 0,
            _ => 2,
        };
        let onto = &chain.maps[0];
        let (places, _) = inverted(&block(onto, 0, free))?;
        // `per_place` is the change of the angles of incidence per change of position on the
        // surface.
        let per_place = product(&block(onto, 2, free), &places);
        let [s, t, theta, phi] = onto.offset;
        let arrives = times(&per_place, &[s, t]);
        // The angles from the mirror direction are the sum of the outgoing and the incident
        // angles.
        let by = |column: usize| {
            let angles = block(&off, 2, column);
            let through = product(&per_place, &block(&off, 0, column));
            crate::geometry::from_fn(|i, j| angles[i][j] + through[i][j])
        };
        let [s0, t0, theta0, phi0] = off.offset;
        let from = times(&per_place, &[s0, t0]);
        let first = [
            theta0 + theta + from[0] - arrives[0],
            phi0 + phi + from[1] - arrives[1],
        ];
        let (inverse, determinant) = inverted(&by(2))?;
        let shape = system.light.shape();
        let light = shape.map_or(0.0, |shape| {
            radius(shape) / chain.scatterers[0].frame.origin.z
        });
        Some(Self {
            first,
            at: by(0),
            by: by(2),
            inverse,
            determinant: determinant.abs(),
            width: libm::hypot(BROADENED * narrowest_of(system)?, light),
        })
    }

    fn draw(&self, position: [f64; 2], at: [f64; 2]) -> [f64; 2] {
        let angles = bell(self.width, at);
        let center = times(&self.at, &position);
        let left = [0, 1].map(|i| angles[i] - self.first[i] - center[i]);
        times(&self.inverse, &left)
    }

    fn density(&self, [x, y, u, v]: [f64; 4]) -> f64 {
        let (at, by) = (times(&self.at, &[x, y]), times(&self.by, &[u, v]));
        let angles = [0, 1].map(|i| self.first[i] + at[i] + by[i]);
        bell_density(self.width, angles) * self.determinant
    }
}

/// Samples parts of the light.
#[derive(Clone, Debug)]
pub(super) struct Lights<'a> {
    system: &'a PathSystem,
    /// Parts that are sampled independently of the surface; `None` if the light is dark.
    parts: Option<LightParts<'a>>,
    /// Whether half of the sampled parts of the light follow the lobe.
    by_lobe: bool,
    /// The number of cells along each side of the unit square; one part of the light is sampled in
    /// each cell.
    side: usize,
}

impl<'a> Lights<'a> {
    /// Builds the sampler for a system whose light has the given parts.
    pub(super) fn new(
        system: &'a PathSystem,
        parts: Option<LightParts<'a>>,
        strategy: LightStrategy,
    ) -> Self {
        let strategy = strategy.in_effect(system);
        Self {
            system,
            parts,
            by_lobe: strategy.by_lobe,
            side: if strategy.quarters { 2 } else { 1 },
        }
    }

    /// Builds the sampler for a changed system in the same environment.
    pub(super) fn of<'b>(&'b self, system: &'b PathSystem, strategy: LightStrategy) -> Lights<'b> {
        let parts = self.parts.as_ref().map(|parts| parts.of(&system.light));
        Lights::new(system, parts, strategy)
    }

    /// The sampled parts of the light for a point of the surface. There is a single part,
    /// or there is one part in each quarter of the unit square. Each part's density is multiplied
    /// by the number of parts, so that the parts' contributions add up to a mean.
    pub(super) fn each<'b>(
        &'b self,
        leaving: &'b Leaving,
        [a, b]: [f64; 2],
    ) -> impl Iterator<Item = (LightPart, f64)> + 'b {
        let side = self.side;
        (0..side * side).filter_map(move |k| {
            let cell = [(k / side) as f64, (k % side) as f64];
            let at = [(a + cell[0]) / side as f64, (b + cell[1]) / side as f64];
            let (part, density) = self.draw(leaving, at)?;
            Some((part, density * (side * side) as f64))
        })
    }

    /// A sampled part of the light, and the sampling density in the part's measure.
    pub(super) fn draw(&self, leaving: &Leaving, [a, b]: [f64; 2]) -> Option<(LightPart, f64)> {
        let parts = self.parts.as_ref()?;
        if !self.by_lobe {
            return parts.draw([a, b]);
        }
        let lobe = LobeDensity::new(self.system, leaving);
        let (part, by_light) = if a < 0.5 {
            parts.draw([2.0 * a, b])?
        } else {
            parts.seen(leaving.point, lobe.draw([2.0 * a - 1.0, b])?)?
        };
        let by_lobe = lobe.density(self.direction(leaving, part)) * self.steradians(leaving, part);
        Some((part, 0.5 * (by_light + by_lobe)))
    }

    /// The direction towards a part of the light, a unit vector away from the surface.
    fn direction(&self, leaving: &Leaving, part: LightPart) -> DVec3 {
        match part {
            LightPart::Point([a, b]) => (DVec3::new(a, b, 0.0) - leaving.point).normalize(),
            LightPart::Sky { slopes: [u, v], .. } => -DVec3::new(u, v, 1.0).normalize(),
            LightPart::Whole => DVec3::ZERO,
        }
    }

    /// The solid angle in steradians per unit of the part's measure.
    fn steradians(&self, leaving: &Leaving, part: LightPart) -> f64 {
        let DVec3 { x, y, z } = leaving.point;
        match part {
            LightPart::Point([a, b]) => 1.0 / (z * z * secant([(x - a) / z, (y - b) / z]).powi(3)),
            LightPart::Sky { .. } | LightPart::Whole => 1.0,
        }
    }
}

/// Samples incident directions for a given outgoing direction, by sampling normals of microfacets
/// about the surface normal.
struct LobeDensity {
    local: Frame,
    wo: DVec3,
    /// Width of the density of slopes of the microfacet normals.
    width: f64,
}

impl LobeDensity {
    fn new(system: &PathSystem, leaving: &Leaving) -> Self {
        let (patch, reflectance) = system.scatterer();
        let at = patch.frame.to_local(leaving.point);
        let brdfs = reflectance.at(at.x, at.y).weighted();
        let local = Frame::IDENTITY.turned_to(leaving.normal);
        Self {
            wo: local.vector_to_local(leaving.direction),
            local,
            width: 0.5 * narrowest(brdfs.map(|(_, brdf)| brdf)).unwrap_or(1.0),
        }
    }

    fn draw(&self, at: [f64; 2]) -> Option<DVec3> {
        let [p, q] = bell(self.width, at);
        let half = DVec3::new(p, q, 1.0).normalize();
        let wi = 2.0 * half.dot(self.wo) * half - self.wo;
        (wi.z > 0.0).then(|| self.local.vector_to_world(wi))
    }

    /// The density per steradian of incident directions.
    fn density(&self, wi: DVec3) -> f64 {
        let wi = self.local.vector_to_local(wi);
        let half = (wi + self.wo).normalize();
        // Incident and outgoing directions that are opposite have no half vector.
        if half.z <= 0.0 || half.is_nan() {
            return 0.0;
        }
        let slopes = [half.x / half.z, half.y / half.z];
        // The density of incident directions is the density per steradian of normals, divided by
        // four times the cosine of the angle between normal and direction.
        let per_normal = bell_density(self.width, slopes) / half.z.powi(3);
        per_normal / (4.0 * half.dot(self.wo).abs())
    }
}

/// The width of the narrowest lobe of a surface. Light that wider lobes scatter beyond
/// this width is sampled by the densities of the window and the light.
fn narrowest_of(system: &PathSystem) -> Option<f64> {
    narrowest(system.scatterer().1.terms.iter().map(|term| &term.brdf))
}

/// The distance from the light's axis to the farthest point of a shape.
fn radius(shape: &Shape) -> f64 {
    let [x, y] = [0, 1].map(|axis| {
        let [low, high] = shape.bounds().extent(axis);
        low.abs().max(high.abs())
    });
    libm::hypot(x, y)
}

/// Samples a point (p, q) with the density [`bell_density`].
pub(crate) fn bell(width: f64, [a, b]: [f64; 2]) -> [f64; 2] {
    let r = width * (a / (1.0 - a)).sqrt();
    let (sin, cos) = libm::sincos(TAU * b);
    [r * cos, r * sin]
}

/// The density 1/(π w² (1 + r²/w²)²) with r² = p² + q². The density is as wide as a lobe
/// and has longer tails than any lobe.
pub(crate) fn bell_density(width: f64, [p, q]: [f64; 2]) -> f64 {
    let squared = width * width;
    1.0 / (PI * squared * (1.0 + (p * p + q * q) / squared).powi(2))
}

/// The inverse and the determinant of a matrix, or `None` if the matrix is nearly
/// singular.
fn inverted([[a, b], [c, d]]: &Matrix<2>) -> Option<(Matrix<2>, f64)> {
    let determinant = a * d - b * c;
    let scale = (a * a + b * b + c * c + d * d) * 1e-9;
    (determinant.abs() > scale).then(|| {
        let inverse = [[*d, -b], [-c, *a]].map(|row| row.map(|x| x / determinant));
        (inverse, determinant)
    })
}
