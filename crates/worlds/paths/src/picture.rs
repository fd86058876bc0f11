//! Pictures, with the variance of each pixel.

use crate::numbers::PathNumbers;
use crate::paths::{LightSearch, Paths, TracedPath};
use crate::space::Ray;
use etendue_sampling::disc;
use etendue_world::Camera;
use rayon::prelude::*;

/// The picture of a camera, W m⁻² sr⁻¹. The rows begin at the top, and each row begins at the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The mean radiance over each pixel.
    pub mean: Vec<f64>,
    /// Variance of that mean, estimated from the samples.
    pub variance: Vec<f64>,
}

/// Number of paths that are traced together.
const STREAM: usize = 32;

impl Paths {
    /// Renders the picture of a camera with `samples` paths per pixel; `progress` receives the
    /// number of finished pixels. Each pixel depends only on the seed and its index.
    #[must_use]
    pub fn picture(
        &self,
        camera: &Camera,
        samples: u32,
        seed: u64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Picture {
        let [w, h] = camera.size;
        let row = |row: usize| {
            // If `progress` unwinds to stop the work, it also unwinds in this call, so no further
            // row is computed.
            progress(0);
            let pixels = self.row(camera, row, samples, seed);
            progress(w as u64);
            pixels
        };
        let pixels: Vec<[f64; 2]> = (0..h).into_par_iter().flat_map_iter(row).collect();
        Picture {
            size: camera.size,
            mean: pixels.iter().map(|pixel| pixel[0]).collect(),
            variance: pixels.iter().map(|pixel| pixel[1]).collect(),
        }
    }

    /// The mean of each pixel of a row, and the variance of this mean.
    fn row(&self, camera: &Camera, row: usize, samples: u32, seed: u64) -> Vec<[f64; 2]> {
        let (width, samples) = (camera.size[0], samples as usize);
        let mut walks = Vec::with_capacity(STREAM);
        let mut radiances = [0.0; STREAM];
        let mut pixels = vec![[0.0; 2]; width];
        for start in (0..width * samples).step_by(STREAM) {
            let paths = start..(start + STREAM).min(width * samples);
            let mut drawn: [PathNumbers<'_>; STREAM] = std::array::from_fn(|i| {
                PathNumbers::new(seed, (row * width * samples + start + i) as u64)
            });
            PathNumbers::prepare(&mut drawn, |numbers| numbers);
            walks.clear();
            for ((i, path), numbers) in paths.clone().enumerate().zip(drawn) {
                let pixel = [(path / samples) as f64, row as f64];
                let (radiance, walk) = self.seen(camera, pixel, i, numbers);
                radiances[i] = radiance;
                walks.extend(walk);
            }
            self.scattered(&mut walks, 0, LightSearch::Both, &mut |i, _, light| {
                radiances[i] += light;
            });
            for (path, radiance) in paths.zip(radiances) {
                // This recurrence is numerically stable (Welford 1962).
                let [mean, squares] = &mut pixels[path / samples];
                let off = radiance - *mean;
                *mean += off / (path % samples + 1) as f64;
                *squares += off * (radiance - *mean);
            }
        }
        let count = samples as f64;
        for [_, squares] in &mut pixels {
            *squares /= count * (count - 1.0).max(1.0);
        }
        pixels
    }

    /// What a ray through a random point of a pixel sees of sources, and the path that
    /// begins at its hit.
    fn seen<'a>(
        &self,
        camera: &Camera,
        pixel: [f64; 2],
        number: usize,
        mut numbers: PathNumbers<'a>,
    ) -> (f64, Option<TracedPath<'a>>) {
        let [x, y, a, b] = numbers.draw();
        let lens = if camera.has_lens() {
            disc(1.0, [a, b]).to_array()
        } else {
            [0.0; 2]
        };
        let look = camera.look([pixel[0] + x, pixel[1] + y], lens);
        let ray = Ray::new(look.from, look.along);
        let hit = self.geometry.first(&ray, look.seen);
        let shown = self.shown(&ray, hit.as_ref(), 0);
        let walk = hit.map(|hit| TracedPath::new(number, (ray, hit), numbers));
        (shown, walk)
    }
}
