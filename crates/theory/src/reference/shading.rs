//! Checks of cosines, lobes, Fresnel factors and bandwidths.

#![expect(
    clippy::print_stdout,
    reason = "the deviations of blocks and of planted faults are printed for the reader"
)]

use super::*;
use crate::shading::{
    Criterion, PlanarLobe, cosine_hat, cosine_squared_hat, fresnel_cosine_hat, fresnel_reflectance,
};
use etendue_field::Fresnel;
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

/// The largest deviation of a real function of Ω from the samples of a block.
fn curve(block: &Value, count: usize, f: impl Fn(f64) -> f64) -> f64 {
    let pairs = samples(&block["samples"]).iter().map(|sample| {
        let got = f(number(&sample["omega"]));
        (got.into(), number(&sample["value"]).into())
    });
    deviation(count, pairs)
}

#[test]
fn cosines() {
    let clamped = block("cosplus_hat");
    assert_near("cos⁺", curve(&clamped, 20, cosine_hat));
    let series = curve(&clamped, 20, |omega| cosine_hat(omega) / TAU);
    assert_seen("the series in place of the transform", series);
    let latitude = block("cos2_latitude_hat");
    assert_near("cos²", curve(&latitude, 10, cosine_squared_hat));
    assert_seen("cos for cos²", curve(&latitude, 10, cosine_hat));
}

#[test]
fn phong_lobes() {
    let block = block("phong2d_hat");
    let off = |scale: f64| {
        let pairs = samples(&block["samples"]).iter().map(|sample| {
            let exponent = scale * number(&sample["n"]);
            let got = PlanarLobe::Phong { exponent }.spectrum(number(&sample["omega"]));
            (got.into(), number(&sample["value"]).into())
        });
        deviation(8, pairs)
    };
    assert_near("Phong", off(1.0));
    assert_seen("an exponent with an error of 5 %", off(1.05));
}

#[test]
fn fresnel_and_cosine() {
    let block = block("fresnel_cos_hat");
    for material in samples(&block["materials"]) {
        let p = |name: &str| number(&material[name]);
        let (index, extinction) = (p("n"), p("k"));
        let fresnel = if extinction > 0.0 {
            Fresnel::Conductor {
                n: index,
                k: extinction,
            }
        } else {
            Fresnel::Dielectric { index }
        };
        let pairs = samples(&material["reflectance"]).iter().map(|sample| {
            let got = fresnel_reflectance(fresnel, number(&sample["theta"]));
            (got.into(), number(&sample["value"]).into())
        });
        assert_near("reflectance", deviation(5, pairs));
        let hat = |omega| fresnel_cosine_hat(fresnel, omega);
        assert_near("Fresnel · cos⁺", curve(material, 15, hat));
        // The planted fault uses one polarisation instead of the mean of both.
        let square = Complex::new(index, extinction) * Complex::new(index, extinction);
        let across = |omega: f64| {
            let kernel = |theta: f64| {
                let (sine, cosine) = libm::sincos(theta);
                let beyond = (square - sine * sine).sqrt();
                let share = ((cosine - beyond) / (cosine + beyond)).norm_sqr();
                2.0 * share * cosine * libm::cos(TAU * omega * theta)
            };
            crate::quadrature::integrate(200, [0.0, 0.5 * PI], kernel)
        };
        assert_seen("one polarisation", curve(material, 15, across));
        let twice = |omega| fresnel_cosine_hat(fresnel, omega) * fresnel_reflectance(fresnel, 0.0);
        assert_seen("the factor twice", curve(material, 15, twice));
    }
}

#[test]
fn bandwidths() {
    let block = block("bandwidth");
    let off = |name: &str, value: &dyn Fn(&Criterion) -> f64| {
        let pairs = samples(&block["rows"]).iter().map(|row| {
            let p = |name: &str| number(&row[name]);
            let criterion = Criterion {
                curvature: p("k"),
                incidence: p("th0"),
                outgoing: -p("th0"),
                distance: p("d"),
                blocker_distance: Some(p("dp")),
                lobe_cutoff: p("Or"),
                environment_cutoff: p("Oe"),
            };
            (value(&criterion).into(), number(&row[name]).into())
        });
        deviation(4, pairs)
    };
    assert_near("B", off("B_env", &Criterion::environment));
    assert_near("B'", off("B_blocker_line", &Criterion::blocker));
    let combined = "B_blocker_with_env_bandwidth_Oe";
    assert_near("B''", off(combined, &Criterion::combined));
    let printed = "B_env_printed_eq20";
    assert_near("Eq. 20", off(printed, &Criterion::printed_environment));
    let printed = "B_blocker_printed_eq21";
    assert_near("Eq. 21", off(printed, &Criterion::printed_blocker));
    assert_seen(
        "Eq. 20 in place of B",
        off("B_env", &Criterion::printed_environment),
    );
    assert_seen(
        "Eq. 21 in place of B'",
        off("B_blocker_line", &Criterion::printed_blocker),
    );
    let unsigned = |c: &Criterion| {
        Criterion {
            curvature: c.curvature.abs(),
            ..*c
        }
        .environment()
    };
    assert_seen("|k| for k", off("B_env", &unsigned));
    assert_seen("B' for B''", off(combined, &Criterion::blocker));
}
