//! Cameras of pbrt-v4: X points to the right, and the angle of view is along the shorter side.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_close, assert_first, assert_near, assert_refused, cases};
use crate::pbrt_scenes::{notes, set_up, unsettled};
use etendue_world::{Camera, Look};

const WIDE: &str = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20";
const TALL: &str = "Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 40";

fn camera(before: &str) -> Camera {
    set_up(before).cameras.remove(0)
}

fn along(look: Look) -> [f64; 3] {
    look.along.to_array()
}

#[test]
fn x_is_to_the_right() {
    let top_right = camera(&format!("{WIDE} Camera \"perspective\"")).look([40.0, 0.0], [0.0; 2]);
    // The vertical slope of the ray is the tangent of 45 degrees, and the horizontal slope is twice
    // the vertical slope.
    assert_close(
        &along(top_right),
        &[2.0 / 6_f64.sqrt(), 1.0 / 6_f64.sqrt(), 1.0 / 6_f64.sqrt()],
        1e-12,
    );
    let placed = format!("LookAt 1 2 3  1 2 -5  0 1 0 {WIDE} Camera \"perspective\"");
    let look = camera(&placed).look([40.0, 10.0], [0.0; 2]);
    assert_close(&look.from.to_array(), &[1.0, 2.0, 3.0], 1e-12);
    // The camera looks along −Z in left-handed coordinates, so −X is to the right.
    assert_close(
        &along(look),
        &[-2.0 / 5_f64.sqrt(), 0.0, -1.0 / 5_f64.sqrt()],
        1e-12,
    );
    // Exporters write a mirroring transform before the camera.
    let mirrored = format!("Scale -1 1 1 {placed}");
    let look = camera(&mirrored).look([40.0, 10.0], [0.0; 2]);
    assert_close(
        &along(look),
        &[2.0 / 5_f64.sqrt(), 0.0, -1.0 / 5_f64.sqrt()],
        1e-12,
    );
}

#[test]
fn the_angle_of_view_is_of_the_shorter_side() {
    let fov = "Camera \"perspective\" \"float fov\" 60";
    let edge = |film: &str, place| {
        let look = camera(&format!("{film} {fov}")).look(place, [0.0; 2]);
        look.along.z.acos().to_degrees()
    };
    assert_close(
        &[edge(WIDE, [20.0, 0.0]), edge(TALL, [20.0, 20.0])],
        &[30.0; 2],
        1e-9,
    );
    let window = "Camera \"perspective\" \"float screenwindow\" [0 2 -0.5 0.5]";
    let look = camera(&format!("{WIDE} {window}")).look([40.0, 0.0], [0.0; 2]);
    assert_close(
        &[look.along.x / look.along.z, look.along.y / look.along.z],
        &[2.0, 0.5],
        1e-12,
    );
    let look = camera(&format!("{WIDE} {window}")).look([0.0, 20.0], [0.0; 2]);
    assert_close(
        &[look.along.x / look.along.z, look.along.y / look.along.z],
        &[0.0, -0.5],
        1e-12,
    );
    let square = "Camera \"perspective\" \"float screenwindow\" [-1 1 -1 1]";
    assert_first(
        &unsettled(&format!("{WIDE} {square}")),
        "the pixels are not square",
    );
}

#[test]
fn lenses_focus_on_a_plane() {
    let lens = "Scale 0.5 0.5 0.5 Camera \"perspective\" \"float lensradius\" 0.1 \"float focaldistance\" 3";
    let camera = camera(lens);
    let [middle, edge] = [[0.0, 0.0], [0.6, -0.8]].map(|lens| camera.look([4.0, 6.0], lens));
    // The scale of one half doubles the size of the camera, so the camera focuses at a distance of
    // 6.
    let at = |look: Look| look.from + look.along * (6.0 / look.along.z);
    assert_close(&(at(middle) - at(edge)).to_array(), &[0.0; 3], 1e-12);
    assert_near(edge.from.length(), 0.2, 1e-12);
}

#[test]
fn orthographic_cameras_show_two_units_of_the_shorter_side() {
    let look = camera(&format!("{WIDE} Camera \"orthographic\"")).look([40.0, 0.0], [0.0; 2]);
    assert_close(&look.from.to_array(), &[2.0, 1.0, 0.0], 1e-12);
    assert_close(&along(look), &[0.0, 0.0, 1.0], 1e-12);
    let window = "Camera \"orthographic\" \"float screenwindow\" [1 3 0 1]";
    let look = camera(&format!("{WIDE} {window}")).look([0.0, 20.0], [0.0; 2]);
    assert_close(&look.from.to_array(), &[1.0, 0.0, 0.0], 1e-12);
}

#[test]
fn depth_counts_bounces() {
    assert_eq!(set_up("").depth, Some(5));
    let depth = |n| set_up(&format!("Integrator \"path\" \"integer maxdepth\" {n}")).depth;
    assert_eq!(
        [depth(0), depth(1), depth(12)],
        [Some(0), Some(1), Some(12)]
    );
    assert_first(&unsettled("Integrator \"ao\""), "`ao` is not supported");
}

#[test]
fn unsound_cameras_are_refused() {
    for (before, what) in cases(
        r#"
        Camera "spherical" => text:1:19: camera `spherical` is not supported
        Camera "perspective" "float fov" 180 => fov is 180
        Scale 1 2 1 Camera "perspective" => different scales along its axes
        Scale 0 0 0 Camera "perspective" => different scales along its axes
        Film "rgb" "float cropwindow" [0 0.5 0 1] => parts of a film
        Film "rgb" "integer xresolution" 0 => xresolution is 0
        ActiveTransform EndTime => animated transforms
        ColorSpace "rec2020" => colour space `rec2020`
        "#,
    ) {
        assert_refused(&unsettled(before), &[what]);
    }
    assert_eq!(notes(""), Vec::<String>::new());
}
