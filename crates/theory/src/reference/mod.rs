//! Checks against the numbers in `tests/reference.json`, which are computed with mpmath at 25
//! digits, independently of this crate.
//!
//! For each block of the file with an untruncated Gaussian window, the closed form is checked. If
//! the light field of the block consists of polygons, the polygon code is checked too, with the
//! window truncated at 3.4 widths, where its value is 2e-16.

mod area;
pub(crate) mod gaussian;
mod geometry;
mod grating;
mod half_planes;
mod jitter;
mod lights;
mod shading;

use crate::parallel::expansion::Expansion;
use crate::testing::{chain, lambertian, window};
use crate::{Chain, g_hat, g_hat_3d};
use etendue_field::{Complex, Profile, Rectangle};
use gaussian::{GaussianBlock, GaussianWindow};
use jitter::{JitteredArray, jittered_array_power};
use serde_json::Value;

/// Values must agree to this tolerance, relative to the largest value of a block. The file is
/// accurate to 14 digits, and rounding errors affect the last digit.
const CLOSE: f64 = 1e-13;
/// Length of the rectangles that represent strips, which is greater than the width of any window.
const ENDLESS: f64 = 1e3;

fn block(name: &str) -> Value {
    let mut file: Value = serde_json::from_str(include_str!("../../tests/reference.json")).unwrap();
    file[name].take()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn complex(value: &Value) -> Complex {
    Complex::new(number(&value["re"]), number(&value["im"]))
}

fn samples(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

/// Returns (Ωx, Ωv) of a sample.
fn frequency(sample: &Value) -> [f64; 2] {
    [number(&sample["ox"]), number(&sample["ov"])]
}

/// Returns (Ωx, Ωy, Ωu, Ωv) of a sample.
fn frequency_4d(sample: &Value) -> [f64; 4] {
    ["ox", "oy", "ou", "ov"].map(|name| number(&sample[name]))
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

fn assert_close(what: &str, deviation: f64) {
    assert!(deviation < CLOSE, "{what}: {deviation:e}");
}

fn cut(width: f64) -> Profile {
    Profile::Gaussian {
        width,
        cut: 3.4 * width,
    }
}

/// The spectrum's factor over (x, u), for a chain whose rectangles are unbounded along y.
fn factor(chain: &Chain, [x, u]: [Profile; 2], k: [f64; 2]) -> Complex {
    let expansion = Expansion::of_rectangles(chain, &window(x, u));
    let section = &expansion.sections[0];
    let waves = &expansion.products[0][0];
    let terms = expansion.terms.iter();
    terms
        .map(|t| section.value(waves, &section.polygons[t.polygons[0]], k) * t.weight)
        .sum()
}

fn strip(center: f64, width: f64) -> Rectangle {
    Rectangle {
        center: [center, 0.0],
        size: [width, ENDLESS],
    }
}

/// A chain with a light of the given width at the given distance, and without occluders.
fn light(width: f64, distance: f64) -> Chain {
    let mut chain = chain(width, &[(distance, vec![])]);
    chain.source.light = lambertian(strip(0.0, width));
    chain
}

struct ReferenceScene {
    bench: GaussianBlock,
    gaussian: GaussianWindow,
    profiles: [Profile; 2],
}

/// The light, distances and Gaussian window of a block.
fn scene(parameters: &Value) -> ReferenceScene {
    let p = |name: &str| number(&parameters[name]);
    ReferenceScene {
        bench: GaussianBlock {
            light: p("w"),
            to_blockers: p("d1"),
            below: p("d2"),
        },
        gaussian: GaussianWindow {
            a: p("a"),
            b: p("b"),
        },
        profiles: [cut(p("a")), cut(p("b"))],
    }
}

#[test]
fn cosine_transforms() {
    let (g, g3) = (block("ghat"), block("Ghat"));
    let one = samples(&g["samples"]).iter().map(|s| {
        let expected = number(&s["value"]);
        (g_hat(number(&s["omega"])).into(), expected.into())
    });
    assert_close("ĝ", deviation(20, one));
    let two = samples(&g3["samples"]).iter().map(|s| {
        let expected = number(&s["value"]);
        let got = g_hat_3d(number(&s["ou"]), number(&s["ov"]));
        (got.into(), expected.into())
    });
    assert_close("Ĝ", deviation(20, two));
}

#[test]
fn jittered_array() {
    let block = block("jittered_array");
    let p = |name: &str| number(&block["params"][name]);
    let array = JitteredArray {
        count: 7,
        size: p("size"),
        pitch: p("period"),
        jitter: p("jitter"),
    };
    assert_eq!(block["params"]["count"], array.count);
    let regular = JitteredArray {
        jitter: 0.0,
        ..array
    };
    let (mut jittered, mut still) = (Vec::new(), Vec::new());
    for sample in samples(&block["samples"]) {
        let omega = number(&sample["omega"]);
        let expected = |name: &str| Complex::from(number(&sample[name]["value"]));
        let got = |array| Complex::from(jittered_array_power(array, omega));
        jittered.push((got(&array), expected("mean_power")));
        still.push((got(&regular), expected("unjittered_power")));
    }
    assert_close("jittered", deviation(8, jittered));
    assert_close("regular", deviation(8, still));
}
