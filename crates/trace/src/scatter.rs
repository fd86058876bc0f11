//! Draws the directions in which a surface scatters light, aimed at the windows of virtual
//! planes.

use crate::brdf;
use crate::plane_on_leg::{PlaneOnLeg, SurfaceCoordinates};
use crate::proposal::{Aim, ProfileDensity};
use crate::reach::{looks_at_surface, outline, reach, reflects};
use crate::sampling::LAMBERTIAN;
use etendue_field::{Frame, Mixture, Profile};
use etendue_sampling::{about, cosine_hemisphere};
use etendue_scene::{Emission, Scene};
use etendue_transform::random;
use glam::DVec3;

/// How light leaves the surface at the beginning of a leg: a density over slopes at each point of
/// the surface, and a strategy to sample it. Directions are in the frame of the leg, with component
/// 1 along D or against it: (u, v, ±1).
#[derive(Clone, Debug)]
pub(crate) struct Scatterer {
    /// The strategies to draw a ray, each selected with equal probability.
    strategies: Vec<SamplingStrategy>,
}

/// One strategy to draw a ray.
#[derive(Clone, Debug)]
enum SamplingStrategy {
    /// Draws directions towards a window, with one density along X and one along Y.
    Window([Aim; 2]),
    /// Draws directions that a virtual plane on the surface sees.
    Angles(Box<Angles>),
    /// Draws directions in proportion to the BRDF, or to the cosine for Lambertian scattering.
    Lobe,
}

/// The angles that a virtual plane on the surface sees.
#[derive(Clone, Copy, Debug)]
struct Angles {
    view: SurfaceCoordinates,
    across: [ProfileDensity; 2],
}

/// How a surface scatters light from one of its points.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Spread<'a> {
    /// Scattering by the cosine of the angle to the normal.
    Cosine,
    /// Scattering by a sum of BRDFs, for light from one direction. The direction is given in a
    /// frame whose D is the normal.
    Lobe {
        brdf: Mixture<'a>,
        frame: Frame,
        wi: DVec3,
    },
}

/// A slope so large that it sets no bound. If it is used, only the size of a surface limits the
/// slopes towards that surface.
const ANY_SLOPE: f64 = 1e6;

impl Spread<'_> {
    /// A direction in which light leaves a point at which the surface has the normal
    /// `normal`.
    #[inline]
    fn sample(&self, normal: DVec3, [a, b]: [f64; 2]) -> DVec3 {
        match self {
            Self::Cosine => about(normal, cosine_hemisphere([a, b])),
            Self::Lobe { brdf, frame, wi } => {
                frame.vector_to_world(brdf::towards(brdf, *wi, [a, b]))
            }
        }
    }

    /// The density of [`Self::sample`] with respect to n · (u, v, ±1) du dv, where
    /// `cosine` is n · (u, v, ±1).
    #[inline]
    fn density(&self, towards: DVec3, cosine: f64) -> f64 {
        let secant_squared = towards.length_squared();
        match self {
            Self::Cosine => 1.0 / (LAMBERTIAN * secant_squared * secant_squared),
            Self::Lobe { brdf, frame, wi } => {
                let wo = frame.vector_to_local(towards).normalize();
                brdf::densities(brdf, *wi, wo) * per_slope(secant_squared, cosine)
            }
        }
    }

    /// The value of the BRDF for a direction; Lambertian scattering omits the albedo.
    #[inline]
    pub(crate) fn value(&self, towards: DVec3) -> f64 {
        match self {
            Self::Cosine => 1.0 / LAMBERTIAN,
            Self::Lobe { brdf, frame, wi } => {
                let wo = frame.vector_to_local(towards).normalize();
                brdf::sum(brdf, *wi, wo)
            }
        }
    }
}

impl Angles {
    /// A direction in which light leaves a point, drawn with two random numbers in (0,
    /// 1).
    fn sample(&self, point: DVec3, random: [f64; 2]) -> Option<DVec3> {
        let angles = [0, 1].map(|i| self.across[i].quantile(random[i]));
        self.view.direction(point, angles)
    }

    /// The density of [`Self::sample`] per solid angle, which is cos φ dθ dφ.
    fn density(&self, point: DVec3, towards: DVec3) -> f64 {
        self.view.angles(point, towards).map_or(0.0, |[u, v]| {
            self.across[0].density(u) * self.across[1].density(v) / libm::cos(v)
        })
    }
}

/// The ratio dω / (n · (u, v, ±1) du dv), where dω = du dv / (1 + u² + v²)^(3/2).
#[inline]
fn per_slope(secant_squared: f64, cosine: f64) -> f64 {
    1.0 / (secant_squared * secant_squared.sqrt() * cosine)
}

