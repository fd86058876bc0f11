//! Tests of half-planes and gratings: the phases of spectra and the frequencies at which spectra
//! are non-zero.

use super::{FREQUENCIES, hann, zero};
use crate::model::Over;
use crate::nets::RayBudget;
use crate::testing::*;
use crate::{Chain, Model, Operator, Parameter, at};
use etendue_field::{
    FrequencyAxis, HalfPlane, Light, Mask, ProjectionGrid, Rectangle, Shape, SliceGrid,
};

fn open() -> Chain {
    chain(0.2, &[(2.0, vec![])])
}

/// Tests the scene of Durand et al. 2005, Fig. 7: a half-plane, and a second half-plane that
/// blocks all light that passes the first.
#[test]
fn two_half_planes_let_nothing_through_together() {
    let [a, b] = [true, false].map(|above| half_plane(0, 0.013, above));
    let behind = |masks: [Option<Mask>; 2]| {
        let [first, second] = masks;
        let light = lambertian(square([0.0, 0.0], 0.2));
        chain_of(light, [(1.0, first), (0.0, second), (1.0, None)])
    };
    let both = behind([Some(a.clone()), Some(b.clone())]);
    let alone = [behind([Some(a), None]), behind([None, Some(b)])];
    for k in FREQUENCIES {
        let value = |chain: &Chain| at(chain, &hann(), k);
        let sum = value(&alone[0]) + value(&alone[1]);
        assert!((sum - value(&open())).norm() < 1e-14 * zero(&open())); // rounding
        assert!(value(&both).norm() < 1e-12 * zero(&open())); // rounding of four products
    }
    // The spectra of the two half-planes add up, but their moduli do not: on the line of the
    // shear, the sum of moduli differs strongly from the modulus of the sum.
    let k = [2.0, 0.0, -3.4, 0.0];
    let value = |chain: &Chain| at(chain, &hann(), k).norm();
    let blind = value(&alone[0]) + value(&alone[1]) - value(&open());
    assert!(blind > 0.05 * zero(&open())); // twelve orders of magnitude above rounding
}

#[test]
fn two_half_planes_in_one_mask_leave_a_slit() {
    let half_planes = [(-0.1, false), (0.15, true)].map(|(edge, above)| HalfPlane {
        axis: 1,
        edge,
        above,
    });
    let slit = Mask::Opaque {
        shapes: vec![],
        half_planes: half_planes.to_vec(),
    };
    // Rectangular blockers that are much larger than the window give the same result as
    // half-planes.
    let blocks = rectangles(&[-50.1, 50.15].map(|y| square([0.0, y], 100.0)));
    let behind = |mask| {
        chain_of(
            lambertian(square([0.0, 0.0], 0.2)),
            [(1.0, Some(mask)), (1.0, None)],
        )
    };
    let (slit, blocks) = (behind(slit), behind(blocks));
    for k in FREQUENCIES {
        let difference = at(&slit, &hann(), k) - at(&blocks, &hann(), k);
        assert!(difference.norm() < 1e-13 * zero(&open())); // distances of 100 m lose two digits
    }
}

/// Tests that the spectrum of light at the distance h after a grating is ½ ℓ̂(Ωx, Ωu) + m/4 (e^(ip)
/// ℓ̂(Ωx − f, Ωu + h f) + e^(−ip) ℓ̂(Ωx + f, Ωu − h f)).
#[test]
fn a_grating_is_three_copies() {
    let (f, phase, modulation, h) = (3.0, 0.4, 0.9, 0.7);
    let behind = |mask| {
        let steps = [(1.3, mask), (h, None)];
        chain_of(spot(disc([0.0, 0.1], 0.2), 3.0), steps)
    };
    let (open, seen) = (behind(None), behind(Some(grating(1, f, phase))));
    for [x, y, u, v] in FREQUENCIES {
        let copy = |n: f64| {
            let shifted = [x, y - n * f, u, v + n * h * f];
            at(&open, &hann(), shifted) * etendue_field::Complex::cis(n * phase)
        };
        let sum = copy(0.0) * 0.5 + (copy(1.0) + copy(-1.0)) * (0.25 * modulation);
        let difference = sum - at(&seen, &hann(), [x, y, u, v]);
        // Discs are split into different numbers of rectangles for different frequencies, which
        // limits the agreement.
        assert!(difference.norm() < 1e-9 * zero(&open));
    }
}

/// Tests that the spectrum behind two gratings is non-zero at (0, f Δh). This frequency is outside
/// the wedge between the lines of the two depths, and the spectrum behind each single grating is
/// zero there.
#[test]
fn two_gratings_leave_the_wedge() {
    // The window has the half-widths 0.5 and 0.3. At the tested frequency, the transform of the
    // window is zero.
    let (f, between) = (5.0, 1.0);
    let mask = || Some(grating(0, f, 0.0));
    let wide = || lambertian(square([0.0, 0.0], 8.0));
    let seen = |first, second| chain_of(wide(), [(1.0, first), (between, second)]);
    let k = [0.0, 0.0, f * between, 0.0];
    let value = |chain: &Chain| at(chain, &hann(), k).norm() / zero(chain);
    let both = value(&seen(mask(), mask()));
    // The component at the difference of the two gratings' frequencies divided by the component at
    // zero is (m/4)² / (½)². Half of the tolerance covers the effect of the window's edge.
    assert!(
        (both / (0.9_f64.powi(2) / 4.0) - 1.0).abs() < 0.05,
        "{both}"
    );
    for alone in [seen(mask(), None), seen(None, mask())] {
        assert!(value(&alone) < 0.02 * both, "{}", value(&alone) / both);
    }
}

