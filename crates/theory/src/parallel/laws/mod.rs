//! Tests of laws that every prediction obeys, and tests against sums over quasi-random rays.

mod brute_force;
mod kinds;
mod masks;
mod receiver;

use crate::testing::*;
use crate::{Chain, Operator, at, slices};
use brute_force::brute_force;
use etendue_field::{
    FrequencyAxis, HalfPlane, Light, Mask, Profile, Rectangle, Shape, SliceGrid, Slices, Window,
};

const FREQUENCIES: [[f64; 4]; 5] = [
    [0.0; 4],
    [2.9, 0.2, -2.5, 0.0],
    [1.0, 0.0, -1.7, 0.0],
    [0.4, -0.6, 0.3, 1.1],
    [-1.3, 0.9, 2.0, -2.5],
];

fn hann() -> Window {
    window(Profile::Hann(0.5), Profile::Hann(0.3))
}

/// The spectrum of a chain at zero frequency.
fn zero(chain: &Chain) -> f64 {
    at(chain, &hann(), [0.0; 4]).re
}

#[test]
fn two_layers_agree_with_brute_force() {
    let steps = |first: Vec<Rectangle>, second| [(1.0, first), (0.6, second), (0.5, vec![])];
    let (first, second) = (blockers(3, 0.2, 0.14), blockers(4, 0.16, 0.12));
    let both = chain(0.3, &steps(first.clone(), second.clone()));
    let truth = brute_force(&both, &hann(), &FREQUENCIES, 400_000);
    let open = chain(0.3, &steps(vec![], vec![]));
    let alone = [
        chain(0.3, &steps(first, vec![])),
        chain(0.3, &steps(vec![], second)),
    ];
    for (k, truth) in FREQUENCIES.iter().zip(truth) {
        let value = |chain: &Chain| at(chain, &hann(), *k);
        // For masks with edges, the error of the sum over 400000 quasi-random points is slightly
        // below 1/√400000 = 1.6e-3.
        assert!((value(&both) - truth).norm() < 1e-3 * zero(&open));
    }
    // If the rays that both layers block were counted twice, the result would differ detectably.
    let single = alone.iter().map(zero).sum::<f64>() - zero(&open);
    assert!((single - zero(&both)).abs() > 1e-2 * zero(&open)); // ten times the tolerance above
}

#[test]
fn travels_add_up() {
    let whole = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (0.75, vec![])]);
    let parts = chain(
        0.2,
        &[
            (0.25, vec![]),
            (0.75, blockers(2, 0.2, 0.1)),
            (0.5, vec![]),
            (0.25, vec![]),
        ],
    );
    for k in FREQUENCIES {
        let difference = at(&whole, &hann(), k) - at(&parts, &hann(), k);
        assert!(difference.norm() < 1e-15 * zero(&whole)); // the same polygons, distances are exact
    }
}

#[test]
fn nothing_passes_closed_blockers() {
    let tiles = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]
        .map(|[x, y]| square([x + 0.03, y - 0.01], 2.0))
        .to_vec();
    let closed = chain(0.2, &[(1.0, tiles), (1.0, vec![])]);
    let open = chain(0.2, &[(2.0, vec![])]);
    for k in FREQUENCIES {
        let left = at(&closed, &hann(), k);
        assert!(left.norm() < 1e-14 * zero(&open)); // rounding of five products
    }
}

/// Tests the scene of Durand et al. 2005, Fig. 7, with two half-planes that overlap.
#[test]
fn two_halves_in_one_plane_block_everything() {
    let half = |side: f64| vec![square([side * 0.95, 0.0], 2.0)];
    let one = chain(0.2, &[(1.0, half(1.0)), (1.0, vec![])]);
    let both = chain(0.2, &[(1.0, half(1.0)), (0.0, half(-1.0)), (1.0, vec![])]);
    // A single half-plane transmits part of the light.
    assert!(zero(&one) > 0.01 * zero(&chain(0.2, &[(2.0, vec![])])));
    for k in FREQUENCIES {
        assert!(at(&both, &hann(), k).norm() < 1e-13 * zero(&one)); // rounding of four products
    }
}

