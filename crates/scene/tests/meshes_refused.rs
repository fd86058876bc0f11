//! Tests meshes that a scene cannot use: which vertex or triangle is reported, and which
//! triangles are dropped or cause a warning instead.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_scene::{Scene, SceneError, SceneFile, resolve};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 0.1\n";
const ROOF: &str = "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

/// A scene file with a mesh below a light; `rest` is appended to the file.
fn text(mesh: &str, rest: &str) -> String {
    format!(
        r#"(
            light: Disc(center: (0.3, 0.1, 2), radius: 0.2),
            surfaces: [Mesh(name: "mesh", center: (0, 0, 0), mesh: {mesh}, {rest})],
            path: (direction: (-0.1, 0.05, -1), x_axis: (1, 0, 0), visits: ["mesh"]),
            planes: [(name: "after", at: After("mesh"))],
            window: (x: Hann(0.1), u: Hann(0.1)),
            frequencies: (rho: (max: 10), nu: (max: 10)),
            run: (photons: 1000),
        )"#
    )
}

fn resolved(text: &str, folder: &Path) -> Result<Scene, SceneError> {
    resolve("test", SceneFile::parse(text)?, folder, u64::MAX)
}

/// The scene, or the error, for a mesh file with the given content.
fn file(name: &str, content: &str, rest: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), content).unwrap();
    resolved(&text(&format!("File({name:?})"), rest), folder.path())
}

fn told(outcome: Result<Scene, SceneError>, words: &[&str]) {
    let told = outcome.unwrap_err().to_string();
    for words in words {
        assert!(told.contains(words), "{words}: {told}");
    }
    assert_eq!(told.lines().count(), 1, "{told}");
}

fn ply(obj: &str) -> String {
    let rows = |mark: char| obj.lines().filter(move |line| line.starts_with(mark));
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        rows('v').count(),
        rows('f').count()
    );
    rows('v').for_each(|line| writeln!(text, "{}", &line[2..]).unwrap());
    for line in rows('f') {
        let corners = line[2..].split(' ').map(|i| i.parse::<u32>().unwrap() - 1);
        let corners: Vec<String> = corners.map(|i| i.to_string()).collect();
        writeln!(text, "3 {}", corners.join(" ")).unwrap();
    }
    text
}

#[test]
fn vertices_whose_normals_cancel_are_named_as_the_file_counts() {
    let both =
        format!("{SQUARE}{ROOF}v 0.5 0.5 -1\nv 0.5 -0.5 -1\nv 0.6 0.2 -0.8\nf 6 7 8\nf 6 8 7\n");
    told(
        file("a.obj", &both, "event: Mirror"),
        &[
            "surfaces[0].mesh, \"a.obj\": vertex 6 is without a normal",
            "(2 more have this fault)",
        ],
    );
    told(
        file("a.ply", &ply(&both), "event: Mirror"),
        &["\"a.ply\": vertex 5 is without"],
    );
    assert!(
        file("a.obj", &both, "albedo: 0.5").is_ok(),
        "triangles have normals of their own"
    );
}

#[test]
fn folds_and_windings_that_disagree_are_named() {
    let turned = format!("{SQUARE}{}", ROOF.replace("f 3 4 5", "f 4 3 5"));
    told(
        file("a.obj", &turned, "event: Mirror"),
        &[
            "vertex 5 is on a fold: its normal differs by",
            "the normal of the triangle of vertices 4, 3 and 5",
            "at most 89.4°",
        ],
    );
    assert!(file("a.obj", &format!("{SQUARE}{ROOF}"), "event: Mirror").is_ok());
}

#[test]
fn vertices_beyond_all_coordinates_are_named() {
    let far = text(
        "Star(radius: 1e8, relief: 0, lobes: 0, rings: 4)",
        "scale: 1e9",
    );
    told(
        resolved(&far, ".".as_ref()),
        &[
            "surfaces[0].mesh, vertex 0 is at [",
            "1000000000.0 (25 more have this fault)",
        ],
    );
}

