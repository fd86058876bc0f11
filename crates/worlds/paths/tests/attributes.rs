//! Reflectances given at the vertices or on the faces of a mesh.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use etendue_import::{Options, import_mitsuba};
use etendue_paths::Paths;
use etendue_world::{Look, World};
use glam::DVec3;
use std::fmt::Write;

/// Number of squares along each side of the mesh.
const SIDE: usize = 5;

/// A bumpy square from −1 to 1, seen from above. The colour of a vertex is a linear function
/// of its place, and the weight of a face states the index of its square.
fn ply() -> String {
    let (mut rows, mut faces) = (String::new(), String::new());
    for i in 0..=SIDE {
        for j in 0..=SIDE {
            let [x, y] = [i, j].map(|k| 2.0 * k as f64 / SIDE as f64 - 1.0);
            let z = 0.1 * ((7 * i + 3 * j) % 5) as f64;
            let [r, g, b] = colors(DVec3::new(x, y, z));
            writeln!(rows, "{x} {y} {z} {r} {g} {b}").unwrap();
        }
    }
    for i in 0..SIDE {
        for j in 0..SIDE {
            let at = |di, dj| (i + di) * (SIDE + 1) + j + dj;
            let weight = (i * SIDE + j) as f64 / 100.0;
            let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            // Every second square is one face of four corners.
            if (i + j) % 2 == 0 {
                writeln!(faces, "4 {a} {b} {c} {d} {weight}").unwrap();
            } else {
                writeln!(faces, "3 {a} {b} {c} {weight}\n3 {a} {c} {d} {weight}").unwrap();
            }
        }
    }
    // A face of zero area is dropped, with its number.
    let faces = format!("3 0 0 1 0.9\n{faces}");
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         property double r\nproperty double g\nproperty double b\nelement face {}\n\
         property list uchar int vertex_index\nproperty double weight_0\nend_header\n{rows}{faces}",
        rows.lines().count(),
        faces.lines().count(),
    )
}

fn colors(place: DVec3) -> [f64; 3] {
    [0.3, 0.5, 0.4].map(|first| first + DVec3::new(0.1, 0.15, -0.2).dot(place) * first)
}

fn world(attribute: &str) -> World {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.ply"), ply()).unwrap();
    let scene = format!(
        "<scene version=\"3.0.0\"><shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/>\
         <bsdf type=\"diffuse\"><texture type=\"mesh_attribute\" name=\"reflectance\">\
         <string name=\"name\" value=\"{attribute}\"/></texture></bsdf></shape></scene>"
    );
    import_mitsuba(&scene, folder.path(), &Options::default())
        .unwrap()
        .world
}

/// Calls `check` with points of the mesh and the reflectance there.
fn seen(attribute: &str, mut check: impl FnMut(DVec3, f64)) {
    let paths = Paths::new(&world(attribute));
    let mut count = 0;
    for i in 0..40 {
        for j in 0..40 {
            let [x, y] = [i, j].map(|k| (f64::from(k) + 0.4) / 20.0 - 1.0);
            let look = Look {
                from: DVec3::new(x, y, 5.0),
                along: DVec3::NEG_Z,
                seen: [0.0, f64::INFINITY],
            };
            let hit = paths.view(&look).surface.unwrap();
            check(hit.position(), paths.factors(&hit)[0]);
            count += 1;
        }
    }
    assert_eq!(count, 1600);
}

#[test]
fn numbers_of_vertices_are_interpolated_over_faces() {
    seen("vertex_color", |place, found| {
        let [r, g, b] = colors(place);
        let expected = 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
        assert!(
            (found - expected).abs() < 1e-9,
            "{place}: {found} is not {expected}"
        );
    });
}

#[test]
fn numbers_of_faces_are_constant_on_each_face() {
    seen("face_weight", |place, found| {
        let [i, j] = [place.x, place.y].map(|x| ((x + 1.0) * 0.5 * SIDE as f64).floor());
        let expected = (i * SIDE as f64 + j) / 100.0;
        assert!(
            (found - expected).abs() < 1e-12,
            "{place}: {found} is not {expected}"
        );
    });
}
