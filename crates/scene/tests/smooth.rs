//! Tests smooth surfaces, pictures and planes on surfaces: which objects they resolve to, and
//! which are refused.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Light, Orientation};
use etendue_scene::{Object, Scene, SceneError, SceneFile, resolve};

const MIRROR: &str = r#"Smooth(name: "mirror", center: (0, 0, 1), facing: (0.6, 0, -0.8), form: Sphere(-0.5), along: (1, 0, 0), aperture: 0.4, event: Mirror)"#;
const GLASS: &str = r#"Smooth(name: "glass", center: (1.44, 0, 0.58), facing: (-0.96, 0, 0.28), form: Paraboloid(0.4, -0.2), aperture: 0.3, event: Refraction(front: 1, back: 1.5))"#;
const MESH: &str = r#"Mesh(name: "mesh", center: (2.4, 0, 0.3), mesh: Star(radius: 0.2, relief: 0, lobes: 0, rings: 60), event: Mirror)"#;

fn text() -> String {
    format!(
        r#"(
            light: Projector(center: (0, 0, 0), intensity: 2, image: (width: (0.1, 0.2), grating: (axis: X, frequency: 20))),
            surfaces: [{MIRROR}, {GLASS}, {MESH}],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["mirror", "glass"]),
            planes: [
                (name: "a", at: Before("mirror"), orientation: Tangent),
                (name: "b", at: After("mirror"), orientation: LocalNormals),
                (name: "c", at: After("mirror")),
                (name: "d", at: After("glass")),
            ],
            window: (x: Hann(0.1), u: Hann(0.1)),
            frequencies: (azimuths: 4, rho: (max: 10), nu: (max: 10)),
            run: (photons: 1000),
        )"#
    )
}

fn resolved(text: &str) -> Result<Scene, SceneError> {
    resolve("test", SceneFile::parse(text)?, ".".as_ref(), u64::MAX)
}

#[test]
fn a_path_through_smooth_surfaces_resolves_to_what_it_says() {
    let scene = resolved(&text()).unwrap();
    assert!(
        matches!(scene.light, Light::Projector { intensity, image } if (intensity - 2.0).abs() < 1e-15 && image.grating.is_some())
    );
    let [_, reflected, refracted] = scene.path.legs.as_slice() else {
        panic!("three legs: {:?}", scene.path.legs);
    };
    // The ray is deflected by twice the angle of incidence: 2 · 0.6 · 0.8 = 0.96.
    assert!(
        (reflected.frame.d.x - 0.96).abs() < 1e-12 && (reflected.frame.d.z + 0.28).abs() < 1e-12
    ); // rounding
    assert!((reflected.length - 1.5).abs() < 1e-12); // rounding
    // At normal incidence light goes straight through.
    assert!((refracted.frame.d - reflected.frame.d).length() < 1e-12); // rounding
    assert!((refracted.frame.x - reflected.frame.x).length() < 1e-12); // rounding
    assert_eq!(refracted.leaves.unwrap().object, Object::Patch(1));
    let [a, b, c, _] = scene.planes.as_slice() else {
        panic!("four planes");
    };
    // The central ray comes from the side of −X, and T is rotated to −X, so the longitude θ₀
    // changes its sign.
    let angle = 0.6_f64.asin();
    assert!((a.longitude.abs() - angle).abs() < 1e-12, "{}", a.longitude); // rounding
    assert!((a.longitude + b.longitude).abs() < 1e-12); // rounding
    assert!(
        (a.frame.d.x - 0.6).abs() < 1e-12
            && (a.frame.x.cross(a.frame.y) - a.frame.d).length() < 1e-12
    ); // rounding
    assert_eq!(
        (b.orientation, c.orientation),
        (Orientation::LocalNormals, Orientation::Orthogonal)
    );
    // At normal incidence T is rotated to −X, so T never points along X.
    assert!(a.frame.x.dot(scene.path.frame.x) < 0.0);
}

