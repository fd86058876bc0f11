//! Tests of light scattered by a BRDF, against closed forms and quadrature.

use super::*;
use crate::RayBudget;
use crate::geometry::AffineMap;
use crate::light::LightParts;
use crate::path::{Interaction, PathChain, PathSurface, PathSystem, PreparedPath, chain};
use crate::testing::{chain_of, mask_at, opaque, window};
use crate::{Model, Observed, Operator, Parameter, Plane, Predicted, slices};
use etendue_field::{
    AngleTable, Brdf, EnvironmentMap, Frame, FrequencyAxis, Fresnel, Grating, Image, LatLong,
    Light, Lobe, Orientation, Patch, Pattern, Profile, ProjectionGrid, Quantity, Rectangle,
    Reflectance, Shape, SliceGrid, Window,
};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const DISTANCE: f64 = 1.0;

/// Predicts with two million nodes, so errors are far below the deviations that these tests
/// detect.
fn exact(system: &PathSystem, plane: &Plane, window: &Window, grid: &SliceGrid) -> Predicted {
    by(
        system,
        plane,
        window,
        grid,
        chain(&view(system, plane)).as_ref(),
    )
}

/// ‖first order − exact‖/‖exact‖ of the two predictions of a system.
fn linearised(
    system: &PathSystem,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
    chain: &PathChain,
) -> f64 {
    let right = by(system, plane, window, grid, Some(chain));
    let mut near = right.to_first_order.unwrap().slices;
    near.half += &right.slices.half;
    near.relative_difference(&right.slices)
}

fn view(system: &PathSystem, plane: &Plane) -> Observed {
    Observed {
        system: system.clone(),
        plane: *plane,
    }
}

fn by(
    system: &PathSystem,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
    chain: Option<&PathChain>,
) -> Predicted {
    let budget = RayBudget::new(2e6, 1e-4);
    let picture = ProjectionGrid::new(window, 8);
    predict(
        &view(system, plane),
        chain,
        &[],
        (window, grid, &picture),
        budget,
    )
}

fn grid([x, u]: [f64; 2]) -> SliceGrid {
    let axis = |h: f64| FrequencyAxis {
        half: 6,
        spacing: 0.5 / h,
    };
    SliceGrid {
        azimuths: 3,
        rho: axis(x),
        nu: axis(u),
    }
}

fn square(side: f64) -> Shape {
    Shape::Rectangle(Rectangle {
        center: [0.0; 2],
        size: [side; 2],
    })
}

fn white(lobe: Lobe) -> Reflectance {
    Brdf::new(lobe, 0.7, Fresnel::White).into()
}

/// Builds a surface 1 m from the light. The central ray meets the surface at the angle θ₀ in the
/// plane of X and the ray.
fn system(light: Light, theta0: f64, curvature: [f64; 3], reflectance: Reflectance) -> PathSystem {
    let d = DVec3::new(libm::sin(theta0), 0.0, -libm::cos(theta0));
    let patch = Patch {
        frame: Frame::new(DVec3::Z * DISTANCE, d, DVec3::X).unwrap(),
        curvature,
        aperture: 1.5,
    };
    let interaction = Interaction::Reflects(Box::new(reflectance));
    PathSystem::new(light, vec![PathSurface::new("surface", patch, interaction)])
}

/// A plane perpendicular to the mirrored central ray, at the distance `after` from the
/// surface.
fn across(theta0: f64, after: f64) -> Plane {
    let n = DVec3::new(libm::sin(theta0), 0.0, -libm::cos(theta0));
    let reflected = |v: DVec3| v - 2.0 * v.dot(n) * n;
    let d = reflected(DVec3::Z);
    Plane {
        frame: Frame {
            origin: DVec3::Z * DISTANCE + d * after,
            x: -reflected(DVec3::X),
            y: reflected(DVec3::Y),
            d,
        },
        orientation: Orientation::Orthogonal,
        longitude: 0.0,
        patch: None,
        side: etendue_field::Side::After,
        quantity: Quantity::Radiance,
    }
}

/// A plane on the surface, for light leaving it.
fn on(system: &PathSystem, theta0: f64, orientation: Orientation) -> Plane {
    let t = DVec3::new(-libm::cos(theta0), 0.0, -libm::sin(theta0));
    let n = system.surfaces[0].patch.frame.d;
    Plane {
        frame: Frame {
            origin: DVec3::Z * DISTANCE,
            x: t,
            y: n.cross(t),
            d: n,
        },
        orientation,
        longitude: -theta0,
        patch: Some(system.surfaces[0].patch),
        ..across(theta0, 0.0)
    }
}

