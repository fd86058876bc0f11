//! Measures the bandwidth of the picture around a pixel, and chooses the window for this
//! measurement.

use super::scene::{BATCHES, ProbedScene, budget};
use etendue_field::{Slices, TwoPlane, VirtualPlane};
use etendue_paths::{BackwardProbe, Probe, Stop};
use etendue_spectrum::bandwidth::Widest;
use etendue_spectrum::directional::DirectionalBandwidth;
use etendue_spectrum::{Uncertain, WindowedMean, measure};
use etendue_store::Failure;
use serde_json::{Value, json as tree_of};
use std::f64::consts::FRAC_PI_2;

/// The width, in pixels, of the smallest window that is tried.
const NARROWEST: f64 = 16.0;
/// The window is wide enough if the measured bandwidth exceeds the bandwidth of the window by this
/// factor.
const CLEAR: f64 = 3.0;
/// A measured bandwidth may be due to the window if it is at most this multiple of the window's
/// bandwidth. If light is linear across the window, the multiple is 1.49; if light is quadratic,
/// the multiple is 1.89.
const SMOOTH: f64 = 1.9;
/// A picture is found to vary if the power of its variation exceeds this many standard errors.
const FOUND: f64 = 5.0;
/// The largest allowed ratio of the power of noise to the power of the variation. Noise of this
/// power has about 450 independent frequencies, so it fluctuates by a 150th of the power of the
/// variation. This is little, because a twentieth of that power lies beyond the bandwidth.
const MAX_NOISE: f64 = 0.1;
/// A bandwidth with a larger relative standard error is not reported, because with few rays its
/// jackknife is unreliable.
const MAX_ERROR: f64 = 0.1;
/// The highest frequencies are too low for a picture if they miss more than this share of its
/// variation. The polar cells change the power by up to 3 %, and an edge has 5 % of its power
/// beyond the highest frequency.
const MISSED: f64 = 0.1;
/// Number of rays for each pair of paths that finds the whole variation, and the largest number of
/// such pairs.
const RAYS_PER_PAIR: u64 = 8;
const MOST_PAIRS: u64 = 1 << 16;
/// The largest number of rays that are traced to choose the window.
const RAYS_OF_TRIAL: u64 = 1 << 17;

/// The bandwidth of the picture around a pixel. It is the bandwidth of the light at the middle of
/// the lens as a function of direction.
#[derive(Clone, Debug)]
pub(super) struct PictureBandwidth {
    /// Width of the window, pixels.
    pub(super) pixels: f64,
    /// The bandwidth of the picture after its mean is subtracted; `None` if noise hides this
    /// bandwidth.
    pub(super) variation: Option<DirectionalBandwidth>,
    /// Whether the picture varies by more than noise.
    pub(super) varies: bool,
    /// The share of the variation at frequencies above [`Self::highest`], if it is large.
    pub(super) missed: Option<f64>,
    /// The highest frequency that is measured, cycles per slope.
    pub(super) highest: f64,
    /// The spectra of the picture, one for each batch of rays.
    pictures: Vec<Slices>,
    /// The bandwidth of the window alone.
    pub(super) window: DirectionalBandwidth,
    /// The slope difference between adjacent pixels.
    pixel_slope: f64,
    /// The surface behind the pixel.
    pub(super) surface: Stop,
}

