//! Computes shading samples by paths from points of a picture.

use crate::blue_noise::{PicturePoint, PixelPosition};
use crate::cutoffs::Cutoffs;
use crate::reconstruct::ShadedSample;
use crate::visible::{SeenPlace, SeenSurface};
use etendue_paths::{Paths, SurfaceHit, View};
use etendue_world::Camera;
use rayon::prelude::*;

/// The data that shading needs: the paths of the world, the camera, the cutoffs of lobes, and
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
    /// Shades points. The values do not include the texture factors of the surface, but the
    /// estimated variance of each point does. Points at which nothing is visible are left out.
    /// Point i uses random numbers of index `first` + i.
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
        let seen = self.view(point.at).surface?;
        let surface = SeenSurface::new(self.paths, &seen, self.cutoffs);
        if surface.cutoff <= 0.0 {
            return None;
        }
        let (parts, variance) = self.paths.shade(&seen, self.each, self.seed, number);
        let sample = ShadedSample {
            at: point.at,
            metric: point.metric,
            surface,
            value: without(parts, surface.factors),
        };
        Some((sample, variance))
    }

    /// Traces the ray from the camera through a position of the picture.
    pub(crate) fn view(&self, at: PixelPosition) -> View {
        self.paths.view(&self.camera.look(at, [0.0; 2]))
    }

    /// Finds what is visible at a position of the picture.
    pub(crate) fn place(&self, at: PixelPosition) -> SeenPlace {
        self.look(at).0
    }

    /// Finds what is visible at a position of the picture, and returns it with the traced ray.
    pub(crate) fn look(&self, at: PixelPosition) -> (SeenPlace, View) {
        let view = self.view(at);
        (SeenPlace::new(self.paths, self.cutoffs, &view), view)
    }

    /// Computes the direct light of base and lobe by one path, without the given texture factors.
    /// The path has the point `index` of the net `number`.
    pub(crate) fn direct(
        &self,
        seen: &SurfaceHit,
        factors: [f64; 2],
        (number, index): (u64, u32),
    ) -> [f64; 2] {
        let parts = self.paths.direct(seen, self.seed, OF_GUIDE + number, index);
        without(parts, factors)
    }
}

/// The number of the first net for direct light; nets with smaller numbers belong to blockers.
const OF_GUIDE: u64 = 1 << 40;

/// Divides base and lobe by their texture factors.
fn without(parts: [f64; 2], factors: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i: usize| {
        if factors[i] > 0.0 {
            parts[i] / factors[i]
        } else {
            0.0
        }
    })
}
