//! Tests of the chain derived from the geometry, against derivatives of traced rays and known foci.

use super::*;
use crate::path::rays::central::Incidence;
use etendue_field::Side;

/// The coordinates at the plane of a ray that leaves the light.
fn lands(system: &PathSystem, plane: &Plane, ray: [f64; 4]) -> Option<[f64; 4]> {
    Some(plane.coordinates(&system.follow(ray)?)?.0)
}

/// The derivative ∂z'/∂z of a ray's coordinates at the plane with respect to its
/// coordinates at the light, by central differences of traced rays.
fn traced(system: &PathSystem, plane: &Plane) -> [[f64; 4]; 4] {
    const STEP: f64 = 1e-5;
    let mut rows = [[0.0; 4]; 4];
    for column in 0..4 {
        let at = |side: f64| {
            let mut ray = [0.0; 4];
            ray[column] = side * STEP;
            lands(system, plane, ray).unwrap()
        };
        let (above, below) = (at(1.0), at(-1.0));
        for row in 0..4 {
            rows[row][column] = (above[row] - below[row]) / (2.0 * STEP);
        }
    }
    rows
}

/// The largest difference between the matrix and offset of the chain's map and the matrix
/// and offset of traced rays.
fn off(system: &PathSystem, plane: &Plane, print: Edition) -> f64 {
    let first = chain(&view(system, plane), print).unwrap();
    let center = lands(system, plane, [0.0; 4]).unwrap();
    let rays = first.map.rays();
    let offsets = rays.offset.iter().zip(center).map(|(a, b)| (a - b).abs());
    let traced = traced(system, plane);
    let entries = (0..16).map(|i| (rays.matrix[i / 4][i % 4] - traced[i / 4][i % 4]).abs());
    offsets.chain(entries).fold(0.0, f64::max)
}

/// Error of central differences of rays: the square of a step of 10⁻⁵, and rounding error divided
/// by the step.
const CLOSE: f64 = 1e-8;

/// A point light with a narrow picture; only its geometry matters here.
fn light() -> Light {
    projector([0.1, 0.1])
}

/// The frame of leg `i`, at its start.
fn leg(system: &PathSystem) -> Frame {
    system
        .hits()
        .unwrap()
        .last()
        .map_or(Frame::IDENTITY, |hit| hit.leaving)
}

fn with(mut system: PathSystem, name: &str, patch: Patch, event: Specular) -> PathSystem {
    visit(&mut system, element(name, patch, event));
    system
}

fn systems() -> Vec<PathSystem> {
    let glass = |front, back| Specular::Refraction { front, back };
    let shapes = [
        [-0.5; 3],         // hollow sphere
        [0.4, 0.0, 0.4],   // cylinder
        [-0.5, -0.2, 0.0], // paraboloid
        [0.6, -0.3, 0.0],  // saddle
        [0.0; 3],          // plane
    ];
    let mut all = vec![];
    for shape in shapes {
        for theta0 in [0.0, 0.7, -0.4] {
            for turns in [[0.0, 0.0], [0.0, 0.5], [0.6, 0.5], [1.9, -0.3]] {
                all.push(mirror(light(), theta0, turns, shape));
                let patch = placed(&Frame::IDENTITY, 0.8, theta0, turns, shape);
                all.push(PathSystem::new(
                    light(),
                    vec![element("glass", patch, glass(1.0, 1.5))],
                ));
                // Light enters the glass from its back, so the surface normal points along the
                // light's direction.
                let flipped = Frame::new(patch.frame.origin, -patch.frame.d, patch.frame.x);
                let patch = Patch {
                    frame: flipped.unwrap(),
                    ..patch
                };
                all.push(PathSystem::new(
                    light(),
                    vec![element("glass", patch, glass(1.3, 1.1))],
                ));
            }
        }
    }
    // The path has two mirrors with different planes of incidence, then a lens that is met
    // off-centre and obliquely.
    let first = mirror(light(), 0.5, [0.3, 0.2], [-0.5, 0.3, 0.0]);
    let patch = placed(&leg(&first), 0.7, -0.6, [1.2, 0.4], [0.4, 0.1, 0.0]);
    let second = with(first, "second", patch, Specular::Mirror);
    all.push(second.clone());
    let mut patch = placed(&leg(&second), 0.6, 0.3, [0.4, 0.0], [0.0; 3]);
    for aside in [0.0, 0.1] {
        patch.frame.origin += patch.frame.x * aside;
        let event = Specular::ThinLens { focal_length: 0.4 };
        all.push(with(second.clone(), "lens", patch, event));
    }
    // A sphere that the central ray meets away from the vertex of the sphere's patch.
    let mut aside = mirror(light(), 0.3, [0.2, 0.0], [-0.7; 3]);
    let x = aside.surfaces[0].patch.frame.x;
    aside.surfaces[0].patch.frame.origin += x * 0.2;
    all.push(aside);
    all
}

