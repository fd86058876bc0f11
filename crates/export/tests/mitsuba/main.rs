//! Reads back the files that are written for Mitsuba.

mod smooth;

use etendue_export::{Export, NotInMitsuba, mitsuba};
use etendue_scene::{Scene, SceneFile, resolve};
use roxmltree::{Document, Node};

fn scene(name: &str, text: &str) -> Scene {
    let file = SceneFile::parse(text).expect("a scene file");
    resolve(name, file, ".".as_ref(), u64::MAX).expect("a sound scene")
}

fn stored(name: &str) -> Scene {
    let path = format!("{}/../../scenes/{name}.ron", env!("CARGO_MANIFEST_DIR"));
    let name = name.rsplit('/').next().unwrap_or(name);
    scene(name, &std::fs::read_to_string(path).expect("scenes/"))
}

/// A scene with the given light and blockers, above a floor of 1/3 by 0.1 m.
fn of(light: &str, blockers: &str) -> Scene {
    let text = format!(
        r#"(
            light: {light}, blockers: [{blockers}],
            surfaces: [Rectangle(name: "a--- & <floor>", center: (0, 2, 0), size: (0.3333333333333333, 0.1), albedo: 0.7)],
            path: (direction: (0, 2, 0), x_axis: (0, 0, 1), visits: ["a--- & <floor>"]),
            planes: [(name: "a--b-", at: Distance(0.3)), (name: "leaving", at: After("a--- & <floor>"), quantity: DifferentialIrradiance)],
            window: (x: Hann(0.5), u: Gaussian(width: 0.1, cut: 0.3)),
            frequencies: (azimuths: 3, rho: (max: 8), nu: (max: 16)),
        )"#
    );
    scene("own", &text)
}

fn file<'a>(export: &'a Export, name: &str) -> &'a [u8] {
    let found = export.files.iter().find(|(n, _)| n == name);
    &found.expect("a file of that name").1
}

fn text<'a>(export: &'a Export, name: &str) -> &'a str {
    std::str::from_utf8(file(export, name)).expect("text")
}

/// Checks whether a mesh file states these numbers of vertices and faces.
fn counts(export: &Export, name: &str, [vertices, faces]: [usize; 2]) -> bool {
    let ply = String::from_utf8_lossy(file(export, name));
    ply.contains(&format!("element vertex {vertices}\n"))
        && ply.contains(&format!("element face {faces}\n"))
}

fn of_type<'a>(xml: &'a Document<'a>, kind: &str) -> Vec<Node<'a, 'a>> {
    let nodes = xml.descendants();
    nodes
        .filter(|n| n.attribute("type") == Some(kind))
        .collect()
}

/// The numbers in the attributes of the first descendant with this tag.
fn numbers(node: &Node<'_, '_>, tag: &str, names: &[&str]) -> Vec<f64> {
    let mut inside = node.descendants().filter(|n| n.has_tag_name(tag));
    let element = inside.next().expect("such an element");
    let value = |name: &&str| element.attribute(*name).and_then(|v| v.parse().ok());
    names.iter().map(|n| value(n).expect("a number")).collect()
}

const SQUARE: &str = "Rectangle(center: (0, 0, 0), size: (0.2, 0.1), radiance: 0.7)";

#[test]
fn every_shape_is_there_once_with_its_numbers() {
    let shapes = r#"Shapes(name: "cards", center: (0.25, 1.1, 0), shapes: [
        Rectangle(center: (0.3, 0), size: (0.1, 0.2)),
        Disc(center: (-0.3, 0.7), radius: 0.3333333333333333),
        HalfPlane(axis: X, edge: 0.9, opaque: Above),
    ])"#;
    let export = mitsuba(&of(SQUARE, shapes)).unwrap();
    let names: Vec<&str> = export.files.iter().map(|(n, _)| n.as_str()).collect();
    assert_eq!(names, ["scene.xml", "planes.json", "blockers_0.ply"]);
    let xml = Document::parse(text(&export, "scene.xml")).unwrap();
    let [light, floor] = of_type(&xml, "rectangle").try_into().unwrap();
    assert_eq!(light.attribute("id"), Some("light"));
    assert_eq!(numbers(&light, "scale", &["x", "y"]), [0.1, 0.05]);
    assert_eq!(numbers(&light, "spectrum", &["value"]), [0.7]);
    assert_eq!(numbers(&floor, "scale", &["x", "y"]), [0.5 / 3.0, 0.05]);
    assert_eq!(
        numbers(&floor, "translate", &["x", "y", "z"]),
        [0.0, 0.0, 2.0]
    );
    assert_eq!(numbers(&floor, "spectrum", &["value"]), [0.7]);
    let [disk] = of_type(&xml, "disk").try_into().unwrap();
    // Y = D × X is the world's x axis.
    assert_eq!(numbers(&disk, "scale", &["x", "y"]), [1.0 / 3.0; 2]);
    assert_eq!(
        numbers(&disk, "translate", &["x", "y", "z"]),
        [-0.3, 0.25 + 0.7, 1.1]
    );
    assert_eq!(of_type(&xml, "ply").len(), 1);
    assert!(counts(&export, "blockers_0.ply", [8, 4]));
    // A shape without a material reflects half in Mitsuba.
    let shapes = xml.descendants().filter(|n| n.has_tag_name("shape"));
    for shape in shapes {
        let material =
            |n: Node<'_, '_>| n.has_tag_name("bsdf") || n.attribute("id") == Some("black");
        assert_eq!(shape.children().filter(|n| material(*n)).count(), 1);
    }
}