fn area(side: f64) -> Light {
    Light::Area {
        shape: square(side),
        radiance: 1.0,
        exponent: 0.0,
    }
}

fn projector(width: f64) -> Light {
    Light::Projector {
        intensity: 1.0,
        image: Image {
            width: [width; 2],
            grating: None,
        },
    }
}

/// Tests a flat Lambertian surface at normal incidence behind blockers. The light that leaves the
/// surface must equal the light that a closed-form receiver reflects.
#[test]
fn flat_lambertian_surface_is_the_receiver() {
    let blocker = vec![Shape::Rectangle(Rectangle {
        center: [0.03, 0.0],
        size: [0.1, 0.15],
    })];
    let mut chain = chain_of(
        area(0.3),
        [(0.6, Some(opaque(blocker.clone()))), (0.4, None)],
    );
    chain.operators.extend([
        Operator::Cosine {
            name: "surface".into(),
        },
        Operator::Diffuse {
            name: "surface".into(),
            albedo: 0.7,
        },
        Operator::Travel {
            from: "surface".into(),
            to: "plane".into(),
            distance: 0.2,
        },
    ]);
    let window = window(Profile::Hann(0.2), Profile::Hann(0.3));
    let grid = grid([0.2, 0.3]);
    let known = slices(&chain, &window, &grid);
    let mut system = system(area(0.3), 0.0, [0.0; 3], white(Lobe::Lambertian));
    system.masks = vec![mask_at(0.6, opaque(blocker))];
    let plane = across(0.0, 0.2);
    let found = exact(&system, &plane, &window, &grid);
    let apart = found.slices.relative_difference(&known);
    // The estimated error is close to the actual error, because both are means over many
    // frequencies.
    let error = found.error.unwrap();
    let ratio = apart / error;
    assert!((0.6..1.6).contains(&ratio), "{apart:e} {error:e}");
    assert!(error < 6e-3, "{error:e}"); // the error of a million nodes
    // If the mask is removed, the prediction differs detectably.
    system.masks.clear();
    let open = exact(&system, &plane, &window, &grid);
    assert!(open.slices.relative_difference(&known) > 0.05);
}

/// Tests that the chain's maps, which are derived by finite differences, equal the corrected
/// operators of docs/theory.md, section 7.
#[test]
fn chain_is_the_product_of_operators() {
    for (theta0, k) in [
        (0.0, 0.5),
        (0.6, 0.5),
        (0.6, -0.4),
        (1.1, 0.3),
        (-0.5, -0.2),
    ] {
        let system = system(projector(0.1), theta0, [k; 3], white(Lobe::Lambertian));
        let plane = across(theta0, 0.7);
        let read = chain(&view(&system, &plane)).unwrap();
        let shape = [[k, 0.0], [0.0, k]];
        let onto = AffineMap::<4>::travel(DISTANCE)
            .then(&AffineMap::<4>::incidence(theta0))
            .then(&AffineMap::<4>::curvature(shape, theta0));
        let off = AffineMap::<4>::back(shape, -theta0)
            .then(&AffineMap::<4>::outgoing(-theta0))
            .then(&AffineMap::<4>::travel(0.7));
        // The chain's angles after the surface are relative to the central ray.
        let off = AffineMap {
            offset: off.apply([0.0, 0.0, -theta0, 0.0]),
            ..off
        };
        for (read, put) in [(&read.maps[0], onto), (&read.maps[1], off)] {
            let a = read.matrix.as_flattened().iter().chain(&read.offset);
            let b = put.matrix.as_flattened().iter().chain(&put.offset);
            let worst = a.zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // The tolerance covers a rounding error of 1e-16 divided by a step of 1e-5.
            assert!(worst < 1e-8, "{theta0} {k}: {worst:e}\n{read:?}\n{put:?}");
        }
    }
}

/// ‖first order − exact‖/‖exact‖ for neighbourhoods of several sizes e.
fn errors(
    theta0: f64,
    k: f64,
    reflectance: impl Fn(f64) -> Reflectance,
    orientation: Orientation,
) -> Vec<f64> {
    [0.2, 0.1, 0.05]
        .map(|e| {
            let system = system(projector(e), theta0, [k; 3], reflectance(e));
            let plane = match orientation {
                Orientation::Orthogonal => across(theta0, 0.4),
                _ => on(&system, theta0, orientation),
            };
            let profile = Profile::Hann(1.2 * e);
            let window = Window {
                x: profile,
                y: profile,
                u: profile,
                v: profile,
            };
            let grid = grid([1.2 * e; 2]);
            let chain = chain(&view(&system, &plane)).unwrap();
            linearised(&system, &plane, &window, &grid, &chain)
        })
        .to_vec()
}

