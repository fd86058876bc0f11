//! What shines on a point, by quadrature over slopes.

use super::{System, sky};
use crate::quadrature::gauss_legendre;
use crate::shadow::{Seen, Sides, is_rectangular, open_within};
use etendue_field::{Light, Mask, Rectangle, Shape};
use glam::DVec3;
use std::f64::consts::TAU;

/// Light that arrives with slopes (u, v).
#[derive(Clone, Copy, Debug)]
pub(super) struct Incoming {
    pub(super) slopes: [f64; 2],
    /// Radiance times its share of du dv.
    pub(super) weight: f64,
}

/// A Gauss rule on (0, 1).
#[derive(Clone, Debug)]
pub(super) struct Rule {
    pub(super) nodes: Vec<(f64, f64)>,
    /// What an environment shines on all points, where nothing is in its way.
    sky: Vec<Incoming>,
}

impl Rule {
    pub(super) fn new(count: usize, light: &Light) -> Self {
        let mut rule = Self::plain(count);
        if let Light::Environment { environment } = light {
            rule.sky = sky::incoming(environment, &rule);
        }
        rule
    }

    /// Nodes alone.
    pub(super) fn plain(count: usize) -> Self {
        let nodes = gauss_legendre(count).into_iter();
        Self {
            nodes: nodes.map(|(x, w)| (0.5 * (x + 1.0), 0.5 * w)).collect(),
            sky: Vec::new(),
        }
    }

    /// From how many directions an environment shines.
    pub(super) fn directions(&self) -> usize {
        self.sky.len()
    }

    /// Nodes and weights on a rectangle.
    pub(super) fn over(&self, [a, b]: Sides) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
        let at = |[low, high]: [f64; 2], t: f64| low + t * (high - low);
        let area = (a[1] - a[0]) * (b[1] - b[0]);
        self.nodes.iter().flat_map(move |&(s, p)| {
            let along = self.nodes.iter();
            along.map(move |&(t, q)| ([at(a, s), at(b, t)], p * q * area))
        })
    }
}

impl System {
    /// All that shines on a point, given where it is in the frame at the light.
    pub(super) fn incoming(&self, point: DVec3, rule: &Rule) -> Vec<Incoming> {
        let DVec3 { x, y, z } = point;
        let one = |slopes: [f64; 2], weight: f64| {
            let weight = weight * self.transmittance(point, slopes, false);
            vec![Incoming { slopes, weight }]
        };
        match &self.light {
            Light::Point { intensity } => {
                let slopes = [x / z, y / z];
                one(slopes, intensity * secant(slopes) / (z * z))
            }
            Light::Projector { intensity, image } => {
                let slopes = [x / z, y / z];
                let seen = image.value(slopes[0], slopes[1]);
                one(slopes, intensity * seen * secant(slopes) / (z * z))
            }
            Light::Environment { .. } => rule
                .sky
                .iter()
                .map(|incoming| {
                    let passes = self.transmittance(point, incoming.slopes, false);
                    Incoming {
                        weight: incoming.weight * passes,
                        ..*incoming
                    }
                })
                .collect(),
            Light::Beam { irradiance, image } => one([0.0; 2], irradiance * image.value(x, y)),
            Light::Area {
                shape,
                radiance,
                exponent,
            } => {
                let lobe = |slopes| radiance * secant(slopes).powf(-exponent);
                self.area(point, shape, rule, lobe)
            }
        }
    }

    fn area(
        &self,
        point: DVec3,
        shape: &Shape,
        rule: &Rule,
        radiance: impl Fn([f64; 2]) -> f64,
    ) -> Vec<Incoming> {
        let Shape::Rectangle(rectangle) = shape else {
            return self.disc(point, shape, rule, radiance);
        };
        let parts = self.parts(point, rectangle, usize::MAX).unwrap_or_default();
        let nodes = parts.iter().flat_map(|(sign, sides)| {
            let nodes = rule.over(*sides);
            nodes.map(move |(slopes, share)| (slopes, sign * share))
        });
        nodes
            .map(|(slopes, share)| Incoming {
                slopes,
                weight: share * radiance(slopes) * self.transmittance(point, slopes, true),
            })
            .collect()
    }

    /// What rectangular masks leave of a rectangular light, in slopes at a point, with signs; `None` if that is more parts than `most`.
    pub(super) fn parts(
        &self,
        point: DVec3,
        light: &Rectangle,
        most: usize,
    ) -> Option<Vec<(f64, Sides)>> {
        let DVec3 { x, y, z } = point;
        let clear = |(_, mask): &&(f64, Mask)| is_rectangular(mask);
        let whole = [0, 1].map(|axis| {
            let [low, high] = light.extent(axis);
            [([x, y][axis] - high) / z, ([x, y][axis] - low) / z]
        });
        let masks = self.layers.iter().filter(clear);
        let seen = masks.map(|(distance, mask)| Seen {
            mask,
            origin: [x, y],
            scale: distance - z,
        });
        open_within(whole, &seen.collect::<Vec<_>>(), most)
    }

    /// From a disc: equal shares of the angle, and a rule in the square of the radius.
    fn disc(
        &self,
        point: DVec3,
        shape: &Shape,
        rule: &Rule,
        radiance: impl Fn([f64; 2]) -> f64,
    ) -> Vec<Incoming> {
        let Shape::Disc(disc) = shape else {
            return Vec::new();
        };
        let angles = 2 * rule.nodes.len();
        let share = shape.area() / (angles as f64 * point.z * point.z);
        let nodes = rule.nodes.iter().flat_map(|&(t, weight)| {
            (0..angles).map(move |i| {
                let (sin, cos) = (TAU * i as f64 / angles as f64).sin_cos();
                let r = disc.radius * t.sqrt();
                (
                    [disc.center[0] + r * cos, disc.center[1] + r * sin],
                    weight * share,
                )
            })
        });
        nodes
            .map(|(from, share)| {
                let slopes = [(point.x - from[0]) / point.z, (point.y - from[1]) / point.z];
                let weight = share * radiance(slopes) * self.transmittance(point, slopes, false);
                Incoming { slopes, weight }
            })
            .collect()
    }

    /// What masks leave of light that arrives at a point; those that have been taken apart are not asked again.
    fn transmittance(&self, point: DVec3, [u, v]: [f64; 2], apart: bool) -> f64 {
        let masks = self.layers.iter().map(|(distance, mask)| {
            let back = distance - point.z;
            let (x, y) = (point.x + back * u, point.y + back * v);
            match mask {
                Mask::Grating(grating) => grating.transmittance(x, y),
                Mask::Opaque { .. } if apart && is_rectangular(mask) => 1.0,
                Mask::Opaque {
                    shapes,
                    half_planes,
                } => {
                    let stopped = shapes.iter().any(|s| s.contains(x, y))
                        || half_planes.iter().any(|h| h.contains(x, y));
                    f64::from(u8::from(!stopped))
                }
            }
        });
        masks.product()
    }
}

/// 1/cos of the angle to the central ray.
pub(super) fn secant([u, v]: [f64; 2]) -> f64 {
    (1.0 + u * u + v * v).sqrt()
}
