//! Compares cameras with the rays that Mitsuba 3.9.1 sends through a film of 40 × 20 pixels.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{
    assert_close, assert_first, assert_refused, cases, causes, notes, numbers, world,
};
use etendue_world::Camera;

const FILM: &str = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"40\"/><integer name=\"height\" value=\"20\"/><rfilter type=\"box\"/></film>";

fn camera(plugin: &str, inside: &str) -> Camera {
    let all = format!("<sensor type=\"{plugin}\" id=\"eye\">{FILM}{inside}</sensor>");
    world(&all).cameras.remove(0)
}

/// The direction of the ray at a tenth of the film's width and three tenths of its height.
fn along(camera: &Camera) -> [f64; 3] {
    camera.look([4.0, 6.0], [0.0; 2]).along.to_array()
}

#[test]
fn angles_of_view_have_an_axis() {
    for (inside, expected) in cases(
        r#"
        <float name="fov" value="40"/> => 0.27889 0.06972 0.95779
        <float name="fov" value="40"/><string name="fov_axis" value="x"/> => 0.27889 0.06972 0.95779
        <float name="fov" value="40"/><string name="fov_axis" value="y"/> => 0.4993 0.12483 0.85739
        <float name="fov" value="40"/><string name="fov_axis" value="smaller"/>
        => 0.4993 0.12483 0.85739
        <float name="fov" value="40"/><string name="fov_axis" value="larger"/>
        => 0.27889 0.06972 0.95779
        <float name="fov" value="40"/><string name="fov_axis" value="diagonal"/>
        => 0.25153 0.06288 0.9658
        <string name="focal_length" value="35mm"/> => 0.40243 0.10061 0.90991
        => 0.29494 0.07373 0.95267
        <float name="fov" value="40"/><float name="principal_point_offset_x" value="0.2"/><float name="principal_point_offset_y" value="-0.1"/>
        => 0.14324 0.10743 0.98384
        "#,
    ) {
        let found = along(&camera("perspective", inside));
        assert_close(&found, &numbers(expected), 1e-5);
    }
}

#[test]
fn cameras_look_along_z_with_y_up() {
    let inside = "<float name=\"fov\" value=\"90\"/><transform name=\"to_world\"><lookat origin=\"0,0,0\" target=\"1,0,0\" up=\"0,0,1\"/></transform>";
    let corner = camera("perspective", inside).look([0.0, 0.0], [0.0; 2]);
    assert_close(
        &corner.along.to_array(),
        &[0.666_67, 0.666_67, 0.333_33],
        1e-5,
    );
    // Clip planes: Mitsuba's ray begins at the distance 0.015 and has the length 14999.986.
    assert_close(&corner.seen, &[0.015, 15_000.0], 2e-2);
}

#[test]
fn lenses_focus_on_a_plane() {
    let inside = "<float name=\"fov\" value=\"40\"/><float name=\"aperture_radius\" value=\"0.2\"/><float name=\"focus_distance\" value=\"3\"/>";
    let camera = camera("thinlens", inside);
    let [middle, edge] = [[0.0, 0.0], [0.6, -0.8]].map(|lens| camera.look([4.0, 6.0], lens));
    let at = |look: etendue_world::Look| look.from + look.along * (3.0 / look.along.z);
    assert_close(&(at(middle) - at(edge)).to_array(), &[0.0; 3], 1e-12);
    assert_close(&edge.from.to_array(), &[0.12, -0.16, 0.0], 1e-12);
}

#[test]
fn orthographic_cameras_are_scaled() {
    let plain = camera("orthographic", "").look([4.0, 6.0], [0.0; 2]);
    assert_close(&plain.from.to_array(), &[0.8, 0.2, 0.0], 1e-12);
    let scale = "<transform name=\"to_world\"><scale x=\"2\" y=\"2\" z=\"3\"/></transform>";
    let look = camera("orthographic", scale).look([4.0, 6.0], [0.0; 2]);
    assert_close(&look.from.to_array(), &[1.6, 0.4, 0.0], 1e-12);
    // Mitsuba's ray begins at z = 0.03 and has length 9999.99.
    assert_close(&look.seen, &[0.03, 0.03 + 9_999.99], 1e-9);
}

#[test]
fn unsound_cameras_are_refused() {
    for (inside, what) in cases(
        r#"
        <float name="fov" value="180"/> => fov is 180
        <transform name="to_world"><scale value="2"/></transform> => to_world scales
        <float name="near_clip" value="-1"/> => the clip planes are at -1
        <film type="hdrfilm"><integer name="width" value="0"/></film> => width is 0
        <film type="hdrfilm"><float name="width" value="3"/></film>
        => width is a number; allowed: an integer
        <film type="hdrfilm"><integer name="crop_width" value="3"/></film> => crop_width
        "#,
    ) {
        assert_refused(
            &causes(&format!("<sensor type=\"perspective\">{inside}</sensor>")),
            &[what],
        );
    }
    let other = "<sensor type=\"irradiancemeter\"/>";
    assert_first(&causes(other), "sensor `irradiancemeter` is not supported");
    let both = format!("{other}<sensor type=\"perspective\">{FILM}</sensor>");
    assert_first(&notes(&both), "sensor `irradiancemeter` is left out");
}

#[test]
fn filters_other_than_the_box_are_noted() {
    let film = "<sensor type=\"perspective\"><film type=\"hdrfilm\"><rfilter type=\"tent\"/></film></sensor>";
    assert_eq!(
        notes(film),
        ["text:2:49: rfilter `tent` is approximated by the box filter"]
    );
}
