//! Tests the conversion of crossings to rays in world coordinates: the rays carry the flux that
//! crossed the plane, and lie on the lines of the photons.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::PhotonSource;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{PlaneInWorld, Tracer};
use glam::DVec3;
use std::f64::consts::PI;
use std::path::Path;

/// Returns a scene with a square light that shines obliquely and does not lie at the world's
/// origin. If `visits` names the curved glossy surface, the light shines on that surface.
fn scene(visits: &str, planes: &str) -> Scene {
    let text = format!(
        r#"(light: Rectangle(center: (0.3, -0.2, 0.1), size: (0.06, 0.04), radiance: 2),
            surfaces: [Smooth(name: "it", center: (0.3, 0.4, 0.9), facing: (0.2, -0.5, -1), form: Sphere(0.5), aperture: 0.6,
                              event: Reflects(brdf: (lobe: Phong(40), albedo: 0.8)))],
            path: (direction: (0, 0.6, 0.8), x_axis: (1, 0, 0), visits: [{visits}]),
            planes: [{planes}], window: (x: Hann(0.12), u: Hann(0.25)), frequencies: (azimuths: 2, rho: (max: 9), nu: (max: 6)),
            run: (photons: 32768, emission: Plain))"#
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("test", file, Path::new("."), u64::MAX).unwrap()
}

/// The position, the direction and the flux in W of all photons that cross a virtual
/// plane.
fn rays(scene: &Scene, plane: usize) -> Vec<(DVec3, DVec3, f64)> {
    let tracer = Tracer::new(scene);
    let world = PlaneInWorld::new(scene, plane).unwrap();
    let mut all = Vec::new();
    for batch in 0..scene.run.batches {
        let mut record = |at: usize, crossings: &[etendue_field::Crossing]| {
            if at == plane {
                all.extend(crossings.iter().map(|c| {
                    let [point, along] = world.ray(&c.ray).unwrap();
                    (point, along, world.flux(c) / 32768.0)
                }));
            }
        };
        tracer.emit(batch, &mut record, &|_| ());
    }
    all
}

fn total(rays: &[(DVec3, DVec3, f64)]) -> f64 {
    rays.iter().map(|(.., watts)| watts).sum()
}

/// A Lambertian rectangle emits the flux π L A in total. With plain emission, all photons have
/// the same flux.
#[test]
fn at_the_light_it_is_the_flux_of_the_light() {
    let scene = scene(
        r#""it""#,
        r#"(name: "light", at: Emission), (name: "on", at: Distance(0.5))"#,
    );
    for plane in 0..2 {
        let rays = rays(&scene, plane);
        let expected = PI * 2.0 * 0.06 * 0.04;
        // At the first plane, the tolerance is the sum of 32768 rounding errors. At the second
        // plane, it allows for the loss of light that grazes the adjacent surface.
        let slack = [1e-11, 0.3][plane];
        assert!(
            (total(&rays) / expected - 1.0).abs() < slack,
            "{}",
            total(&rays)
        );
        // If a ray is traced back to the plane of the light, it ends within the light.
        let (center, d) = (DVec3::new(0.3, -0.2, 0.1), DVec3::new(0.0, 0.6, 0.8));
        for (point, along, _) in rays {
            assert!((along.length() - 1.0).abs() < 1e-12 && along.dot(d) > 0.0);
            let back = (point - center).dot(d) / along.dot(d);
            let from = point - back * along - center;
            let y = DVec3::new(0.0, 0.8, -0.6);
            // The bounds are the half-sides of the light, plus rounding errors, which steep rays
            // magnify.
            let steep = 1.0 / along.dot(d);
            assert!(
                from.x.abs() < 0.03 + 1e-12 * steep && from.dot(y).abs() < 0.02 + 1e-12 * steep,
                "{from}"
            );
        }
    }
}

/// Virtual planes at the same hit record the same photons in different coordinates, so the flux,
/// the directions and the lines are the same.
#[test]
fn planes_on_a_surface_have_one_flux() {
    let planes = r#"(name: "across", at: Before("it")), (name: "tangent", at: Before("it"), orientation: Tangent),
        (name: "local", at: Before("it"), orientation: LocalNormals), (name: "mirrored", at: Before("it"), orientation: Mirrored)"#;
    let scene = scene(r#""it""#, planes);
    let [across, tangent, local, mirrored] = [0, 1, 2, 3].map(|plane| rays(&scene, plane));
    assert!(local.len() > 1000);
    assert_eq!(local.len(), mirrored.len());
    for ((p, d, watts), (q, e, same)) in local.iter().zip(&mirrored) {
        assert!((*p - *q).length() < 1e-12 && (*d - *e).length() < 1e-9); // arcsines of numbers near 1 lose half their digits
        assert!((watts / same - 1.0).abs() < 1e-9); // the same
        // The recorded point lies on the sphere of radius 2 whose vertex is the central hit.
        let normal = DVec3::new(0.2, -0.5, -1.0).normalize();
        let center = DVec3::new(0.3, 0.4, 0.9) - 2.0 * normal;
        assert!(((*p - center).length() - 2.0).abs() < 1e-9);
        assert!(d.dot(*p - center) < 0.0); // the photon arrives from outside
    }
    // The other virtual planes also record each tested photon, on the same line and with the same
    // power.
    for others in [&across, &tangent] {
        let mut found = 0;
        for (p, d, watts) in &local[..50] {
            let same = others.iter().find(|(q, e, _)| {
                let off = *q - *p;
                (*e - *d).length() < 1e-9 && (off - off.dot(*d) * *d).length() < 1e-9
            });
            if let Some((.., same)) = same {
                assert!((same / watts - 1.0).abs() < 1e-9);
                found += 1;
            }
        }
        assert!(found > 10, "{found}");
    }
}
