//! Tests of light from an environment: on surfaces, past masks, and behind mirrors and glass.

use super::super::draw::{RaySampler, RayStrategy};
use super::super::region::neighbourhood;
use super::*;
use crate::light::emitted;
use crate::nets::{DIMENSIONS, NetPoints};
use crate::testing::mask_at;
use etendue_field::{
    Environment, EnvironmentMap, Grating, LatLong, Mask, SphericalGaussian, TwoPlane,
};
use std::sync::Arc;

/// Relative error allowed for nets of two million rays, for frequencies up to four cycles over a
/// window along all coordinates.
const OF_NETS: f64 = 5e-3;
/// Number of points of a midpoint rule along each coordinate of a plane; they suffice because the
/// spectrum falls to 10⁻⁴ within five cycles over the window.
const NODES: u32 = 30;

const WINDOW: [Profile; 2] = [Profile::Hann(0.3), Profile::Hann(0.7)];
/// Radius of the sphere, metres.
const RADIUS: f64 = 0.9;

/// Builds an environment of two lobes in axes that are turned about the central ray; one lobe is
/// not centred on this ray.
fn lobes() -> Environment {
    let lobe = |from: DVec3, width, radiance| SphericalGaussian {
        from: from.normalize(),
        radiance,
        width,
    };
    let all = vec![
        lobe(DVec3::new(0.2, 0.1, 1.0), 0.2, 3.0),
        lobe(DVec3::new(-0.4, 0.3, 1.0), 0.3, 1.0),
    ];
    Environment {
        frame: Frame::new(DVec3::ZERO, -DVec3::Z, DVec3::new(0.3, 1.0, 0.0)).unwrap(),
        map: EnvironmentMap::Lobes(all),
    }
}

/// Builds an environment map that has approximately the same radiance as the two lobes.
fn map() -> Environment {
    let Environment { frame, map } = lobes();
    let picture = LatLong::from_fn(256, 128, |from| map.radiance(from));
    Environment {
        frame,
        map: EnvironmentMap::LatLong(Arc::new(picture)),
    }
}

fn under(environment: &Environment, elements: Vec<PathSurface>) -> PathSystem {
    let environment = environment.clone();
    PathSystem::new(Light::Environment { environment }, elements)
}

/// Builds a plane for arriving light on a sphere 1 m from the light; the angle `tilt` is between
/// the sphere's normal and the central ray.
fn on_sphere(tilt: f64, orientation: Orientation, quantity: Quantity) -> Plane {
    let patch = placed(&Frame::IDENTITY, 1.0, tilt, [0.0; 2], [1.0 / RADIUS; 3]);
    let incidence = Incidence::new(&Frame::IDENTITY.travelled(1.0), patch.frame.d);
    let is_local = orientation != Orientation::Tangent;
    let turned = if orientation == Orientation::Mirrored {
        -1.0
    } else {
        1.0
    };
    Plane {
        frame: Frame {
            origin: patch.frame.origin,
            x: incidence.t,
            y: incidence.b,
            d: incidence.n,
        },
        orientation,
        longitude: turned * incidence.theta0,
        patch: is_local.then_some(patch),
        side: etendue_field::Side::Before,
        quantity,
    }
}

/// Computes the light that arrives on a sphere directly from the definition. The normal is the
/// position divided by the radius, and directions are relative to this normal. `sign` is −1 for the
/// curvature of a concave sphere, and `cosine` is the exponent of the cosine factor.
fn on_sphere_by_hand(environment: &Environment, plane: &Plane, sign: f64, z: [f64; 4]) -> f64 {
    let [x, y, u, v] = z;
    let [s, t] = if plane.patch.is_some() {
        [x, y].map(|p| sign * p / RADIUS)
    } else {
        [0.0; 2]
    };
    let up = (1.0 - s * s - t * t).sqrt();
    let normal = plane.frame.vector_to_world(DVec3::new(s, t, up));
    let turned = if plane.orientation == Orientation::Mirrored {
        -1.0
    } else {
        1.0
    };
    let [theta, phi] = [turned * (u + plane.longitude), turned * v];
    let ((a, b), (c, d)) = (theta.sin_cos(), phi.sin_cos());
    let from = plane
        .frame
        .turned_to(normal)
        .vector_to_world(DVec3::new(d * a, c, d * b));
    let cosine = match plane.quantity {
        Quantity::Radiance => 1.0,
        Quantity::DifferentialIrradiance => b * d * d,
    };
    let arrives = from.z < 0.0 && b * d > 0.0;
    if arrives {
        environment.radiance(-from) * cosine / up
    } else {
        0.0
    }
}

