//! Tests of projection pictures, covariances and derivatives from rays, and of rays that are lost.

use super::*;
use crate::Parameter;

#[test]
fn covariance_of_a_gaussian_beam() {
    // The Gaussian exp(−π x²/w²) has the variance w²/2π, and the window is wide enough not to
    // reduce this variance.
    let w = 0.1;
    let oblique = mirror(beam([w, w]), 0.0, [0.0; 2], [-0.01; 3]);
    let plane = after(&oblique, 0.5);
    let wide = window(Profile::Box(2.0), Profile::Box(1.0));
    let got = exact(&oblique, &plane, &wide, &grid(1, [0.2, 0.2]));
    let got = got.covariance.unwrap();
    let map = chain(&view(&oblique, &plane), Edition::Corrected)
        .unwrap()
        .map
        .rays();
    let variance = w * w / std::f64::consts::TAU;
    let mut before = [[0.0; 4]; 4];
    before[0][0] = variance;
    before[1][1] = variance;
    let expected = map.covariance(&before);
    for i in 0..16 {
        let off = (got[i / 4][i % 4] - expected[i / 4][i % 4]).abs();
        // A mirror of radius R = 100 m changes the slope of a ray by 2x/R. This formula has a
        // relative error of order (x/R)².
        assert!(off < 1e-5 * variance, "{i}: {off:e}");
    }
    assert!(got[0][2].abs() > 1e-4 * variance); // slopes follow positions
}

#[test]
fn projection_holds_the_flux() {
    let system = mirror(projector([0.2, 0.2]), 0.5, [0.2, 0.0], [-0.5; 3]);
    let plane = after(&system, 0.5);
    let window = window(Profile::Hann(0.2), Profile::Hann(0.2));
    let found = exact(&system, &plane, &window, &grid(1, [0.2, 0.2]));
    let sum = found.projection.values.sum() * found.projection.grid.cell_area();
    assert!((sum / found.slices.at_zero() - 1.0).abs() < 1e-4); // a million rays of nets
}