#[test]
fn many_squares_are_one_mesh_with_the_very_corners() {
    let scene = stored("fig9b");
    let export = mitsuba(&scene).unwrap();
    assert!(counts(&export, "blockers_0.ply", [1600, 800]));
    let etendue_field::Mask::Opaque { shapes, .. } = &scene.blockers[0].mask else {
        panic!("squares are opaque");
    };
    let bounds = shapes[0].bounds();
    let corner = [bounds.extent(0)[0], bounds.extent(1)[0], 1.0].map(f64::to_le_bytes);
    let ply = file(&export, "blockers_0.ply");
    let size = 1600 * 24 + 800 * 13; // three doubles; a byte and three integers
    assert!(ply[ply.len() - size..].starts_with(corner.as_flattened()));
    assert_eq!(export, mitsuba(&scene).unwrap());
}

#[test]
fn planes_are_those_of_the_scene() {
    let planes = mitsuba(&of(SQUARE, "")).unwrap();
    let planes: serde_json::Value = serde_json::from_str(text(&planes, "planes.json")).unwrap();
    assert_eq!(planes["world"]["D"], serde_json::json!([0.0, 1.0, 0.0]));
    let plane = &planes["planes"][0];
    assert_eq!(plane["name"], "a--b-");
    assert_eq!(plane["frame"]["O"], serde_json::json!([0.0, 0.0, 0.3]));
    assert_eq!(plane["visits"], serde_json::json!([]));
    assert_eq!(plane["ends"], "surface_0");
    assert_eq!(plane["orientation"], "Orthogonal");
    assert_eq!(plane["window"]["v"]["Gaussian"]["cut"], 0.3);
    assert_eq!(
        plane["frequencies"]["rho"],
        serde_json::json!({"half": 8, "spacing": 1.0})
    );
    let plane = &planes["planes"][1];
    assert_eq!(plane["frame"]["O"], serde_json::json!([0.0, 0.0, 2.0]));
    assert_eq!(plane["frame"]["D"], serde_json::json!([-0.0, -0.0, -1.0]));
    assert_eq!(plane["frame"]["X"], serde_json::json!([-1.0, -0.0, -0.0]));
    assert_eq!(plane["visits"], serde_json::json!(["surface_0"]));
    assert_eq!(plane["ends"], serde_json::Value::Null);
    assert_eq!(plane["leg"], 1);
    assert_eq!(plane["quantity"], "DifferentialIrradiance");
}

#[test]
fn points_and_meshes_are_said() {
    let point = mitsuba(&of("Point(center: (0, 0, 0), intensity: 1.5)", "")).unwrap();
    let xml = Document::parse(text(&point, "scene.xml")).unwrap();
    // A point of Étendue emits into the half-space ahead.
    let [light] = of_type(&xml, "spot").try_into().unwrap();
    assert_eq!(numbers(&light, "spectrum", &["value"]), [1.5]);
    let angles = light.descendants().filter(|n| n.has_tag_name("float"));
    let angles: Vec<_> = angles.filter_map(|n| n.attribute("value")).collect();
    assert_eq!(angles, ["90", "89.999"]);
    let star = stored("mesh_blocker");
    let export = mitsuba(&star).unwrap();
    let faces = star.meshes[0].triangles.len();
    assert!(
        String::from_utf8_lossy(file(&export, "mesh_0.ply"))
            .contains(&format!("element face {faces}\n"))
    );
    let wall = stored("two_bounces");
    assert!(counts(&mitsuba(&wall).unwrap(), "surface_0.ply", [4, 2]));
}

#[test]
fn what_mitsuba_cannot_say_is_refused() {
    let spot = "Spot(center: (0, 0, 0), bulb: Disc(0.1), exponent: 3.5)";
    let error = mitsuba(&of(spot, "")).unwrap_err();
    assert!(matches!(error, NotInMitsuba::Light(_)));
    assert!(error.to_string().contains("exponent 3.5 cannot"));
    let lambertian = "Spot(center: (0, 0, 0), bulb: Disc(0.1), exponent: 0)";
    assert!(mitsuba(&of(lambertian, "")).is_ok());
    let grating = r#"Grating(name: "bars", center: (0, 1, 0), axis: X, frequency: 5)"#;
    let error = mitsuba(&of(SQUARE, grating)).unwrap_err();
    assert!(error.to_string().contains("\"bars\" cannot"));
    let behind = stored("wild/behind_the_sky_plane");
    let error = mitsuba(&behind).unwrap_err();
    assert!(
        matches!(error, NotInMitsuba::BehindTheSky { .. }),
        "{error}"
    );
}
