//! Lights of the plain tracer, as docs/scene.md describes them.

use super::path::Draws;
use super::world::grey;
use crate::second::pattern::cosine;
use crate::second::vector::{Axes, Vector, cross, dot, plus, turned, unit};
use etendue_scene::{BulbFile, EnvironmentFile, ImageFile, LightFile};
use std::f64::consts::{PI, TAU};

/// The picture of a beam ends at this many widths.
const REACH: f64 = 3.6;

pub(super) struct Lamp {
    axes: Axes,
    kind: Kind,
}

enum Kind {
    /// Area and radiance, and the exponent of the cosine that multiplies the radiance.
    Rectangle([f64; 2], f64, f64),
    Disc(f64, f64, f64),
    /// Intensity and slide.
    Point(f64, Option<ImageFile>),
    Beam(f64, ImageFile),
    /// Lobes: direction from which light comes, width, radiance.
    Lobes(Vec<(Vector, f64, f64)>),
}

/// How light begins.
pub(super) enum Start {
    /// At a point, towards any direction; the weight is an area, or 1 for a point light.
    At(Vector, f64),
    /// Along a ray from a point; the weight is a flux.
    Along(Vector, Vector, f64),
    /// From far away: radiance per density of a direction.
    Far(Vector, f64),
}

impl Lamp {
    pub(super) fn new(file: &LightFile, axes: impl Fn(Vector) -> Axes) -> Option<Self> {
        let kind = match file {
            LightFile::Rectangle { size, radiance, .. } => {
                Kind::Rectangle(*size, grey(radiance), 0.0)
            }
            LightFile::Disc {
                radius, radiance, ..
            } => Kind::Disc(*radius, grey(radiance), 0.0),
            LightFile::Spot {
                bulb,
                radiance,
                exponent,
                ..
            } => match bulb {
                BulbFile::Square(side) => Kind::Rectangle([*side; 2], grey(radiance), *exponent),
                BulbFile::Disc(radius) => Kind::Disc(*radius, grey(radiance), *exponent),
            },
            LightFile::Point { intensity, .. } => Kind::Point(grey(intensity), None),
            LightFile::Projector {
                intensity, image, ..
            } => Kind::Point(grey(intensity), Some(*image)),
            LightFile::Beam {
                irradiance, image, ..
            } => Kind::Beam(grey(irradiance), *image),
            LightFile::Environment {
                up,
                front,
                scale,
                map: EnvironmentFile::Lobes(lobes),
                ..
            } => {
                // The components of a lobe are along up × front, up, and front.
                let of_map = Axes::new([0.0; 3], *up, *front);
                let lobes = lobes.iter().map(|lobe| {
                    let [x, up, front] = lobe.from;
                    let from = unit(of_map.vector([front, x, up]));
                    (from, lobe.width, scale * grey(&lobe.radiance))
                });
                Kind::Lobes(lobes.collect())
            }
            LightFile::Environment { .. } | LightFile::Rays { .. } => return None,
        };
        let axes = axes(file.center());
        Some(Self { axes, kind })
    }

    pub(super) fn center(&self) -> Vector {
        self.axes.origin
    }

