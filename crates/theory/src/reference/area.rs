//! Checks of area lights, alone and behind opaque blockers.

use super::gaussian;
use super::*;
use crate::at;
use crate::testing::square;

#[test]
fn area_light_under_a_hann_window() {
    let block = block("area_light_hann");
    let p = |name: &str| number(&block["params"][name]);
    let profiles = [Profile::Hann(p("a")), Profile::Hann(p("b"))];
    let pairs = samples(&block["samples"]).iter().map(|s| {
        let got = factor(&light(p("w"), p("d")), profiles, frequency(s));
        (got, complex(s))
    });
    assert_close("Hann", deviation(5, pairs));
}

#[test]
fn square_light_in_4d() {
    let block = block("square_light_4d");
    let ReferenceScene {
        bench,
        gaussian,
        profiles: [x, u],
    } = scene(&block["params"]);
    let distance = bench.to_blockers + bench.below;
    let chain = chain(
        bench.light,
        &[(bench.to_blockers, vec![]), (bench.below, vec![])],
    );
    let all = samples(&block["samples"]).iter();
    let pairs = all
        .clone()
        .map(|s| (at(&chain, &window(x, u), frequency_4d(s)), complex(s)));
    assert_close("polygons", deviation(4, pairs));
    let pairs = all.map(|s| {
        let [x, y, u, v] = frequency_4d(s);
        let factor = |k| gaussian::area_light(bench.light, distance, &gaussian, k);
        (factor([x, u]) * factor([y, v]), complex(s))
    });
    assert_close("closed form", deviation(4, pairs));
}

/// The centres and the width of the strips of a block.
fn strips(block: &Value) -> (Vec<f64>, f64) {
    let strips = &block["strips"];
    let centers = samples(&strips["centres"]).iter().map(number).collect();
    (centers, number(&strips["size"]))
}

#[test]
fn opaque_strips() {
    let block = block("opaque_grid");
    let ReferenceScene {
        bench,
        gaussian,
        profiles,
    } = scene(&block["light_and_window"]);
    let (centers, size) = strips(&block);
    let (mut closed, mut polygons) = (Vec::new(), Vec::new());
    for sample in samples(&block["samples_2d"]) {
        let below = number(&sample["distance_below_blockers"]);
        let bench = GaussianBlock { below, ..bench };
        let k = frequency(sample);
        let distance = bench.to_blockers + below;
        let open = gaussian::area_light(bench.light, distance, &gaussian, k);
        let extents = centers.iter().map(|c| [c - 0.5 * size, c + 0.5 * size]);
        let blocked: Complex = extents
            .map(|strip| gaussian::blocked_by_strip(&bench, strip, &gaussian, k))
            .sum();
        closed.push((open, complex(&sample["unblocked"])));
        closed.push((blocked, complex(&sample["blocked_part"])));
        let blockers = centers.iter().map(|&c| strip(c, size)).collect();
        let mut chain = chain(
            bench.light,
            &[(bench.to_blockers, blockers), (below, vec![])],
        );
        chain.source.light = lambertian(strip(0.0, bench.light));
        polygons.push((factor(&chain, profiles, k), complex(&sample["visible"])));
    }
    assert_close("closed form", deviation(20, closed));
    assert_close("polygons", deviation(10, polygons));
}

#[test]
fn opaque_squares_in_4d() {
    let block = block("opaque_grid");
    let ReferenceScene {
        bench,
        profiles: [x, u],
        ..
    } = scene(&block["light_and_window"]);
    let (centers, size) = strips(&block);
    let squares = centers
        .iter()
        .flat_map(|&x| centers.iter().map(move |&y| square([x, y], size)));
    let steps = [
        (bench.to_blockers, squares.collect()),
        (bench.below, vec![]),
    ];
    let chain = chain(bench.light, &steps);
    let grid = &block["grid_of_squares_4d_receiver"];
    let pairs = samples(&grid["samples"])
        .iter()
        .map(|s| (at(&chain, &window(x, u), frequency_4d(s)), complex(s)));
    assert_close("polygons", deviation(3, pairs));
}
