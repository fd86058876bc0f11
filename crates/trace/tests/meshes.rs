//! Tests random smooth meshes: each is refused with a message, or has unit normals and finite
//! frames and can be traced.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Frame, PhotonSource};
use etendue_scene::{Scene, SceneError, SceneFile, resolve};
use etendue_trace::{Backward, Tracer};
use etendue_transform::random::{self, Stream};
use glam::DVec3;
use std::cell::Cell;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const MESHES: u64 = 2000;

/// The source of the random numbers of one mesh, which are used in sequence.
struct Draw {
    mesh: u64,
    next: Cell<u32>,
}

impl Draw {
    fn unit(&self) -> f64 {
        let block = self.next.replace(self.next.get() + 1);
        random::unit(random::words(7, Stream::Photon, self.mesh, block)[0])
    }

    fn between(&self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn below(&self, count: usize) -> usize {
        let block = self.next.replace(self.next.get() + 1);
        random::index(random::words(7, Stream::Photon, self.mesh, block)[0], count)
    }

    fn point(&self, by: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.between(-by, by)))
    }
}

struct Parts {
    vertices: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
}

/// A bumpy square around the origin, facing along z.
fn square(draw: &Draw, bumps: f64) -> Parts {
    let n = 1 + draw.below(5);
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let mut vertices = Vec::new();
    for j in 0..=n {
        vertices.extend((0..=n).map(|i| DVec3::new(at(i), at(j), 0.0) + draw.point(bumps)));
    }
    let corner = |i: usize, j: usize| j * (n + 1) + i;
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] =
                [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| corner(i, j));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Parts {
        vertices,
        triangles,
    }
}

/// A closed surface of eight triangles.
fn octahedron(draw: &Draw) -> Parts {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let vertices = axes.into_iter().flat_map(|axis| [axis, -axis]);
    let mut triangles = Vec::new();
    for x in 0..2 {
        for y in 2..4 {
            for z in 4..6 {
                let outward = (x + y + z) % 2 == 0;
                triangles.push(if outward { [x, y, z] } else { [x, z, y] });
            }
        }
    }
    Parts {
        vertices: vertices.map(|v| v + draw.point(0.3)).collect(),
        triangles,
    }
}

/// Returns triangles between random vertices.
fn soup(draw: &Draw) -> Parts {
    let vertices = (0..3 + draw.below(6)).map(|_| draw.point(1.0));
    let vertices: Vec<DVec3> = vertices.collect();
    let corner = || draw.below(vertices.len());
    let triangles = (0..1 + draw.below(12)).map(|_| [corner(), corner(), corner()]);
    Parts {
        triangles: triangles.collect(),
        vertices,
    }
}

fn parts(draw: &Draw, kind: u64) -> Parts {
    let mut parts = match kind {
        0 => return soup(draw),
        1 => return octahedron(draw),
        2 => return square(draw, 0.8),
        _ => square(draw, 0.1),
    };
    let any = draw.below(parts.triangles.len());
    let [a, b, c] = parts.triangles[any];
    match kind {
        // The three kinds of change are a reversed triangle, a duplicated triangle, and a
        // triangle that is present from both sides.
        3 => parts.triangles[any] = [a, c, b],
        4 => parts.triangles.extend([parts.triangles[any]; 2]),
        5 => parts.triangles.push([a, c, b]),
        // The change of kind 6 adds the reverse of every triangle.
        6 => {
            let other = |[a, b, c]: &[usize; 3]| [*a, *c, *b];
            let other: Vec<_> = parts.triangles.iter().map(other).collect();
            parts.triangles.extend(other);
        }
        // The changes of kinds 7 and 8 make vertices nearly coincide, or nearly lie on a line.
        7 => {
            let near = 10_f64.powf(draw.between(-40.0, -3.0));
            parts.vertices[a] = parts.vertices[b] + near * draw.point(1.0);
        }
        8 => {
            let near = 10_f64.powf(draw.between(-40.0, -3.0));
            let middle = parts.vertices[b].midpoint(parts.vertices[c]);
            parts.vertices[a] = middle + near * draw.point(1.0);
        }
        9 => {
            let squeezed = 10_f64.powf(draw.between(-30.0, 0.0));
            parts.vertices.iter_mut().for_each(|v| v.y *= squeezed);
        }
        _ => {}
    }
    parts
}