    pub(super) fn start(&self, draws: &mut Draws<'_>) -> Start {
        match &self.kind {
            Kind::Rectangle([width, height], ..) => {
                let [a, b] = draws.next();
                let at = self
                    .axes
                    .point([(a - 0.5) * width, (b - 0.5) * height, 0.0]);
                Start::At(at, width * height)
            }
            Kind::Disc(radius, ..) => {
                let [a, b] = draws.next();
                let (r, around) = (radius * a.sqrt(), TAU * b);
                let at = self.axes.point([r * around.cos(), r * around.sin(), 0.0]);
                Start::At(at, PI * radius * radius)
            }
            Kind::Point(..) => Start::At(self.axes.origin, 1.0),
            Kind::Beam(irradiance, image) => {
                let [a, b] = draws.next();
                let reach = image.width.map(|width| REACH * width);
                let at = [(2.0 * a - 1.0) * reach[0], (2.0 * b - 1.0) * reach[1]];
                let flux = irradiance * picture(image, at) * 4.0 * reach[0] * reach[1];
                Start::Along(self.axes.point([at[0], at[1], 0.0]), self.axes.d, flux)
            }
            Kind::Lobes(lobes) => {
                // A part of the directions is uniform over the hemisphere, because light of the tail
                // of a lobe may be all that arrives.
                let [which, around] = draws.next();
                let count = lobes.len() as f64 + 1.0;
                let [height, _] = draws.next();
                let chosen = lobes
                    .iter()
                    .zip(1..)
                    .find(|(_, i)| which * count < f64::from(*i));
                let from = match chosen {
                    Some(((from, width, _), _)) => {
                        let squared = width * width;
                        let cosine =
                            1.0 + squared * (height + (1.0 - height) * (-2.0 / squared).exp()).ln();
                        around_axis(*from, self.axes.x, [cosine, around])
                    }
                    None => around_axis(self.axes.d.map(|c| -c), self.axes.x, [height, around]),
                };
                let density = lobes.iter().map(|(of, width, _)| {
                    let squared = width * width;
                    let unit = TAU * squared * (1.0 - (-2.0 / squared).exp());
                    ((dot(*of, from) - 1.0) / squared).exp() / unit / count
                });
                let is_ahead = dot(from, self.axes.d) < 0.0;
                let uniform = if is_ahead { 1.0 / TAU / count } else { 0.0 };
                let along = from.map(|c| -c);
                Start::Far(
                    along,
                    self.radiance(along) / (density.sum::<f64>() + uniform),
                )
            }
        }
    }

    /// The radiance of an environment along a direction.
    pub(super) fn radiance(&self, along: Vector) -> f64 {
        let Kind::Lobes(lobes) = &self.kind else {
            return 0.0;
        };
        if dot(along, self.axes.d) <= 0.0 {
            return 0.0;
        }
        let lobe = |(from, width, radiance): &(Vector, f64, f64)| {
            radiance * ((-dot(*from, along) - 1.0) / (width * width)).exp()
        };
        lobes.iter().map(lobe).sum()
    }

    /// Whether all light has one direction.
    pub(super) fn is_beam(&self) -> bool {
        matches!(self.kind, Kind::Beam(..))
    }

    /// Whether the light is an environment.
    pub(super) fn is_far(&self) -> bool {
        matches!(self.kind, Kind::Lobes(_))
    }

    /// Where a ray through a point leaves the plane of an environment; `None` for a point
    /// behind this plane, from which light only travels forward.
    pub(super) fn origin(&self, point: Vector, along: Vector) -> Option<Vector> {
        let [.., height] = self.axes.coordinates(point);
        (height > 0.0).then(|| plus(point, -height / dot(along, self.axes.d), along))
    }

    /// The flux that leaves towards a direction per solid angle, and per area if the light
    /// has one.
    pub(super) fn emits(&self, to: Vector) -> f64 {
        let [x, y, cosine] = self.axes.components(to);
        match &self.kind {
            _ if cosine <= 0.0 => 0.0,
            Kind::Point(intensity, None) => *intensity,
            Kind::Point(intensity, Some(image)) => {
                intensity * picture(image, [x / cosine, y / cosine])
            }
            Kind::Rectangle(_, radiance, exponent) | Kind::Disc(_, radiance, exponent) => {
                radiance * cosine.powf(exponent + 1.0)
            }
            Kind::Beam(..) | Kind::Lobes(_) => 0.0,
        }
    }
}

/// The direction at an angle, given by its cosine, to an axis, and at a share of a turn
/// around the axis.
fn around_axis(axis: Vector, aside: Vector, [cosine, around]: [f64; 2]) -> Vector {
    let across = unit(cross(axis, aside));
    let tilted = turned(axis, across, cosine.clamp(-1.0, 1.0).acos());
    turned(tilted, axis, TAU * around)
}

/// exp(−π x²/w²) along both axes, times the grating.
fn picture(image: &ImageFile, at: [f64; 2]) -> f64 {
    let gauss = |i: usize| (-PI * (at[i] / image.width[i]).powi(2)).exp();
    let grating = image.grating.as_ref().map_or(1.0, |grating| {
        let numbers = [grating.frequency, grating.modulation, grating.phase];
        cosine(&super::world::grating(grating.axis, numbers), at, "")
    });
    gauss(0) * gauss(1) * grating
}
