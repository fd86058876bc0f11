//! What the pixels of a picture see.

use crate::cutoffs::Cutoffs;
use etendue_paths::{Paths, Reflects, SurfaceHit};
use etendue_world::Camera;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Places of a pixel.
pub(crate) const FOUR: usize = 4;

/// Where they are in it. No two are in one row or column, so that edges near these directions get four steps and not two.
pub(crate) const OFFSETS: [[f64; 2]; FOUR] = [
    [0.375, 0.125],
    [0.875, 0.375],
    [0.125, 0.625],
    [0.625, 0.875],
];

/// Place `i` of a pixel, in pixels to the right and down from the top left of the picture.
pub(crate) fn at(pixel: [usize; 2], i: usize) -> [f64; 2] {
    [0, 1].map(|k: usize| pixel[k] as f64 + OFFSETS[i][k])
}

/// Places that are seen, four for each pixel.
#[derive(Debug)]
pub(crate) struct Visible {
    /// Pixels in a row, and rows.
    pub(crate) size: [usize; 2],
    /// Those of a pixel after each other, pixels in rows from the top.
    pub(crate) places: Vec<SeenPlace>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenPlace {
    /// What sources themselves send, W m⁻² sr⁻¹.
    pub(crate) emitted: f64,
    pub(crate) surface: Option<SeenSurface>,
}

/// A surface where it is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenSurface {
    pub(crate) shape: usize,
    pub(crate) position: DVec3,
    /// On the side that is seen.
    pub(crate) normal: DVec3,
    /// The middle of the directions that light comes from: the mirror direction, or the normal of what has no lobe.
    pub(crate) axis: DVec3,
    /// Whether the axis is the mirror direction.
    pub(crate) has_lobe: bool,
    /// The highest frequency that the material keeps of these, cycles per radian; 0 of what is black.
    pub(crate) cutoff: f64,
    /// The factors of base and lobe, as textures have them. Shading is what remains.
    pub(crate) factors: [f64; 2],
}

impl SeenSurface {
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
            has_lobe,
            cutoff: cutoffs.of(reflects),
            factors: paths.factors(seen),
        }
    }
}

impl Visible {
    /// `progress` is told of pixels.
    pub(crate) fn new(
        paths: &Paths,
        camera: &Camera,
        cutoffs: &Cutoffs,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Self {
        let [w, h] = camera.size;
        let row = |row: usize| {
            let place = |i: usize| {
                let view = paths.view(&camera.look(at([i / FOUR, row], i % FOUR), [0.0; 2]));
                SeenPlace {
                    emitted: view.emitted,
                    surface: view
                        .surface
                        .map(|seen| SeenSurface::new(paths, &seen, cutoffs)),
                }
            };
            let places: Vec<SeenPlace> = (0..FOUR * w).map(place).collect();
            progress(w as u64);
            places
        };
        Self {
            size: camera.size,
            places: (0..h).into_par_iter().flat_map_iter(row).collect(),
        }
    }

    /// The places of a pixel.
    pub(crate) fn of_pixel(&self, [column, row]: [usize; 2]) -> &[SeenPlace] {
        &self.places[self.range([column, row])]
    }

    /// The numbers of its places.
    pub(crate) fn range(&self, [column, row]: [usize; 2]) -> Range<usize> {
        let first = FOUR * (row * self.size[0] + column);
        first..first + FOUR
    }

    /// Something of each pixel.
    pub(crate) fn pixels<T: Send>(&self, of: impl Fn([usize; 2]) -> T + Sync) -> Vec<T> {
        let [w, h] = self.size;
        (0..w * h)
            .into_par_iter()
            .map(|i| of([i % w, i / w]))
            .collect()
    }
}
