//! What an environment shines on a point.

use super::incoming::{Incoming, Rule, secant};
use etendue_field::{Environment, EnvironmentMap, Frame};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Widths of a spherical Gaussian beyond which nothing is left: exp(−5²/2) = 4·10⁻⁶.
const GLOW: f64 = 5.0;

/// An environment over slopes: each lobe in the angle from its middle and around it, each square of a map's pixels by itself.
pub(super) fn incoming(environment: &Environment, rule: &Rule) -> Vec<Incoming> {
    let mut all = Vec::new();
    let mut add = |from: DVec3, solid_angle: f64| {
        let along = -environment.frame.vector_to_world(from);
        if along.z > 0.0 {
            let slopes = [along.x / along.z, along.y / along.z];
            // du dv = dω / cos³.
            let weight = environment.radiance(along) * solid_angle * secant(slopes).powi(3);
            all.push(Incoming { slopes, weight });
        }
    };
    match &environment.map {
        EnvironmentMap::Lobes(lobes) => {
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
                        // Where lobes overlap, each has its share of the radiance of all.
                        let own = lobe.radiance_from(from);
                        let whole: f64 = lobes.iter().map(|l| l.radiance_from(from)).sum();
                        if own > 0.0 {
                            add(from, share * own / whole);
                        }
                    }
                }
            }
        }
        EnvironmentMap::LatLong(map) => {
            let [w, h] = [map.raster().width(), map.raster().height()];
            let pixel = TAU / w as f64 * PI / h as f64;
            // Between centres of pixels it is bilinear: halves of a pixel have no kinks.
            let half = Rule::plain(2);
            for place in (0..4 * w * h).map(|i| [i % (2 * w), i / (2 * w)]) {
                let [a, b] = place.map(|i| [0.5 * i as f64, 0.5 * (i + 1) as f64]);
                for (at, share) in half.over([a, b]) {
                    let from = map.direction(at);
                    add(from, share * pixel * from.x.hypot(from.z));
                }
            }
        }
    }
    all.retain(|incoming| incoming.weight > 0.0);
    all
}
