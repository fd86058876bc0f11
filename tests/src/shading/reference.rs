//! Checks of reflection step by step, and of environments, against the numbers in the theory's
//! `tests/reference.json`, which are computed with mpmath at 25 digits.

#![expect(
    clippy::print_stdout,
    reason = "the deviations of blocks and of planted faults are printed for the reader"
)]

use super::brdfs::term;
use super::light::Bell;
use super::planar::environment::{Glow, mirrored_differential_irradiance};
use super::planar::{Factor, Lattice, PlanarReflection, ReflectionStep, Schlick};
use super::traced::Circle;
use etendue_field::Complex;
use etendue_theory::shading::environment::irradiance;
use etendue_theory::shading::{PlanarLobe, cosine_squared_hat};
use serde_json::Value;

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
    let text = include_str!("../../../crates/theory/tests/reference.json");
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

/// The largest deviation relative to the largest expected value; requires at least `count`
/// samples.
fn deviation(count: usize, pairs: impl IntoIterator<Item = (Complex, Complex)>) -> f64 {
    let pairs: Vec<_> = pairs.into_iter().collect();
    assert!(pairs.len() >= count);
    let largest = pairs.iter().map(|(_, e)| e.norm()).fold(0.0, f64::max);
    let worst = pairs.iter().map(|(got, e)| (got - e).norm());
    worst.fold(0.0, f64::max) / largest
}

/// The parameters of the block `reflection_chain`, and the light of this block.
struct ReferenceReflection {
    block: Value,
    light: Vec<Bell>,
}

impl ReferenceReflection {
    fn new() -> Self {
        let block = block("reflection_chain");
        let input = &block["input"];
        let pair = |value: &Value| [number(&value[0]), number(&value[1])];
        let bells = (0..samples(&input["A"]).len()).map(|i| Bell {
            amplitude: number(&input["A"][i]),
            mean: pair(&input["mu"][i]),
            covariance: [pair(&input["C"][i][0]), pair(&input["C"][i][1])],
        });
        let light = bells.collect();
        Self { block, light }
    }

    fn parameter(&self, name: &str) -> f64 {
        number(&self.block["params"][name])
    }

    /// The reflection with a given factor of the incident direction and a given lobe.
    fn chain<'a>(&self, before: Factor<'a>, lobe: Option<f64>) -> PlanarReflection<'a> {
        let lobe = lobe.map(|deviation| PlanarLobe::Gaussian { deviation });
        PlanarReflection {
            incidence: self.parameter("th0"),
            outgoing: self.parameter("th1"),
            curvature: self.parameter("k"),
            terms: vec![term(before, lobe)],
            // A field that is 0.04 rad wide has frequencies up to ± 30, shifted by the correlation
            // of positions and angles.
            lattice: Lattice::circle(60.0),
        }
    }

    /// The spectrum after a step of a chain.
    fn spectrum(
        &self,
        chain: &PlanarReflection<'_>,
        step: ReflectionStep,
        omega: [f64; 2],
    ) -> Complex {
        let light = |w: [f64; 2]| self.light.iter().map(|bell| bell.spectrum(w)).sum();
        chain.spectrum(step, omega, &light)
    }
}

fn frequency(sample: &Value) -> [f64; 2] {
    ["ox", "oth"].map(|name| number(&sample[name]))
}

#[test]
fn every_step_of_a_reflection() {
    let of = ReferenceReflection::new();
    let off = |chain: &PlanarReflection<'_>, step: ReflectionStep, name: &str| {
        let pairs = samples(&of.block["samples"]).iter().map(|sample| {
            let found = of.spectrum(chain, step, frequency(sample));
            (found, complex(&sample[name]))
        });
        deviation(5, pairs)
    };
    let lobe = of.parameter("lobe");
    let gloss = of.chain(Factor::Cosine, Some(lobe));
    for (i, step) in ReflectionStep::ALL.into_iter().enumerate() {
        let name = format!("step{}", i + 1);
        assert_near(&format!("{step:?}"), off(&gloss, step, &name));
    }
    let last = |chain: &PlanarReflection<'_>| off(chain, ReflectionStep::Outgoing, "step7");
    let mirror =
        |chain: &PlanarReflection<'_>| off(chain, ReflectionStep::Outgoing, "step7_mirror_brdf");
    // The BRDF of this mirror is a Dirac that is not divided by the cosine, so the reflected light
    // keeps the factor of the cosine.
    assert_near("Outgoing, mirror", mirror(&of.chain(Factor::Cosine, None)));
    assert_seen(
        "an ideal mirror in place of the Dirac",
        mirror(&of.chain(Factor::One, None)),
    );
    let squared = |q| Complex::from(cosine_squared_hat(q));
    let hollow = PlanarReflection {
        curvature: -gloss.curvature,
        ..gloss.clone()
    };
    for (fault, chain) in [
        ("no cosine", of.chain(Factor::One, Some(lobe))),
        (
            "the cosine twice",
            of.chain(Factor::Other(&squared), Some(lobe)),
        ),
        ("the sign of the curvature", hollow),
        (
            "a lobe 5 % wider",
            of.chain(Factor::Cosine, Some(1.05 * lobe)),
        ),
    ] {
        assert_seen(fault, last(&chain));
    }
}

#[test]
fn rays_off_the_circle() {
    let of = ReferenceReflection::new();
    let lobe = of.parameter("lobe");
    for (name, lobe) in [("step7", Some(lobe)), ("step7_mirror_brdf", None)] {
        let expected = samples(&of.block["exact_geometry_double_quadrature"][name]);
        let omegas: Vec<[f64; 2]> = expected.iter().map(frequency).collect();
        let off = |found: Vec<Complex>| {
            let expected = expected.iter().map(complex);
            deviation(5, found.into_iter().zip(expected))
        };
        let circle = Circle {
            theta0: of.parameter("th0"),
            theta1: of.parameter("th1"),
            k: of.parameter("k"),
            lobe,
        };
        // The light's positions on the surface have a standard deviation of 0.07, and its angles
        // one of 0.05.
        let traced = circle.rays(ReflectionStep::Outgoing, &of.light, [0.55, 0.45], &omegas);
        let traced = off(traced);
        // Both values are from quadratures; the value in the file is accurate to 1e-6.
        assert!(traced < 1e-6, "{name}: {traced:e}");
        println!("{name}, traced: {traced:.1e} of the largest value");
        // The chain holds to first order. At this size of the neighbourhood, the chain has a
        // detectable error of a few per cent.
        let chain = of.chain(Factor::Cosine, lobe);
        let last = |omega: &[f64; 2]| of.spectrum(&chain, ReflectionStep::Outgoing, *omega);
        let linear = off(omegas.iter().map(last).collect());
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
        let pairs = samples(&block["samples"])
            .iter()
            .map(|sample| (value(frequency(sample)), complex(sample)));
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

#[test]
fn schlick_and_cosine() {
    let block = block("fresnel_cos_hat");
    let schlick = &block["schlick"];
    let f0 = number(&schlick["F0"]);
    let off = |f0: f64| {
        let pairs = samples(&schlick["samples"]).iter().map(|sample| {
            let found = Schlick(f0).cosine_hat(number(&sample["omega"]));
            (found.into(), number(&sample["value"]).into())
        });
        deviation(15, pairs)
    };
    assert_near("Schlick · cos⁺", off(f0));
    assert_seen("F₀ with an error of 5 %", off(1.05 * f0));
}