#[test]
fn curvatures_of_a_mesh_are_those_of_what_it_samples() {
    let text = text()
        .replace(GLASS, &GLASS.replace("1.44", "9.44"))
        .replace("\"glass\"]", "\"mesh\"]")
        .replace("(2.4, 0, 0.3)", "(1.44, 0.02, 0.58)")
        .replace("(name: \"d\", at: After(\"glass\")),", "");
    let scene = resolved(&text).unwrap();
    let hit = scene.path.legs[2].leaves.unwrap();
    let patch = scene.meshes[0].osculating(&hit).unwrap();
    // The sphere has a radius of 0.2 m and triangles of 1 cm. The fit extends over 6 edges of
    // triangles, where (r/R)² is a tenth and the sphere departs from a paraboloid.
    for k in &patch.curvature[..2] {
        assert!((k / 5.0 - 1.0).abs() < 0.1, "{k}");
    }
    let outward = (hit.point - scene.meshes[0].center).normalize();
    // The error of interpolation is the square of a triangle's size divided by the radius of the
    // sphere.
    assert!(
        hit.normal.dot(outward) > 1.0 - 1e-5,
        "{}",
        hit.normal.dot(outward)
    );

    let saddle = r#"(
        light: Projector(center: (-0.6, 0.1, 0.8), image: (width: (0.1, 0.1))),
        surfaces: [Mesh(name: "mesh", center: (0, 0, 0), mesh: Paraboloid(curvatures: (-0.5, 0.3), half: 0.5, cells: 100), event: Mirror)],
        path: (direction: (0.6, -0.1, -0.8), x_axis: (1, 0.2, 0), visits: ["mesh"]),
        planes: [(name: "a", at: After("mesh"))],
        window: (x: Hann(0.1), u: Hann(0.1)), frequencies: (rho: (max: 10), nu: (max: 10)), run: (photons: 1000),
    )"#;
    let scene = resolved(saddle).unwrap();
    let patch = scene.meshes[0]
        .osculating(&scene.path.legs[1].leaves.unwrap())
        .unwrap();
    let mut found = [patch.curvature[0], patch.curvature[1]];
    found.sort_by(f64::total_cmp);
    // The vertices of the mesh lie on a paraboloid, so the fit is exact at its vertex, except
    // that the ray ends on a facet (some 1e-5 m inside).
    assert!(
        (found[0] + 0.5).abs() < 1e-4 && (found[1] - 0.3).abs() < 1e-4,
        "{found:?}"
    );
}