#[test]
fn radiance_is_a_factor() {
    let one = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (1.0, vec![])]);
    let mut five = one.clone();
    if let Light::Area { radiance, .. } = &mut five.source.light {
        *radiance = 5.0;
    }
    for k in FREQUENCIES {
        let difference = at(&five, &hann(), k) - at(&one, &hann(), k) * 5.0;
        assert!(difference.norm() < 1e-14 * zero(&five)); // rounding
    }
}

#[test]
fn light_that_misses_the_window_is_dark() {
    let mut aside = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (0.5, vec![])]);
    aside.source.light = lambertian(square([0.0, 1.5], 0.2));
    let axis = FrequencyAxis {
        half: 2,
        spacing: 1.0,
    };
    let grid = SliceGrid {
        azimuths: 3,
        rho: axis,
        nu: axis,
    };
    assert_eq!(slices(&aside, &hann(), &grid), Slices::zeros(grid));
}

/// Tests that a shear with the wrong sign, for light that travels backward, causes a large error.
#[test]
fn a_wrong_sign_of_the_shear_shows() {
    let right = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (1.0, vec![])]);
    let mut wrong = right.clone();
    for operator in &mut wrong.operators {
        if let Operator::Travel { distance, .. } = operator {
            *distance = -*distance;
        }
    }
    // The tested frequency is on the line Ωu = −2 Ωx, onto which travel over 2 m shears the
    // light's spectrum.
    let k = [1.0, 0.0, -2.0, 0.0];
    let difference = at(&right, &hann(), k) - at(&wrong, &hann(), k);
    assert!(difference.norm() > 0.3 * zero(&right)); // the error is a third of all light
    let truth = brute_force(&right, &hann(), &[k], 100_000)[0];
    let close = 3e-3 * zero(&right); // about 1/√100000
    assert!((at(&right, &hann(), k) - truth).norm() < close);
}

#[test]
fn chain_in_words() {
    let mut chain = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (0.5, vec![])]);
    if let Operator::Travel { distance, .. } = &mut chain.operators[2] {
        *distance = -0.5;
    }
    assert_eq!(
        chain.describe(),
        [
            "source  light: Lambertian rectangle 0.2 x 0.2 m, radiance 1 W m⁻² sr⁻¹",
            "map  travel 1 m, a to b: ℓ̂(Ωx, Ωu + 1 Ωx)",
            "multiply  by the visibility of b: 4 opaque rectangles",
            "map  travel -0.5 m, b to c: ℓ̂(Ωx, Ωu − 0.5 Ωx)",
        ]
    );
}

#[test]
fn new_kinds_in_words() {
    let light = spot(disc([0.0, 0.0], 0.1), 20.0);
    let mixed = Mask::Opaque {
        shapes: vec![disc([0.0; 2], 0.1), Shape::Rectangle(square([0.5; 2], 0.1))],
        half_planes: vec![HalfPlane {
            axis: 0,
            edge: 1.0,
            above: true,
        }],
    };
    let steps = [
        (1.0, Some(mixed)),
        (1.0, Some(half_plane(0, 0.0, true))),
        (1.0, Some(grating(0, 5.0, 0.3))),
    ];
    let mut chain = chain_of(light, steps);
    chain.operators.extend([
        cosine(),
        Operator::Diffuse {
            name: "floor".into(),
            albedo: 0.5,
        },
    ]);
    let lines = chain.describe();
    let others = lines.iter().filter(|line| !line.starts_with("map"));
    assert_eq!(
        others.collect::<Vec<_>>(),
        [
            "source  light: disc of radius 0.1 m, radiance 1 W m⁻² sr⁻¹ cosⁿθ, n = 20",
            "multiply  by the visibility of b: 1 opaque rectangle, 1 disc, 1 half-plane",
            "multiply  by the visibility of c: 1 opaque half-plane",
            "multiply  by the grating d: ½(1 + 0.9 cos(2π 5 x + 0.3))",
            "multiply  by the cosine at floor: G = (1 + u² + v²)⁻²",
            "convolve  with the diffuse reflection at floor: albedo 0.5, constant in slope",
        ]
    );
    chain.source.light = Light::Point { intensity: 3.0 };
    assert_eq!(
        chain.describe()[0],
        "source  light: point, intensity 3 W sr⁻¹"
    );
}
