//! The points visible in the pixels of a picture.

use crate::cutoffs::Cutoffs;
use etendue_field::whole;
use etendue_paths::{Paths, Reflects, SurfaceHit, View};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Number of points per pixel.
pub(crate) const FOUR: usize = 4;

/// Positions of the points in a pixel. No two points have the same row or column, so a nearly
/// horizontal or vertical edge gets four steps instead of two.
pub(crate) const OFFSETS: [[f64; 2]; FOUR] = [
    [0.375, 0.125],
    [0.875, 0.375],
    [0.125, 0.625],
    [0.625, 0.875],
];

/// The position of point `i` of a pixel, in pixels to the right and down from the top left
/// of the picture.
pub(crate) fn at(pixel: [usize; 2], i: usize) -> [f64; 2] {
    [0, 1].map(|k: usize| pixel[k] as f64 + OFFSETS[i][k])
}

/// The squared distance of two positions, in pixels.
pub(crate) fn squared_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (0..2).map(|k| (a[k] - b[k]).powi(2)).sum()
}

/// Visible points, four for each pixel.
#[derive(Debug)]
pub(crate) struct Visible {
    /// Width and height in pixels.
    pub(crate) size: [usize; 2],
    /// The points, grouped by pixel. The pixels are in rows from the top.
    pub(crate) places: Vec<SeenPlace>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenPlace {
    /// Radiance emitted by sources, W m⁻² sr⁻¹.
    pub(crate) emitted: f64,
    pub(crate) surface: Option<SeenSurface>,
}

impl SeenPlace {
    /// Describes what a ray from the camera meets.
    pub(crate) fn new(paths: &Paths, cutoffs: &Cutoffs, view: &View) -> Self {
        let of = |seen| SeenSurface::new(paths, seen, cutoffs);
        Self {
            emitted: view.emitted,
            surface: view.surface.as_ref().map(of),
        }
    }
}

/// A visible surface point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenSurface {
    pub(crate) shape: usize,
    pub(crate) position: DVec3,
    /// The normal on the visible side.
    pub(crate) normal: DVec3,
    /// The central direction of incident light: the mirror direction, or the normal of a material
    /// without a lobe.
    pub(crate) axis: DVec3,
    /// The material preserves frequencies around the axis up to this frequency, cycles per radian;
    /// 0 if the material is black.
    pub(crate) cutoff: f64,
    /// The texture factors of base and lobe. Shading samples are divided by these factors.
    pub(crate) factors: [f64; 2],
}

impl SeenSurface {
    /// Multiplies the values of base and lobe by the factors of the surface, and returns the
    /// radiance.
    pub(crate) fn light(&self, [base, lobe]: [f64; 2]) -> f64 {
        self.factors[0] * base + self.factors[1] * lobe
    }

    pub(crate) fn new(paths: &Paths, seen: &SurfaceHit, cutoffs: &Cutoffs) -> Self {
        let reflects = paths.reflects(seen);
        let has_lobe = matches!(reflects, Reflects::Lobe(_) | Reflects::Mirror);
        Self {
            shape: seen.shape(),
            position: seen.position(),
            normal: seen.normal(),
            axis: if has_lobe {
                seen.mirrored()
            } else {
                seen.normal()
            },
            cutoff: cutoffs.of(reflects),
            factors: paths.factors(seen),
        }
    }
}

impl Visible {
    /// Finds the visible points of a picture. `look` receives the index and the position of each
    /// point, and returns what is visible there and another value; these values are also returned.
    /// `progress` receives the number of finished pixels.
    pub(crate) fn new<T: Send>(
        size: [usize; 2],
        look: impl Fn(usize, [f64; 2]) -> (SeenPlace, T) + Sync,
        progress: &(dyn Fn(u64) + Sync),
    ) -> (Self, Vec<T>) {
        let [w, h] = size;
        let row = |row: usize| {
            let point = |i: usize| look(FOUR * row * w + i, at([i / FOUR, row], i % FOUR));
            let points: Vec<(SeenPlace, T)> = (0..FOUR * w).map(point).collect();
            progress(w as u64);
            points
        };
        let (places, found) = (0..h).into_par_iter().flat_map_iter(row).unzip();
        (Self { size, places }, found)
    }

    /// The points of a pixel.
    pub(crate) fn of_pixel(&self, [column, row]: [usize; 2]) -> &[SeenPlace] {
        &self.places[self.range([column, row])]
    }

    /// The indices of a pixel's points.
    pub(crate) fn range(&self, [column, row]: [usize; 2]) -> Range<usize> {
        let first = FOUR * (row * self.size[0] + column);
        first..first + FOUR
    }

    /// The pixel at a position, clamped to the picture.
    pub(crate) fn pixel_at(&self, at: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|k: usize| whole(at[k]).min(self.size[k] - 1))
    }

    /// The index of the pixel at a position, in rows from the top.
    pub(crate) fn pixel_index(&self, at: [f64; 2]) -> usize {
        let [column, row] = self.pixel_at(at);
        row * self.size[0] + column
    }

    /// The pixels that are at most `radius` to each side of a pixel, in rows from the top.
    pub(crate) fn around(
        &self,
        pixel: [usize; 2],
        radius: usize,
    ) -> impl Iterator<Item = [usize; 2]> + use<> {
        let near =
            |k: usize| pixel[k].saturating_sub(radius)..(pixel[k] + radius + 1).min(self.size[k]);
        let columns = near(0);
        near(1).flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }

    /// Computes a value for each pixel.
    pub(crate) fn pixels<T: Send>(&self, of: impl Fn([usize; 2]) -> T + Sync) -> Vec<T> {
        let [w, h] = self.size;
        (0..w * h)
            .into_par_iter()
            .map(|i| of([i % w, i / w]))
            .collect()
    }
}