/// For each case: the text that is replaced, its replacement, and the reported field.
const BAD: &[(&str, &str, &str)] = &[
    (
        "facing: (0.6, 0, -0.8)",
        "facing: (1, 0, 0.001)",
        "path.visits[0]",
    ),
    (
        "visits: [\"mirror\", \"glass\"]",
        "visits: [\"mirror\", \"glass\"], leaves: (0, 0, -1)",
        "path.leaves",
    ),
    (
        "at: After(\"glass\")",
        "at: Before(\"mesh\"), orientation: Tangent",
        "planes[3].orientation",
    ),
    ("event: Mirror)", "event: ThinLens(0))", "surfaces[0].event"),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Ggx(0))))",
        "surfaces[0].event.brdf.lobe",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Beckmann(2))))",
        "surfaces[0].event.brdf.lobe",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Phong(-1))))",
        "surfaces[0].event.brdf.lobe",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Phong(NaN))))",
        "surfaces[0].event.brdf.lobe",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian, albedo: 1.5)))",
        "surfaces[0].event.brdf.albedo",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian, fresnel: Dielectric(0))))",
        "surfaces[0].event.brdf.fresnel",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian, fresnel: Conductor(n: NaN, k: 1))))",
        "surfaces[0].event.brdf.fresnel.n",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian, fresnel: Conductor(n: 1, k: -1))))",
        "surfaces[0].event.brdf.fresnel.k",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian, incoming: [1, 1.5])))",
        "surfaces[0].event.brdf.incoming[1]",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian, outgoing: [1])))",
        "surfaces[0].event.brdf.outgoing",
    ),
    (
        "event: Mirror)",
        "event: Sum(terms: []))",
        "surfaces[0].event.terms",
    ),
    (
        "event: Mirror)",
        "event: Sum(terms: [(brdf: (lobe: Lambertian)), (brdf: (lobe: Phong(-1)))]))",
        "surfaces[0].event.terms[1].brdf.lobe",
    ),
    (
        "event: Mirror)",
        "event: Sum(terms: [(brdf: (lobe: Lambertian), weight: Checkerboard(0))]))",
        "surfaces[0].event.terms[0].weight",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian), blend: Checkerboard(0.1)))",
        "surfaces[0].event.blend",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian), other: (lobe: Lambertian)))",
        "surfaces[0].event.other",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian), texture: Checkerboard(0)))",
        "surfaces[0].event.texture",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian), texture: Cosine(axis: X, frequency: inf)))",
        "surfaces[0].event.texture.frequency",
    ),
    (
        "event: Mirror)",
        "event: Reflects(brdf: (lobe: Lambertian), texture: Cosine(axis: Y, frequency: 1, modulation: 2)))",
        "surfaces[0].event.texture.modulation",
    ),
    ("aperture: 0.4", "aperture: 0", "surfaces[0].aperture"),
    ("aperture: 0.4", "aperture: 2.5", "surfaces[0].aperture"),
    ("aperture: 0.4", "aperture: NaN", "surfaces[0].aperture"),
    (
        "form: Sphere(-0.5)",
        "form: Sphere(inf)",
        "surfaces[0].form",
    ),
    (
        "facing: (0.6, 0, -0.8)",
        "facing: (0, 0, 0)",
        "surfaces[0].facing",
    ),
    (
        "facing: (0.6, 0, -0.8)",
        "facing: (0.6, NaN, -0.8)",
        "surfaces[0].facing[1]",
    ),
    (
        "along: (1, 0, 0)",
        "along: (0.6, 0, -0.8)",
        "surfaces[0].facing",
    ),
    (
        "event: Mirror)",
        "event: ThinLens(0.5))",
        "surfaces[0].event",
    ),
    (
        "front: 1, back: 1.5",
        "front: 0, back: 1.5",
        "surfaces[1].event.front",
    ),
    (
        "front: 1, back: 1.5",
        "front: 1, back: NaN",
        "surfaces[1].event.back",
    ),
    ("center: (0, 0, 1)", "center: (0, 0.9, 1)", "path.visits[0]"),
    (
        "visits: [\"mirror\", \"glass\"]",
        "visits: [\"glass\", \"mirror\"]",
        "path.visits[0]",
    ),
    (
        "(name: \"d\", at: After(\"glass\"))",
        "(name: \"d\", at: After(\"glass\"), orientation: Mirrored)",
        "planes[3].orientation",
    ),
    (
        "(name: \"d\", at: After(\"glass\"))",
        "(name: \"d\", at: Distance(0.5), orientation: Tangent)",
        "planes[3].orientation",
    ),
    (
        "width: (0.1, 0.2)",
        "width: (0.1, 0)",
        "light.image.width[1]",
    ),
    (
        "frequency: 20",
        "frequency: -20",
        "light.image.grating.frequency",
    ),
    (
        "frequency: 20",
        "frequency: 20, modulation: 1.5",
        "light.image.grating.modulation",
    ),
    ("intensity: 2", "intensity: inf", "light.intensity"),
    (
        "rings: 60), event: Mirror",
        "rings: 60), event: ThinLens(1)",
        "surfaces[2].event",
    ),
    (
        "Star(radius: 0.2, relief: 0, lobes: 0, rings: 60)",
        "Paraboloid(curvatures: (1, NaN), half: 1, cells: 9)",
        "surfaces[2].mesh.curvatures[1]",
    ),
    (
        "Star(radius: 0.2, relief: 0, lobes: 0, rings: 60)",
        "Paraboloid(curvatures: (1, 1), half: 0, cells: 9)",
        "surfaces[2].mesh.half",
    ),
    (
        "Star(radius: 0.2, relief: 0, lobes: 0, rings: 60)",
        "Paraboloid(curvatures: (1, 1), half: 1, cells: 0)",
        "surfaces[2].mesh.cells",
    ),
];

#[test]
fn each_bad_value_is_named() {
    for (from, to, field) in BAD {
        let text = text();
        assert!(text.contains(from), "{from}");
        let error = resolved(&text.replacen(from, to, 1)).expect_err(to);
        let SceneError::Values(faults) = &error else {
            panic!("{to}: {error}");
        };
        assert!(
            faults.iter().any(|fault| fault.field == *field),
            "{to}: {error}"
        );
    }
}

/// A path along which light would be totally reflected is refused.
#[test]
fn total_reflection_is_named() {
    let grazing = r#"Smooth(name: "glass", center: (1.44, 0, 0.58), facing: (0.1, 0, 1), form: Plane, aperture: 0.3, event: Refraction(front: 1.5, back: 1))"#;
    let error = resolved(&text().replace(GLASS, grazing)).expect_err("total reflection");
    assert!(
        error
            .to_string()
            .contains("without total internal reflection"),
        "{error}"
    );
}
