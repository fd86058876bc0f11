//! The operators in 2D: against a plain quadrature of the mapped field, and against rays traced off a circle.

use super::order::slope;
use crate::report::Section;
use etendue_field::Complex;
use etendue_theory::geometry::{Map, Matrix, Media};
use std::f64::consts::TAU;

/// Covariance of the Gaussian field of the tests at size 1, (x, θ).
const FIELD: Matrix<2> = [[1.0, 0.3], [0.3, 0.8]];
/// Sizes of the neighbourhood.
const SIZES: [f64; 4] = [0.02, 0.01, 0.005, 0.0025];
/// Nodes along each axis of the lattice, half of them, and its half-width in standard deviations.
const NODES: i32 = 60;
const REACH: f64 = 8.5;
/// Rounding of a sum of 10⁴ terms.
const ROUNDING: f64 = 1e-12;
/// How far a fitted order may be from what is known beforehand.
const ORDER: f64 = 0.15;
/// Where nothing is left out.
const EXACT: f64 = 1e-9;

/// Steps of the path, in the order of light.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Travel,
    Incidence,
    Curvature,
    Event,
    Back,
    Outgoing,
    Beyond,
}

use Stage::{Back, Beyond, Curvature, Event, Incidence, Outgoing, Travel};

/// Travel, and a surface: a mirror unless it has media.
#[derive(Clone, Copy, Debug)]
struct Path {
    theta0: f64,
    k: f64,
    media: Option<Media>,
}

/// Metres before and after the surface.
const BEFORE: f64 = 1.0;
const AFTER: f64 = 0.7;

const GLASS: Media = Media {
    before: 1.0,
    after: 1.5,
};

fn paths() -> Vec<(&'static str, Path)> {
    let mirror = |theta0, k| Path {
        theta0,
        k,
        media: None,
    };
    let glass = |theta0, k, media| Path {
        theta0,
        k,
        media: Some(media),
    };
    vec![
        ("plane mirror", mirror(0.65, 0.0)),
        ("convex mirror", mirror(0.0, 0.5)),
        ("convex mirror", mirror(0.65, 0.5)),
        ("convex mirror", mirror(1.1, 0.1)),
        ("concave mirror", mirror(0.0, -0.5)),
        ("concave mirror", mirror(0.65, -0.5)),
        ("concave mirror", mirror(1.1, -0.1)),
        ("into glass", glass(0.65, 0.5, GLASS)),
        ("out of glass", glass(0.4, -0.5, GLASS.reversed())),
        ("into glass", glass(0.0, 0.5, GLASS)),
    ]
}

/// The 2D half of the table.
pub(super) fn planar() -> Section {
    let mut rows = Vec::new();
    let mut passed = true;
    for (name, path) in paths() {
        for stage in [Travel, Incidence, Curvature, Event, Back, Outgoing, Beyond] {
            let at = |size: f64| path.errors(stage, size);
            let errors = SIZES.map(at);
            let quadrature = errors.iter().map(|e| e[0]).fold(0.0, f64::max);
            let traced = errors.map(|e| e[1]);
            let logs = [0, 1, 2, 3].map(|i: usize| [SIZES[i].ln(), traced[i].ln()]);
            let order = slope(&logs);
            let known = path.known(stage);
            let follows = match known {
                Some(n) => (order - n).abs() <= ORDER,
                None => traced.iter().all(|e| *e < EXACT),
            };
            let well = quadrature < ROUNDING && follows;
            passed &= well;
            rows.push(vec![
                format!("{stage:?}").to_lowercase(),
                name.to_owned(),
                format!("{}", path.theta0),
                format!("{}", path.k),
                format!("{quadrature:.1e}"),
                format!("{:.2e}", traced[0]),
                format!("{:.2e}", traced[3]),
                known.map_or("–".to_owned(), |_| format!("{order:.3}")),
                known.map_or("exact".to_owned(), |n| format!("{n:.0}")),
                if well { "pass" } else { "FAIL" }.to_owned(),
            ]);
        }
    }
    Section {
        title: "Operators in 2D: theory against quadrature".to_owned(),
        text: format!(
            "A Gaussian field e wide through travel over {BEFORE} m, a circle of curvature k met at θ₀, and travel over {AFTER} m; 24 frequencies. Map: the \
             operators' spectrum against a plain quadrature of the field they map. Traced: against that of the field traced off the circle, at e = 0.02 and at \
             0.0025, and the exponent with which it falls. Required: map below {ROUNDING:.0e}; order within {ORDER} of 1 where light comes at an angle, of 2 along \
             the normal; travel and a plane mirror exact but for slopes being tangents, which is of second order."
        ),
        header: vec![
            "up to", "surface", "θ₀", "k", "map", "traced .02", "traced .0025", "order", "known", "verdict",
        ],
        rows,
        passed,
    }
}

