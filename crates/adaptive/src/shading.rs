//! Shading samples: paths from a point of a picture.

use crate::blue_noise::PicturePoint;
use crate::cutoffs::Cutoffs;
use crate::reconstruct::ShadedSample;
use crate::visible::SeenSurface;
use etendue_paths::Paths;
use etendue_world::Camera;
use rayon::prelude::*;

/// What is needed to shade points: the paths of the world, the camera, the cutoffs of lobes, and
/// settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shader<'a> {
    pub(crate) paths: &'a Paths,
    pub(crate) camera: &'a Camera,
    pub(crate) cutoffs: &'a Cutoffs,
    /// Paths per sample.
    pub(crate) each: u32,
    pub(crate) seed: u64,
}

impl Shader<'_> {
    /// Shades points without the texture factors of their surface, and estimates the variance of
    /// each with these factors. Points where nothing is visible are left out. Point i uses random
    /// numbers of index `first` + i.
    pub(crate) fn shade(
        &self,
        points: &[PicturePoint],
        first: u64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Vec<(ShadedSample, f64)> {
        let of = |(i, point): (usize, &PicturePoint)| {
            let found = self.one(point, first + i as u64);
            progress(1);
            found
        };
        points.par_iter().enumerate().filter_map(of).collect()
    }

    pub(crate) fn one(&self, point: &PicturePoint, number: u64) -> Option<(ShadedSample, f64)> {
        let seen = self
            .paths
            .view(&self.camera.look(point.at, [0.0; 2]))
            .surface?;
        let surface = SeenSurface::new(self.paths, &seen, self.cutoffs);
        if surface.cutoff <= 0.0 {
            return None;
        }
        let (parts, variance) = self.paths.shade(&seen, self.each, self.seed, number);
        let [base, lobe] = surface.factors;
        let without = |part: f64, factor: f64| if factor > 0.0 { part / factor } else { 0.0 };
        let sample = ShadedSample {
            at: point.at,
            metric: point.metric,
            surface,
            value: [without(parts[0], base), without(parts[1], lobe)],
        };
        Some((sample, variance))
    }
}
