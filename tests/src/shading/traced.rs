//! All seven steps of a reflection, compared with rays traced off a circle.

use super::brdfs::term;
use super::light::Bell;
use super::planar::{Factor, Lattice, PlanarReflection, ReflectionStep};
use super::primal::{about, wave};
use crate::orders::{self, ORDER, slope};
use crate::report::Bound::{Above, Below};
use crate::report::{Check, ReportSection, Row, worse};
use crate::rows::Line;
use crate::table1::{apart, content};
use etendue_field::Complex;
use etendue_theory::geometry::AffineMap;
use etendue_theory::shading::{PlanarLobe, cosine_squared_hat};
use std::f64::consts::TAU;

/// Relative sizes of the neighbourhood of the central ray.
const SIZES: [f64; 4] = [0.02, 0.01, 0.005, 0.0025];
/// Maximum error of an exact step. It is the error of the trapezoid rule over ± 7 standard
/// deviations.
const ROUNDING: f64 = 1e-9;
const REACH: f64 = 7.0;

/// A glossy circle.
#[derive(Clone, Copy)]
pub(super) struct Circle {
    pub(super) theta0: f64,
    pub(super) theta1: f64,
    pub(super) k: f64,
    /// Standard deviation of the lobe; `None` means a Dirac.
    pub(super) lobe: Option<f64>,
}

/// At the smallest size, the error of a chain with a fault must be at least this number times the
/// error of the correct chain.
const SEEN: f64 = 3.0;