impl Path {
    /// Beforehand: 1 at an angle, 2 along the normal, where angles stand for slopes as well.
    fn known(&self, stage: Stage) -> Option<f64> {
        let flat_mirror = self.k == 0.0 && self.media.is_none();
        match stage {
            Travel => Some(2.0),
            Outgoing | Beyond if flat_mirror => Some(2.0),
            // Angles to a fixed normal and to one that does not turn are right; the scale of positions is not.
            _ if self.theta0 == 0.0 => Some(2.0),
            _ => Some(1.0),
        }
    }

    fn theta1(&self) -> f64 {
        match self.media {
            Some(media) => media.refracted(self.theta0).unwrap_or(f64::NAN),
            None => -self.theta0,
        }
    }

    /// The operators up to a stage.
    fn map(&self, stage: Stage) -> Map<2> {
        let theta1 = self.theta1();
        let event = match &self.media {
            Some(media) => Map::<2>::refraction(self.theta0, media).unwrap_or(Map::identity()),
            None => Map::mirror(),
        };
        let off = match self.media {
            Some(_) => Map::<2>::incidence(theta1)
                .inverse()
                .unwrap_or(Map::identity()),
            None => Map::<2>::outgoing(theta1),
        };
        let steps = [
            (Travel, Map::travel(BEFORE)),
            (Incidence, Map::<2>::incidence(self.theta0)),
            (Curvature, Map::<2>::curvature(self.k)),
            (Event, event),
            (Back, Map::<2>::back(self.k)),
            (Outgoing, off),
            (Beyond, Map::travel(AFTER)),
        ];
        let mut map = Map::identity();
        for (step, next) in steps {
            map = map.then(&next);
            if step == stage {
                break;
            }
        }
        map
    }

    /// Where a ray really goes, (x, θ) at the light to the coordinates of a stage.
    fn trace(&self, stage: Stage, [x, theta]: [f64; 2]) -> [f64; 2] {
        let x = x + BEFORE * theta.tan();
        if stage == Travel {
            return [x, theta];
        }
        // (T, N) axes: D comes from ω(θ₀), X = −c₀ T + sin θ₀ N.
        let (sin, cos) = self.theta0.sin_cos();
        let point = [-cos * x, sin * x];
        let along = -omega(self.theta0 + theta);
        let point = [point[0], point[1]];
        let on_tangent = point[0] - point[1] / along.1 * along.0;
        let from = self.theta0 + theta;
        if stage == Incidence {
            return [on_tangent, from];
        }
        let hit = self.hit(point, along);
        let tilt = (self.k * hit[0]).asin();
        if stage == Curvature {
            return [hit[0], from - tilt];
        }
        let local = match self.media {
            Some(media) => (media.index_ratio() * (from - tilt).sin()).asin(),
            None => tilt - from,
        };
        if stage == Event {
            return [hit[0], local];
        }
        let global = local + tilt;
        let away = omega(global);
        let back = hit[0] - hit[1] / away.1 * away.0;
        if stage == Back {
            return [back, global];
        }
        // The frame after: X = c₁ T − sin θ₁ N, or that of light that goes on through.
        let theta1 = self.theta1();
        let (sin, cos) = theta1.sin_cos();
        let sign = if self.media.is_some() { -1.0 } else { 1.0 };
        let axis = [sign * cos, -sign * sin];
        let central = omega(theta1);
        let height = hit[0] * central.0 + hit[1] * central.1;
        let advance = away.0 * central.0 + away.1 * central.1;
        let at = [
            hit[0] - height / advance * away.0,
            hit[1] - height / advance * away.1,
        ];
        let x = at[0] * axis[0] + at[1] * axis[1];
        let theta = global - theta1;
        if stage == Outgoing {
            return [x, theta];
        }
        [x + AFTER * theta.tan(), theta]
    }

