//! Checks of reflection step by step, and of environments, against the numbers in the theory's
//! `tests/reference.json`, which are computed with mpmath at 25 digits.

#![expect(
    clippy::print_stdout,
    reason = "the deviations of blocks and of planted faults are printed for the reader"
)]

use super::environment::{Glow, mirrored_differential_irradiance};
use super::{Factor, Lattice, PlanarReflection, ReflectionStep, Schlick, SeparableTerm};
use etendue_field::Complex;
use etendue_theory::shading::environment::irradiance;
use etendue_theory::shading::{PlanarLobe, cosine_squared_hat};
use serde_json::Value;
use std::f64::consts::{PI, TAU};

/// Values must agree to this tolerance, relative to the largest value of a block. The expected
/// values are closed forms, or quadratures accurate to 10⁻¹².
const NEAR: f64 = 1e-9;
/// The minimum error that a planted fault must cause; the actual errors are much larger.
const FAULT: f64 = 1e-3;

fn assert_near(what: &str, off: f64) {
    assert!(off < NEAR, "{what}: {off:e}");
    println!("{what}: {off:.1e} of the largest value");
}

fn assert_seen(what: &str, off: f64) {
    assert!(off > FAULT, "{what} is not detected: {off:e}");
    println!("  {what}: {off:.2e}");
}

fn block(name: &str) -> Value {
    let text = include_str!("../../../../crates/theory/tests/reference.json");
    let mut file: Value = serde_json::from_str(text).expect("the file is valid");
    file[name].take()
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn complex(value: &Value) -> Complex {
    Complex::new(number(&value["re"]), number(&value["im"]))
}

fn samples(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

/// Returns the largest deviation relative to the largest expected value; requires at least `count`
/// samples.
fn deviation(count: usize, pairs: impl IntoIterator<Item = (Complex, Complex)>) -> f64 {
    let pairs: Vec<_> = pairs.into_iter().collect();
    assert!(pairs.len() >= count);
    let largest = pairs.iter().map(|(_, e)| e.norm()).fold(0.0, f64::max);
    let worst = pairs.iter().map(|(got, e)| (got - e).norm());
    worst.fold(0.0, f64::max) / largest
}

/// A Gaussian component of a light field, A exp(−½ (z − μ)ᵀ C⁻¹ (z − μ)).
struct GaussianField {
    amplitude: f64,
    mean: [f64; 2],
    covariance: [[f64; 2]; 2],
}

impl GaussianField {
    fn all(input: &Value) -> Vec<Self> {
        let of = |name: &str, i: usize| input[name][i].clone();
        let pair = |value: &Value| [number(&value[0]), number(&value[1])];
        let count = samples(&input["A"]).len();
        let bells = (0..count).map(|i| Self {
            amplitude: number(&of("A", i)),
            mean: pair(&of("mu", i)),
            covariance: [pair(&of("C", i)[0]), pair(&of("C", i)[1])],
        });
        bells.collect()
    }

    fn det(&self) -> f64 {
        let [[a, b], [_, d]] = self.covariance;
        a * d - b * b
    }

    fn value(&self, [x, t]: [f64; 2]) -> f64 {
        let [[a, b], [_, d]] = self.covariance;
        let (x, t) = (x - self.mean[0], t - self.mean[1]);
        let form = (d * x * x - 2.0 * b * x * t + a * t * t) / self.det();
        self.amplitude * libm::exp(-0.5 * form)
    }

    fn spectrum(&self, [x, t]: [f64; 2]) -> Complex {
        let [[a, b], [_, d]] = self.covariance;
        let form = a * x * x + 2.0 * b * x * t + d * t * t;
        let size = self.amplitude * TAU * self.det().sqrt() * libm::exp(-2.0 * PI * PI * form);
        Complex::from_polar(size, -TAU * (x * self.mean[0] + t * self.mean[1]))
    }
}

/// Returns the block's reflection with a given factor of the incident direction and a given lobe.
fn reflection<'a>(
    parameters: &Value,
    before: Factor<'a>,
    lobe: Option<PlanarLobe>,
) -> PlanarReflection<'a> {
    let p = |name: &str| number(&parameters[name]);
    PlanarReflection {
        incidence: p("th0"),
        outgoing: p("th1"),
        curvature: p("k"),
        terms: vec![SeparableTerm {
            before,
            lobe,
            after: Factor::One,
            weight: None,
        }],
        // A field that is 0.04 rad wide has frequencies up to ± 30, shifted by the correlation of
        // positions and angles.
        lattice: Lattice::circle(60.0),
    }
}

