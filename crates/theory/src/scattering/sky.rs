//! What an environment shines on a point.

use super::incoming::{Incoming, Rule, secant};
use etendue_field::{Environment, EnvironmentMap, Frame, LatLong, SphericalGaussian};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Widths of a spherical Gaussian beyond which nothing is left: exp(−5²/2) = 4·10⁻⁶.
const GLOW: f64 = 5.0;
/// Parts of a map from pole to pole for each node of a rule; around there are twice as many.
const PARTS: usize = 8;

/// An environment over slopes, as light from a number of directions.
pub(super) fn incoming(environment: &Environment, rule: &Rule) -> Vec<Incoming> {
    let flux = match &environment.map {
        EnvironmentMap::Lobes(lobes) => of_lobes(lobes, rule),
        EnvironmentMap::LatLong(map) => {
            let goes_forward = |from: DVec3| environment.frame.vector_to_world(from).z < 0.0;
            of_map(map, PARTS * rule.nodes.len(), goes_forward)
        }
    };
    let incoming = flux.into_iter().filter_map(|flux| {
        let along = -environment.frame.vector_to_world(flux);
        let slopes = [along.x / along.z, along.y / along.z];
        // du dv = dω / cos³.
        let weight = flux.length() * secant(slopes).powi(3);
        (along.z > 0.0).then_some(Incoming { slopes, weight })
    });
    incoming.collect()
}

/// Radiance times solid angle, along where it comes from: over each lobe by a rule in the angle from its middle, and around it.
fn of_lobes(lobes: &[SphericalGaussian], rule: &Rule) -> Vec<DVec3> {
    let mut all = Vec::new();
    for lobe in lobes {
        let around = Frame::IDENTITY.turned_to(lobe.from);
        let most = (GLOW * lobe.width).min(PI);
        let turns = 2 * rule.nodes.len();
        for &(t, weight) in &rule.nodes {
            let (sin, cos) = (t * most).sin_cos();
            let share = weight * most * sin * TAU / turns as f64;
            for turn in 0..turns {
                let (s, c) = (TAU * turn as f64 / turns as f64).sin_cos();
                let from = around.vector_to_world(DVec3::new(sin * c, sin * s, cos));
                all.push(share * lobe.radiance_from(from) * from);
            }
        }
    }
    all
}

/// The same of a map, in `parts` from pole to pole and twice as many around: of each part it is the sum, as a vector, so that the irradiance of a
/// surface that sees all of the part is that of its pixels. A map with fewer pixels is taken by quarters of them.
fn of_map(map: &LatLong, parts: usize, goes_forward: impl Fn(DVec3) -> bool + Sync) -> Vec<DVec3> {
    let raster = map.raster();
    // Between centres of pixels it is bilinear: halves of a pixel have no kinks. Of small pixels the centre is enough.
    let per_pixel = if raster.height() > 4 * parts { 1 } else { 2 };
    let cells = [raster.width(), raster.height()].map(|n| n * per_pixel);
    let parts = [cells[0].min(2 * parts), cells[1].min(parts)];
    let cell = |[i, j]: [usize; 2]| {
        let place = [i, j].map(|n| (n as f64 + 0.5) / per_pixel as f64);
        let from = map.direction(place);
        let latitude = |j: usize| PI * (0.5 - j as f64 / cells[1] as f64);
        let solid_angle = TAU / cells[0] as f64 * (latitude(j).sin() - latitude(j + 1).sin());
        if goes_forward(from) {
            raster.value(place[0], place[1], true) * solid_angle * from
        } else {
            DVec3::ZERO
        }
    };
    let rows = (0..parts[1]).into_par_iter().map(|part| {
        let mut row = vec![DVec3::ZERO; parts[0]];
        let [first, end] = [part, part + 1].map(|p| (p * cells[1]).div_ceil(parts[1]));
        for j in first..end {
            for i in 0..cells[0] {
                row[i * parts[0] / cells[0]] += cell([i, j]);
            }
        }
        row
    });
    let rows: Vec<Vec<DVec3>> = rows.collect();
    rows.concat()
        .into_iter()
        .filter(|flux| *flux != DVec3::ZERO)
        .collect()
}
