//! Pictures, with the variance of each pixel.

use crate::numbers::PathNumbers;
use crate::paths::{LightSearch, Paths};
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
            let pixels = (0..w).map(|column| self.pixel(camera, [column, row], samples, seed));
            let pixels: Vec<[f64; 2]> = pixels.collect();
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

    /// Returns the mean of a pixel, and the variance of this mean.
    fn pixel(
        &self,
        camera: &Camera,
        [column, row]: [usize; 2],
        samples: u32,
        seed: u64,
    ) -> [f64; 2] {
        let number = (row * camera.size[0] + column) as u64;
        let (mut mean, mut squares) = (0.0, 0.0);
        for sample in 0..samples {
            let mut numbers =
                PathNumbers::new(seed, number * u64::from(samples) + u64::from(sample));
            let radiance = self.seen(camera, [column as f64, row as f64], &mut numbers);
            // This recurrence is numerically stable (Welford 1962).
            let off = radiance - mean;
            mean += off / f64::from(sample + 1);
            squares += off * (radiance - mean);
        }
        let count = f64::from(samples);
        [mean, squares / (count * (count - 1.0).max(1.0))]
    }

    /// Returns the radiance by one path through a random point of a pixel.
    fn seen(&self, camera: &Camera, pixel: [f64; 2], numbers: &mut PathNumbers<'_>) -> f64 {
        let [x, y, a, b] = numbers.draw();
        let lens = if camera.has_lens() {
            disc(1.0, [a, b]).to_array()
        } else {
            [0.0; 2]
        };
        let look = camera.look([pixel[0] + x, pixel[1] + y], lens);
        let ray = Ray {
            from: look.from,
            along: look.along,
        };
        self.radiance(ray, look.seen, 0, LightSearch::Both, numbers)
    }
}
