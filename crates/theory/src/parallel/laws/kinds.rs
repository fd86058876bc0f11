//! Tests of every kind of light, mask and factor against sums over quasi-random rays, and tests
//! that deliberately wrong formulas are detected.

use super::{FREQUENCIES, brute_force, hann, zero};
use crate::parallel::disc_resolution::DiscResolution;
use crate::parallel::expansion::Expansion;
use crate::parallel::slope::Slope;
use crate::reference::gaussian::{GaussianWindow, disc_light, point_light};
use crate::testing::*;
use crate::{Chain, Model, Operator, Parameter, at};
use etendue_field::{Complex, Light, Mask, Profile, Shape, Window};

const POINT: Light = Light::Point { intensity: 1.3 };
const RAYS: u32 = 200_000;

fn light() -> Light {
    lambertian(square([0.05, -0.02], 0.3))
}

/// Builds a chain of a light, a mask 1 m from the light, and a plane 0.8 m behind the mask.
fn bench(light: Light, mask: Option<Mask>) -> Chain {
    chain_of(light, [(1.0, mask), (0.8, None)])
}

fn with_cosine(mut chain: Chain) -> Chain {
    chain.operators.push(cosine());
    chain
}

/// The largest difference between `value` and the sum over quasi-random rays, divided by
/// the chain's spectrum at zero frequency without masks.
fn error(chain: &Chain, value: impl Fn([f64; 4]) -> Complex) -> f64 {
    let truth = brute_force(chain, &hann(), &FREQUENCIES, RAYS);
    let pairs = FREQUENCIES.iter().zip(truth);
    let errors = pairs.map(|(k, truth)| (value(*k) - truth).norm());
    let mut open = chain.clone();
    let is_mask = |operator: &Operator| matches!(operator, Operator::Visibility { .. });
    open.operators.retain(|operator| !is_mask(operator));
    errors.fold(0.0, f64::max) / zero(&open)
}

fn assert_agrees(name: &str, chain: &Chain) {
    let error = error(chain, |k| at(chain, &hann(), k));
    // For shapes with edges, the error of a sum over 200000 quasi-random points is below 1/√200000
    // = 2.2e-3.
    assert!(error < 1e-3, "{name}: {error:e}");
}

fn some_discs() -> Mask {
    let discs = blockers(3, 0.2, 0.16).into_iter();
    opaque(discs.map(|b| disc(b.center, 0.5 * b.size[0])).collect())
}

#[test]
fn lights_agree_with_brute_force() {
    let square = Shape::Rectangle(square([0.0, 0.1], 0.4));
    let round = disc([0.05, -0.1], 0.25);
    assert_agrees("disc", &bench(spot(round, 0.0), None));
    assert_agrees("spot", &bench(spot(square, 20.0), None));
    assert_agrees("round spot", &bench(spot(round, 20.0), None));
    assert_agrees("point", &bench(POINT, None));
    let blockers = Some(rectangles(&blockers(4, 0.2, 0.1)));
    assert_agrees(
        "disc and blockers",
        &bench(spot(round, 0.0), blockers.clone()),
    );
    assert_agrees("point and blockers", &bench(POINT, blockers));
}

#[test]
fn masks_agree_with_brute_force() {
    assert_agrees("discs", &bench(light(), Some(some_discs())));
    assert_agrees(
        "half-plane",
        &bench(light(), Some(half_plane(1, 0.07, false))),
    );
    assert_agrees("grating", &bench(light(), Some(grating(0, 3.0, 0.4))));
    assert_agrees(
        "grating along y",
        &bench(light(), Some(grating(1, 2.0, -1.0))),
    );
    let steps = [
        (0.5, Some(grating(0, 3.0, 0.4))),
        (0.2, Some(some_discs())),
        (0.1, Some(grating(0, 5.0, 1.9))),
        (0.2, Some(grating(1, 2.0, 0.0))),
        (0.2, Some(half_plane(0, -0.11, false))),
        (0.3, None),
    ];
    assert_agrees("all", &chain_of(light(), steps.clone()));
    assert_agrees("all steps, lit by a point", &chain_of(POINT, steps.clone()));
    let all = with_cosine(chain_of(spot(disc([0.0, 0.0], 0.2), 20.0), steps));
    assert_agrees("all steps, lit by a round spot, and a cosine", &all);
}

#[test]
fn differential_irradiance_agrees_with_brute_force() {
    assert_agrees("cosine", &with_cosine(bench(light(), None)));
    assert_agrees("cosine, point light", &with_cosine(bench(POINT, None)));
}

/// Tests that a spot with the lobe cos⁴θ has the same spectrum as a chain with the factor G.
#[test]
fn a_spot_of_exponent_four_is_a_cosine() {
    let shape = Shape::Rectangle(square([0.0, 0.1], 0.4));
    let lobe = bench(spot(shape, 4.0), None);
    let shaded = with_cosine(bench(spot(shape, 0.0), None));
    for k in FREQUENCIES {
        assert_eq!(at(&lobe, &hann(), k), at(&shaded, &hann(), k));
    }
}