#[test]
fn every_step_of_a_reflection() {
    let block = block("reflection_chain");
    let parameters = &block["params"];
    let bells = GaussianField::all(&block["input"]);
    let light = |omega: [f64; 2]| -> Complex { bells.iter().map(|b| b.spectrum(omega)).sum() };
    let lobe = PlanarLobe::Gaussian {
        deviation: number(&parameters["lobe"]),
    };
    let off = |chain: &PlanarReflection<'_>, step: ReflectionStep, name: &str| {
        let pairs = samples(&block["samples"]).iter().map(|sample| {
            let omega = ["ox", "oth"].map(|name| number(&sample[name]));
            (chain.spectrum(step, omega, &light), complex(&sample[name]))
        });
        deviation(5, pairs)
    };
    let gloss = reflection(parameters, Factor::Cosine, Some(lobe));
    for (i, step) in ReflectionStep::ALL.into_iter().enumerate() {
        let name = format!("step{}", i + 1);
        assert_near(&format!("{step:?}"), off(&gloss, step, &name));
    }
    // The BRDF of this mirror is a Dirac that is not divided by the cosine, so the reflected light
    // keeps the factor of the cosine.
    let dirac = reflection(parameters, Factor::Cosine, None);
    let mirror =
        |chain: &PlanarReflection<'_>| off(chain, ReflectionStep::Outgoing, "step7_mirror_brdf");
    assert_near("Outgoing, mirror", mirror(&dirac));
    let last = |chain: &PlanarReflection<'_>| off(chain, ReflectionStep::Outgoing, "step7");
    let without = reflection(parameters, Factor::One, Some(lobe));
    assert_seen("no cosine", last(&without));
    let squared = |q| Complex::from(cosine_squared_hat(q));
    let twice = reflection(parameters, Factor::Other(&squared), Some(lobe));
    assert_seen("the cosine twice", last(&twice));
    let ideal = reflection(parameters, Factor::One, None);
    assert_seen("an ideal mirror in place of the Dirac", mirror(&ideal));
    let hollow = PlanarReflection {
        curvature: -gloss.curvature,
        ..gloss.clone()
    };
    assert_seen("the sign of the curvature", last(&hollow));
    let wider = PlanarLobe::Gaussian {
        deviation: 1.05 * number(&parameters["lobe"]),
    };
    let wider = reflection(parameters, Factor::Cosine, Some(wider));
    assert_seen("a lobe 5 % wider", last(&wider));
}

/// Returns the coordinates (x, θ) of a ray that leaves the circle at arc length s with the local
/// direction θ, and ∂x/∂s at a fixed direction. The coordinates are in the frame of the central ray
/// at the angle `central`.
///
/// The frame is the frame of light after the reflection, with X = cos T − sin N. For light before
/// the reflection, the caller reverses rays and X.
fn seen(k: f64, central: f64, s: f64, local: f64) -> ([f64; 2], f64) {
    let turn = k * s;
    let point = [libm::sin(turn) / k, (libm::cos(turn) - 1.0) / k];
    let angle = local + turn - central;
    let (sine, cosine) = libm::sincos(central);
    let across = point[0] * cosine - point[1] * sine;
    let along = point[0] * sine + point[1] * cosine;
    (
        [across - along * libm::tan(angle), angle],
        libm::cos(local) / libm::cos(angle),
    )
}

/// Computes step 7 with rays that leave the exact circle. The integrals over arc length, local
/// incident angle and local outgoing angle are computed by the trapezoid rule.
fn traced(
    parameters: &Value,
    bells: &[GaussianField],
    lobe: Option<f64>,
    omega: [f64; 2],
) -> Complex {
    let p = |name: &str| number(&parameters[name]);
    let (k, theta0, theta1) = (p("k"), p("th0"), p("th1"));
    let lattice = |middle: f64, reach: f64, count: i32| {
        let step = reach / f64::from(count);
        (-count..=count).map(move |i| (middle + f64::from(i) * step, step))
    };
    let wave = |s: f64, outgoing: f64| {
        let ([x, theta], scale) = seen(k, theta1, s, outgoing);
        Complex::from_polar(scale, -TAU * (omega[0] * x + omega[1] * theta))
    };
    let mut sum = Complex::from(0.0);
    // The bound 0.55 is eight standard deviations of the light's positions on the surface.
    for (s, ds) in lattice(0.0, 0.55, 60) {
        // The light's angles have a standard deviation of 0.05, and are relative to the normal at
        // s.
        for (incident, di) in lattice(theta0 - k * s, 0.45, 60) {
            let ([x, theta], _) = seen(k, theta0, s, incident);
            let light: f64 = bells.iter().map(|bell| bell.value([-x, theta])).sum();
            let share = light * libm::cos(incident) * ds * di;
            if share < 1e-20 {
                continue;
            }
            let Some(deviation) = lobe else {
                sum += wave(s, -incident) * share;
                continue;
            };
            // The sum over the Gaussian lobe is a trapezoid rule with steps of 0.4 standard
            // deviations, which is accurate up to rounding errors.
            for (z, dz) in lattice(0.0, 8.0, 20) {
                let density = libm::exp(-0.5 * z * z) / TAU.sqrt() * dz;
                sum += wave(s, deviation * z - incident) * (share * density);
            }
        }
    }
    sum
}