#[test]
fn chain_is_the_derivative_of_the_rays() {
    let systems = systems();
    assert!(systems.len() > 180);
    for system in systems {
        let mut plane = after(&system, 0.65);
        let off_by = off(&system, &plane, Edition::Corrected);
        assert!(off_by < CLOSE, "{off_by:e} {:?}", system.surfaces);
        // The plane is rotated about the ray, and its origin is displaced.
        let x = plane.frame.x * 0.8 + plane.frame.y * 0.6;
        let origin = plane.frame.origin + x * 0.01;
        plane.frame = Frame::new(origin, plane.frame.d, x).unwrap();
        let off_by = off(&system, &plane, Edition::Corrected);
        assert!(off_by < CLOSE, "turned: {off_by:e}");
    }
}

#[test]
fn printed_chains_are_not() {
    // None of the printed editions gives the correct map onto a surface. If the mirror is curved,
    // none of them gives the correct map behind the mirror.
    let system = mirror(light(), 0.7, [0.0, 0.0], [-0.5, -0.2, 0.0]);
    let plane = after(&system, 0.65);
    for print in [Edition::Equations, Edition::Table] {
        assert!(off(&system, &plane, print) > 0.1);
    }
}

/// Builds a plane on a surface that light meets or leaves; its frame is (T, B, N) turned about N.
fn on_surface(
    frame: Frame,
    orientation: Orientation,
    patch: Patch,
    direction: DVec3,
    side: Side,
) -> Plane {
    let away = if side == Side::Before {
        -direction
    } else {
        direction
    };
    Plane {
        frame,
        orientation,
        longitude: libm::atan2(away.dot(frame.x), away.dot(frame.d)),
        patch: Some(patch),
        side,
        quantity: Quantity::Radiance,
    }
}

pub(super) fn surface_planes() -> Vec<(PathSystem, Plane)> {
    let glass = Specular::Refraction {
        front: 1.0,
        back: 1.5,
    };
    let mut all = vec![];
    for event in [Specular::Mirror, glass] {
        for (theta0, curvature) in [
            (0.7, [-0.5, 0.3, 0.0]),
            (-0.5, [0.6; 3]),
            (0.0, [0.4, 0.1, 0.0]),
        ] {
            for orientation in [Orientation::Tangent, Orientation::LocalNormals] {
                let patch = placed(&Frame::IDENTITY, 0.8, theta0, [0.4, 0.5], curvature);
                let onto = PathSystem::new(projector([0.1, 0.1]), vec![]);
                let hit = Incidence::new(&Frame::IDENTITY.travelled(0.8), patch.frame.d);
                let frame = |t: DVec3, d: DVec3| Frame::new(patch.frame.origin, d, t).unwrap();
                for t in [hit.t, -hit.t] {
                    let plane =
                        on_surface(frame(t, hit.n), orientation, patch, DVec3::Z, Side::Before);
                    all.push((onto.clone(), plane));
                    let off = with(onto.clone(), "surface", patch, event);
                    let leaving = off.hits().unwrap()[0].leaving.d;
                    let side = if leaving.dot(hit.n) > 0.0 {
                        hit.n
                    } else {
                        -hit.n
                    };
                    let plane =
                        on_surface(frame(t, side), orientation, patch, leaving, Side::After);
                    all.push((off, plane));
                }
            }
        }
    }
    all
}

#[test]
fn surface_planes_are_read_off() {
    for (system, plane) in surface_planes() {
        let off_by = off(&system, &plane, Edition::Corrected);
        assert!(off_by < CLOSE, "{off_by:e} {plane:?}");
        for print in [Edition::Equations, Edition::Table] {
            let oblique = plane.longitude.abs() > 0.1;
            assert!(!oblique || off(&system, &plane, print) > 0.1, "{print:?}");
        }
    }
}

#[test]
fn foci_of_a_hollow_sphere() {
    let (theta0, radius) = (0.7_f64, 2.0);
    let system = mirror(beam([0.1, 0.1]), theta0, [0.0; 2], [-1.0 / radius; 3]);
    let first = chain(&view(&system, &after(&system, 0.5)), Edition::Corrected).unwrap();
    // By Coddington's equations, the foci are at R/2 · cos θ₀ and R/(2 cos θ₀).
    let expected = [
        0.5 * radius * libm::cos(theta0),
        0.5 * radius / libm::cos(theta0),
    ];
    assert!((expected[0] - 0.764_842).abs() < 1e-6 && (expected[1] - 1.307_459).abs() < 1e-6);
    for (got, expected) in first.foci.iter().zip(expected) {
        assert!((got - expected).abs() < 1e-12); // rounding
    }
    // Rays that start one micrometre from the central ray and parallel to it cross the central ray
    // at the foci.
    for axis in 0..2 {
        let plane = after(&system, expected[axis]);
        let mut ray = [0.0; 4];
        ray[axis] = 1e-6;
        let z = lands(&system, &plane, ray).unwrap();
        assert!(z[axis].abs() < 1e-11); // coma: the square of 10⁻⁶
    }
}

