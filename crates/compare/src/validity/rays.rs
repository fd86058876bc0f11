//! Draws rays of the light for a check. The rays are the same in every run.

use etendue_field::{EnvironmentMap, Frame, Light, Patch, Rectangle, Shape, Window};
use glam::DVec3;
use std::f64::consts::TAU;

/// Light with less than this share of the strongest light in the window changes no verdict.
const DARK: f64 = 1e-5;

/// The numbers from which a ray is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayDraw {
    /// The number of the draw, which selects one of several ways to draw.
    pub(super) index: u32,
    /// Six numbers in [0, 1].
    pub(super) numbers: [f64; 6],
}

impl RayDraw {
    pub(super) fn new(index: u32) -> Self {
        Self {
            index,
            numbers: lattice(index),
        }
    }
}

/// Returns the first `most` rays that carry light into the window. Rays that are dark relative to
/// the others are left out. Only light inside the window determines which rays count as dark,
/// because the strongest part of the sky may lie outside the window.
pub(super) fn bright<T>(rays: impl Iterator<Item = (f64, T)>, most: usize) -> Vec<(f64, T)> {
    let mut strongest = 0.0;
    let mut found = Vec::new();
    for (light, ray) in rays {
        if light > DARK * strongest {
            strongest = light.max(strongest);
            found.push((light, ray));
        }
        if found.len() == most {
            break;
        }
    }
    found.retain(|(light, _)| *light > DARK * strongest);
    found
}

/// A straight leg of a ray, in the frame at the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct CheckRay {
    pub(super) point: DVec3,
    /// A unit vector.
    pub(super) direction: DVec3,
}

impl CheckRay {
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.point + t * self.direction
    }

    /// Returns the same ray with its start moved to the plane of the light.
    pub(super) fn begun(&self) -> Self {
        Self {
            point: self.at(-self.point.z / self.direction.z),
            ..*self
        }
    }

    /// Returns the reversed ray with its start moved beyond a surface that the ray meets.
    pub(super) fn back(&self, patch: &Patch) -> Self {
        let far = 4.0 * patch.aperture + (self.point - patch.frame.origin).length();
        Self {
            point: self.at(far),
            direction: -self.direction,
        }
    }

    /// Returns the same ray in the coordinates of a frame.
    pub(super) fn seen_from(&self, frame: &Frame) -> Self {
        Self {
            point: frame.to_local(self.point),
            direction: frame.vector_to_local(self.direction),
        }
    }

    /// Returns the distance along the ray at which it meets a triangle (Möller and Trumbore 1997).
    pub(super) fn meets_triangle(&self, [a, b, c]: &[DVec3; 3]) -> Option<f64> {
        let [side, other, from] = [*b - *a, *c - *a, self.point - *a];
        let across = self.direction.cross(other);
        let whole = side.dot(across);
        let s = from.dot(across) / whole;
        let turned = from.cross(side);
        let t = self.direction.dot(turned) / whole;
        let at = other.dot(turned) / whole;
        (s >= 0.0 && t >= 0.0 && s + t <= 1.0).then_some(at)
    }

    /// Returns the distance at which theory finds the intersection of the ray with a surface.
    /// Theory uses Newton's method from the point where the ray crosses the tangent plane at the
    /// vertex (`etendue_theory::rays`). Therefore the intersection and that point lie on the same
    /// side of the extremum that the quadric has along the ray.
    pub(super) fn theory_hit(&self, patch: &Patch) -> Option<f64> {
        let Self { point, direction } = self.seen_from(&patch.frame);
        let from = if direction.z.abs() > 1e-3 {
            -point.z / direction.z
        } else {
            -point.dot(direction)
        };
        let curved = DVec3::from(patch.curvature) * direction;
        let (a, b) = (curved.dot(direction), curved.dot(point) + direction.z);
        // To avoid cancellation, the other root is computed as the constant term divided by q.
        let root = (b * b - a * patch.value(point)).sqrt();
        let q = -(b + root.copysign(b));
        let roots = [q / a, patch.value(point) / q];
        // The extremum is at −b/a. If a line has no extremum, there is a single root.
        let first = |t: &&f64| a == 0.0 || (**t < -b / a) == (from < -b / a);
        let found = roots.iter().filter(|t| t.is_finite()).find(first);
        let found = found.copied().filter(|t| *t > 0.0);
        found.filter(|t| patch.contains(point + *t * direction))
    }

    /// Returns the distance at which the ray meets a surface from the side to which `side` points,
    /// even if the ray meets another object before.
    pub(super) fn front_hit(&self, patch: &Patch, side: DVec3) -> Option<f64> {
        let Self { point, direction } = self.seen_from(&patch.frame);
        let side = patch.frame.d.dot(side).signum();
        let faces = |t: &f64| side * patch.gradient(point + *t * direction).dot(direction) < 0.0;
        let hits = patch.hits(point, direction).into_iter();
        hits.filter(|t| *t > 0.0).find(faces)
    }
}

