//! Tests of diffuse reflection against transforms of polygons.

use crate::testing::*;
use crate::{Chain, Operator, at};
use etendue_field::{Light, Mask, Profile, Window};
use std::f64::consts::PI;

const ALBEDO: f64 = 0.6;

/// Builds a chain from a light to a floor 1.8 m from the light, with the floor's cosine operator.
fn onto_floor(light: Light, mask: Option<Mask>) -> Chain {
    let mut chain = chain_of(light, [(1.0, mask), (0.8, None)]);
    chain.operators.push(cosine());
    chain
}

fn reflected(mut chain: Chain) -> Chain {
    chain.operators.push(Operator::Diffuse {
        name: "floor".into(),
        albedo: ALBEDO,
    });
    chain
}

fn with_slopes(half: f64, profile: fn(f64) -> Profile) -> Window {
    window(Profile::Hann(0.5), profile(half))
}

/// Tests that the radiance that leaves the floor is albedo/π times the integral of the incident
/// light over all slopes, mirrored in x. The spectrum is computed both from this integral and by
/// the receiver.
#[test]
fn exitant_radiance_is_what_arrives() {
    let light = lambertian(square([0.05, -0.02], 0.3));
    let all = with_slopes(0.45, Profile::Box); // (0.5 + 0.2)/1.8 is the steepest ray
    let seen = with_slopes(0.3, Profile::Hann);
    let none = [[0.0; 4], [0.0, 0.0, 1.0, -0.4]];
    for mask in [
        None,
        Some(rectangles(&blockers(3, 0.2, 0.1))),
        Some(grating(0, 2.0, 0.4)),
        Some(half_plane(0, 0.1, true)),
        Some(opaque(vec![disc([0.05, 0.1], 0.15)])),
    ] {
        let arriving = onto_floor(light.clone(), mask);
        let leaving = reflected(arriving.clone());
        let largest = at(&leaving, &seen, [0.0; 4]).norm();
        for [x, y, u, v] in [[1.1, 0.3, 0.5, -0.8], [-2.0, 1.0, 0.0, 0.0]]
            .into_iter()
            .chain(none)
        {
            let hann = |k: f64| {
                // The Fourier transform of cos²(πt/2h) is h sinc(2hk)/(1 − (2hk)²).
                let s = 0.6 * k;
                0.3 * etendue_field::sinc(s) / (1.0 - s * s)
            };
            let expected =
                at(&arriving, &all, [-x, y, 0.0, 0.0]) * (ALBEDO / PI * hann(u) * hann(v));
            let error = (at(&leaving, &seen, [x, y, u, v]) - expected).norm() / largest;
            // The tolerance is the error of the receiver's rule; this rule is of second order and
            // has about 400 nodes.
            assert!(error < 1e-5, "{error:e}");
        }
    }
}

#[test]
#[should_panic(expected = "only travel may follow the diffuse floor")]
fn nothing_but_travel_may_follow() {
    let mut chain = reflected(onto_floor(lambertian(square([0.0; 2], 0.3)), None));
    chain.operators.push(cosine());
    let _ = at(&chain, &with_slopes(0.3, Profile::Hann), [0.0; 4]);
}
