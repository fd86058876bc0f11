//! The export of smooth surfaces, their BRDFs and patterns, and lights with pictures.

use super::{file, numbers, of_type, scene, stored, text};
use etendue_export::{Export, NotInMitsuba, mitsuba};
use roxmltree::{Document, Node};

const PROJECTOR: &str = "Projector(center: (0, 0, 0), intensity: 2, image: (width: (0.12, 0.06)))";

/// A scene with a given smooth surface, 0.5 m around its vertex.
fn smooth(light: &str, form: &str, event: &str) -> Result<Export, NotInMitsuba> {
    let text = format!(
        r#"(
            light: {light},
            surfaces: [Smooth(name: "s", center: (0, 0, 1), facing: (0.6, 0, -0.8), form: {form}, aperture: 0.5, event: {event})],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["s"]),
            planes: [
                (name: "mirrored", at: Before("s"), orientation: Mirrored),
                (name: "leaving", at: After("s")),
            ],
            window: (x: Hann(0.15), u: Hann(0.3)),
            frequencies: (azimuths: 2, rho: (max: 8), nu: (max: 8)),
        )"#
    );
    mitsuba(&scene("own", &text))
}

fn reflects(form: &str, brdf: &str) -> Export {
    smooth(PROJECTOR, form, &format!("Reflects({brdf})")).expect("words of Mitsuba")
}

/// The value of a parameter.
fn number(node: &Node<'_, '_>, name: &str) -> f64 {
    let mut inside = node.descendants();
    let found = inside.find(|n| n.attribute("name") == Some(name));
    let value = found.and_then(|n| n.attribute("value"));
    value.expect("a value").parse().expect("a number")
}

/// The width and height of a picture, and its values, which begin with the lowest row.
fn picture(export: &Export, name: &str) -> ([usize; 2], Vec<f32>) {
    let bytes = file(export, name);
    let head = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n');
    let [_, size, scale] = head.take(3).map(|(i, _)| i).collect::<Vec<_>>()[..] else {
        panic!("three lines");
    };
    let size = std::str::from_utf8(&bytes[3..size]).expect("a picture");
    let size: Vec<usize> = size
        .split(' ')
        .map(|n| n.parse().expect("a picture"))
        .collect();
    let numbers = bytes[scale + 1..].chunks_exact(4);
    let numbers = numbers.map(|n| f32::from_le_bytes(n.try_into().expect("a picture")));
    ([size[0], size[1]], numbers.collect())
}