/// The text of a mesh file. Vertices are counted from 1 in OBJ files, and from 0 in PLY
/// files.
fn written(parts: &Parts, obj: bool) -> String {
    let mut text = String::new();
    let Parts {
        vertices,
        triangles,
    } = parts;
    if !obj {
        let (n, m) = (vertices.len(), triangles.len());
        write!(
            text,
            "ply\nformat ascii 1.0\nelement vertex {n}\nproperty double x\nproperty double y\nproperty double z\n\
             element face {m}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        .unwrap();
    }
    for v in vertices {
        let mark = if obj { "v " } else { "" };
        writeln!(text, "{mark}{:e} {:e} {:e}", v.x, v.y, v.z).unwrap();
    }
    let (mark, first) = if obj { ("f", 1) } else { ("3", 0) };
    for [a, b, c] in triangles {
        writeln!(text, "{mark} {} {} {}", a + first, b + first, c + first).unwrap();
    }
    text
}

/// A scene with a mesh of half-width `size` in front of a light of the same size.
fn scene(file: &str, event: &str, scale: f64, size: f64, center: DVec3) -> String {
    let (length, wide) = (size.clamp(1e-9, 1e9), size.clamp(1e-8, 1e8));
    let light = center + 3.0 * size * DVec3::new(0.3, -0.2, 1.0);
    format!(
        r#"(
            light: Rectangle(center: ({:e}, {:e}, {:e}), size: ({length:e}, {length:e})),
            surfaces: [Mesh(name: "mesh", center: ({:e}, {:e}, {:e}), mesh: File("{file}"), scale: {scale:e}, event: {event})],
            path: (direction: (-0.3, 0.2, -1), x_axis: (1, 0, 0), visits: ["mesh"]),
            planes: [(name: "before", at: Before("mesh")), (name: "after", at: After("mesh"))],
            window: (x: Hann({wide:e}), u: Hann(0.5)),
            frequencies: (rho: (max: {:e}), nu: (max: 1)),
            run: (photons: 3200, batches: 32),
        )"#,
        light.x,
        light.y,
        light.z,
        center.x,
        center.y,
        center.z,
        1.0 / wide
    )
}

fn resolved(text: &str, folder: &Path) -> Result<Scene, SceneError> {
    resolve("random", SceneFile::parse(text)?, folder, u64::MAX)
}

fn assert_sound(scene: &Scene, what: &str) {
    for mesh in &scene.meshes {
        let normals = &mesh.smooth.as_ref().unwrap().normals;
        let unit = |n: &DVec3| (n.length() - 1.0).abs() < 1e-12; // rounding
        assert!(
            normals.as_flattened().iter().all(unit),
            "{what}: {normals:?}"
        );
    }
    let finite = |f: &Frame| [f.origin, f.x, f.y, f.d].iter().all(|v| v.is_finite());
    let legs = scene.path.legs.iter().map(|leg| &leg.frame);
    let planes = scene.planes.iter().map(|plane| &plane.frame);
    assert!(legs.chain(planes).all(finite), "{what}: {:?}", scene.path);
    assert!(scene.planes.iter().all(|plane| plane.distance.is_finite()));
    let backward = Backward::new(scene).unwrap();
    let sources: [&dyn PhotonSource; 2] = [&Tracer::new(scene), &backward];
    for source in sources {
        let mut record = |_: usize, crossings: &[etendue_field::Crossing]| {
            let sound = crossings.iter().all(|crossing| crossing.weight.is_finite());
            assert!(sound, "{what}: {crossings:?}");
        };
        source.emit(0, &mut record, &|_| ());
    }
    // Some random meshes are kilometres wide, for which the scene gives a warning about units.
    let of_units = |warning: &String| warning.contains("in millimetres?");
    let (units, others): (Vec<_>, Vec<_>) = scene.warnings().into_iter().partition(of_units);
    assert!(units.len() <= 1 && others.len() <= 1, "{what}");
}

#[test]
fn random_smooth_meshes_are_refused_or_traced() {
    let folder = tempfile::tempdir().unwrap();
    let (mut sound, mut refused) = ([0; 13], [0; 13]);
    for mesh in 0..MESHES {
        let draw = Draw {
            mesh,
            next: Cell::new(0),
        };
        let kind = mesh % 13;
        let mut parts = parts(&draw, kind);
        let (mut size, mut scale, mut center) = (1.0, 1.0, DVec3::ZERO);
        if kind >= 10 {
            size = 10_f64.powf(draw.between(-20.0, 12.0));
            scale = [1e-9, 1.0, 1e9][draw.below(3)];
            parts.vertices.iter_mut().for_each(|v| *v *= size / scale);
        }
        if kind == 12 {
            center = draw.point(10_f64.powf(draw.between(-3.0, 9.0)));
        }
        let obj = draw.unit() < 0.5;
        let file = if obj { "mesh.obj" } else { "mesh.ply" };
        fs::write(folder.path().join(file), written(&parts, obj)).unwrap();
        let event = ["Mirror", "Refraction(front: 1, back: 1.5)"][draw.below(2)];
        let text = scene(file, event, scale, size, center);
        let place = usize::try_from(kind).unwrap();
        match resolved(&text, folder.path()) {
            Ok(scene) => {
                assert_sound(&scene, &format!("mesh {mesh}, kind {kind}: {text}"));
                sound[place] += 1;
            }
            Err(SceneError::Values(faults)) => {
                assert!(!faults.is_empty() && faults.len() < 10, "{faults:?}");
                let short = |fault: &etendue_scene::Fault| fault.to_string().len() < 600;
                assert!(faults.iter().all(short), "{faults:?}");
                refused[place] += 1;
            }
            Err(other) => panic!("{other}: {text}"),
        }
    }
    // Meshes must often be accepted and often be refused; otherwise they were too irregular or
    // too regular for the test.
    let often = |counts: [u32; 13]| counts.iter().sum::<u32>() > 400;
    assert!(often(sound) && often(refused), "{sound:?} and {refused:?}");
}