/// The long thin triangles of real files are dropped. A mesh that consists only of long thin
/// triangles is refused.
#[test]
fn triangles_too_thin_are_dropped_or_named() {
    let sliver = format!("{SQUARE}v 0 -1.00000000000001 0\n{ROOF}f 1 6 2\n");
    let scene = file("a.obj", &sliver, "event: Mirror").unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 4);
    let thin = SQUARE
        .replace("-1 0", "-1e-13 0")
        .replace(" 1 0", " 1e-13 0")
        .replace("0 0 0.1", "0 0 0");
    told(
        file("a.obj", &format!("{thin}{ROOF}"), "event: Mirror"),
        &[
            "the triangle of vertices 1, 2 and 5 is",
            "m high; allowed: at least",
            "(3 more have this fault)",
        ],
    );
}

/// Another part of the mesh may stand in front of the part that is hit, and may face the other
/// way.
#[test]
fn the_side_of_a_hit_is_that_of_its_own_triangle() {
    // The mesh consists of a roof that faces down and a plate that faces up. The plate is above the
    // hit, beside the path.
    let roof = "v -1 -1 -0.5\nv 1 -1 -0.5\nv 1 1 -0.5\nv -1 1 -0.5\nv 0 0 -0.4\n";
    let above = "v -0.1 0.1 0.3\nv 0.1 0.1 0.3\nv 0.1 0.4 0.3\nv -0.1 0.4 0.3\n";
    let faces = "f 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n";
    let mesh = format!("{roof}{faces}{above}f 6 7 8 9\n");
    let glass = "event: Refraction(front: 1, back: 1.5)";
    let alone = file("a.obj", &format!("{roof}{faces}"), glass).unwrap();
    let both = file("a.obj", &mesh, glass).unwrap();
    assert_eq!(both.path.legs[1].frame, alone.path.legs[1].frame);
}

/// With boxes padded for the distance of the light, the hierarchy took sixty times as long.
#[test]
fn a_light_that_is_too_far_is_refused_as_fast_as_a_scene_is_read() {
    let seconds = |y: &str| {
        let text = format!(
            "(light: Rectangle(center: (0, {y}, 0), size: (0.2, 0.2)), blockers: [Mesh(name: \"star\", \
             center: (0, 0, 1), mesh: Star(radius: 0.25, relief: 0.3, lobes: 5, rings: 120))], \
             surfaces: [Rectangle(name: \"floor\", center: (0, 0, 2), size: (6, 6))], \
             path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"floor\"]), \
             planes: [(name: \"a\", at: Before(\"floor\"))], window: (x: Hann(0.5), u: Hann(0.5)), \
             frequencies: (rho: (max: 1), nu: (max: 1)), run: (photons: 1000))"
        );
        let file = SceneFile::parse(&text).unwrap();
        let start = std::time::Instant::now();
        let is_refused = resolve("far", file, ".".as_ref(), u64::MAX).is_err();
        (is_refused, start.elapsed().as_secs_f64())
    };
    let [(sound, near), (refused, far)] = ["0", "1e19"].map(seconds);
    assert!(!sound && refused);
    assert!(far < 20.0 * near, "{far} s, {near} s");
}

/// The spectrum of a mesh with two cells differs from that of a smooth surface by 3 %.
#[test]
fn coarse_smooth_meshes_are_warned_of() {
    let warned = |cells: u32| {
        let mesh = format!("Paraboloid(curvatures: (1.5, 1), half: 0.2, cells: {cells})");
        let text = text(&mesh, "event: Mirror").replace(
            "center: (0.3, 0.1, 2)",
            "center: (-0.644217687, 0, 0.764842187)",
        );
        let text = text.replace("(-0.1, 0.05, -1)", "(0.644217687, 0, -0.764842187)");
        resolved(&text, ".".as_ref()).unwrap().warnings()
    };
    let coarse = warned(2);
    assert!(
        coarse.len() == 1 && coarse[0].starts_with("mesh: the mesh is too coarse"),
        "{coarse:?}"
    );
    assert_eq!(warned(32), Vec::<String>::new());
}
