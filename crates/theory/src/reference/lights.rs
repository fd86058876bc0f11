//! Checks of lights that are not rectangles.

use super::*;
use crate::reference::gaussian;

#[test]
fn disc_light_in_4d() {
    let block = block("disc_light_4d");
    let p = |name: &str| number(&block["params"][name]);
    let window = GaussianWindow {
        a: p("a"),
        b: p("b"),
    };
    let pairs = samples(&block["samples"]).iter().map(|s| {
        let got = gaussian::disc_light(p("radius"), p("d"), &window, frequency_4d(s));
        (got.into(), complex(s))
    });
    assert_close("disc", deviation(4, pairs));
}

#[test]
fn point_and_spot() {
    let block = block("point_and_spot");
    let p = |name: &str| number(&block["params"][name]);
    let (distance, bulb, lobe) = (p("d"), p("bulb"), p("c"));
    let window = GaussianWindow {
        a: p("a"),
        b: p("b"),
    };
    let all = samples(&block["samples"]).iter();
    let points = all.clone().map(|s| {
        let got = gaussian::point_light(distance, &window, frequency(s));
        (got.into(), complex(&s["point"]))
    });
    assert_close("point", deviation(4, points));
    let spots = all.map(|s| {
        let got = gaussian::spot(bulb, lobe, distance, &window, frequency(s));
        (got, complex(&s["spot"]))
    });
    assert_close("spot", deviation(4, spots));
}

#[test]
fn narrow_lights_are_points() {
    let window = GaussianWindow { a: 0.7, b: 0.35 };
    let (k, distance, width) = ([0.8, -1.1], 2.0, 1e-5);
    let point = gaussian::point_light(distance, &window, k);
    let area = gaussian::area_light(width, distance, &window, k) / width;
    assert!((area - point).norm() < 1e-9); // a second moment of 1e-11 over squares of widths of 0.3
    let plane = [0.8, 0.3, -1.1, -0.5];
    let disc = gaussian::disc_light(width, distance, &window, plane) / (width * width);
    let other = gaussian::point_light(distance, &window, [plane[1], plane[3]]);
    assert!((disc / std::f64::consts::PI - point * other).abs() < 1e-9); // the same
}