/// A Phong lobe whose width 1/√n is proportional to the size e of the neighbourhood.
fn phong(e: f64) -> Lobe {
    Lobe::Phong {
        exponent: 1.0 / (0.25 * e * e),
    }
}

#[test]
fn first_order_is_of_its_order() {
    for (theta0, k, orientation) in [
        (0.6, 0.5, Orientation::LocalNormals),
        (0.6, 0.5, Orientation::Tangent),
        (0.6, -0.4, Orientation::Orthogonal),
        (0.0, 0.5, Orientation::Orthogonal),
    ] {
        let errors = errors(theta0, k, |e| white(phong(e)), orientation);
        let order = libm::log2(errors[1] / errors[2]);
        let due = if theta0 == 0.0 { 2.0 } else { 1.0 };
        // Three sizes are tested; the terms of higher orders are at most a quarter of the first
        // neglected term.
        assert!(
            (order - due).abs() < 0.25,
            "{theta0} {orientation:?}: {order} {errors:?}"
        );
        assert!(errors[2] < 0.06, "{errors:?}");
    }
}

/// Tests a sum of two BRDFs. Both BRDFs have factors of the angles of incidence and departure, and
/// weights whose wavelength is proportional to the size of the neighbourhood.
#[test]
fn weighted_and_separable_brdfs_are_of_first_order() {
    let table = |values: [f64; 2]| {
        Some(AngleTable {
            values: values.into(),
        })
    };
    let sum = |e: f64| {
        let one = Brdf {
            incoming: table([1.0, 0.1]),
            outgoing: table([0.2, 1.0]),
            ..Brdf::new(phong(e), 1.0, Fresnel::White)
        };
        let zero = Brdf::new(phong(2.0 * e), 0.8, Fresnel::Dielectric { index: 1.5 });
        let grating = Grating {
            axis: 0,
            frequency: 0.5 / e,
            modulation: 0.9,
            phase: 0.4,
        };
        Reflectance::blend(one, zero, Pattern::Cosine(grating))
    };
    for orientation in [Orientation::LocalNormals, Orientation::Orthogonal] {
        let errors = errors(0.6, 0.5, sum, orientation);
        let order = libm::log2(errors[1] / errors[2]);
        // As above.
        assert!(
            (order - 1.0).abs() < 0.25,
            "{orientation:?}: {order} {errors:?}"
        );
        assert!(errors[2] < 0.06, "{errors:?}");
    }
}

/// Tests that three wrong chains have larger errors than the correct chain. The first chain has a
/// lobe around the normal, the second has no cosine, and the third has an exponent that is wrong by
/// 5 %.
#[test]
fn wrong_operators_are_seen() {
    let theta0 = 0.6;
    let e = 0.05;
    let system = system(projector(e), theta0, [0.5; 3], white(phong(e)));
    let plane = across(theta0, 0.4);
    let profile = Profile::Hann(1.2 * e);
    let window = Window {
        x: profile,
        y: profile,
        u: profile,
        v: profile,
    };
    let grid = grid([1.2 * e; 2]);
    let right = exact(&system, &plane, &window, &grid);
    let sound = chain(&view(&system, &plane)).unwrap();
    let error =
        |system: &PathSystem, chain: &PathChain| linearised(system, &plane, &window, &grid, chain);
    let least = error(&system, &sound);
    let mut turned = sound.clone();
    // In this wrong chain the central ray arrives along the normal, so the cosine is 1 and the
    // mirror direction is the normal.
    turned.maps[0].offset[2] = 0.0;
    assert!(error(&system, &turned) > 5.0 * least);
    let mut sheared = sound;
    sheared.maps[0].matrix[2][0] *= -1.0;
    assert!(error(&system, &sheared) > 3.0 * least);
    let exact_error = |other: &PathSystem| {
        exact(other, &plane, &window, &grid)
            .slices
            .relative_difference(&right.slices)
    };
    let sharper = view(&system, &plane)
        .with(Parameter::Lobe, 1.05 / (0.25 * e * e))
        .unwrap()
        .system;
    assert!(exact_error(&sharper) > 0.005);
}