/// A change to the theory's chain.
type ChainChange = dyn Fn(&mut PlanarReflection<'static>);

/// Returns faults that are planted one at a time. Their effect on the spectrum after the last step
/// is tested.
fn planted() -> Vec<(&'static str, Box<ChainChange>)> {
    let twice: &'static dyn Fn(f64) -> Complex = &|q| cosine_squared_hat(q).into();
    vec![
        ("no cosine", Box::new(|r| r.terms[0].before = Factor::One)),
        (
            "cosine counted twice",
            Box::new(move |r| r.terms[0].before = Factor::Other(twice)),
        ),
        ("wrong sign of k", Box::new(|r| r.curvature = -r.curvature)),
        (
            "lobe 5 % wider",
            Box::new(|r| {
                if let Some(PlanarLobe::Gaussian { deviation }) = &mut r.terms[0].lobe {
                    *deviation *= 1.05;
                }
            }),
        ),
    ]
}

/// The section.
pub(super) fn traced() -> ReportSection {
    // The deviation of a lobe is relative to the size of the neighbourhood.
    let circle = |theta0: f64, k, lobe| Circle {
        theta0,
        theta1: -theta0,
        k,
        lobe,
    };
    let cases = [
        ("convex", circle(0.0, 0.5, Some(0.6))),
        ("convex", circle(0.65, 0.5, Some(0.6))),
        ("convex, grazing", circle(1.1, 0.1, Some(0.6))),
        ("concave", circle(0.0, -0.5, Some(0.6))),
        ("concave", circle(0.65, -0.5, Some(0.6))),
        ("concave, Dirac", circle(0.65, -0.5, None)),
    ];
    let mut rows = Vec::new();
    for (name, case) in &cases {
        for step in ReflectionStep::ALL {
            let errors = SIZES.map(|size| case.error(step, size, &|_| ()));
            let logs = [0, 1, 2, 3].map(|i: usize| [SIZES[i].ln(), errors[i].ln()]);
            let fitted = slope(&logs);
            let known = case.known(step);
            let check = match known {
                Some(known) => orders::check(fitted, known),
                None => {
                    let largest = errors.into_iter().fold(0.0, worse);
                    Check::new("error", largest, Below(ROUNDING))
                        .because("error of the trapezoid rule")
                }
            };
            let cells = vec![
                format!("{step:?}").to_lowercase(),
                (*name).to_owned(),
                case.theta0.to_string(),
                case.k.to_string(),
                format!("{:.2e}", errors[0]),
                format!("{:.2e}", errors[3]),
                known.map_or("–".to_owned(), |_| format!("{fitted:.3}")),
                known.map_or("exact".to_owned(), |known| format!("{known:.0}")),
            ];
            rows.push(Row::new(cells, vec![check]).of([line(step)]));
        }
    }
    let convex = circle(0.65, 0.5, Some(0.6));
    let right = convex.error(ReflectionStep::Outgoing, SIZES[3], &|_| ());
    for (name, plant) in planted() {
        let errors = SIZES.map(|size| convex.error(ReflectionStep::Outgoing, size, &*plant));
        let reason = "the error of a correct chain falls with the size";
        let check = Check::new("seen", errors[3], Above(SEEN * right)).because(reason);
        let cells = vec![
            "outgoing".to_owned(),
            format!("convex, planted: {name}"),
            convex.theta0.to_string(),
            convex.k.to_string(),
            format!("{:.2e}", errors[0]),
            format!("{:.2e}", errors[3]),
            "–".to_owned(),
            "error remains".to_owned(),
        ];
        rows.push(Row::new(cells, vec![check]));
    }
    ReportSection::new(
        "A glossy circle, all steps, against traced rays",
        format!(
            "No photons are traced here. A Gaussian light field of width e is reflected by a \
             circle with a Gaussian lobe of width 0.6 e, and the cosine is included. At 24 \
             frequencies where the spectrum is not negligible, the spectrum after every step is \
             compared with a quadrature of rays. These rays are traced onto the circle, weighted \
             by the cosine to its normal at that point, spread by the lobe, and followed off the \
             circle. *Error* is the difference at e = 0.02 and 0.0025, and *order* is the exponent \
             with which it falls. Required: the order is within {ORDER} of 1 where light comes at \
             an angle, and of 2 where it comes along the normal. Along the normal, the first step \
             leaves nothing out, and its error is below {ROUNDING:.0e}. With a fault planted in \
             the chain, the error at e = 0.0025 is more than {SEEN} times the error of the correct \
             chain."
        ),
        "up to | surface | θ₀ | k | error, e = 0.02 | error, e = 0.0025 | order | known order | \
         verdict",
        rows,
    )
}

const fn line(step: ReflectionStep) -> Line {
    match step {
        ReflectionStep::Incidence => Line::Incidence,
        ReflectionStep::Curvature | ReflectionStep::Back => Line::Curvature,
        ReflectionStep::Cosine => Line::Cosine,
        ReflectionStep::Mirror => Line::Mirror,
        ReflectionStep::Brdf => Line::Brdf,
        ReflectionStep::Outgoing => Line::Outgoing,
    }
}

impl Circle {
    /// The known order at which the error of a step decreases with the neighbourhood's
    /// size, or `None` if the step is exact.
    fn known(&self, step: ReflectionStep) -> Option<f64> {
        match step {
            _ if self.theta0 != 0.0 => Some(1.0),
            ReflectionStep::Incidence => None,
            _ => Some(2.0),
        }
    }

    fn light(size: f64) -> Bell {
        let square = size * size;
        Bell {
            amplitude: 1.0,
            mean: [0.0; 2],
            covariance: [[square, 0.3 * square], [0.3 * square, 0.8 * square]],
        }
    }

    /// ‖chain − rays‖/‖rays‖, with a fault planted in the chain.
    fn error(&self, step: ReflectionStep, size: f64, plant: &ChainChange) -> f64 {
        let bell = Self::light(size);
        let lobe = self.lobe.map(|lobe| lobe * size);
        let planar = lobe.map(|deviation| PlanarLobe::Gaussian { deviation });
        let mut reflection = PlanarReflection {
            incidence: self.theta0,
            outgoing: self.theta1,
            curvature: self.k,
            terms: vec![term(Factor::Cosine, planar)],
            // The light's spectrum has the standard deviation 0.18/e, and shears tilt this
            // spectrum.
            lattice: Lattice::circle(2.5 / size),
        };
        plant(&mut reflection);
        let map = self.map(step);
        let frequency = |i: i32| {
            let radius = 0.06 * f64::from(i / 6) / size;
            let angle = TAU * f64::from(i % 6) / 6.0 + 0.2;
            content(&map, [radius * angle.cos(), radius * angle.sin()])
        };
        let omegas: Vec<[f64; 2]> = (0..24).filter_map(frequency).collect();
        let said: Vec<Complex> = omegas
            .iter()
            .map(|w| reflection.spectrum(step, *w, &|w| bell.spectrum(w)))
            .collect();
        let reach = [REACH * size / self.theta0.cos(), REACH * size];
        let shrunk = Self { lobe, ..*self };
        apart(&said, &shrunk.rays(step, &[bell], reach, &omegas))
    }

    /// The affine map composed of a mirror's steps, which locates the frequencies where
    /// the spectrum is not negligible.
    fn map(&self, step: ReflectionStep) -> AffineMap<2> {
        let mut map = AffineMap::identity();
        for next in ReflectionStep::ALL {
            map = map.then(&match next {
                ReflectionStep::Incidence => AffineMap::<2>::incidence(self.theta0),
                ReflectionStep::Curvature => AffineMap::<2>::curvature(self.k),
                ReflectionStep::Cosine | ReflectionStep::Brdf => AffineMap::identity(),
                ReflectionStep::Mirror => AffineMap::mirror(),
                ReflectionStep::Back => AffineMap::<2>::back(self.k),
                ReflectionStep::Outgoing => AffineMap::<2>::outgoing(self.theta1),
            });
            if next == step {
                break;
            }
        }
        map
    }

    /// The transforms of the traced field, by the trapezoid rule over positions of hits
    /// and over angles, which end at `reach`.
    pub(super) fn rays(
        &self,
        step: ReflectionStep,
        light: &[Bell],
        reach: [f64; 2],
        omegas: &[[f64; 2]],
    ) -> Vec<Complex> {
        let mut sums = vec![Complex::from(0.0); omegas.len()];
        let mut add = |[a, b]: [f64; 2], weight: f64| {
            for (sum, w) in sums.iter_mut().zip(omegas) {
                *sum += wave(w[0] * a + w[1] * b) * weight;
            }
        };
        let deviation = match step {
            ReflectionStep::Brdf | ReflectionStep::Back | ReflectionStep::Outgoing => self.lobe,
            _ => None,
        };
        for (s, ds) in about(0.0, reach[0], 26) {
            // In the first step, s is a position on the tangent; in all later steps, s is a
            // position on the arc.
            let turn = if step == ReflectionStep::Incidence {
                0.0
            } else {
                self.k * s
            };
            let point = match step {
                ReflectionStep::Incidence => [s, 0.0],
                _ => [turn.sin() / self.k, (turn.cos() - 1.0) / self.k],
            };
            for (theta, dt) in about(0.0, reach[1], 26) {
                // This is the radiance of the light through the hit point along the direction −ω(θ₀
                // + θ). It is computed in the light's frame.
                let at = [-self.across(self.theta0, point, theta), theta];
                let radiance: f64 = light.iter().map(|bell| bell.value(at)).sum();
                let incident = self.theta0 + theta - turn;
                let weight = radiance * ds * dt;
                match step {
                    ReflectionStep::Incidence | ReflectionStep::Curvature => {
                        add([s, incident], weight);
                    }
                    ReflectionStep::Cosine => add([s, incident], weight * incident.cos()),
                    ReflectionStep::Mirror => add([s, -incident], weight * incident.cos()),
                    _ => {
                        let weight = weight * incident.cos();
                        let Some(lobe) = deviation else {
                            let (at, scale) = self.leaves(step, s, -incident);
                            add(at, weight * scale);
                            continue;
                        };
                        for (z, dz) in about(0.0, REACH, 14) {
                            let local = lobe * z - incident;
                            let share = (-0.5 * z * z).exp() / TAU.sqrt() * dz;
                            let (at, scale) = self.leaves(step, s, local);
                            add(at, weight * share * scale);
                        }
                    }
                }
            }
        }
        sums
    }

    /// The coordinates of light that leaves at arc length s in a local direction, and the
    /// ratio of their area element to ds dθ.
    fn leaves(&self, step: ReflectionStep, s: f64, local: f64) -> ([f64; 2], f64) {
        let turn = self.k * s;
        match step {
            ReflectionStep::Brdf => ([s, local], 1.0),
            ReflectionStep::Back => ([s, local + turn], 1.0),
            _ => {
                let theta = local + turn - self.theta1;
                let point = [turn.sin() / self.k, (turn.cos() - 1.0) / self.k];
                let x = self.across(self.theta1, point, theta);
                // The second value is the ratio of dx dθ to ds dθ.
                ([x, theta], local.cos() / theta.cos())
            }
        }
    }

    /// The position at which a line crosses the axis X = cos T − sin N through the origin.
    /// The line runs through the given point, at the angle θ to the central direction, which is
    /// perpendicular to X.
    fn across(&self, central: f64, [t, n]: [f64; 2], theta: f64) -> f64 {
        let (sine, cosine) = central.sin_cos();
        t * cosine - n * sine - (t * sine + n * cosine) * theta.tan()
    }
}
