//! Tests of light that several surfaces reflect in turn, against other predictions and separate
//! sums.

use super::*;
use crate::model::Over;
use crate::obstacle::{Obstacle, ObstacleForm};
use crate::path::{Interaction, PathSurface, PathSystem, chain, defect};
use crate::testing::{mask_at, window};
use crate::{Model, Observed, Parameter, Plane, Predicted, RayBudget};
use etendue_field::{
    Brdf, Environment, EnvironmentMap, Frame, FrequencyAxis, Fresnel, HalfPlane, Image, LatLong,
    Light, Lobe, Mask, Orientation, Patch, Profile, ProjectionGrid, Rectangle, Reflectance, Shape,
    SliceGrid, Specular, SphericalGaussian, Window,
};
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::sync::Arc;

const BUDGET: RayBudget = RayBudget::new(2e6, 1e-4);

/// Predicts the light at a plane by paths from the light, for any number of surfaces.
fn predicted(system: &PathSystem, plane: &Plane, window: &Window) -> Predicted {
    predicted_over(BUDGET, system, plane, window)
}

fn predicted_over(
    budget: RayBudget,
    system: &PathSystem,
    plane: &Plane,
    window: &Window,
) -> Predicted {
    summed(system, plane, window, |view, over| {
        predict(view, &[], over, budget)
    })
}

/// Predicts the light at a plane behind one surface by rays that start at the plane.
fn by_plane(system: &PathSystem, plane: &Plane, window: &Window) -> Predicted {
    summed(system, plane, window, |view, over| {
        view.predict(&[], over, BUDGET)
    })
}

