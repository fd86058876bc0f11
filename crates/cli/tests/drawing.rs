//! Tests the drawing of a scene by `etendue check --draw`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common;
use crate::common::told;
use std::fs;

/// The drawing of a scene of the repository, as SVG.
fn drawing(scene: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let scene = common::scene(&format!("{scene}.ron"));
    told(
        folder.path(),
        format!("check {} --draw a.svg", scene.display()),
        0,
    );
    fs::read_to_string(folder.path().join("a.svg")).unwrap()
}

#[test]
fn a_cut_through_y_is_drawn_where_it_shows_something_else() {
    // The first scene has bars along Y; the other scenes have squares that are irregular only
    // because of jitter.
    for (scene, is_other) in [
        ("grating", true),
        ("fig9b", false),
        ("table1/environment", false),
    ] {
        let is_drawn = drawing(scene).contains("font-style=\"italic\">y</tspan>");
        assert_eq!(is_drawn, is_other, "{scene}");
    }
}

#[test]
fn a_path_that_turns_is_drawn_to_scale() {
    for (scene, turns) in [
        ("two_bounces", true),
        ("fig10", true),
        ("fig9b", false),
        ("fig1", false),
    ] {
        assert_eq!(drawing(scene).contains(">to scale<"), turns, "{scene}");
    }
}

#[test]
fn surfaces_are_hatched_evenly_and_glass_is_not() {
    // Only the strokes of hatching have this color and width.
    let strokes = |scene: &str| {
        drawing(scene)
            .matches("stroke=\"#9a9a9a\" stroke-width=\"1\"")
            .count()
    };
    assert_eq!(strokes("table1/lens"), 0);
    assert_eq!(strokes("table1/refraction_in"), 0);
    // The segments of the drawn sphere are short: the first stroke of hatching is farther from a
    // segment's end than the segment is long.
    assert!(strokes("table1/environment") > 20);
}

#[test]
fn light_from_far_away_is_no_lamp() {
    let texts = |scene: &str| drawing(scene).matches(">sky<").count();
    assert_eq!([texts("table1/environment"), texts("fig9b")], [1, 0]);
}

#[test]
fn planes_stand_where_they_are() {
    // All seven planes of this scene are at the same position, so each cut contains the same line
    // seven times.
    let svg = drawing("fig10");
    let lines: Vec<&str> = svg
        .lines()
        .filter(|line| line.contains("dasharray=\"5 3\""))
        .collect();
    let places = lines.iter().map(|line| line.split(' ').nth(1).unwrap());
    let mut places: Vec<&str> = places.collect();
    assert_eq!(places.len(), 14);
    places.dedup();
    assert_eq!(places.len(), 1, "{places:?}");
}

/// The view to scale lies in the plane in which the path turns, also if the x axis is across it.
#[test]
fn a_path_is_drawn_in_its_plane() {
    let folder = tempfile::tempdir().unwrap();
    let scene = common::scene("table1/concave_oblique.ron");
    let height = |x_axis: &str| {
        let line = format!(
            "check {} --set path.x_axis={x_axis} --draw {x_axis}.svg",
            scene.display()
        );
        told(folder.path(), line, 0);
        let svg = fs::read_to_string(folder.path().join(format!("{x_axis}.svg"))).unwrap();
        // The first line of three points is the path.
        let lines = svg.split("<path d=\"M").skip(1);
        let points = lines.map(|line| line.split('"').next().unwrap().split('L'));
        let points = points.map(Iterator::collect::<Vec<_>>);
        let path = points
            .into_iter()
            .find(|points| points.len() == 3)
            .unwrap()
            .into_iter();
        let y: Vec<f64> = path
            .map(|point| point.split(' ').nth(1).unwrap().parse().unwrap())
            .collect();
        y.iter().copied().fold(0.0, f64::max) - y.iter().copied().fold(f64::INFINITY, f64::min)
    };
    for x_axis in ["(1,0,0)", "(0,1,0)"] {
        assert!(height(x_axis) > 50.0, "{x_axis}: {}", height(x_axis));
    }
}
