//! The image that an eye sees in a glossy circle, computed by tracing rays back from the eye.

use crate::table1::on_circle;
use etendue_theory::shading::Criterion;
use glam::DVec2;
use std::f64::consts::TAU;

/// Step of finite differences, in slope or radians; the error of the derivative is of fourth
/// order in this step.
const STEP: f64 = 1e-3;

/// A glossy circle with an eye and a blocker, whose rays are traced without approximation.
pub(super) struct EyeScene {
    pub(super) criterion: Criterion,
}

/// The hit of an eye ray on the circle: the arc length of the hit, and the outgoing angle to the
/// local normal.
struct EyeHit {
    turn: f64,
    point: [f64; 2],
    local: f64,
}

impl EyeScene {
    /// The point at which the circle is hit by the ray that reaches the eye with this
    /// slope.
    fn hit(&self, slope: f64) -> EyeHit {
        let c = &self.criterion;
        let (sine, cosine) = c.outgoing.sin_cos();
        // The axis X = cos T − sin N is perpendicular to the central ray, which is along D = sin T
        // + cos N.
        let angle = slope.atan() + c.outgoing;
        let along = DVec2::new(angle.sin(), angle.cos());
        let back = -slope * c.distance;
        let start = DVec2::new(back * cosine, -back * sine);
        let point = on_circle(c.curvature, start, along);
        let turn = (c.curvature * point.x).asin();
        EyeHit {
            turn,
            point: point.to_array(),
            local: angle - turn,
        }
    }

    /// The angle of the light that a mirror would send into an eye ray, and the point
    /// where this light crosses the plane of the blocker.
    fn origin(&self, slope: f64) -> [f64; 2] {
        let hit = self.hit(slope);
        self.from(&hit, self.aside() - hit.local)
    }

    /// The angle from the mirror direction to the outgoing central ray; this angle does
    /// not depend on the lobe.
    fn aside(&self) -> f64 {
        self.criterion.incidence + self.criterion.outgoing
    }

    fn from(&self, hit: &EyeHit, incident: f64) -> [f64; 2] {
        let angle = incident + hit.turn;
        let (sine, cosine) = self.criterion.incidence.sin_cos();
        let [t, n] = hit.point;
        let across = t * cosine - n * sine;
        let along = t * sine + n * cosine;
        let distance = self.criterion.blocker_distance.unwrap_or(1.0);
        let tangent = (angle - self.criterion.incidence).tan();
        [angle, across + (distance - along) * tangent]
    }

    /// Three bandwidths at the eye, which are B, B' and a maximum bandwidth. For the
    /// maximum, the environment has frequencies up to Ω_e, and the blocker has all frequencies that
    /// keep the summed frequency on the surface below Ω_ρ.
    pub(super) fn traced(&self) -> [f64; 3] {
        let c = &self.criterion;
        let seen = derivative(&|slope| self.origin(slope));
        let center = self.hit(0.0);
        let there = derivative(&|angle| self.from(&center, angle + self.aside() - center.local));
        // The derivatives of the phase with respect to the slope at the eye, relative to those
        // with respect to the local angle of mirrored light at a fixed point.
        let [environment, blocker] = [0, 1].map(|i: usize| (seen[i] / there[i]).abs());
        // For a frequency g in the environment, f is the frequency at the blocker with which the
        // summed frequency on the surface equals its limit.
        let mut most = 0.0_f64;
        for (limit, g) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let g = g * c.environment_cutoff;
            let f = (limit * c.lobe_cutoff - g * there[0]) / there[1];
            most = most.max((f * seen[1] + g * seen[0]).abs());
        }
        [c.lobe_cutoff * environment, c.lobe_cutoff * blocker, most]
    }

    /// The frequency below which 99 % of the energy of an image lies, divided by the
    /// predicted frequency. The Gaussian lobe is so narrow that angles are linear functions of the
    /// position within its image. The image shows a distant point. If `edge` is set, the derivative
    /// of the image of an edge is used instead.
    pub(super) fn image(&self, edge: bool, said: f64) -> f64 {
        const DEVIATION: f64 = 1e-4;
        const COUNT: i32 = 240;
        // Ω_ρ = 2.5758/(2√2 πσ).
        let cutoff = 2.575_829_303_5 * 2.0_f64.sqrt() / (2.0 * TAU * DEVIATION);
        let said = said / self.criterion.lobe_cutoff * cutoff;
        let width = DEVIATION * cutoff / said;
        let value = |slope: f64| {
            let hit = self.hit(slope);
            let incident = if edge {
                let distance = self.criterion.blocker_distance.unwrap_or(1.0);
                let (sine, cosine) = self.criterion.incidence.sin_cos();
                let to = [
                    distance * sine - hit.point[0],
                    distance * cosine - hit.point[1],
                ];
                to[0].atan2(to[1]) - hit.turn
            } else {
                self.criterion.incidence - hit.turn
            };
            let z = (hit.local + incident - self.aside()) / DEVIATION;
            (-0.5 * z * z).exp()
        };
        let nodes = super::primal::about(0.0, 9.0 * width, COUNT);
        let image: Vec<(f64, f64, f64)> = nodes.map(|(v, w)| (v, w, value(v))).collect();
        let total: f64 = image.iter().map(|(_, w, i)| i * i * w).sum();
        let power = |omega: f64| -> f64 {
            let waves = image.iter();
            let sum: etendue_field::Complex = waves
                .map(|(v, w, i)| super::primal::wave(omega * v) * (w * i))
                .sum();
            sum.norm_sqr()
        };
        let step = said / 400.0;
        let (mut sum, mut omega, mut last) = (0.0, 0.0, power(0.0));
        while omega < 3.0 * said {
            let next = power(omega + step);
            let more = (last + next) * step;
            if sum + more > 0.99 * total {
                return (omega + step * (0.99 * total - sum) / more) / said;
            }
            sum += more;
            omega += step;
            last = next;
        }
        f64::INFINITY
    }
}

/// The derivative by central differences, extrapolated.
fn derivative(f: &dyn Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let slope = |h: f64, i: usize| (f(h)[i] - f(-h)[i]) / (2.0 * h);
    [0, 1].map(|i| (4.0 * slope(0.5 * STEP, i) - slope(STEP, i)) / 3.0)
}
