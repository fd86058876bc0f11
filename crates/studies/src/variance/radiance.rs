//! The radiance along rays of a window, found by rays traced back, and its moments.

use crate::variance::VarianceError;
use crate::variance::points::{points, shift};
use crate::variance::power_estimate::jackknife_error;
use crate::variance::sampler::{MAX_POINTS, Sampler, WindowPoint};
use etendue_field::{TwoPlane, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_spectrum::Uncertain;
use etendue_trace::Backward;
use rayon::prelude::*;

/// Number of independent nets of rays for the moments, and number of rays of each net.
const NETS: u64 = 64;
const RAYS_PER_NET: usize = 1 << 13;

/// Set numbers from here on belong to the moments.
const FIRST_NET: u64 = 1 << 47;

/// The radiance along rays, found by rays traced back.
pub trait RayRadiance: std::fmt::Debug + Send + Sync {
    /// The radiance along a ray, in the unit of the plane's quantity. `index` selects the
    /// random numbers of scattering.
    fn along(&self, ray: &TwoPlane, index: u64) -> f64;
}

/// The radiance f(z) at the points z of the window of a plane.
#[derive(Debug)]
pub struct WindowRadiance<'a> {
    window: Window,
    rays: Box<dyn RayRadiance + 'a>,
}

/// The radiance at the only plane of a scene.
#[derive(Debug)]
struct SceneRadiance {
    tracer: Backward,
    plane: VirtualPlane,
}

impl RayRadiance for SceneRadiance {
    fn along(&self, ray: &TwoPlane, index: u64) -> f64 {
        self.plane.factor(ray) * self.tracer.radiance(0, ray, index)
    }
}

/// The moments of the radiance over the window. Points have uniform density in the window
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowMoments {
    /// The mean ∫ f.
    pub mean: Uncertain,
    /// The variance σ² = ∫ f² − (∫ f)², without the noise of radiances.
    pub variance: Uncertain,
    /// The mean variance of a radiance along a fixed ray: the noise of paths with scattering. It is
    /// 0 if radiances are exact.
    pub noise: Uncertain,
}

impl<'a> WindowRadiance<'a> {
    /// Builds the radiance at the only plane of a scene.
    ///
    /// # Errors
    ///
    /// Fails if the plane sees light without extent directly, or if rays traced back do not find the
    /// light.
    pub fn new(scene: &Scene) -> Result<Self, VarianceError> {
        let plane = scene.planes[0].clone();
        if plane.leg == 0 && !scene.light.has_extent() {
            return Err(VarianceError::NoRadiance(plane.name));
        }
        let tracer = Backward::new(scene)?;
        let window = plane.window;
        Ok(Self::of(window, Box::new(SceneRadiance { tracer, plane })))
    }

    /// Builds the radiance at a window from the radiance along rays.
    #[must_use]
    pub fn of(window: Window, rays: Box<dyn RayRadiance + 'a>) -> Self {
        Self { window, rays }
    }

    /// The radiance along rays.
    pub(crate) fn into_rays(self) -> Box<dyn RayRadiance + 'a> {
        self.rays
    }

    /// The radiance at a point of the window, in the unit of the plane's quantity. `index`
    /// selects the random numbers of scattering.
    #[must_use]
    pub fn at(&self, [x, u, y, v]: WindowPoint, index: u64) -> f64 {
        let Window {
            x: wx,
            y: wy,
            u: wu,
            v: wv,
        } = &self.window;
        let along =
            |z: f64, profile: &etendue_field::Profile| (2.0 * z - 1.0) * profile.half_width();
        let ray = TwoPlane {
            x: along(x, wx),
            y: along(y, wy),
            u: along(u, wu),
            v: along(v, wv),
        };
        self.rays.along(&ray, index)
    }

    /// The mean radiance at the points of set number `set`.
    pub(crate) fn mean(&self, points: &[WindowPoint], set: u64) -> f64 {
        let radiances = (0..)
            .zip(points)
            .map(|(i, z)| self.at(*z, index_of(set, i)));
        radiances.sum::<f64>() / points.len() as f64
    }

    /// The moments over the window, from scrambled nets of rays.
    ///
    /// Each ray is traced twice, with different random numbers. The product of both radiances has
    /// the mean ∫ f², even if radiances are noisy.
    #[must_use]
    pub fn moments(&self, seed: u64, progress: &(dyn Fn(u64) + Sync)) -> WindowMoments {
        let of_net = |net: u64| {
            let set = FIRST_NET + 2 * net;
            let mut rays = points(&Sampler::Sobol, RAYS_PER_NET, seed, set).unwrap_or_default();
            shift(&mut rays, seed, set);
            let mut sums = [0.0; 3];
            for (i, ray) in (0..).zip(&rays) {
                let [a, b] = [set, set + 1].map(|set| self.at(*ray, index_of(set, i)));
                let terms = [0.5 * (a + b), a * b, 0.5 * (a - b) * (a - b)];
                sums.iter_mut()
                    .zip(terms)
                    .for_each(|(sum, term)| *sum += term);
            }
            progress(1);
            sums.map(|sum| sum / rays.len() as f64)
        };
        let nets: Vec<[f64; 3]> = (0..NETS).into_par_iter().map(of_net).collect();
        let without = |net: usize| {
            let others = nets.iter().enumerate().filter(|(other, _)| *other != net);
            moments_of(others.map(|(_, sums)| sums))
        };
        let without: Vec<[f64; 3]> = (0..nets.len()).map(without).collect();
        let values = moments_of(nets.iter());
        let of = |i: usize| Uncertain {
            value: values[i],
            error: jackknife_error(&without.iter().map(|values| values[i]).collect::<Vec<_>>()),
        };
        WindowMoments {
            mean: of(0),
            variance: of(1),
            noise: of(2),
        }
    }

    /// The number of steps of which [`moments`](Self::moments) reports the progress.
    #[must_use]
    pub fn steps() -> u64 {
        NETS
    }
}

/// The index of the random numbers of ray `ray` of a set.
fn index_of(set: u64, ray: u64) -> u64 {
    set.wrapping_mul(MAX_POINTS as u64) + ray
}

/// The mean, the variance and the noise from the means over nets. The square of the mean is
/// the mean product of different nets.
fn moments_of<'a>(nets: impl Iterator<Item = &'a [f64; 3]>) -> [f64; 3] {
    let mut sums = [0.0; 3];
    let [mut squares, mut n] = [0.0; 2];
    for net in nets {
        sums.iter_mut()
            .zip(net)
            .for_each(|(sum, value)| *sum += value);
        squares += net[0] * net[0];
        n += 1.0;
    }
    let [mean, product, noise] = sums.map(|sum| sum / n);
    let square = (sums[0] * sums[0] - squares) / (n * (n - 1.0));
    [mean, product - square, noise]
}
