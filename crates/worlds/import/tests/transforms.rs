//! Transforms, compared with matrices printed by Mitsuba 3.9.1.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_close, assert_refused, cases, causes, notes, world};

/// The rows of the matrix `to_world` of a rectangle.
fn rows(steps: &str) -> Vec<f64> {
    let shape = format!(
        "<shape type=\"rectangle\"><transform name=\"to_world\">{steps}</transform></shape>"
    );
    let map = world(&shape).shapes[0].to_world;
    let rows = (0..3).flat_map(|i| {
        let row = map.matrix3.row(i);
        [row.x, row.y, row.z, map.translation[i]]
    });
    rows.collect()
}

#[test]
fn later_steps_come_after_earlier_ones() {
    let steps = "<translate x=\"1\"/><scale value=\"2\"/><rotate z=\"1\" angle=\"90\"/>";
    let expected = [0.0, -2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0];
    assert_close(&rows(steps), &expected, 1e-15);
}

#[test]
fn lookat_has_x_to_the_left() {
    let steps = "<lookat origin=\"1, 2, 3\" target=\"0 0 0\" up=\"0, 0, 1\"/>";
    let expected = [
        0.894_427_2,
        -0.358_568_55,
        -0.267_261_24,
        1.0,
        -0.447_213_6,
        -0.717_137_1,
        -0.534_522_5,
        2.0,
        0.0,
        0.597_614_3,
        -0.801_783_7,
        3.0,
    ];
    assert_close(&rows(steps), &expected, 1e-7);
}

#[test]
fn lookat_finds_a_way_up() {
    let steps = "<lookat origin=\"1,2,3\" target=\"4,4,4\"/>";
    let expected = [
        0.338_187, 0.492_719, 0.801_784, 1.0, -0.774_542, -0.338_187, 0.534_522, 2.0, 0.534_522,
        -0.801_784, 0.267_261, 3.0,
    ];
    assert_close(&rows(steps), &expected, 1e-6);
}

#[test]
fn matrices_are_written_row_by_row() {
    let nine = "<matrix value=\"1 2 3, 4 5 6, 7 8 10\"/>";
    let expected = [1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0, 0.0, 7.0, 8.0, 10.0, 0.0];
    assert_close(&rows(nine), &expected, 0.0);
    let all = "<matrix value=\"1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\"/>";
    let expected = [1.0, 0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 6.0, 0.0, 0.0, 1.0, 7.0];
    assert_close(&rows(all), &expected, 0.0);
}

/// Dr.Jit's `rotate` computes cos α I + (1 − cos α) a aᵀ + sin α [a]ₓ with an axis a of any length.
#[test]
fn rotation_axes_of_any_length_distort_as_in_mitsuba() {
    let half = "<rotate z=\"2\" angle=\"90\"/>";
    let expected = [0.0, -2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0];
    assert_close(&rows(half), &expected, 1e-12);
    let shape = |axis: f64| {
        format!(
            "<shape type=\"rectangle\"><transform name=\"to_world\"><rotate z=\"{axis}\" angle=\"90\"/></transform></shape>"
        )
    };
    let noted = "text:2:52: the length of the rotation axis is not 1: as in Mitsuba 3, this also distorts shapes";
    assert_eq!(notes(&shape(2.0)), [noted]);
    assert_eq!(notes(&shape(1.0)), [""; 0]);
}

#[test]
fn unsound_steps_are_causes() {
    for (step, what) in cases(
        r#"
        <rotate angle="3"/> => a rotation axis of length 0
        <scale value="1" x="2"/>
        => value is given together with x, y or z; allowed: only one of the two forms
        <translate x="1.0f"/> => `1.0f` is not a finite number
        <translate x="nan"/> => `nan` is not a finite number
        <matrix value="1 2 3"/> => 3 numbers
        <matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"/> => last row
        <lookat origin="1,1,1" target="1,1,1"/> => the viewing direction has length 0
        <shear x="1"/> => is not allowed in a transform
        "#,
    ) {
        let shape = format!(
            "<shape type=\"rectangle\"><transform name=\"to_world\">{step}</transform></shape>"
        );
        assert_refused(&causes(&shape), &["text:2:25: ", what]);
    }
}