#[test]
fn rays_off_the_circle() {
    let block = block("reflection_chain");
    let parameters = &block["params"];
    let bells = GaussianField::all(&block["input"]);
    let lobe = number(&parameters["lobe"]);
    for (name, lobe) in [("step7", Some(lobe)), ("step7_mirror_brdf", None)] {
        let expected = samples(&block["exact_geometry_double_quadrature"][name]);
        let off = |bells: &[GaussianField]| {
            let pairs = expected.iter().map(|sample| {
                let omega = ["ox", "oth"].map(|name| number(&sample[name]));
                (traced(parameters, bells, lobe, omega), complex(sample))
            });
            deviation(5, pairs)
        };
        let off = off(&bells);
        // Both values are from quadratures; the value in the file is accurate to 1e-6.
        assert!(off < 1e-6, "{name}: {off:e}");
        println!("{name}, traced: {off:.1e} of the largest value");
        // The chain holds to first order. At this size of the neighbourhood, the chain has a
        // detectable error of a few per cent.
        let light = |w: [f64; 2]| -> Complex { bells.iter().map(|b| b.spectrum(w)).sum() };
        let lobe = lobe.map(|deviation| PlanarLobe::Gaussian { deviation });
        let chain = reflection(parameters, Factor::Cosine, lobe);
        let pairs = expected.iter().map(|sample| {
            let omega = ["ox", "oth"].map(|name| number(&sample[name]));
            (
                chain.spectrum(ReflectionStep::Outgoing, omega, &light),
                complex(sample),
            )
        });
        let linear = deviation(5, pairs);
        assert!(linear < 0.1, "{linear}");
        assert_seen("the first order", linear);
    }
}

#[test]
fn environment_maps() {
    let block = block("environment_map");
    let parameters = &block["params"];
    let k = number(&parameters["k"]);
    let [amplitudes, means, deviations] =
        ["amps", "mus", "sigs"].map(|name| samples(&parameters[name]));
    let glows: Vec<Glow> = (0..amplitudes.len())
        .map(|i| Glow {
            amplitude: number(&amplitudes[i]),
            mean: number(&means[i]),
            deviation: number(&deviations[i]),
        })
        .collect();
    let hat = |omega: f64| -> Complex { glows.iter().map(|glow| glow.spectrum(omega)).sum() };
    let off = |value: &dyn Fn([f64; 2]) -> Complex| {
        let pairs = samples(&block["samples"]).iter().map(|sample| {
            let omega = ["ox", "oth"].map(|name| number(&sample[name]));
            (value(omega), complex(sample))
        });
        deviation(6, pairs)
    };
    let right = |omega| mirrored_differential_irradiance(k, omega, &hat);
    assert_near("dE'_r", off(&right));
    assert_seen("1/|k| left out", off(&|omega| right(omega) * k));
    assert_seen("the sign of Ωθ", off(&|[x, t]| right([x, -t])));
    assert_seen(
        "the sign of k",
        off(&|w| mirrored_differential_irradiance(-k, w, &hat)),
    );
    assert_seen("the cosine left out", off(&|[x, _]| hat(x / k) / k));
    let diffuse = samples(&block["samples"]).iter();
    let diffuse = diffuse.filter(|sample| number(&sample["oth"]) == 0.0);
    let pairs = diffuse.map(|sample| (irradiance(k, number(&sample["ox"]), &hat), complex(sample)));
    assert_near("irradiance", deviation(4, pairs));
}

/// Returns the largest deviation of a real function of Ω from the samples of a block.
fn curve(block: &Value, count: usize, f: impl Fn(f64) -> f64) -> f64 {
    let pairs = samples(&block["samples"]).iter().map(|sample| {
        let got = f(number(&sample["omega"]));
        (got.into(), number(&sample["value"]).into())
    });
    deviation(count, pairs)
}

#[test]
fn schlick_and_cosine() {
    let block = block("fresnel_cos_hat");
    let schlick = &block["schlick"];
    let hat = |f0| move |omega| Schlick(f0).cosine_hat(omega);
    let f0 = number(&schlick["F0"]);
    assert_near("Schlick · cos⁺", curve(schlick, 15, hat(f0)));
    assert_seen(
        "F₀ with an error of 5 %",
        curve(schlick, 15, hat(1.05 * f0)),
    );
}
