//! Measures the nearness of blockers at sparse points of the picture, and interpolates it between
//! these points.

use crate::blue_noise::{PicturePoint, blue_noise};
use crate::criterion::BandwidthCriterion;
use crate::density::{even, scaled};
use crate::metric::Metric;
use crate::reconstruct::{SampleFit, ShadedSample, reconstruct_pixels};
use crate::shading::Shader;
use crate::visible::{SeenSurface, Visible};
use etendue_paths::Nearness;
use etendue_world::Camera;
use rayon::prelude::*;

/// Pixels between adjacent points of the grid for the corrected criterion.
const STEP: usize = 4;

/// Pixels for each point of the paper's method: Durand et al. 2005, section 6.2, use 20,000 visible
/// points in a picture of 800 × 500 pixels.
const PIXELS_PER_POINT: usize = 20;

/// The sparse points of a criterion. They form a grid; those of the paper's method are blue
/// noise over what is visible.
pub(crate) fn points(visible: &Visible, by: BandwidthCriterion, seed: u64) -> Vec<PicturePoint> {
    let [w, h] = visible.size;
    match by {
        BandwidthCriterion::Corrected => {
            let [columns, rows] = visible.size.map(|n| n.div_ceil(STEP));
            let point = |i: usize| PicturePoint {
                at: [i % columns, i / columns].map(|i| (i as f64 + 0.5) * STEP as f64),
                metric: Metric::even((STEP as f64).powi(-2)),
            };
            (0..columns * rows).map(point).collect()
        }
        BandwidthCriterion::Printed => {
            let count = (w * h).div_ceil(PIXELS_PER_POINT);
            let metrics = scaled(&even(visible), count as f64);
            // Samples have the seeds of rounds 0 and 1.
            blue_noise(&metrics, w, count, seed.wrapping_add(2 << 32))
        }
    }
}

/// The nearness of blockers at each pixel. From each of the sparse points, `rays` rays go
/// towards the objects that the point reflects, and equally many go towards lights. For the
/// printed criterion, they go into the hemisphere, and none go towards lights.
///
/// As in Durand et al. 2005, section 6.2, the reconstruction between the points is that of the
/// picture. It reconstructs 1/distance, which is finite where nothing is near.
pub(crate) fn nearness(
    visible: &Visible,
    shader: &Shader<'_>,
    (by, points): (BandwidthCriterion, &[PicturePoint]),
    rays: u32,
    progress: &(dyn Fn(u64) + Sync),
) -> Vec<Nearness> {
    let Shader { paths, seed, .. } = *shader;
    let of = |(i, point): (usize, &PicturePoint)| {
        let seen = shader.view(point.at).surface?;
        progress(1);
        // A pixel does not resolve blockers that are nearer than its width.
        let nearest = seen.distance() * pixel_angle(shader.camera);
        let near = match by {
            BandwidthCriterion::Corrected => paths.nearness(&seen, rays, nearest, seed, i as u64),
            BandwidthCriterion::Printed => Nearness {
                reflected: paths.harmonic_nearness(&seen, rays, nearest, seed, i as u64),
                shadow: 0.0,
            },
        };
        Some(ShadedSample {
            at: point.at,
            metric: point.metric,
            surface: SeenSurface::new(paths, &seen, shader.cutoffs),
            value: [near.reflected, near.shadow],
        })
    };
    let samples: Vec<ShadedSample> = points.par_iter().enumerate().filter_map(of).collect();
    let values = reconstruct_pixels(visible, &samples, SampleFit::Mean);
    let of = |value: &Option<[f64; 2]>| {
        let [reflected, shadow] = value.unwrap_or_default();
        Nearness { reflected, shadow }
    };
    values.iter().map(of).collect()
}

/// The slope between adjacent pixels at the centre of the picture.
fn pixel_angle(camera: &Camera) -> f64 {
    let [w, h] = camera.size.map(|n| 0.5 * n as f64);
    let [a, b] = [w, w + 1.0].map(|x| camera.look([x, h], [0.0; 2]).along);
    (a - b).length()
}