/// Evaluates the chain's spectrum with the given power of 1 + u² + v² instead of the chain's own
/// power.
fn at_power(chain: &Chain, window: &Window, power: f64, k: [f64; 4]) -> Complex {
    let path = chain.path();
    let slope = Slope::new([&window.u, &window.v], power);
    let fineness = DiscResolution::for_spectrum(&path, window, [3.0; 2]);
    let expansion = Expansion::new(&path, window, &slope, &fineness.0);
    expansion.at(k)
}

/// Asserts that the wrong formula `fault` differs detectably from the sum over quasi-random rays.
fn assert_seen(name: &str, chain: &Chain, fault: impl Fn([f64; 4]) -> Complex) {
    let right = error(chain, |k| at(chain, &hann(), k));
    let wrong = error(chain, fault);
    // The integrand is smooth, so the sum over quasi-random points is more accurate than for masks
    // with edges.
    assert!(right < 5e-4, "{name}: {right:e}");
    assert!(wrong > 5e-3, "{name}: {wrong:e}"); // ten times that
}

#[test]
fn planted_faults_are_seen() {
    let shape = Shape::Rectangle(square([0.0, 0.1], 0.4));
    for (name, chain, power) in [
        (
            "a point light without the factor √(1 + u² + v²)",
            bench(POINT, None),
            0.0,
        ),
        ("no G", with_cosine(bench(light(), None)), 0.0),
        ("g for G", with_cosine(bench(light(), None)), -1.5),
        (
            "an exponent with an error of 5 %",
            bench(spot(shape, 20.0), None),
            -10.5,
        ),
    ] {
        assert_seen(name, &chain, |k| at_power(&chain, &hann(), power, k));
    }
    let chain = bench(light(), Some(grating(0, 3.0, 0.4)));
    let wrong = chain.with(Parameter::GratingPhase(1), 0.6).unwrap();
    assert_seen("a phase with an error of 0.2", &chain, |k| {
        at(&wrong, &hann(), k)
    });
    let wrong = chain.with(Parameter::GratingPhase(1), -0.4).unwrap();
    assert_seen("a phase of the opposite sign", &chain, |k| {
        at(&wrong, &hann(), k)
    });
}

/// A Gaussian window that is truncated where its value is 2e-16.
fn gaussian_window(a: f64, b: f64) -> Window {
    let profile = |width| Profile::Gaussian {
        width,
        cut: 3.4 * width,
    };
    window(profile(a), profile(b))
}

#[test]
fn discs_and_points_agree_with_closed_forms() {
    let (gaussian, window) = (
        GaussianWindow { a: 0.7, b: 0.35 },
        gaussian_window(0.7, 0.35),
    );
    let (radius, distance) = (0.3, 2.0);
    let round = chain_of(spot(disc([0.0; 2], radius), 0.0), [(distance, None)]);
    let point = chain_of(Light::Point { intensity: 1.0 }, [(distance, None)]);
    let closed_disc = |k| disc_light(radius, distance, &gaussian, k);
    // This closed form omits the factor √(1 + u² + v²), so its radiance is constant in slope.
    let closed_point = |[x, y, u, v]: [f64; 4]| {
        let along = |k| point_light(distance, &gaussian, k);
        along([x, u]) * along([y, v])
    };
    for k in FREQUENCIES {
        let error = (at(&round, &window, k) - closed_disc(k)).norm() / closed_disc([0.0; 4]);
        assert!(error < 1e-12, "{error:e}"); // the rule is exponential under a smooth window
        let segments = at_power(&point, &window, 0.0, k);
        let error = (segments - closed_point(k)).norm() / closed_point([0.0; 4]);
        assert!(error < 1e-13, "{error:e}"); // rounding of hundreds of waves in two closed forms
    }
}

/// Tests that without the factor √(1 + u² + v²) the spectrum of a point light at 2 m is 2 % too
/// low under Gaussian windows of widths 1 and ½.
#[test]
fn the_root_of_a_point_is_two_per_cent() {
    let window = gaussian_window(1.0, 0.5);
    let chain = chain_of(POINT, [(2.0, None)]);
    let [with, without] = [0.5, 0.0].map(|power| at_power(&chain, &window, power, [0.0; 4]).re);
    assert!((with / without - 1.02).abs() < 2e-3, "{}", with / without); // to the digits stated
    // Without the factor √(1 + u² + v²) the result is the Gaussian integral I/(D²/a² + 1/b²).
    assert!((without * 8.0 / 1.3 - 1.0).abs() < 1e-14, "{without}"); // the cut is at 2e-16
}