/// Returns six numbers in (0, 1) that fill the cube uniformly. They are multiples of powers of the
/// root of x⁷ = x + 1 (Roberts 2018, *The unreasonable effectiveness of quasirandom sequences*).
pub(super) fn lattice(index: u32) -> [f64; 6] {
    const ROOT: f64 = 1.112_775_684_278_705_6;
    std::array::from_fn(|axis| {
        let power = ROOT.powi(-1 - i32::try_from(axis).unwrap_or_default());
        (0.5 + f64::from(index + 1) * power).fract()
    })
}

/// Returns coordinates at a plane, uniform in its window.
pub(super) fn within(window: &Window, r: [f64; 6]) -> [f64; 4] {
    let Window { x, y, u, v } = window;
    let profiles = [x, y, u, v];
    std::array::from_fn(|axis| (2.0 * r[axis] - 1.0) * profiles[axis].half_width())
}

/// The function [`centred`] draws numbers densely down to this modulus.
const CENTRE: f64 = 1e-3;

/// Returns a number in [−1, 1]. Every second number is uniform, and the other numbers are
/// distributed logarithmically around zero, down to a thousandth.
pub(super) fn centred(index: u32, r: f64) -> f64 {
    let s = 2.0 * r - 1.0;
    if index.is_multiple_of(2) {
        s
    } else {
        s.signum() * libm::pow(CENTRE, 1.0 - s.abs())
    }
}

/// Returns the density of pairs of numbers that [`centred`] draws with the same index, averaged
/// over all indices.
pub(super) fn density(pair: [f64; 2]) -> f64 {
    let dense = pair.map(|s| {
        let is_drawn = (CENTRE..=1.0).contains(&s.abs());
        let density = -0.5 / (s.abs() * libm::log(CENTRE));
        if is_drawn { density } else { 0.0 }
    });
    0.5 * (0.25 + dense[0] * dense[1])
}

/// Returns a ray of the light through a point, and the strength of this ray; `None` where the light
/// has no such ray.
pub(super) fn ray_to(
    light: &Light,
    point: DVec3,
    index: u32,
    r: [f64; 2],
) -> Option<(CheckRay, f64)> {
    let through = |from: DVec3| {
        let direction = (point - from).try_normalize()?;
        let point = from;
        Some(CheckRay { point, direction })
    };
    let offset = [0, 1].map(|axis| centred(index / 2, r[axis]));
    let ray = match light {
        Light::Area { shape, .. } => through(point_of(shape, offset))?,
        Light::Point { .. } | Light::Projector { .. } => through(DVec3::ZERO)?,
        Light::Beam { .. } => through(DVec3::new(point.x, point.y, 0.0))?,
        Light::Environment { environment } => {
            let frame = &environment.frame;
            let direction = match &environment.map {
                // Rays of a lobe are also drawn far from the centre of the lobe, because it is
                // possible that only light far from the centre travels forward.
                EnvironmentMap::Lobes(lobes) if (index / 4).is_multiple_of(2) => {
                    let lobe = &lobes[(index / 8) as usize % lobes.len().max(1)];
                    let around = Frame::IDENTITY.turned_to(lobe.from);
                    let [x, y] = offset.map(|o| 3.0 * lobe.width * o);
                    let from = around.vector_to_world(DVec3::new(x, y, 1.0));
                    -frame.vector_to_world(from)
                }
                EnvironmentMap::Lobes(_) | EnvironmentMap::LatLong(_) => {
                    let (sin, cos) = libm::sincos(TAU * r[0]);
                    let across = (1.0 - r[1] * r[1]).sqrt();
                    DVec3::new(across * cos, across * sin, r[1])
                }
            };
            let direction = direction.normalize();
            CheckRay { point, direction }.begun()
        }
        // The theories that use this check do not predict the light of ray files.
        Light::Rays { .. } => return None,
    };
    (ray.direction.z > 0.0).then(|| (ray, strength(light, &ray)))
}