/// The irradiance ∫ L cos⁺ dω of a spherical Gaussian on a surface whose normal is at the
/// angle γ from the Gaussian's centre. The convolution with the clamped cosine is computed as a
/// product of spherical-harmonic coefficients (Ramamoorthi and Hanrahan 2001; in 2D, section 6.1
/// of Durand et al. 2005).
fn harmonic_irradiance(width: f64, gamma: f64) -> f64 {
    let squared = width * width;
    let legendre = |l: i32, x: f64| {
        let (mut before, mut value) = (1.0, x);
        if l == 0 {
            return 1.0;
        }
        for j in 2..=l {
            let j = f64::from(j);
            (before, value) = (
                value,
                ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j,
            );
        }
        value
    };
    let mut factorials = 1.0; // l!/(2^l ((l/2)!)²), for even l
    let mut sum = 0.0;
    for l in 0..=60 {
        let cosine = if l == 0 {
            PI
        } else if l == 1 {
            TAU / 3.0
        } else if l % 2 == 1 {
            continue;
        } else {
            factorials *= f64::from(l - 1) / f64::from(l);
            let sign = if l % 4 == 2 { 1.0 } else { -1.0 };
            TAU * sign * factorials / f64::from((l + 2) * (l - 1))
        };
        let light = TAU
            * crate::quadrature::integrate(200, [-1.0, 1.0], |x| {
                libm::exp((x - 1.0) / squared) * legendre(l, x)
            });
        sum += f64::from(2 * l + 1) / (2.0 * TAU) * light * cosine * legendre(l, libm::cos(gamma));
    }
    sum
}

#[test]
fn diffuse_sphere_under_an_environment_is_the_known_product() {
    let width = 0.25;
    let from = DVec3::new(0.2, 0.1, -1.0).normalize();
    let lobe = etendue_field::SphericalGaussian {
        from,
        radiance: 1.0,
        width,
    };
    let under = |map: EnvironmentMap| {
        let frame = Frame::IDENTITY;
        let environment = etendue_field::Environment { frame, map };
        let light = Light::Environment { environment };
        system(light, 0.0, [0.8; 3], white(Lobe::Lambertian))
    };
    let on_it = |system: &PathSystem| Plane {
        longitude: 0.0,
        ..on(system, 0.0, Orientation::LocalNormals)
    };
    let map = |[w, h]: [usize; 2]| {
        let map = LatLong::from_fn(w, h, |from| lobe.radiance_from(from));
        EnvironmentMap::LatLong(Arc::new(map))
    };
    for (map, most) in [
        // The tolerance is the error of a net of 2¹⁸ points.
        (EnvironmentMap::Lobes(vec![lobe]), 1e-5),
        // The tolerance is the error of the net plus the error (1/40)²/24 that kinks between pixels
        // cause. Pixels are 0.006 rad apart, and the lobe has a width of 0.25.
        (map([1024, 512]), 1e-4),
        // The map is interpolated bilinearly between pixel centres 0.03 rad apart, which causes an
        // error of (1/8)²/12 of the lobe's curvature.
        (map([200, 100]), 4e-4),
    ] {
        let system = under(map);
        let plane = on_it(&system);
        let path = PreparedPath::new(&system);
        for [s, t] in [[0.0, 0.0], [0.3, -0.1], [-0.4, 0.2]] {
            let leaving = system.leaving(&plane, [s, t, 0.1, 0.0]).unwrap();
            let parts = LightParts::new(&system.light, leaving.normal);
            let lights = draw::Lights::new(&system, parts, draw::LightStrategy::default());
            let mut net = crate::nets::NetPoints::new(1, 6);
            let count = 1 << 18;
            let points = (0..count).filter_map(|_| {
                let [a, b, ..] = net.point();
                let (part, density) = lights.draw(&leaving, [a, b])?;
                Some(path.radiance(&leaving, part, &mut path.at_mask()) / density)
            });
            let radiance = points.sum::<f64>() / f64::from(count);
            let gamma = libm::acos(leaving.normal.dot(from));
            let expected = 0.7 / PI * harmonic_irradiance(width, gamma);
            let off = (radiance / expected - 1.0).abs();
            assert!(off < most, "{off:e} at {s} {t}");
        }
    }
    let system = under(EnvironmentMap::Lobes(vec![lobe]));
    let plane = on_it(&system);
    // If the environment is rotated by one pixel of 256, the result differs detectably.
    assert!(
        (harmonic_irradiance(width, 0.3) / harmonic_irradiance(width, 0.3 + TAU / 256.0) - 1.0)
            > 1e-3
    );
    // The first-order chain is exact for these surfaces except the sphere.
    let window = window(Profile::Hann(0.1), Profile::Hann(0.4));
    let grid = grid([0.1, 0.4]);
    let chain = chain(&view(&system, &plane)).unwrap();
    let error = linearised(&system, &plane, &window, &grid, &chain);
    // The chain neglects terms (k s)³ = 0.08³ and the interaction of tilts about both axes.
    assert!(error < 3e-3, "{error}");
}