fn summed(
    system: &PathSystem,
    plane: &Plane,
    window: &Window,
    predict: impl Fn(&Observed, Over<'_>) -> Predicted,
) -> Predicted {
    let [x, u] = [window.x, window.u].map(|profile| profile.half_width());
    let axis = |half: f64| FrequencyAxis {
        half: 6,
        spacing: 0.5 / half,
    };
    let grid = SliceGrid {
        azimuths: 3,
        rho: axis(x),
        nu: axis(u),
    };
    let view = Observed {
        system: system.clone(),
        plane: *plane,
    };
    let picture = ProjectionGrid::new(window, 8);
    predict(&view, (window, &grid, &picture))
}

fn lamp(side: f64) -> Light {
    Light::Area {
        shape: Shape::Rectangle(Rectangle {
            center: [0.0; 2],
            size: [side; 2],
        }),
        radiance: 1.0,
        exponent: 0.0,
    }
}

/// An environment of two lobes beside the central ray, or a map of nearly the same
/// radiance. `y` is −1 for the mirror image of the environment, and 1 otherwise.
fn sky(as_map: bool, y: f64) -> Light {
    let lobe = |from: DVec3, width, radiance| SphericalGaussian {
        from: from.normalize(),
        radiance,
        width,
    };
    let lobes = EnvironmentMap::Lobes(vec![
        lobe(DVec3::new(0.2, 0.2 * y, 1.0), 0.1, 5.0),
        lobe(DVec3::new(0.4, 0.4 * y, 1.0), 0.2, 1.0),
    ]);
    let map = match as_map {
        true => EnvironmentMap::LatLong(Arc::new(LatLong::from_fn(256, 128, |from| {
            lobes.radiance(from)
        }))),
        false => lobes,
    };
    let frame = Frame::new(DVec3::ZERO, -DVec3::Z, DVec3::X).unwrap();
    let environment = Environment { frame, map };
    Light::Environment { environment }
}

fn reflectance(lobe: Lobe) -> Reflectance {
    Brdf::new(lobe, 0.7, Fresnel::White).into()
}

/// A patch around a point; the patch faces a direction in the plane of X and Z.
fn patch(at: DVec3, facing: DVec3, curvature: f64) -> Patch {
    Patch {
        frame: Frame::new(at, facing.normalize(), DVec3::Y).unwrap(),
        curvature: [curvature; 3],
        aperture: 0.6,
    }
}

fn surface(patch: Patch, interaction: Interaction) -> PathSurface {
    // Surfaces with the same name are visits of one surface.
    PathSurface::new(&patch.frame.origin.to_string(), patch, interaction)
}

/// A plane through a point, perpendicular to a ray.
fn across(origin: DVec3, d: DVec3, x: DVec3) -> Plane {
    Plane::orthogonal(Frame::new(origin, d, x).unwrap())
}

/// The difference between two predictions in units of their errors.
fn apart(a: &Predicted, b: &Predicted) -> f64 {
    let error = libm::hypot(a.error.unwrap(), b.error.unwrap());
    a.slices.relative_difference(&b.slices) / error
}

/// Maximum permitted difference between two predictions, in units of their errors. The mean over
/// all frequencies of a grid exceeds 1.3 in one of a thousand tests.
const CLOSE: f64 = 1.3;

/// Tests that for a single surface, the sum over paths from the light equals the prediction of the
/// module `scattering`, which samples rays at the plane and follows them back to the light.
#[test]
fn one_surface_is_that_of_scattering() {
    let normal = DVec3::new(FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2);
    let plane = across(DVec3::new(0.5, 0.0, 1.0), DVec3::X, DVec3::NEG_Z);
    let window = window(Profile::Hann(0.1), Profile::Hann(0.15));
    for (light, lobe, curvature) in [
        (lamp(0.2), Lobe::Lambertian, 0.4),
        (lamp(0.2), Lobe::Ggx { roughness: 0.2 }, 0.0),
        (lamp(0.2), Lobe::Phong { exponent: 300.0 }, -0.3),
        (sky(false, 1.0), Lobe::Lambertian, 0.4),
        (sky(false, 1.0), Lobe::Ggx { roughness: 0.2 }, 0.0),
        (sky(true, 1.0), Lobe::Phong { exponent: 300.0 }, -0.3),
    ] {
        let patch = patch(DVec3::Z, normal, curvature);
        let mask = Mask::Opaque {
            shapes: vec![],
            half_planes: vec![HalfPlane {
                axis: 0,
                edge: 0.02,
                above: true,
            }],
        };
        let interaction = Interaction::Reflects(Box::new(reflectance(lobe)));
        let is_sky = matches!(light, Light::Environment { .. });
        let mut system = PathSystem::new(light, vec![surface(patch, interaction)]);
        system.masks.push(mask_at(0.5, mask));
        let [one, other] = [by_plane, predicted].map(|by| by(&system, &plane, &window));
        // These are the errors of 2·10⁶ paths; the error for a sky is larger, because the sky has a
        // narrow lobe.
        let most = if is_sky { 0.04 } else { 0.02 };
        assert!(other.error.unwrap() < most, "{lobe:?} {:?}", other.error);
        let off = apart(&one, &other);
        assert!(off < CLOSE, "{lobe:?} {off}");
        // The chain of `scattering` parametrises the directions of a sky at the surface, and this
        // chain parametrises them at the light.
        if is_sky {
            continue;
        }
        // The chains differ only in the points where rays meet the mask.
        let [one, other] = [one, other].map(|found| {
            let size = found.slices.at_zero();
            found.to_first_order.unwrap().slices.at_zero() / size
        });
        assert!((one - other).abs() < 0.02, "{lobe:?} {one} {other}"); // noise of derivatives' nets
    }
}

/// Tests that rays from a wide surface find a narrow window close to it, in the air and on another
/// surface. If the rays are aimed by angles, the errors are above 0.2.
#[test]
fn rays_of_a_wide_surface_find_a_narrow_window() {
    let normal = DVec3::new(FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2);
    let floor = patch(DVec3::Z, normal, 0.0);
    let at = DVec3::new(0.5, 0.0, 1.0);
    let in_air = across(at, DVec3::X, DVec3::NEG_Z);
    let window = window(Profile::Hann(1e-4), Profile::Hann(0.15));
    let diffuse = || Interaction::Reflects(Box::new(reflectance(Lobe::Lambertian)));
    let mut system = PathSystem::new(lamp(0.2), vec![surface(floor, diffuse())]);
    let by_plane = by_plane(&system, &in_air, &window);
    let by_path = predicted(&system, &in_air, &window);
    let off = apart(&by_plane, &by_path);
    assert!(off < CLOSE, "{off}");
    let card = patch(at, DVec3::NEG_X, 0.3);
    system.surfaces.push(surface(card, diffuse()));
    let on_card = Plane {
        orientation: Orientation::LocalNormals,
        patch: Some(card),
        side: etendue_field::Side::Before,
        ..Plane::orthogonal(card.frame)
    };
    let arriving = predicted(&system, &on_card, &window);
    for found in [&by_path, &arriving] {
        let stated = found.error.unwrap();
        assert!(stated < 0.01, "{stated}"); // 2·10⁶ paths
    }
    // An angle differs from its slope by at most 0.8 % in this window.
    let ratio = arriving.slices.at_zero() / by_path.slices.at_zero();
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

/// Tests flat mirrors before and behind a surface. The prediction must not change if the mirrors
/// are removed and the light and the plane are moved to their mirror images.
#[test]
fn flat_mirrors_unfold() {
    let mirror = || Interaction::Specular(Specular::Mirror);
    let gloss = || Interaction::Reflects(Box::new(reflectance(Lobe::Ggx { roughness: 0.3 })));
    let (x, z) = (DVec3::X, DVec3::Z);
    let window = window(Profile::Hann(0.1), Profile::Hann(0.15));
    // The legs of the path run along Z, X, −Z with the mirror, and along Z, Z, −X without it.
    let before = patch(z, x - z, 0.0);
    let at = z + x;
    let gloss_after = surface(patch(at, -x - z, 0.0), gloss());
    let mut wide = before;
    wide.aperture = 20.0; // light of a sky reaches the edge of the mirror
    // The mirror exchanges Z and X, which reverses the y axis of a plane.
    let skies = [sky(false, 1.0), sky(false, -1.0)];
    for ([light, mirrored], before) in [([lamp(0.2), lamp(0.2)], before), (skies, wide)] {
        let folded = vec![surface(before, mirror()), gloss_after.clone()];
        let folded = PathSystem::new(light, folded);
        let plane = across(at - 0.5 * z, -z, x);
        let found = predicted(&folded, &plane, &window);
        let straight = surface(patch(2.0 * z, -x - z, 0.0), gloss());
        let plane = across(2.0 * z - 0.5 * x, -x, z);
        let wanted = predicted(&PathSystem::new(mirrored, vec![straight]), &plane, &window);
        let off = apart(&found, &wanted);
        assert!(off < CLOSE, "before: {off}");
    }

    let first = || surface(patch(z, x - z, 0.0), gloss());
    let folded = PathSystem::new(
        lamp(0.2),
        vec![first(), surface(patch(at, -x - z, 0.0), mirror())],
    );
    let found = predicted(&folded, &across(at - 0.5 * z, -z, x), &window);
    let straight = PathSystem::new(lamp(0.2), vec![first()]);
    let wanted = predicted(&straight, &across(at + 0.5 * x, x, -z), &window);
    let off = apart(&found, &wanted);
    assert!(off < CLOSE, "behind: {off}");
}

/// Compares the radiance of a floor with a sum over a diffuse wall. A projector lights the wall,
/// and the wall lights the floor.
#[test]
fn two_diffuse_surfaces_are_a_sum_over_the_first() {
    let (x, z) = (DVec3::X, DVec3::Z);
    let image = Image {
        width: [0.3; 2],
        grating: None,
    };
    let light = Light::Projector {
        intensity: 1.0,
        image,
    };
    let diffuse = |albedo| Interaction::Diffuse { albedo };
    let (wall, floor) = (patch(z, x - z, 0.0), patch(z + x, -x, 0.0));
    let both = vec![surface(wall, diffuse(0.8)), surface(floor, diffuse(0.5))];
    let system = PathSystem::new(light.clone(), both);
    let small = 0.002;
    let tiny = window(Profile::Box(small), Profile::Box(small));
    let plane = across(z + 0.9 * x, -x, DVec3::Y);
    let budget = RayBudget {
        nodes: 8.0 * BUDGET.nodes,
        ..BUDGET
    };
    let found = predicted_over(budget, &system, &plane, &tiny);
    let n = 400;
    let side = 1.2 / f64::from(n);
    let mut irradiance = 0.0;
    let floor_at = floor.frame.origin;
    for (i, j) in (0..n * n).map(|k| (k / n, k % n)) {
        let [s, t] = [i, j].map(|i| (f64::from(i) + 0.5) * side - 0.6);
        if libm::hypot(s, t) > 0.6 {
            continue;
        }
        let at = wall.frame.to_world(DVec3::new(s, t, 0.0));
        let from_light = at.normalize();
        let intensity = match light {
            Light::Projector { image, .. } if at.z > 0.0 => image.value(at.x / at.z, at.y / at.z),
            _ => 0.0,
        };
        let lit = intensity * -wall.frame.d.dot(from_light) / at.length_squared();
        let to_floor = floor_at - at;
        let cosines =
            to_floor.normalize().dot(wall.frame.d) * -to_floor.normalize().dot(floor.frame.d);
        irradiance += 0.8 / PI * lit * cosines / to_floor.length_squared() * side * side;
    }
    let wanted = 0.5 / PI * irradiance * (2.0 * small).powi(4);
    let off = found.slices.at_zero() / wanted - 1.0;
    // The tolerance is four standard errors of the paths (7·10⁻⁴), plus the error of representing
    // the round edge of the wall by squares of 3 mm.
    assert!(off.abs() < 3e-3, "{off:e} {:?}", found.error);
}

/// Tests that paths in a corner have bounded weights, although the next surface may be arbitrarily
/// near. The stated error of the sum over paths must be correct and as small as without a corner.
#[test]
fn a_corner_has_no_heavy_paths() {
    let (x, z) = (DVec3::X, DVec3::Z);
    let gloss = Interaction::Reflects(Box::new(reflectance(Lobe::Beckmann { roughness: 0.06 })));
    // The wall stands on the floor, 0.1 m from the point where the central ray meets the floor.
    let (floor, wall) = (patch(z, x - z, 0.0), patch(z + 0.1 * x, -x, 0.0));
    let light = lamp(0.2);
    let both = vec![
        surface(floor, gloss),
        surface(wall, Interaction::Diffuse { albedo: 0.8 }),
    ];
    let system = PathSystem::new(light, both);
    let away = (-x - z).normalize();
    let plane = across(z + 0.1 * x + 0.2 * away, away, DVec3::Y);
    let window = window(Profile::Hann(0.1), Profile::Hann(0.15));
    let found = predicted(&system, &plane, &window);
    let stated = found.error.unwrap();
    assert!(stated < 0.02, "{stated}"); // 2·10⁶ paths; 0.038 if all are aimed at positions
}

/// Tests that light is blocked by occluders between two surfaces, and by surfaces of the path.
#[test]
fn surfaces_and_masks_hide_later_legs() {
    let (x, z) = (DVec3::X, DVec3::Z);
    let diffuse = || Interaction::Diffuse { albedo: 0.5 };
    let (wall, floor) = (patch(z, x - z, 0.0), patch(z + x, -x, 0.0));
    let mut open = PathSystem::new(
        lamp(0.2),
        vec![surface(wall, diffuse()), surface(floor, diffuse())],
    );
    let plane = across(z + 0.9 * x, -x, DVec3::Y);
    let window = window(Profile::Hann(0.1), Profile::Hann(0.15));
    let whole = predicted(&open, &plane, &window).slices.at_zero();
    let mut card = patch(z + 0.5 * x, x, 0.0);
    card.aperture = 0.2;
    open.surfaces.push(surface(card, diffuse()));
    let hidden = predicted(&open, &plane, &window).slices.at_zero();
    open.surfaces.pop();
    open.obstacles.push(Obstacle {
        name: "card".into(),
        form: ObstacleForm::Patch(card),
        until: None,
    });
    let stopped = predicted(&open, &plane, &window).slices.at_zero();
    // The card is 0.4 m wide and half-way to the wall, which is lit over more than a metre.
    assert!(hidden < 0.9 * whole && (hidden / stopped - 1.0).abs() < 0.02); // errors of both nets
}

/// Tests that a chain with a wrong map is distinguished from the correct chain.
#[test]
fn a_wrong_map_is_a_defect() {
    let (x, z) = (DVec3::X, DVec3::Z);
    let gloss = || Interaction::Reflects(Box::new(reflectance(Lobe::Ggx { roughness: 0.1 })));
    let first = surface(patch(z, x - z, 0.2), gloss());
    let second = surface(patch(z + x, -x - z, -0.3), gloss());
    let view = Observed {
        system: PathSystem::new(lamp(0.1), vec![first, second]),
        plane: across(z + x - 0.5 * z, -z, x),
    };
    let mut tried = chain(&view).unwrap();
    assert!(defect(&view, &tried).unwrap() < 1e-9); // differences of fourth order
    tried.maps[1].matrix[2][0] += 1e-3;
    assert!(defect(&view, &tried).unwrap() > 1e-4);
    assert_eq!(
        view.parameters(),
        [
            Parameter::SourceSize(0),
            Parameter::SourceSize(1),
            Parameter::SourcePosition(0),
            Parameter::SourcePosition(1),
            Parameter::SurfaceSize(0, 0),
            Parameter::SurfacePosition(0, 0),
            Parameter::SurfacePosition(0, 1),
            Parameter::SurfaceSize(1, 0),
            Parameter::SurfacePosition(1, 0),
            Parameter::SurfacePosition(1, 1),
            Parameter::Curvature(0, 0),
            Parameter::Curvature(1, 0),
            Parameter::Albedo,
            Parameter::Lobe
        ]
    );
}