/// Returns the strength of a ray that starts at the light, relative to the other rays.
pub(super) fn strength(light: &Light, ray: &CheckRay) -> f64 {
    let CheckRay { point, direction } = ray;
    match light {
        Light::Area { exponent, .. } => libm::pow(direction.z, *exponent),
        Light::Point { .. } => 1.0,
        Light::Projector { image, .. } => {
            image.value(direction.x / direction.z, direction.y / direction.z)
        }
        Light::Beam { image, .. } => image.value(point.x, point.y),
        Light::Environment { environment } => environment.radiance(*direction),
        Light::Rays { .. } => 0.0,
    }
}

/// Returns the point of a shape at an offset from the centre of the shape. The offset is given in
/// units of the shape's size. For a disc, the square of offsets is mapped to the disc.
fn point_of(shape: &Shape, [a, b]: [f64; 2]) -> DVec3 {
    match shape {
        Shape::Rectangle(rectangle) => {
            let [x, y] = rectangle.center;
            let [w, h] = rectangle.size;
            DVec3::new(x + 0.5 * w * a, y + 0.5 * h * b, 0.0)
        }
        Shape::Disc(disc) => {
            let [x, y] = disc.center;
            let scale =
                disc.radius * a.abs().max(b.abs()) / libm::hypot(a, b).max(f64::MIN_POSITIVE);
            DVec3::new(x + scale * a, y + scale * b, 0.0)
        }
    }
}

/// Returns the area of a shape, divided by the area of the square of offsets that [`point_of`]
/// maps to the shape. Also returns the offset that is mapped to `point`.
pub(super) fn offset_of(shape: &Shape, point: DVec3) -> (f64, [f64; 2]) {
    match shape {
        Shape::Rectangle(Rectangle { center, size }) => {
            let offset = [point.x - center[0], point.y - center[1]];
            let [w, h] = size.map(|s| 0.5 * s);
            (w * h, [offset[0] / w, offset[1] / h])
        }
        Shape::Disc(disc) => {
            let [x, y] = [point.x - disc.center[0], point.y - disc.center[1]];
            // The map takes the square of side 2 r/R to the circle of radius r.
            let wide = x.abs().max(y.abs()).max(f64::MIN_POSITIVE);
            let share = wide / libm::hypot(x, y).max(f64::MIN_POSITIVE);
            let scale = disc.radius * share;
            (scale * scale, [x / scale, y / scale])
        }
    }
}

/// Returns a point of a surface. Points are drawn from the whole surface, but most of them are near
/// the point that the central ray hits.
pub(super) fn point_on(patch: &Patch, hit: DVec3, index: u32, r: [f64; 2]) -> Option<DVec3> {
    let center = patch.frame.to_local(hit);
    let [s, t] = [0, 1].map(|axis| 2.0 * patch.aperture * centred(index, r[axis]));
    let point = patch.point(center.x + s, center.y + t);
    let on_patch = point.is_finite() && patch.contains(patch.frame.to_local(point));
    on_patch.then_some(point)
}
