//! Laws that every prediction obeys, and brute force where there is no law.

use crate::testing::{blockers, chain, square, window};
use crate::{Chain, Operator, at, slices};
use etendue_field::{
    Complex, FrequencyAxis, Profile, Rectangle, SliceGrid, Slices, TwoPlane, Window,
};
use std::f64::consts::TAU;

const FREQUENCIES: [[f64; 4]; 4] = [
    [0.0; 4],
    [1.0, 0.0, -1.7, 0.0],
    [0.4, -0.6, 0.3, 1.1],
    [-1.3, 0.9, 2.0, -2.5],
];

fn hann() -> Window {
    window(Profile::Hann(0.5), Profile::Hann(0.3))
}

/// The value at zero frequency.
fn zero(chain: &Chain) -> f64 {
    at(chain, &hann(), [0.0; 4]).re
}

/// The transform by quasi-random rays: from the light to the final plane.
///
/// Points of the R₄ sequence (Roberts 2018): multiples of the powers of 1/φ, φ⁵ = φ + 1.
fn brute_force(chain: &Chain, frequencies: &[[f64; 4]], rays: u32) -> Vec<Complex> {
    let window = hann();
    let layers = chain.layers();
    let source = layers[0].rectangles[0];
    let distance = layers[0].distance;
    let powers = [1, 2, 3, 4].map(|i| 1.167_303_978_261_418_7_f64.powi(-i));
    let mut sums = vec![Complex::ZERO; frequencies.len()];
    for i in 0..rays {
        let [a, b, c, d] = powers.map(|p| (f64::from(i) * p).fract() - 0.5);
        let (x, y) = (
            a * 2.0 * window.x.half_width(),
            b * 2.0 * window.y.half_width(),
        );
        let from = [(0, c), (1, d)].map(|(k, t)| source.center[k] + t * source.size[k]);
        let (u, v) = ((x - from[0]) / distance, (y - from[1]) / distance);
        let ray = TwoPlane { x, y, u, v };
        let free = layers[1..].iter().all(|layer| {
            let then = ray.travelled(-layer.distance);
            !layer.rectangles.iter().any(|r| r.contains(then.x, then.y))
        });
        if free {
            for (sum, k) in sums.iter_mut().zip(frequencies) {
                let phase = k[0] * x + k[1] * y + k[2] * u + k[3] * v;
                *sum += Complex::cis(-TAU * phase) * window.value(&ray);
            }
        }
    }
    let area = 4.0 * window.x.half_width() * window.y.half_width() * source.area();
    let scale = area / (distance * distance * f64::from(rays));
    sums.iter().map(|sum| sum * scale).collect()
}

#[test]
fn two_layers_agree_with_brute_force() {
    let steps = |first: Vec<Rectangle>, second| [(1.0, first), (0.6, second), (0.5, vec![])];
    let (first, second) = (blockers(3, 0.2, 0.14), blockers(4, 0.16, 0.12));
    let both = chain(0.3, &steps(first.clone(), second.clone()));
    let truth = brute_force(&both, &FREQUENCIES, 400_000);
    let open = chain(0.3, &steps(vec![], vec![]));
    let alone = [
        chain(0.3, &steps(first, vec![])),
        chain(0.3, &steps(vec![], second)),
    ];
    for (k, truth) in FREQUENCIES.iter().zip(truth) {
        let value = |chain: &Chain| at(chain, &hann(), *k);
        // Quasi-random points with edges: somewhat better than 1/√400000 = 1.6e-3.
        assert!((value(&both) - truth).norm() < 1e-3 * zero(&open));
    }
    // Without the rays that both layers block the difference shows.
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

/// The scene of Durand et al. 2005, Fig. 7, with an overlap that both block.
#[test]
fn two_halves_in_one_plane_block_everything() {
    let half = |side: f64| vec![square([side * 0.95, 0.0], 2.0)];
    let one = chain(0.2, &[(1.0, half(1.0)), (1.0, vec![])]);
    let both = chain(0.2, &[(1.0, half(1.0)), (0.0, half(-1.0)), (1.0, vec![])]);
    assert!(zero(&one) > 0.01 * zero(&chain(0.2, &[(2.0, vec![])]))); // something passes a single one
    for k in FREQUENCIES {
        assert!(at(&both, &hann(), k).norm() < 1e-13 * zero(&one)); // rounding of four products
    }
}

#[test]
fn radiance_is_a_factor() {
    let one = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (1.0, vec![])]);
    let mut five = one.clone();
    five.source.radiance = 5.0;
    for k in FREQUENCIES {
        let difference = at(&five, &hann(), k) - at(&one, &hann(), k) * 5.0;
        assert!(difference.norm() < 1e-14 * zero(&five)); // rounding
    }
}

#[test]
fn light_that_misses_the_window_is_dark() {
    let mut aside = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (0.5, vec![])]);
    aside.source.rectangle.center = [0.0, 1.5];
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

/// The test of shears can fail: light that travels backwards is far off.
#[test]
fn a_wrong_sign_of_the_shear_shows() {
    let right = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (1.0, vec![])]);
    let mut wrong = right.clone();
    for operator in &mut wrong.operators {
        if let Operator::Travel { distance, .. } = operator {
            *distance = -*distance;
        }
    }
    // On the line Ωu = −2 Ωx, where the shear of 2 m puts the light.
    let k = [1.0, 0.0, -2.0, 0.0];
    let difference = at(&right, &hann(), k) - at(&wrong, &hann(), k);
    assert!(difference.norm() > 0.3 * zero(&right)); // a third of everything
    let truth = brute_force(&right, &[k], 100_000)[0];
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
            "multiply  visibility of b: 4 opaque rectangles",
            "map  travel -0.5 m, b to c: ℓ̂(Ωx, Ωu − 0.5 Ωx)",
        ]
    );
}