#[test]
fn every_lobe_has_its_word_and_its_numbers() {
    let parsed = |export: &Export| text(export, "scene.xml").to_owned();
    let xml = parsed(&reflects(
        "Sphere(0.5)",
        "brdf: (lobe: Phong(30), albedo: 0.8)",
    ));
    let xml = Document::parse(&xml).unwrap();
    let [phong] = of_type(&xml, "phong").try_into().unwrap();
    assert!((number(&phong, "exponent") - 30.0).abs() < 1e-12); // rounding
    // Multiplied by (n + 2)/2π, this value is (n + 1)/2π times the albedo.
    assert!((number(&phong, "specular_reflectance") - 0.8 * 31.0 / 32.0).abs() < 1e-12); // rounding
    assert!(number(&phong, "diffuse_reflectance").abs() < 1e-300); // the very number
    for (lobe, distribution) in [("Ggx(0.2)", "ggx"), ("Beckmann(0.2)", "beckmann")] {
        let brdf =
            format!("brdf: (lobe: {lobe}, albedo: 0.9, fresnel: Conductor(n: 0.96, k: 6.69))");
        let xml = parsed(&reflects("Plane", &brdf));
        let xml = Document::parse(&xml).unwrap();
        let [rough] = of_type(&xml, "roughconductor").try_into().unwrap();
        assert_eq!(
            rough
                .children()
                .find(|n| n.has_tag_name("string"))
                .unwrap()
                .attribute("value"),
            Some(distribution)
        );
        for (name, expected) in [
            ("alpha", 0.2),
            ("eta", 0.96),
            ("k", 6.69),
            ("specular_reflectance", 0.9),
        ] {
            assert!((number(&rough, name) - expected).abs() < 1e-12, "{name}"); // the very number
        }
        // A flat uniform surface needs no triangles.
        assert_eq!(of_type(&xml, "disk").len(), 1);
    }
    // A dielectric reflects like a metal without absorption; without a Fresnel factor, a surface
    // reflects all light.
    let glass = parsed(&reflects(
        "Plane",
        "brdf: (lobe: Ggx(0.2), fresnel: Dielectric(1.5))",
    ));
    assert!(glass.contains(r#"name="eta" value="1.5"/><spectrum name="k" value="0.0"/>"#));
    let white = parsed(&reflects("Plane", "brdf: (lobe: Ggx(0.2))"));
    assert!(white.contains(r#"name="material" value="none""#));
    // Mitsuba has no Fresnel factor on a lobe.
    for lobe in ["Phong(30)", "Lambertian"] {
        let brdf = format!("brdf: (lobe: {lobe}, fresnel: Dielectric(1.5))");
        let xml = parsed(&reflects("Plane", &brdf));
        let xml = Document::parse(&xml).unwrap();
        let [factor] = of_type(&xml, "etendue_fresnel").try_into().unwrap();
        assert!((number(&factor, "n") - 1.5).abs() < 1e-12, "{lobe}"); // the very number
        assert!(factor.children().any(|n| n.has_tag_name("bsdf")));
    }
}

#[test]
fn mirrors_work_on_both_sides_and_interfaces_have_their_front_outside() {
    let mirror = smooth(PROJECTOR, "Sphere(-0.5)", "Mirror").unwrap();
    let xml = Document::parse(text(&mirror, "scene.xml")).unwrap();
    let [twosided] = of_type(&xml, "twosided").try_into().unwrap();
    assert_eq!(
        twosided.first_element_child().unwrap().attribute("type"),
        Some("conductor")
    );
    let glass = smooth(PROJECTOR, "Sphere(0.5)", "Refraction(front: 1, back: 1.5)").unwrap();
    let xml = Document::parse(text(&glass, "scene.xml")).unwrap();
    let [glass] = of_type(&xml, "dielectric").try_into().unwrap();
    assert!((number(&glass, "int_ior") - 1.5).abs() < 1e-12); // the very number
    assert!((number(&glass, "ext_ior") - 1.0).abs() < 1e-12); // the very number
    let lens = smooth(PROJECTOR, "Plane", "ThinLens(0.5)").unwrap_err();
    assert!(
        lens.to_string().contains("thin lenses in cameras only"),
        "{lens}"
    );
    let mesh = mitsuba(&stored("table1/mesh_mirror")).unwrap();
    let ply = String::from_utf8_lossy(file(&mesh, "mesh_0.ply"));
    assert!(ply.contains("element face 80000\n") && ply.contains("property double nx\n"));
    let xml = Document::parse(text(&mesh, "scene.xml")).unwrap();
    assert_eq!(of_type(&xml, "conductor").len(), 1);
}

#[test]
fn patterns_become_pictures() {
    let texture = |pattern: &str| {
        let brdf = format!("brdf: (lobe: Lambertian, albedo: 0.5), texture: {pattern}");
        reflects("Plane", &brdf)
    };
    let board = texture("Checkerboard(0.2)");
    assert_eq!(
        picture(&board, "smooth_0_reflectance.pfm"),
        ([2, 2], vec![0.0, 0.5, 0.5, 0.0])
    );
    let xml = Document::parse(text(&board, "scene.xml")).unwrap();
    let [bitmap] = of_type(&xml, "bitmap")
        .into_iter()
        .filter(|n| n.attribute("name") == Some("reflectance"))
        .collect::<Vec<_>>()
        .try_into()
        .unwrap();
    assert_eq!(numbers(&bitmap, "scale", &["x", "y"]), [5.0, 5.0]);
    // Texture coordinates are in metres, so even a flat surface becomes a mesh.
    assert!(file(&board, "smooth_0.ply").len() > 1000);
    let cosine = texture("Cosine(axis: Y, frequency: 15, modulation: 0.9, phase: 1.5)");
    let ([width, rows], values) = picture(&cosine, "smooth_0_reflectance.pfm");
    assert_eq!([width, rows], [2, 512]);
    // The values begin with the lowest row, which is the last row of the picture. The centre of
    // this row is half a pixel before the end of a period, where the cosine is nearly 1.
    let expected = 0.25 * (1.0 + 0.9 * f64::cos(std::f64::consts::TAU * 0.5 / 512.0));
    assert!((f64::from(values[0]) - expected).abs() < 1e-7); // 32 bits
    let xml = Document::parse(text(&cosine, "scene.xml")).unwrap();
    let bitmaps = of_type(&xml, "bitmap");
    let bitmap = bitmaps
        .iter()
        .find(|n| n.attribute("name") == Some("reflectance"))
        .unwrap();
    assert_eq!(numbers(bitmap, "scale", &["x", "y"]), [0.0, 15.0]);
}

#[test]
fn blends_are_of_two_lobes() {
    let tiles = reflects(
        "Plane",
        "brdf: (lobe: Phong(400)), other: (lobe: Phong(60), albedo: 0.6), blend: Checkerboard(0.1)",
    );
    let xml = Document::parse(text(&tiles, "scene.xml")).unwrap();
    let [blend] = of_type(&xml, "blendbsdf").try_into().unwrap();
    // Weight 0 of Mitsuba's blend selects the first BRDF, which is the other lobe.
    let lobes: Vec<f64> = of_type(&xml, "phong")
        .iter()
        .map(|n| number(n, "exponent"))
        .collect();
    assert_eq!(lobes, [60.0, 400.0]);
    assert!(
        blend
            .children()
            .any(|n| n.attribute("name") == Some("weight"))
    );
    assert_eq!(
        picture(&tiles, "smooth_0_weight.pfm").1,
        [0.0, 1.0, 1.0, 0.0]
    );
    let smooth_blend = reflects(
        "Plane",
        "brdf: (lobe: Phong(400)), other: (lobe: Ggx(0.2)), blend: Cosine(axis: X, frequency: 3)",
    );
    let xml = Document::parse(text(&smooth_blend, "scene.xml")).unwrap();
    assert_eq!(of_type(&xml, "blendbsdf").len(), 1);
    let (_, values) = picture(&smooth_blend, "smooth_0_weight.pfm");
    let (low, high) = values
        .iter()
        .fold((1.0_f32, 0.0_f32), |(l, h), v| (l.min(*v), h.max(*v)));
    assert!(low < 1e-4 && high > 1.0 - 1e-4); // half a pixel beside both ends
}

#[test]
fn what_mitsuba_cannot_add_is_refused() {
    let refused = |event: &str| smooth(PROJECTOR, "Plane", event).unwrap_err();
    let name = || "s".to_owned();
    let sum = "Sum(terms: [(brdf: (lobe: Phong(400), albedo: 0.5)), (brdf: (lobe: Lambertian, albedo: 0.5))])";
    assert_eq!(refused(sum), NotInMitsuba::Sum { name: name() });
    let alone = "Sum(terms: [(brdf: (lobe: Phong(400)), weight: Checkerboard(0.1))])";
    assert_eq!(refused(alone), NotInMitsuba::Sum { name: name() });
    for table in ["incoming", "outgoing"] {
        let event = format!("Reflects(brdf: (lobe: Phong(400), {table}: [1, 0.5]))");
        assert_eq!(refused(&event), NotInMitsuba::AngleTable { name: name() });
    }
}

#[test]
fn lights_shine_through_pictures() {
    let projector = smooth(PROJECTOR, "Plane", "Mirror").unwrap();
    let ([width, rows], values) = picture(&projector, "light_picture.pfm");
    assert_eq!([width, rows], [1024, 1024]);
    // The centre value is 2/π; three widths of 0.12 are visible to each side.
    assert!((f64::from(values[512 * 1024 + 512]) - 2.0 / std::f64::consts::PI).abs() < 1e-4); // half a pixel beside
    let xml = Document::parse(text(&projector, "scene.xml")).unwrap();
    let [light] = of_type(&xml, "projector").try_into().unwrap();
    let half = f64::tan((0.5 * number(&light, "fov")).to_radians());
    assert!((half - 0.36).abs() < 1e-12); // rounding
    let beam = smooth(
        "Beam(center: (0, 0, 0), irradiance: 3, image: (width: (0.1, 0.1)))",
        "Plane",
        "Mirror",
    )
    .unwrap();
    let (_, values) = picture(&beam, "light_picture.pfm");
    assert!((values[512 * 1024 + 512] - 3.0).abs() < 1e-3); // half a pixel beside the middle
    let xml = Document::parse(text(&beam, "scene.xml")).unwrap();
    assert_eq!(of_type(&xml, "directionalarea").len(), 1);
}

/// The exported sky is black where its light would travel against the central ray.
#[test]
fn environments_become_maps() {
    let sky =
        "Environment(center: (0, 0, 0), map: Lobes([(from: (0, 0, -1), width: 0.5, radiance: 3)]))";
    let export = smooth(sky, "Sphere(0.5)", "Reflects(brdf: (lobe: Lambertian))").unwrap();
    let ([width, rows], values) = picture(&export, "light_sky.pfm");
    assert_eq!([width, rows], [4096, 2049]);
    let most = values.iter().copied().fold(0.0_f32, f32::max);
    assert!((most - 3.0).abs() < 1e-4); // half a pixel beside the peak
    let dark = values.iter().filter(|v| **v == 0.0).count();
    // Half of all directions are dark. Longitude is uniform, so half of the pixels are also dark,
    // within a column or two.
    assert!(dark.abs_diff(values.len() / 2) < 3 * rows, "{dark}");
    let xml = Document::parse(text(&export, "scene.xml")).unwrap();
    assert_eq!(of_type(&xml, "envmap").len(), 1);
    let planes: serde_json::Value = serde_json::from_str(text(&export, "planes.json")).unwrap();
    assert_eq!(planes["planes"][0]["orientation"], "Mirrored");
    assert_eq!(planes["planes"][0]["ends"], "smooth_0");
    let theta = planes["planes"][0]["longitude"].as_f64().unwrap();
    assert!((theta.abs() - f64::acos(0.8)).abs() < 1e-12, "{theta}"); // rounding
}