impl Scatterer {
    /// The scatterer at the beginning of a leg; `None` if no virtual plane sees light of
    /// the leg.
    pub(crate) fn new(scene: &Scene, leg: usize) -> Option<Self> {
        let this = &scene.path.legs[leg];
        let leaves = this.leaves?.object;
        let origins: Vec<DVec3> = outline(scene, leaves)
            .iter()
            .map(|p| this.frame.to_local(*p))
            .collect();
        let is_ahead = origins.iter().all(|p| p.z < 0.99 * this.length);
        let by_brdf = reflects(scene, leaves);
        let aim = |(index, plane): (usize, &etendue_field::VirtualPlane)| {
            let w = &plane.window;
            if scene.run.emission == Emission::Plain {
                return None;
            }
            let plane_on_leg = PlaneOnLeg::new(scene, index, plane);
            let view = plane_on_leg.view();
            if let Some(view) = view.filter(|view| plane.leg == leg && !view.is_arriving()) {
                let across = [ProfileDensity::new(&w.u), ProfileDensity::new(&w.v)];
                Some(SamplingStrategy::Angles(Box::new(Angles { view, across })))
            } else if plane.leg == leg && !looks_at_surface(plane) {
                let d = scene.path.along(plane);
                Some(SamplingStrategy::Window([
                    Aim::new(d, &w.x, ProfileDensity::new(&w.u)),
                    Aim::new(d, &w.y, ProfileDensity::new(&w.v)),
                ]))
            } else {
                let half = reach(scene, plane, leg, &origins).filter(|_| is_ahead)?;
                // If a virtual plane lies on the surface at the end of the leg, it sees only some
                // slopes. If it lies beyond this surface, it sees light of any slope.
                let slopes = plane_on_leg.slopes(w).filter(|_| plane.leg == leg);
                let slopes = slopes.unwrap_or([ANY_SLOPE; 2]).map(ProfileDensity::cosine);
                Some(SamplingStrategy::Window([0, 1].map(|axis| {
                    let space = Profile::Box(half[axis]);
                    Aim::new(this.length, &space, slopes[axis])
                })))
            }
        };
        let planes = scene.planes.iter().enumerate();
        let mut looking = planes.filter(|(_, p)| p.leg >= leg).peekable();
        looking.peek()?;
        let aims = looking.map(aim);
        let strategies: Vec<SamplingStrategy> = if by_brdf {
            // A lobe of a BRDF may be narrower than any window or wider than all windows, so half
            // of the directions are drawn by the lobe.
            let mut strategies: Vec<SamplingStrategy> = aims.flatten().collect();
            let lobes = strategies.len().max(1);
            strategies.extend((0..lobes).map(|_| SamplingStrategy::Lobe));
            strategies
        } else {
            aims.map(|aim| aim.unwrap_or(SamplingStrategy::Lobe))
                .collect()
        };
        Some(Self { strategies })
    }

    /// A direction in which light leaves a point with the normal `normal`, and the
    /// density of this direction with respect to n · (u, v, ±1) du dv. Returns `None` if light
    /// from the point cannot reach the selected virtual plane, or if the direction goes behind
    /// the surface.
    #[inline]
    pub(crate) fn sample(
        &self,
        point: DVec3,
        normal: DVec3,
        spread: &Spread<'_>,
        words: [u32; 4],
    ) -> Option<(DVec3, f64)> {
        let r = words.map(random::unit);
        let from = point.z;
        let drawn = match &self.strategies[random::index(words[2], self.strategies.len())] {
            SamplingStrategy::Window([along_x, along_y]) => DVec3::new(
                along_x.sample(point.x, from, r[0])?,
                along_y.sample(point.y, from, r[1])?,
                1.0,
            ),
            SamplingStrategy::Angles(angles) => angles.sample(point, [r[0], r[1]])?,
            SamplingStrategy::Lobe => spread.sample(normal, [r[0], r[1]]),
        };
        let towards = drawn / drawn.z.abs();
        let cosine = normal.dot(towards);
        if cosine <= 0.0 || !cosine.is_finite() {
            return None;
        }
        let plain = spread.density(towards, cosine);
        let densities = self.strategies.iter().map(|strategy| match strategy {
            SamplingStrategy::Window(_) if towards.z < 0.0 => 0.0,
            SamplingStrategy::Window([a, b]) => {
                let [x, y] = [(a, point.x, towards.x), (b, point.y, towards.y)]
                    .map(|(aim, at, slope)| aim.density(at, from, slope));
                x * y / cosine
            }
            SamplingStrategy::Angles(angles) => {
                angles.density(point, towards) * per_slope(towards.length_squared(), cosine)
            }
            SamplingStrategy::Lobe => plain,
        });
        let density = densities.sum::<f64>() / self.strategies.len() as f64;
        (density > 0.0).then_some((towards, density))
    }
}
