//! Tests the class of theory of scenes that once had no prediction or a wrong one.

use super::{MORE, does_not_fail, edited, scene_does_not_fail};
use etendue_compare::Class;

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn slow_scenes_do_not_fail() {
    use Class::{Exact, FirstOrder};
    does_not_fail(
        "square_rectangle_disc_grating",
        &[
            ("leaving", Exact),
            ("on_its_way", Exact),
            ("farther", Exact),
        ],
    );
    let behind = [
        ("outgoing", FirstOrder),
        ("beyond", FirstOrder),
        ("farther", FirstOrder),
    ];
    does_not_fail("two_arrays_interface", &behind);
    does_not_fail("projector_halfplane_beckmann", &behind);
    let on_and_off = [("reflection", FirstOrder), ("outgoing", FirstOrder)];
    does_not_fail("big_map", &on_and_off);
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn refused_scenes_do_not_fail() {
    let behind = [("outgoing", Class::FirstOrder)];
    does_not_fail("many_squares_mirror", &behind);
    does_not_fail("many_squares_glossy", &behind);
    let in_a_row = ["leaving_wall", "at_floor", "beyond"].map(|plane| (plane, Class::FirstOrder));
    does_not_fail("sky_on_walls", &in_a_row);
    does_not_fail("sky_on_both_sides", &[("leaving", Class::FirstOrder)]);
}

#[test]
fn scenes_that_were_wrong_do_not_fail() {
    use Class::{Exact, FirstOrder};
    does_not_fail("fine_grating_floor", &[("leaving", Exact)]);
    does_not_fail("wide_gaussian_sky", &[("outgoing", FirstOrder)]);
    does_not_fail("leaning_mesh", &[("on_it", FirstOrder)]);
    let beside = [("across", FirstOrder), ("on_it", FirstOrder)];
    does_not_fail("pinhole_beside_a_wall", &beside);
    does_not_fail("at_a_tilted_sky", &[("sky", FirstOrder)]);
    let both_sides = [("arriving", FirstOrder), ("leaving", FirstOrder)];
    does_not_fail("mask_beside_a_tilted_glass", &both_sides);
    let legs = [("outgoing", FirstOrder), ("beyond", FirstOrder)];
    does_not_fail("blocker_in_later_leg", &legs);
    let twice = [("outgoing", FirstOrder), ("beyond", FirstOrder)];
    does_not_fail("hollow_twice", &twice);
    let shadowed = [("reflection", FirstOrder), ("outgoing", FirstOrder)];
    does_not_fail("self_shadow", &shadowed);
    let dark = [("incidence", FirstOrder), ("outgoing", FirstOrder)];
    does_not_fail("projector_two_occluders", &dark);
}

/// The first-order chain is computed as the exact prediction plus a difference. Therefore it has
/// the noise of the exact prediction.
#[test]
fn the_chain_of_a_small_map_does_not_fail() {
    use Class::FirstOrder;
    let planes = [("reflection", FirstOrder), ("outgoing", FirstOrder)];
    scene_does_not_fail(&edited("small_map_phong", &[MORE]), &planes);
}