    /// Where a line meets the circle, near the origin.
    fn hit(&self, [s, h]: [f64; 2], along: Direction) -> [f64; 2] {
        let Direction(a, b) = along;
        // k (s² + h²) + 2 h = 0.
        let (p, q) = (self.k, self.k * (s * a + h * b) + b);
        let c = self.k * (s * s + h * h) + 2.0 * h;
        let t = -c / (q + (q * q - p * c).sqrt().copysign(q));
        [s + t * a, h + t * b]
    }

    /// Of the map against a quadrature of the mapped field, and against the traced one.
    fn errors(&self, stage: Stage, size: f64) -> [f64; 2] {
        let map = self.map(stage);
        let field = FIELD.map(|row| row.map(|s| s * size * size));
        let frequencies: Vec<[f64; 2]> = (0..24)
            .filter_map(|i| {
                // Content of the field, moved to where the map puts it.
                let (radius, angle) = (0.06 * f64::from(i / 6), TAU * f64::from(i % 6) / 6.0 + 0.2);
                map.content([
                    radius * angle.cos() / size,
                    radius * angle.sin() / size,
                ])
            })
            .collect();
        let before =
            |omega| Complex::from(etendue_theory::geometry::covariance::gaussian_spectrum(&field, omega));
        let said: Vec<Complex> = frequencies.iter().map(|w| map.spectrum(*w, &before)).collect();
        let by = |to: &dyn Fn([f64; 2]) -> [f64; 2]| transforms(&field, to, &frequencies);
        [
            apart(&said, &by(&|z| map.apply(z))),
            apart(&said, &by(&|z| self.trace(stage, z))),
        ]
    }
}

#[derive(Clone, Copy)]
struct Direction(f64, f64);

impl std::ops::Neg for Direction {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

/// sin θ T + cos θ N.
fn omega(theta: f64) -> Direction {
    Direction(theta.sin(), theta.cos())
}

/// The transforms of a Gaussian field whose rays went elsewhere, by the trapezoid rule over the rays it had.
fn transforms(
    field: &Matrix<2>,
    to: &dyn Fn([f64; 2]) -> [f64; 2],
    frequencies: &[[f64; 2]],
) -> Vec<Complex> {
    let [[a, b], [_, d]] = *field;
    let det = a * d - b * b;
    let [p, q] = [a, d].map(|s| REACH * s.sqrt() / f64::from(NODES));
    let step = 1e-3 * q;
    let mut sums = vec![Complex::new(0.0, 0.0); frequencies.len()];
    for i in -NODES..=NODES {
        for j in -NODES..=NODES {
            let (x, t) = (f64::from(i) * p, f64::from(j) * q);
            let exponent = 0.5 * (d * x * x - 2.0 * b * x * t + a * t * t) / det;
            if exponent > 40.0 {
                continue;
            }
            let slope = |dx: f64, dt: f64| {
                let (up, down) = (to([x + dx, t + dt]), to([x - dx, t - dt]));
                [0, 1].map(|r: usize| (up[r] - down[r]) / (2.0 * (dx + dt)))
            };
            let ([xx, tx], [xt, tt]) = (slope(1e-3 * p, 0.0), slope(0.0, step));
            let weight = (-exponent).exp() * (xx * tt - xt * tx).abs() * p * q;
            let z = to([x, t]);
            for (sum, w) in sums.iter_mut().zip(frequencies) {
                *sum += Complex::from_polar(weight, -TAU * (w[0] * z[0] + w[1] * z[1]));
            }
        }
    }
    sums
}

fn apart(a: &[Complex], b: &[Complex]) -> f64 {
    let off: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr()).sum();
    (off / b.iter().map(|b| b.norm_sqr()).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transform_of_a_field_that_stays() {
        let sums = transforms(&FIELD, &|z| z, &[[0.0, 0.0]]);
        let expected = TAU * (FIELD[0][0] * FIELD[1][1] - FIELD[0][1].powi(2)).sqrt();
        assert!((sums[0].re / expected - 1.0).abs() < 1e-10); // rounding of differences
    }
}
