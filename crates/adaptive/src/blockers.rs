//! Measures the nearness of blockers at sparse points of the picture, and interpolates it between
//! these points.

use crate::cutoffs::Cutoffs;
use crate::metric::Metric;
use crate::reconstruct::{SampleFit, ShadedSample, reconstruct_pixels};
use crate::visible::{SeenSurface, Visible};
use etendue_paths::{Nearness, Paths};
use etendue_world::Camera;
use rayon::prelude::*;

/// Pixels between adjacent points: an 800 × 500 picture has 20,000 points, as in Durand et al.
/// 2005.
const STEP: usize = 4;

/// Default number of rays per point. Durand et al. 2005 use a hundred rays, six times as many,
/// which would take most of the time.
pub const BLOCKER_RAYS: u32 = 16;

/// Returns the nearness of blockers at each pixel. From each of the sparse points, `rays` rays go
/// towards the objects that the point reflects, and equally many go towards lights.
pub(crate) fn nearness(
    visible: &Visible,
    (paths, camera, cutoffs, seed): (&Paths, &Camera, &Cutoffs, u64),
    rays: u32,
    progress: &(dyn Fn(u64) + Sync),
) -> Vec<Nearness> {
    let [w, h] = visible.size.map(|n| n.div_ceil(STEP));
    let samples: Vec<ShadedSample> = (0..w * h)
        .into_par_iter()
        .filter_map(|i| {
            let at = [i % w, i / w].map(|i| (i as f64 + 0.5) * STEP as f64);
            let seen = paths.view(&camera.look(at, [0.0; 2])).surface?;
            progress(1);
            // A pixel does not resolve blockers that are nearer than its width.
            let nearest = seen.distance() * pixel_angle(camera);
            let Nearness { reflected, shadow } =
                paths.nearness(&seen, rays, nearest, seed, i as u64);
            Some(ShadedSample {
                at,
                metric: Metric::even((STEP as f64).powi(-2)),
                surface: SeenSurface::new(paths, &seen, cutoffs),
                value: [reflected, shadow],
            })
        })
        .collect();
    let values = reconstruct_pixels(visible, &samples, SampleFit::Mean);
    let of = |value: &Option<[f64; 2]>| {
        let [reflected, shadow] = value.unwrap_or_default();
        Nearness { reflected, shadow }
    };
    values.iter().map(of).collect()
}

/// Returns the slope between adjacent pixels at the centre of the picture.
fn pixel_angle(camera: &Camera) -> f64 {
    let [w, h] = camera.size.map(|n| 0.5 * n as f64);
    let [a, b] = [w, w + 1.0].map(|x| camera.look([x, h], [0.0; 2]).along);
    (a - b).length()
}