/// Computes the windowed spectrum of a light field by a midpoint rule over the window.
fn by_rule(radiance: &dyn Fn([f64; 4]) -> f64, window: &Window, grid: &SliceGrid) -> Slices {
    let halves = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
    let nodes: u32 = NODES.pow(4);
    let at = |i: u32, axis: usize| {
        let digit = f64::from(i / NODES.pow(u32::try_from(axis).unwrap()) % NODES);
        halves[axis] * ((2.0 * digit + 1.0) / f64::from(NODES) - 1.0)
    };
    let volume: f64 = halves.iter().map(|h| 2.0 * h / f64::from(NODES)).product();
    let transform = etendue_transform::SliceTransform::new(grid);
    let mut sum = transform.accumulator();
    for i in 0..nodes {
        let [x, y, u, v] = std::array::from_fn(|axis| at(i, axis));
        let ray = TwoPlane { x, y, u, v };
        let weight = volume * window.value(&ray) * radiance([x, y, u, v]);
        if weight > 0.0 {
            sum.deposit(&ray, weight);
        }
    }
    sum.finish(1.0)
}

/// Tests all quantities that a plane may record on a sphere, at normal and oblique incidence, for
/// lobes and for an environment map. Predictions with the curvature of a concave sphere, without
/// the cosine or with a wrong rotation differ from the correct one.
#[test]
fn the_sky_on_a_sphere() {
    let (window, grid) = (window(WINDOW[0], WINDOW[1]), grid(3, [0.3, 0.7]));
    let irradiance = Quantity::DifferentialIrradiance;
    let cases = [
        (0.0, Orientation::Tangent, Quantity::Radiance, lobes()),
        (0.0, Orientation::LocalNormals, irradiance, lobes()),
        (0.5, Orientation::LocalNormals, Quantity::Radiance, map()),
        (-0.4, Orientation::Mirrored, irradiance, lobes()),
    ];
    for (tilt, orientation, quantity, environment) in cases {
        let plane = on_sphere(tilt, orientation, quantity);
        let found = exact(&under(&environment, vec![]), &plane, &window, &grid);
        let off = |plane: &Plane, sign: f64| {
            let radiance = |z| on_sphere_by_hand(&environment, plane, sign, z);
            found
                .slices
                .relative_difference(&by_rule(&radiance, &window, &grid))
        };
        let right = off(&plane, 1.0);
        let stated = found.error.unwrap();
        // The prediction's stated error is a standard error; the relative difference over hundreds
        // of frequencies rarely exceeds it.
        assert!(
            stated < OF_NETS && right < 1.5 * stated,
            "{orientation:?}: {right:e}, {:?}",
            found.error
        );
        let other = match quantity {
            Quantity::Radiance => irradiance,
            Quantity::DifferentialIrradiance => Quantity::Radiance,
        };
        let mut turned = plane.frame;
        (turned.x, turned.y) = (-turned.x, -turned.y);
        let wrong = [
            off(
                &Plane {
                    quantity: other,
                    ..plane
                },
                1.0,
            ),
            off(
                &Plane {
                    frame: turned,
                    ..plane
                },
                1.0,
            ),
        ];
        let hollow = off(&plane, -1.0);
        assert!(wrong.iter().all(|off| *off > 0.05), "{wrong:?}");
        assert!(plane.patch.is_none() || hollow > 0.05, "{hollow}");
    }
}

/// Tests an environment's light that has passed a grating, on a plane with slopes and on an
/// oblique surface.
#[test]
fn the_sky_past_a_grating() {
    let (window, grid) = (window(WINDOW[0], Profile::Hann(0.5)), grid(2, [0.3, 0.5]));
    let environment = lobes();
    let grating = Grating {
        axis: 0,
        frequency: 3.0,
        modulation: 0.9,
        phase: 0.4,
    };
    let mut system = under(&environment, vec![]);
    system.masks = vec![mask_at(0.4, Mask::Grating(grating))];
    let tangent = on_sphere(0.3, Orientation::Tangent, Quantity::Radiance);
    for plane in [after(&system, 1.0), tangent] {
        let found = exact(&system, &plane, &window, &grid);
        let off = |distance_to: f64| {
            let radiance = |z: [f64; 4]| {
                let (ray, _) = plane.ray(z).unwrap();
                let along = (distance_to - ray.point.z) / ray.direction.z;
                let at = ray.point + along * ray.direction;
                let passes = grating.transmittance(at.x, at.y);
                passes * environment.radiance(ray.direction)
            };
            found
                .slices
                .relative_difference(&by_rule(&radiance, &window, &grid))
        };
        assert!(off(0.4) < OF_NETS, "{}", off(0.4));
        let beside = off(0.5);
        assert!(beside > 0.05, "{beside}");
    }
}

