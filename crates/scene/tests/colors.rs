//! Tests colours: each becomes the number that `run.color` selects.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Fresnel, Light};
use etendue_scene::{Color, Event, Scene, SceneError, SceneFile, resolve};

const SCENE: &str = r#"(
    light: Disc(center: (0, 0, 0), radius: 0.1, radiance: (1, 2, 4)),
    other_lights: [Rectangle(center: (1, 0, 0), size: (0.1, 0.1), radiance: (4, 2, 1))],
    surfaces: [
        Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6), albedo: (0.1, 0.2, 0.4)),
        Smooth(name: "copper", center: (5, 0, 3), facing: (0, 0, -1), form: Plane, aperture: 1,
            event: Reflects(brdf: (lobe: Ggx(0.2), albedo: (0.4, 0.2, 0.1),
                fresnel: Conductor(n: (1, 2, 4), k: (4, 2, 1))))),
    ],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "arrival", at: Before("floor"))],
    window: (x: Hann(0.3), u: Hann(0.3)),
    frequencies: (rho: (max: 4), nu: (max: 4)),
)"#;

fn resolved(text: &str, color: Color) -> Result<Scene, SceneError> {
    let mut file = SceneFile::parse(text)?;
    file.run.color = color;
    resolve("test", file, ".".as_ref(), u64::MAX)
}

/// The numbers that a scene has for [`SCENE`]'s colours.
fn numbers(scene: &Scene) -> [f64; 6] {
    let radiance = |light: &Light| match light {
        Light::Area { radiance, .. } => *radiance,
        other => panic!("{other:?}"),
    };
    let Event::Reflects(reflectance) = &scene.patches[0].event else {
        panic!("{:?}", scene.patches);
    };
    let brdf = &reflectance.terms[0].brdf;
    let Fresnel::Conductor { n, k } = brdf.fresnel else {
        panic!("{brdf:?}");
    };
    [
        radiance(&scene.light),
        radiance(&scene.other_lights[0].light),
        10.0 * scene.surfaces[0].albedo,
        10.0 * brdf.albedo,
        n,
        k,
    ]
}

#[test]
fn each_colour_becomes_the_number_of_the_channel() {
    let luminance = |[r, g, b]: [f64; 3]| 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
    let (up, down) = (luminance([1.0, 2.0, 4.0]), luminance([4.0, 2.0, 1.0]));
    for (color, up, down) in [
        (Color::Luminance, up, down),
        (Color::Red, 1.0, 4.0),
        (Color::Green, 2.0, 2.0),
        (Color::Blue, 4.0, 1.0),
    ] {
        let found = numbers(&resolved(SCENE, color).unwrap());
        for (found, wanted) in found.into_iter().zip([up, down, up, down, up, down]) {
            // The tolerance is the rounding error of a few products.
            assert!(
                (found - wanted).abs() < 1e-14,
                "{color:?}: {found} {wanted}"
            );
        }
    }
}

#[test]
fn each_number_of_a_colour_has_a_range() {
    for (from, to, wanted) in [
        (
            "radiance: (1, 2, 4)",
            "radiance: (1, 0, 4)",
            "light.radiance[1] is 0;",
        ),
        (
            "albedo: (0.1, 0.2, 0.4)",
            "albedo: (0.1, 0.2, 1.4)",
            "surfaces[0].albedo[2] is 1.4;",
        ),
        ("n: (1, 2, 4)", "n: (0.01, 2, 4)", "fresnel.n[0] is 0.01;"),
    ] {
        let text = SCENE.replace(from, to);
        assert_ne!(text, SCENE);
        let message = resolved(&text, Color::Green).unwrap_err().to_string();
        assert!(message.contains(wanted), "{message}");
    }
}

/// A scene that selects no channel has the hash that it had before scenes had colours.
#[test]
fn the_luminance_is_not_written() {
    let text = SCENE.replace("(1, 2, 4)", "1");
    let hash = |color| resolved(&text, color).unwrap().hash();
    assert_ne!(hash(Color::Luminance), hash(Color::Red));
    let file = SceneFile::parse(&text).unwrap();
    assert!(serde_json::to_value(&file).unwrap()["run"]["color"].is_null());
}