#[test]
fn projection_of_an_area_light() {
    let light = crate::testing::lambertian(crate::testing::square([0.0; 2], 0.2));
    let window = window(Profile::Hann(0.3), Profile::Hann(0.3));
    let cells = ProjectionGrid::new(&window, 32);
    let straight = PathSystem::new(light.clone(), vec![]);
    let got = exact(
        &straight,
        &after(&straight, 1.0),
        &window,
        &grid(1, [0.3, 0.3]),
    )
    .projection;
    let chain = crate::testing::chain_of(light, [(1.0, None)]);
    let expected = crate::projection(&chain, &window, &cells);
    let most = expected.values.iter().copied().fold(0.0, f64::max);
    let worst = got
        .values
        .iter()
        .zip(&expected.values)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(worst < 0.02 * most, "{}", worst / most); // accuracy of pictures from nets
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn derivatives_by_every_parameter() {
    let lens = Specular::ThinLens { focal_length: 0.6 };
    let glass = Specular::Refraction {
        front: 1.0,
        back: 1.5,
    };
    let mut system = mirror(projector([0.2, 0.2]), 0.5, [0.2, 0.1], [-0.5, -0.3, 0.0]);
    for (name, event, theta0, shape) in [
        ("glass", glass, 0.3, [0.4; 3]),
        ("lens", lens, 0.0, [0.0; 3]),
    ] {
        let patch = placed(&after(&system, 0.0).frame, 0.3, theta0, [0.0; 2], shape);
        visit(&mut system, element(name, patch, event));
    }
    let plane = after(&system, 0.2);
    let window = window(Profile::Hann(0.1), Profile::Hann(0.1));
    let grid = grid(2, [0.1, 0.1]);
    let view = view(&system, &plane);
    let parameters = view.parameters();
    assert_eq!(parameters.len(), 12);
    let picture = ProjectionGrid::new(&window, 1);
    let prediction = view.predict(&parameters, (&window, &grid, &picture), BUDGET);
    for (parameter, slope) in parameters.into_iter().zip(&prediction.derivatives) {
        let value = view.value(parameter).unwrap();
        let name = view.name(parameter);
        let other = view.with(parameter, value + 1e-4).unwrap();
        let read = other.value(parameter).unwrap();
        assert!((read - value - 1e-4).abs() < 1e-12, "{name}"); // rounding
        // The reference derivative is a forward difference of converged predictions, with another
        // step.
        let moved = exact(&other.system, &other.plane, &window, &grid);
        let mut forward = moved.slices.clone();
        forward.half -= &prediction.slices.half;
        forward.half /= Complex::from(1e-4);
        let off = forward.relative_difference(slope);
        // The error of the forward difference is half the second derivative times 10⁻⁴, and its
        // quadrature errors do not cancel.
        assert!(off < 0.02, "{name}: {off}");
        assert!(
            slope
                .half
                .iter()
                .any(|s| s.norm() > 0.01 * prediction.slices.at_zero()),
            "{name}"
        );
    }
}

#[test]
fn rays_are_lost() {
    let system = mirror(beam([0.1, 0.1]), 0.0, [0.0; 2], [-2.0; 3]);
    let plane = after(&system, 0.1);
    let lands = |system: &PathSystem, ray| {
        let ray = system.follow(ray)?;
        plane.coordinates(&ray)
    };
    let arrives = |ray| lands(&system, ray).is_some();
    assert!(arrives([0.3, 0.0, 0.0, 0.0]));
    assert!(!arrives([0.6, 0.0, 0.0, 0.0])); // beside a sphere of radius 0.5
    let mut small = system.clone();
    small.surfaces[0].patch.aperture = 0.2;
    assert!(lands(&small, [0.3, 0.0, 0.0, 0.0]).is_none());
    // Total reflection begins at 0.73 rad.
    let glass = Specular::Refraction {
        front: 1.5,
        back: 1.0,
    };
    for (theta0, passes) in [(0.72, true), (0.74, false)] {
        let mut system = mirror(beam([0.1, 0.1]), theta0, [0.0; 2], [0.0; 3]);
        system.surfaces[0].interaction = Interaction::Specular(glass);
        assert_eq!(system.follow([0.0; 4]).is_some(), passes);
        assert_eq!(system.hits().is_some(), passes);
    }
    // The added surface is behind the light.
    let patch = placed(&Frame::IDENTITY, -1.0, 0.0, [0.0; 2], [0.0; 3]);
    let behind = PathSystem::new(
        beam([0.1, 0.1]),
        vec![element("behind", patch, Specular::Mirror)],
    );
    assert!(behind.hits().is_none());
    let dark = exact(
        &behind,
        &plane,
        &window(Profile::Hann(0.1), Profile::Hann(0.1)),
        &grid(1, [0.1; 2]),
    );
    assert!(dark.slices.half.iter().all(|s| s.norm() == 0.0));
}

/// Light passes a lens, returns from a mirror and passes the lens again.
#[test]
fn a_surface_that_is_visited_twice_changes_as_one() {
    let at = |distance| placed(&Frame::IDENTITY, distance, 0.0, [0.0; 2], [0.0; 3]);
    let lens = || element("lens", at(0.5), Specular::ThinLens { focal_length: 0.6 });
    let mirror = element("mirror", at(1.0), Specular::Mirror);
    let system = PathSystem::new(beam([0.1, 0.1]), vec![lens(), mirror, lens()]);
    let view = view(&system, &after(&system, 0.2));
    let parameters = view.parameters();
    let is_focal = |p: &&Parameter| matches!(p, Parameter::FocalLength(_));
    let focal: Vec<_> = parameters.iter().filter(is_focal).collect();
    assert_eq!(focal, [&Parameter::FocalLength(0)]);
    // The lens cannot move away from itself.
    assert!(!parameters.contains(&Parameter::Travel(1)));
    let changed = view.with(Parameter::FocalLength(0), 0.7).unwrap();
    let [first, _, last] = &changed.system.surfaces[..] else {
        panic!("three visits")
    };
    assert_eq!(first, last);
    assert_ne!(*first, lens());
}
