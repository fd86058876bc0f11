//! Lights that are not surfaces.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_close, assert_first, assert_near, causes, folder, read_in, world};
use etendue_import::Color;
use etendue_world::{Light, Texture};
use std::f64::consts::PI;

fn light(plugin: &str, inside: &str) -> Light {
    world(&format!("<emitter type=\"{plugin}\">{inside}</emitter>"))
        .lights
        .remove(0)
}

#[test]
fn points_have_a_place() {
    let place = |inside: &str| match light("point", inside) {
        Light::Point { position, .. } => position.to_array(),
        other => panic!("{other:?}"),
    };
    let moved = "<transform name=\"to_world\"><translate x=\"4\"/></transform>";
    let named = "<point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/>";
    assert_close(&place(moved), &[4.0, 0.0, 0.0], 0.0);
    assert_close(&place(named), &[1.0, 2.0, 3.0], 0.0);
    let both = format!("<emitter type=\"point\">{moved}{named}</emitter>");
    assert_first(&causes(&both), "position is given together with to_world");
}

/// The shape stays, because it blocks light, but it has no radiance.
#[test]
fn directionalarea_is_a_sheet() {
    let sheet = |shape: &str| {
        let emitter =
            r#"<emitter type="directionalarea"><float name="radiance" value="3"/></emitter>"#;
        format!(r#"<shape type="sphere"/><shape type="{shape}">{emitter}</shape>"#)
    };
    for plugin in ["rectangle", "disk"] {
        let read = world(&sheet(plugin));
        let [
            Light::Sheet {
                shape: 1,
                exitance: Texture::Constant(value),
            },
        ] = read.lights[..]
        else {
            panic!("{:?}", read.lights)
        };
        assert_near(value, 3.0, 0.0);
        assert!(read.shapes.len() == 2 && read.shapes[1].emission.is_none());
    }
    let refused = causes(&sheet("sphere"));
    assert_first(
        &refused,
        "directionalarea on `sphere`; allowed: rectangle or disk",
    );
}

#[test]
fn directional_light_goes_along_z() {
    let way = |inside: &str| match light("directional", inside) {
        Light::Directional {
            direction,
            irradiance,
        } => {
            assert_near(irradiance, 1.0, 0.0);
            direction.to_array()
        }
        other => panic!("{other:?}"),
    };
    assert_close(&way(""), &[0.0, 0.0, 1.0], 0.0);
    assert_close(
        &way("<vector name=\"direction\" value=\"0, 0, -2\"/>"),
        &[0.0, 0.0, -1.0],
        0.0,
    );
    let turned = "<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform>";
    assert_close(&way(turned), &[1.0, 0.0, 0.0], 1e-15);
}

#[test]
fn spots_have_two_angles() {
    let angles = |inside: &str| match light("spot", inside) {
        Light::Spot { beam, cutoff, .. } => [beam.to_degrees(), cutoff.to_degrees()],
        other => panic!("{other:?}"),
    };
    assert_close(&angles(""), &[15.0, 20.0], 1e-12);
    let half =
        r#"<float name="cutoff_angle" value="90"/><float name="beam_width" value="89.999"/>"#;
    assert_close(&angles(half), &[89.999, 90.0], 1e-12);
    assert_close(
        &angles("<float name=\"cutoff_angle\" value=\"40\"/>"),
        &[30.0, 40.0],
        1e-12,
    );
    let wide = "<emitter type=\"spot\"><float name=\"beam_width\" value=\"20\"/></emitter>";
    assert_first(&causes(wide), "beam_width is 20");
    let textured = "<texture name=\"texture\" type=\"checkerboard\"/>";
    let Light::Spot { picture, .. } = light("spot", textured) else {
        panic!("not a spot");
    };
    assert!(matches!(picture, Some(Texture::Checkerboard { .. })));
}

#[test]
fn projectors_have_the_shape_of_their_picture() {
    let inside = "<float name=\"fov\" value=\"90\"/><float name=\"scale\" value=\"2\"/>";
    let Light::Projector { half, scale, .. } = light("projector", inside) else {
        panic!("not a projector");
    };
    assert_close(&[half.x, half.y, scale], &[1.0, 1.0, 2.0 * PI], 1e-12);
}

#[test]
fn skies_keep_their_pixels_and_turn() {
    let hdr = [
        b"#?RADIANCE\n\n-Y 1 +X 2\n".as_slice(),
        &[128, 128, 128, 129, 128, 128, 128, 130],
    ]
    .concat();
    let files = folder(&[("a.hdr", &hdr)]);
    let inside = "<emitter type=\"envmap\"><string name=\"filename\" value=\"a.hdr\"/><float name=\"scale\" value=\"3\"/>\
                  <transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/></transform></emitter>";
    let world = read_in(inside, files.path(), Color::Green).unwrap().world;
    let Light::Sky(sky) = &world.lights[0] else {
        panic!("{:?}", world.lights);
    };
    assert_close(sky.radiance.raster().values(), &[3.0, 6.0], 1e-12);
    assert_close(&(sky.to_world.y_axis).to_array(), &[0.0, 0.0, 1.0], 1e-15);
}