/// Tests that a flat mirror reverses directions, and that glass multiplies radiance by n².
#[test]
fn the_sky_behind_a_mirror_and_in_glass() {
    let (window, grid) = (window(WINDOW[0], Profile::Hann(0.5)), grid(2, [0.3, 0.5]));
    let environment = lobes();
    let glass = Specular::Refraction {
        front: 1.0,
        back: 1.5,
    };
    for (event, tilt) in [(Specular::Mirror, 0.7), (glass, 0.0)] {
        let patch = placed(&Frame::IDENTITY, 1.0, tilt, [0.0; 2], [0.0; 3]);
        let system = under(&environment, vec![element("flat", patch, event)]);
        let plane = after(&system, 0.3);
        let found = exact(&system, &plane, &window, &grid);
        let normal = patch.frame.d;
        let radiance = |[_, _, u, v]: [f64; 4]| {
            let along = plane
                .frame
                .vector_to_world(DVec3::new(u, v, 1.0).normalize());
            let (before, factor) = match event {
                Specular::Mirror => (along - 2.0 * along.dot(normal) * normal, 1.0),
                _ => {
                    let across = 1.5 * (along - along.dot(normal) * normal);
                    let left = 1.0 - across.length_squared();
                    let forward = left.max(0.0).sqrt();
                    (
                        across - forward * normal,
                        if left > 0.0 { 2.25 } else { 0.0 },
                    )
                }
            };
            let shines = before.z > 0.0 && before.dot(normal) < 0.0;
            if shines {
                factor * environment.radiance(before)
            } else {
                0.0
            }
        };
        let off = found
            .slices
            .relative_difference(&by_rule(&radiance, &window, &grid));
        assert!(off < OF_NETS, "{event:?}: {off}");
        let unturned = |[_, _, u, v]: [f64; 4]| environment.radiance(DVec3::new(u, v, 1.0));
        let wrong = found
            .slices
            .relative_difference(&by_rule(&unturned, &window, &grid));
        assert!(wrong > 0.1, "{event:?}: {wrong}");
    }
}

/// Tests that all sampling strategies give the same light, which requires correct densities.
#[test]
fn all_ways_to_draw_the_sky_agree() {
    let window = window(WINDOW[0], Profile::Hann(0.5));
    let environment = lobes();
    let tilted = placed(&Frame::IDENTITY, 1.0, 0.4, [0.3, 0.0], [0.4; 3]);
    let mirror = under(
        &environment,
        vec![element("mirror", tilted, Specular::Mirror)],
    );
    let plain = under(&environment, vec![]);
    let local = on_sphere(0.4, Orientation::LocalNormals, Quantity::Radiance);
    // The plane is on a small sphere that is seen from the side. Some rays within the window also
    // meet the sphere from behind.
    let mut aside = on_sphere(0.9, Orientation::LocalNormals, Quantity::Radiance);
    if let Some(patch) = &mut aside.patch {
        patch.curvature = [2.5; 3];
    }
    let cases = [
        (&plain, after(&plain, 1.0)),
        // The plane is at the light itself, displaced by about the rounding error of a tilted
        // scene.
        (&plain, after(&plain, -1e-16)),
        (&plain, local),
        (&plain, aside),
        (&mirror, after(&mirror, 0.4)),
    ];
    for (system, plane) in cases {
        let lands = neighbourhood(system, &plane).unwrap();
        let drawn = |strategy: RayStrategy| {
            let draw = RaySampler::new((system, Some(&plane)), &window, &lands, strategy)?;
            let mut net = NetPoints::new(3, DIMENSIONS);
            let count = 1 << 18;
            let weight = |(ray, density): ([f64; 4], f64)| {
                let arrives = system.follow(ray)?;
                let ([x, y, u, v], per_flux) = plane.coordinates(&arrives)?;
                let seen = window.value(&TwoPlane { x, y, u, v });
                Some(emitted(&system.light, ray) * per_flux * seen / density)
            };
            let rays = (0..count).filter_map(|_| draw.draw(&net.point()).and_then(weight));
            Some(rays.sum::<f64>() / f64::from(count))
        };
        let found: Vec<f64> = RayStrategy::ALL.into_iter().filter_map(drawn).collect();
        assert!(found.len() > 1, "{plane:?}");
        for other in &found[1..] {
            let off = other / found[0] - 1.0;
            // The tolerance is for nets of 2¹⁸ rays, sampled in four coordinates.
            assert!(off.abs() < 5e-3, "{found:?}");
        }
    }
}

/// Tests a statement of section 6.1 of Durand et al. 2005. On a surface of curvature k, the
/// spectrum of an environment's light is near the line Ωx = k Ωθ, and the spectrum of light from a
/// single direction is exactly on this line.
#[test]
fn curvature_shears_the_sky_onto_a_line() {
    let narrow = SphericalGaussian {
        from: DVec3::Z,
        radiance: 1.0,
        width: 0.02,
    };
    let environment = Environment {
        frame: Frame::new(DVec3::ZERO, -DVec3::Z, DVec3::Y).unwrap(),
        map: EnvironmentMap::Lobes(vec![narrow]),
    };
    let (window, grid) = (window(WINDOW[0], WINDOW[1]), grid(1, [0.3, 0.7]));
    let plane = on_sphere(0.0, Orientation::LocalNormals, Quantity::Radiance);
    let found = exact(&under(&environment, vec![]), &plane, &window, &grid);
    // The quotient Σ P ρ ν / Σ P ν² is k if all power P is on the line ρ = k ν; the window widens
    // this line along ρ only.
    let full = found.slices.full();
    let (mut cross, mut own) = (0.0, 0.0);
    for (m, rho) in grid.rho.values().into_iter().enumerate() {
        for (n, nu) in grid.nu.values().into_iter().enumerate() {
            let power = full[[0, m, n]].norm_sqr();
            cross += power * rho * nu;
            own += power * nu * nu;
        }
    }
    let slope = cross / own;
    assert!((slope * RADIUS - 1.0).abs() < 0.1, "{slope}");
}