impl PictureBandwidth {
    /// Measures the picture around a pixel in the requested window. If no window is requested, uses
    /// the narrowest window whose own bandwidth is well below the measured bandwidth. Returns
    /// `None` if the ray through the pixel meets nothing.
    ///
    /// While rays are traced, `progress` is called with their number.
    pub(super) fn new(
        scene: &ProbedScene<'_>,
        pixel: [usize; 2],
        seed: u64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Option<Self>, Failure> {
        let rays = scene.request.rays;
        let pixels = match scene.request.window {
            Some(pixels) => pixels,
            None => match widened(scene, pixel, seed, progress)? {
                Some(found) if rays <= RAYS_OF_TRIAL => return Ok(Some(found)),
                Some(found) => found.pixels,
                None => return Ok(None),
            },
        };
        measured(scene, (pixel, pixels), (rays, seed), progress)
    }

    /// The largest bandwidth over directions, if it is above the limit that the window
    /// sets and below the highest frequency.
    pub(super) fn widest(&self) -> Option<Widest<Uncertain>> {
        if self.missed.is_some() {
            return None;
        }
        let widest = self.variation.as_ref()?.widest;
        let is_above = widest.value.value > SMOOTH * self.window.at(widest.azimuth);
        is_above.then_some(widest)
    }

    /// The bandwidth perpendicular to the direction of the largest bandwidth, if it is
    /// above the limit that the window sets.
    pub(super) fn across(&self) -> Option<Uncertain> {
        let widest = self.widest()?;
        let across = self.variation.as_ref()?.across;
        let own = self.window.at(widest.azimuth + FRAC_PI_2);
        (across.value > SMOOTH * own).then_some(across)
    }

    /// The largest bandwidth of the window alone.
    pub(super) fn of_window(&self) -> f64 {
        self.window.widest.value.value
    }

    /// The bandwidth below which this window does not distinguish a picture from a smooth
    /// one.
    pub(super) fn limit(&self) -> f64 {
        SMOOTH * self.of_window()
    }

    /// An estimate of the largest bandwidth without the blur of the window. The square of
    /// the window's bandwidth is subtracted from the square of the measured bandwidth. The estimate
    /// is exact for a Gaussian. For a single frequency, it is too high by at most 0.84 bandwidths
    /// of the window.
    pub(super) fn unblurred(&self) -> Option<f64> {
        let Widest { azimuth, value } = self.widest()?;
        let own = self.window.at(azimuth);
        Some((value.value * value.value - own * own).sqrt())
    }

    /// How many shading samples per pixel a bandwidth requires along a direction: two for
    /// each cycle.
    pub(super) fn samples(&self, bandwidth: f64) -> f64 {
        2.0 * bandwidth * self.pixel_slope
    }

    /// Returns, in words, the distance between shading samples that a bandwidth requires.
    pub(super) fn spacing(&self, bandwidth: f64) -> String {
        match self.samples(bandwidth) {
            dense if dense > 1.0 => format!("{dense:.2} in each pixel"),
            sparse => format!("every {:.1} pixels", sparse.recip()),
        }
    }

    /// The bandwidth of all power; `None` without light.
    fn whole(&self) -> Option<DirectionalBandwidth> {
        DirectionalBandwidth::new(&self.pictures).ok()?
    }

    /// The power of noise as a share of all power; `None` without light.
    pub(super) fn noise_share(&self) -> Option<f64> {
        let whole = self.whole()?;
        Some(whole.noise / whole.power.value)
    }

    fn is_clear(&self) -> bool {
        let widest = self.widest();
        widest.is_some_and(|it| it.value.value > CLEAR * self.window.at(it.azimuth))
    }

    /// The result as JSON.
    pub(super) fn tree(&self) -> Value {
        let pair = |of: Uncertain| [of.value, of.error];
        let each = |of: &Option<DirectionalBandwidth>| of.as_ref().map(|of| of.along.clone());
        let widest = self.widest();
        let mut tree = tree_of!({
            "window_pixels": self.pixels,
            "variation": each(&self.variation),
            "all_power": each(&self.whole()),
            "window": self.window.along,
            "largest": widest.map(|it| pair(it.value)),
            "azimuth": widest.map(|it| it.azimuth),
            "across": self.across().map(pair),
            "unblurred": self.unblurred(),
            "varies": self.varies,
            "samples": widest.map(|it| self.samples(it.value.value)),
        });
        if let Some(share) = self.missed {
            tree["missed"] = tree_of!({ "share": share, "above": self.highest });
        }
        tree
    }
}

/// Measures the picture in the narrowest window whose own bandwidth is well below the measured
/// bandwidth. If there is no such window, uses a window as wide as the picture.
fn widened(
    scene: &ProbedScene<'_>,
    pixel: [usize; 2],
    seed: u64,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Option<PictureBandwidth>, Failure> {
    let rays = scene.request.rays.min(RAYS_OF_TRIAL);
    let [w, h] = scene.camera.size.map(|n| n as f64);
    let widest = w.min(h).max(NARROWEST);
    let mut pixels = NARROWEST;
    let mut narrower: Option<PictureBandwidth> = None;
    loop {
        let found = measured(scene, (pixel, pixels), (rays, seed), progress)?;
        let is_missed = found.as_ref().is_some_and(|found| found.missed.is_some());
        // The highest frequency of a wider window is lower.
        if is_missed && narrower.is_some() {
            return Ok(narrower);
        }
        let is_last = found.as_ref().is_none_or(PictureBandwidth::is_clear);
        if is_last || is_missed || 2.0 * pixels > widest {
            return Ok(found);
        }
        narrower = found;
        pixels *= 2.0;
    }
}

/// Measures the picture in a window.
fn measured(
    scene: &ProbedScene<'_>,
    (pixel, pixels): ([usize; 2], f64),
    (rays, seed): (u64, u64),
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Option<PictureBandwidth>, Failure> {
    let question = scene.question(pixel, pixels, 1);
    let probe = Probe::new(&scene.paths, &scene.camera, &question);
    let Some(probe) = probe.and_then(|probe| probe.picture(&scene.camera)) else {
        return Ok(None);
    };
    let plane = &probe.planes[0];
    let backward = BackwardProbe::new(&probe, budget(rays, seed));
    let found = measure(&backward, &probe.planes, 0..BATCHES, progress);
    let pictures: Vec<Slices> = found
        .at_plane(0)
        .map(|batch| batch.slices.clone())
        .collect();
    let mean = WindowedMean::new(&plane.window, &plane.grid);
    let varying = mean.removed_from_all(pictures.iter());
    let variation = DirectionalBandwidth::new(&varying).map_err(Failure::cannot_run)?;
    let relative = |of: Uncertain| of.error / of.value;
    let varies = variation
        .as_ref()
        .map(|found| relative(found.power) < 1.0 / FOUND);
    let pairs = (rays / RAYS_PER_PAIR).min(MOST_PAIRS);
    let whole = whole_variation(&backward, plane, &pictures, pairs);
    let noise = DirectionalBandwidth::noise(&varying).map_err(Failure::cannot_run)?;
    let missed = missed(whole, variation.as_ref().map(|found| found.power), noise);
    let variation = variation.filter(|found| {
        found.noise <= MAX_NOISE * found.power.value && relative(found.widest.value) <= MAX_ERROR
    });
    Ok(Some(PictureBandwidth {
        pixels,
        variation,
        varies: varies.unwrap_or(false),
        missed,
        highest: plane.grid.nu.max(),
        pictures,
        window: DirectionalBandwidth::of_window(&plane.window, &plane.grid),
        pixel_slope: probe.pixel_slope,
        surface: probe.stops[0].clone(),
    }))
}

/// The power of the picture minus its mean at all frequencies. By Parseval's theorem it is
/// the integral of the square of the windowed picture.
fn whole_variation(
    rays: &BackwardProbe<'_>,
    plane: &VirtualPlane,
    pictures: &[Slices],
    pairs: u64,
) -> Uncertain {
    let window = &plane.window;
    let point = window.x.transform(0.0) * window.y.transform(0.0);
    let angle = window.u.transform(0.0) * window.v.transform(0.0);
    let sum: f64 = pictures.iter().map(Slices::at_zero).sum();
    let mean = sum / (pictures.len() as f64 * point * angle);
    let area = 4.0 * window.u.half_width() * window.v.half_width();
    let of = |(ray, [a, b]): &(TwoPlane, [f64; 2])| {
        let weight = window.u.value(ray.u) * window.v.value(ray.v);
        point * point * area * weight * weight * (a - mean) * (b - mean)
    };
    let powers: Vec<f64> = rays.pairs(plane, pairs).iter().map(of).collect();
    let count = powers.len() as f64;
    let value = powers.iter().sum::<f64>() / count;
    let squares: f64 = powers.iter().map(|power| (power - value).powi(2)).sum();
    Uncertain {
        value,
        error: squares.sqrt() / count,
    }
}

/// The share of the whole variation that the measured power misses, if this share is large
/// and not due to noise. Below the noise of the measured power, its lowest frequencies may hide the
/// whole variation.
fn missed(whole: Uncertain, measured: Option<Uncertain>, noise: f64) -> Option<f64> {
    let none = Uncertain {
        value: 0.0,
        error: 0.0,
    };
    let measured = measured.unwrap_or(none);
    let missed = whole.value - measured.value;
    let is_found = missed > FOUND * libm::hypot(whole.error, measured.error);
    (is_found && missed > noise.max(MISSED * whole.value)).then_some(missed / whole.value)
}
