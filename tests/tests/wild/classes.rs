//! Tests the class of theory of scenes that once had no prediction or a wrong one.

use super::{MORE, does_not_fail, edited, scene_does_not_fail};
use etendue_compare::Class::{self, Exact, FirstOrder};

/// Checks scenes, each with a class and the names of its planes.
fn do_not_fail(scenes: &[(&str, Class, &str)]) {
    for (name, class, planes) in scenes {
        does_not_fail(name, *class, planes);
    }
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn slow_scenes_do_not_fail() {
    let behind = "outgoing beyond farther";
    do_not_fail(&[
        (
            "square_rectangle_disc_grating",
            Exact,
            "leaving on_its_way farther",
        ),
        ("two_arrays_interface", FirstOrder, behind),
        ("projector_halfplane_beckmann", FirstOrder, behind),
        ("big_map", FirstOrder, "reflection outgoing"),
    ]);
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn refused_scenes_do_not_fail() {
    do_not_fail(&[
        ("many_squares_mirror", FirstOrder, "outgoing"),
        ("many_squares_glossy", FirstOrder, "outgoing"),
        ("sky_on_walls", FirstOrder, "leaving_wall at_floor beyond"),
        ("sky_on_both_sides", FirstOrder, "leaving"),
    ]);
}

#[test]
fn scenes_that_were_wrong_do_not_fail() {
    do_not_fail(&[
        ("fine_grating_floor", Exact, "leaving"),
        ("wide_gaussian_sky", FirstOrder, "outgoing"),
        ("leaning_mesh", FirstOrder, "on_it"),
        ("pinhole_beside_a_wall", FirstOrder, "across on_it"),
        ("at_a_tilted_sky", FirstOrder, "sky"),
        ("mask_beside_a_tilted_glass", FirstOrder, "arriving leaving"),
        ("blocker_in_later_leg", FirstOrder, "outgoing beyond"),
        ("hollow_twice", FirstOrder, "outgoing beyond"),
        ("self_shadow", FirstOrder, "reflection outgoing"),
        ("projector_two_occluders", FirstOrder, "incidence outgoing"),
    ]);
}

/// The first-order chain is computed as the exact prediction plus a difference. Therefore it has
/// the noise of the exact prediction.
#[test]
fn the_chain_of_a_small_map_does_not_fail() {
    let scene = edited("small_map_phong", &[MORE]);
    scene_does_not_fail(&scene, FirstOrder, "reflection outgoing");
}