#[test]
fn travels_add_up_with_gratings_and_points() {
    let masks = [Some(grating(0, 3.0, 0.4)), Some(half_plane(1, 0.1, true))];
    let [first, second] = masks;
    let whole = [(1.0, first.clone()), (0.5, second.clone()), (0.75, None)];
    let parts = [
        (0.25, None),
        (0.75, first),
        (0.25, None),
        (0.25, second),
        (0.25, None),
        (0.5, None),
    ];
    for light in [
        Light::Point { intensity: 1.0 },
        spot(disc([0.0, 0.0], 0.2), 6.0),
    ] {
        let [whole, parts] = [
            chain_of(light.clone(), whole.clone()),
            chain_of(light, parts.clone()),
        ];
        for k in FREQUENCIES {
            let difference = at(&whole, &hann(), k) - at(&parts, &hann(), k);
            // Both chains have the same polygons, and their distances are exact in binary.
            assert!(difference.norm() < 1e-15 * zero(&whole));
        }
    }
}

/// Tests that a grating of phase p displaced by x₀ equals a grating of phase p − 2π f x₀.
#[test]
fn a_phase_is_a_place() {
    let behind = |phase, x: f64| {
        let light = lambertian(square([x, 0.0], 0.3));
        chain_of(light, [(1.0, Some(grating(0, 3.0, phase))), (0.0, None)])
    };
    let full_turn = behind(0.3 + std::f64::consts::TAU, 0.0);
    let none = behind(0.3, 0.0);
    let half_turn = behind(0.3, 0.0)
        .with(Parameter::GratingPhase(1), 0.3 + std::f64::consts::PI)
        .unwrap();
    for k in FREQUENCIES {
        let value = |chain: &Chain| at(chain, &hann(), k);
        let scale = zero(&chain(0.3, &[(1.0, vec![])]));
        assert!((value(&full_turn) - value(&none)).norm() < 1e-14 * scale); // rounding of the phase
        // The transmissions of two gratings of opposite phase add up to 1.
        let sum = value(&half_turn) + value(&none);
        let open = value(&chain(0.3, &[(1.0, vec![])]));
        assert!((sum - open).norm() < 1e-14 * scale); // rounding
    }
}

/// Tests that light through a hole and light past a blocker of the same shape add up to all light.
#[test]
fn a_hole_passes_what_its_shape_would_block() {
    let wide = Shape::Rectangle(Rectangle {
        center: [-0.05, 0.1],
        size: [0.3, 0.2],
    });
    for shape in [wide, disc([0.03, -0.02], 0.12)] {
        for light in [
            lambertian(square([0.0, 0.0], 0.2)),
            spot(disc([0.0, 0.1], 0.15), 3.0),
        ] {
            let behind = |mask| chain_of(light.clone(), [(1.3, mask), (0.7, None)]);
            let open = behind(None);
            let [hole, blocker] =
                [aperture(shape), opaque(vec![shape])].map(|mask| behind(Some(mask)));
            for k in FREQUENCIES {
                let value = |chain: &Chain| at(chain, &hann(), k);
                let difference = value(&hole) + value(&blocker) - value(&open);
                // For the blocker and for the hole, discs are split into the same rectangles.
                assert!(difference.norm() < 1e-12 * zero(&open), "{shape:?} {k:?}");
            }
            assert!(zero(&hole) > 0.05 * zero(&open) && zero(&blocker) > 0.05 * zero(&open));
        }
    }
}

/// Tests that nets of rays, which predict light behind a polygon, agree with the closed form of a
/// rectangle, with and without a diffuse surface.
#[test]
fn polygons_are_predicted_by_nets() {
    let rectangle = Rectangle {
        center: [0.02, 0.01],
        size: [0.2, 0.12],
    };
    let corners = [[0.12, 0.07], [0.12, -0.05], [-0.08, -0.05], [-0.08, 0.07]];
    let axis = |half, spacing| FrequencyAxis { half, spacing };
    let grid = SliceGrid {
        azimuths: 3,
        rho: axis(4, 1.0),
        nu: axis(4, 1.0),
    };
    let window = hann();
    let picture = ProjectionGrid::new(&window, 8);
    let over: Over<'_> = (&window, &grid, &picture);
    let budget = RayBudget::new(1e6, 1e-3);
    let light = lambertian(square([0.0, 0.0], 0.2));
    let diffuse = |mut chain: Chain| {
        let name = "floor".to_owned();
        chain
            .operators
            .extend([cosine(), Operator::Diffuse { name, albedo: 0.5 }]);
        chain
    };
    for ends in [false, true] {
        let behind = |mask| {
            let chain = chain_of(light.clone(), [(1.0, Some(mask)), (1.0, None)]);
            if ends { diffuse(chain) } else { chain }
        };
        let exact = behind(aperture(Shape::Rectangle(rectangle)));
        let polygon = behind(polygon_aperture(&corners));
        assert!(!exact.is_sampled(over, budget) && polygon.is_sampled(over, budget));
        let [exact, nets] = [exact, polygon].map(|chain| chain.predict(&[], over, budget));
        let difference = nets.slices.relative_difference(&exact.slices);
        // Three standard errors of nets, plus the error of the quadrature over the receiver.
        assert!(
            difference < 3e-3 + exact.error.unwrap_or(0.0),
            "{difference}"
        );
    }
}