#[test]
fn focus_of_a_ball_lens() {
    let (radius, n) = (0.1, 1.5);
    let frame = |z| Frame::new(DVec3::Z * z, -DVec3::Z, DVec3::X).unwrap();
    let half = |z, k: f64| Patch {
        frame: frame(z),
        curvature: [k; 3],
        aperture: radius,
    };
    let entering = Specular::Refraction {
        front: 1.0,
        back: n,
    };
    let out = Specular::Refraction {
        front: n,
        back: 1.0,
    };
    let ball = PathSystem::new(
        beam([0.001, 0.001]),
        vec![
            element("front", half(1.0, 1.0 / radius), entering),
            element("back", half(1.0 + 2.0 * radius, -1.0 / radius), out),
        ],
    );
    let first = chain(&view(&ball, &after(&ball, 0.1)), Edition::Corrected).unwrap();
    // The focal length n R/(2(n − 1)) is measured from the centre (Hecht, Optics).
    let expected = n * radius / (2.0 * (n - 1.0)) - radius;
    for focus in &first.foci {
        assert!((focus - expected).abs() < 1e-12, "{focus}"); // rounding
    }
    assert_eq!(first.foci.len(), 2);
    let plane = after(&ball, expected);
    let z = lands(&ball, &plane, [1e-5, 0.0, 0.0, 0.0]).unwrap();
    assert!(z[0].abs() < 1e-11); // spherical aberration: (10⁻⁵/0.1)³ of 0.1 m
}

#[test]
fn steps_read_like_a_figure() {
    let system = mirror(projector([0.1, 0.1]), 0.6, [0.0; 2], [-0.5; 3]);
    let first = chain(&view(&system, &after(&system, 0.7)), Edition::Corrected).unwrap();
    let words: Vec<&str> = first.steps.iter().map(|step| step.words.as_str()).collect();
    assert_eq!(
        words,
        [
            "map  travel 1 m, light to mirror: ℓ̂(Ωx, Ωu + 1 Ωx)",
            "map  incidence 34.377° onto mirror",
            "map  curvature κ = diag(−0.5, −0.5) m⁻¹",
            "map  mirror: ℓ̂(Ωx, −Ωθ)",
            "map  back from local normals, κ = diag(−0.5, −0.5) m⁻¹",
            "map  outgoing angle −34.377°",
            "map  travel 0.7 m, mirror to plane: ℓ̂(Ωx, Ωu + 0.7 Ωx)",
        ]
    );
}

/// Tests that the `defect` of a chain detects a relative error of 10⁻⁴ in its factor and in each
/// phase, and a wrong sign of the largest entry of each row.
#[test]
fn a_wrong_map_leaves_a_defect() {
    let window = window(Profile::Hann(0.02), Profile::Hann(0.02));
    for system in systems() {
        let view = view(&system, &after(&system, 0.5));
        let sound = chain(&view, Edition::Corrected).unwrap().map;
        let found = |map: &SpectrumMap<4>| defect(&view, map, &window).unwrap();
        // Finite differences over steps of 10⁻⁵ have an error of 10⁻¹⁰ m, which is divided by a
        // window's half-width of two centimetres.
        assert!(found(&sound) < 1e-7, "{:e}", found(&sound));
        let mut wrong = sound;
        wrong.factor *= 1.0 + 1e-4;
        assert!(found(&wrong) > 5e-5);
        for row in 0..4 {
            let mut wrong = sound;
            wrong.phase[row] += 1e-4 * 0.02;
            assert!(found(&wrong) > 5e-5);
            let largest = (0..4).max_by(|a, b| {
                let size = |i: &usize| sound.matrix[row][*i].abs();
                size(a).total_cmp(&size(b))
            });
            let mut wrong = sound;
            wrong.matrix[row][largest.unwrap()] *= -1.0;
            assert!(found(&wrong) > 1e-2, "{:e}", found(&wrong));
        }
    }
}

/// Tests planes that are slightly tilted relative to the central ray. Behind a mesh, the plane is
/// perpendicular to the ray that the mesh's normals reflect, and this ray differs slightly from the
/// ray that the mesh's patch reflects.
#[test]
fn a_plane_may_lean_against_the_leg() {
    for system in systems() {
        let mut plane = after(&system, 0.6);
        let Frame { x, y, d, .. } = plane.frame;
        plane.frame = plane.frame.turned_to((d + 0.02 * x - 0.01 * y).normalize());
        plane.frame.origin += 0.01 * plane.frame.x;
        assert!(off(&system, &plane, Edition::Corrected) < CLOSE);
    }
}
