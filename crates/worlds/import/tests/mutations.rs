//! Damaged scenes. Each damaged scene is imported or refused, and none causes a panic.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_first, folder, told};
use crate::gltf_scene;
use etendue_import::{Options, import, import_mitsuba, import_pbrt};
use std::fs;

const SCENE: &str = r#"<scene version="2.1.0"><default name="n" value="3"/><path value="."/><include filename="part.xml"/>
<integrator type="path"><integer name="max_depth" value="$n"/></integrator>
<sensor type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.1"/>
<transform name="to_world"><lookat origin="1,2,3" target="0,0,0" up="0,0,1"/></transform>
<film type="hdrfilm"><integer name="width" value="4"/><rfilter type="box"/></film></sensor>
<bsdf type="twosided" id="m"><bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.1"/></bsdf></bsdf>
<shape type="obj"><string name="filename" value="a.obj"/><ref id="m"/><transform name="to_world"><rotate x="1" angle="30"/><scale value="2"/></transform></shape>
<shape type="ply"><string name="filename" value="a.ply"/><emitter type="area"><spectrum name="radiance" value="400:1, 500:2"/></emitter></shape>
<shape type="shapegroup" id="g"><shape type="cylinder"><point name="p1" x="0" y="1" z="2"/></shape></shape><shape type="instance"><ref id="g"/></shape>
<emitter type="envmap"><string name="filename" value="a.hdr"/></emitter><alias id="m" as="k"/></scene>"#;
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\nf -1//1 1 2\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
const HDR: &str = "#?RADIANCE\n\n-Y 2 +X 1\nabcdabcd";
const PART: &str =
    "<shape type=\"sphere\" version=\"3.0.0\"><float name=\"radius\" value=\"2\"/></shape>";

const PBRT: &str = r#"LookAt 1 2 3 0 0 0 0 1 0 Camera "perspective" "float fov" 40 "float lensradius" .1
Film "rgb" "integer xresolution" [4] "integer yresolution" 3 Integrator "path" "integer maxdepth" 3
WorldBegin Include "part.pbrt" Attribute "shape" "float radius" .5
Texture "t" "spectrum" "checkerboard" "float uscale" 3 "rgb tex1" [.1 .2 .3]
Texture "s" "spectrum" "scale" "texture tex" "t" "float scale" .5
MakeNamedMaterial "m" "string type" "conductor" "spectrum eta" "metal-Au-eta" "float roughness" .1
AttributeBegin Rotate 30 1 0 0 NamedMaterial "m" Shape "sphere" ReverseOrientation Shape "disk" "float alpha" .5 AttributeEnd
Material "diffuse" "texture reflectance" "s" Shape "plymesh" "string filename" "a.ply"
AreaLightSource "diffuse" "blackbody L" [3000] Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2]
ObjectBegin "o" Shape "cylinder" ObjectEnd Transform [1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1] ObjectInstance "o"
LightSource "infinite" "string filename" "b.hdr" LightSource "spot" "spectrum I" [400 1 500 2]
"#;
const SQUARE: &str = "#?RADIANCE\n\n-Y 2 +X 2\nabcdabcdabcdabcd";
const PBRT_PART: &str = "Scale 2 2 2\nMaterial \"dielectric\" \"float eta\" 1.4\nShape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n";

/// A reproducible random sequence (Marsaglia 2003).
fn next(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    usize::try_from(*state >> 40).unwrap()
}

/// The bytes of texts.
fn bytes<'a>(files: &[(&'a str, &'a str)]) -> Vec<(&'a str, &'a [u8])> {
    let files = files.iter();
    files.map(|(name, text)| (*name, text.as_bytes())).collect()
}

#[test]
fn no_byte_makes_it_panic() {
    let [obj, ply, hdr] = [("a.obj", OBJ), ("a.ply", PLY), ("a.hdr", HDR)];
    let files = [("a.xml", SCENE), obj, ply, hdr, ("part.xml", PART)];
    damage(&bytes(&files), 3000);
}

#[test]
fn no_byte_of_a_pbrt_scene_makes_it_panic() {
    let [ply, hdr, part] = [("a.ply", PLY), ("b.hdr", SQUARE), ("part.pbrt", PBRT_PART)];
    damage(&bytes(&[("a.pbrt", PBRT), ply, hdr, part]), 3000);
}

/// In each round, damages one of the files and imports the scene. In every second round, this is
/// the first file.
fn damage(files: &[(&str, &[u8])], rounds: usize) {
    let folder = folder(files);
    let main = folder.path().join(files[0].0);
    let whole = import(&main, &Options::default());
    assert!(whole.is_ok_and(|read| read.world.shapes.len() > 1));
    let mut state = 88_172_645_463_325_252;
    let (mut read, mut refused) = (0, 0);
    for round in 0..rounds {
        // Even rounds damage the scene file, and odd rounds damage one of the files that the scene
        // uses.
        let which = match files.len() {
            others @ 2.. if round % 2 == 1 => 1 + next(&mut state) % (others - 1),
            _ => 0,
        };
        let (name, sound) = files[which];
        let mut bytes = sound.to_vec();
        for _ in 0..=next(&mut state) % 2 {
            let at = next(&mut state) % bytes.len();
            match next(&mut state) % 4 {
                0 => bytes[at] = b"0123456789-.e\"<>/$= \n[]"[next(&mut state) % 23],
                1 => bytes[at] ^= 1 << (next(&mut state) % 8),
                2 => drop(bytes.remove(at)),
                _ => bytes.truncate(at.max(1)),
            }
        }
        fs::write(folder.path().join(name), &bytes).unwrap();
        match import(&main, &Options::default()) {
            Ok(_) => read += 1,
            Err(causes) => {
                assert!(!causes.causes.is_empty() && !causes.to_string().is_empty());
                refused += 1;
            }
        }
        fs::write(folder.path().join(name), sound).unwrap();
    }
    // Some damaged scenes are imported and others are refused, so both outcomes are tested.
    let few = rounds / 15;
    assert!(
        read > few && refused > few,
        "{read} read, {refused} refused"
    );
}

#[test]
fn no_byte_of_gltf_makes_it_panic() {
    let text = everything();
    let data = gltf_scene::binary(&text);
    damage(&[("a.gltf", text.as_bytes())], 3000);
    damage(&[("a.glb", &data)], 3000);
}

#[test]
fn no_byte_of_obj_makes_it_panic() {
    let more = "usemtl b\nf 1 2 3\nusemtl c\nf 2/1 3/2 4/1\n";
    let obj = format!("mtllib a.mtl\n{OBJ}{more}");
    let mtl = "newmtl b\nKd 0.1 0.2 0.3\nKs .5 .5 .5\nNs 20\nd 0.5\nillum 2\nnewmtl c\nKe 1 2 3\nmap_Kd -s 1 2 -o 0 1 a.hdr\nTf 1 1 1\nNi 1.5\n";
    let files = [("a.obj", &*obj), ("a.mtl", mtl), ("a.hdr", HDR)];
    damage(&bytes(&files), 6000);
}

/// A glTF scene that uses every feature.
fn everything() -> String {
    let nodes = r#"{"mesh":0,"children":[1,2]},{"mesh":0,"rotation":[0,0.6,0,0.8],"scale":[-1,2,1],"camera":0},
{"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,3,4,5,1],"extensions":{"KHR_lights_punctual":{"light":0}}}"#;
    let material = r#"{"doubleSided":true,"alphaMode":"MASK","alphaCutoff":0.4,"emissiveFactor":[1,0.5,0],
"pbrMetallicRoughness":{"metallicFactor":0.5,"roughnessFactor":0.3,"metallicRoughnessTexture":{"index":0},
"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"rotation":1,"scale":[2,3]}}}},
"extensions":{"KHR_materials_ior":{"ior":1.4},"KHR_materials_transmission":{"transmissionFactor":0.5}}}"#;
    let more = format!(
        r#"{},"cameras":[{{"type":"perspective","perspective":{{"yfov":0.8,"aspectRatio":2,"znear":0.5}}}}],
"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","intensity":5,"spot":{{"outerConeAngle":0.4}}}}]}}}}"#,
        gltf_scene::BASE
    );
    gltf_scene::mesh(nodes, material, &more)
}

#[test]
fn deep_and_wide_gltf_scenes_end() {
    // A chain of nodes, each of which is the child of the previous node.
    let node = |i: usize| format!(r#"{{"mesh":0,"children":[{}]}}"#, i + 1);
    let mut nodes: Vec<String> = (0..20_000).map(node).collect();
    nodes.push("{\"mesh\":0}".to_owned());
    let read = |text: &str| gltf_scene::read(text.as_bytes());
    let deep = read(&gltf_scene::mesh(&nodes.join(","), "", ""));
    assert_eq!(deep.unwrap().world.shapes.len(), 20_001);
    let nested = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(read(&nested).is_err());
    let back = gltf_scene::mesh("{\"mesh\":0,\"children\":[0]}", "", "");
    assert!(read(&back).is_err());
}

#[test]
fn deep_and_wide_scenes_end() {
    let folder = folder(&[]);
    let refused = |text: &str| {
        let read = import_mitsuba(text, folder.path(), &Options::default());
        told(read).map(drop).unwrap_err()
    };
    let deep = "<bsdf type=\"twosided\">".repeat(100_000) + &"</bsdf>".repeat(100_000);
    let causes = refused(&format!("<scene version=\"3.0.0\">{deep}</scene>"));
    assert_first(&causes, "elements");
    // References that double their content at each level.
    let mut doubled = String::from("<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"b0\"/>");
    for i in 1..64 {
        let j = i - 1;
        doubled += &format!(
            "<bsdf type=\"twosided\" id=\"b{i}\"><ref id=\"b{j}\"/><ref id=\"b{j}\"/></bsdf>"
        );
    }
    doubled += "<shape type=\"sphere\"><ref id=\"b63\"/></shape></scene>";
    assert_first(&refused(&doubled), "nested more than");
    // Groups and instances multiply the number of shapes.
    let group = "<shape type=\"sphere\"/>".repeat(2000);
    let instances = "<shape type=\"instance\"><ref id=\"g\"/></shape>".repeat(2000);
    let many = format!(
        "<scene version=\"3.0.0\"><shape type=\"shapegroup\" id=\"g\">{group}</shape>{instances}</scene>"
    );
    let causes = refused(&many);
    assert_eq!(causes.len(), 1, "{causes:?}");
    assert_first(&causes, "shapes, counting instances");
    let wrong = "<gizmo/>".repeat(5000);
    let causes = refused(&format!("<scene version=\"3.0.0\">{wrong}</scene>"));
    assert_eq!(causes.len(), 101);
    assert!(causes[100].contains("and 4900 more causes"));
}

#[test]
fn deep_and_wide_pbrt_scenes_end() {
    let files: Vec<(String, String)> = (0..60)
        .map(|i| {
            let next = format!("Include \"{}.pbrt\"\n", i + 1);
            (format!("{i}.pbrt"), next.repeat(if i < 59 { 2 } else { 0 }))
        })
        .collect();
    let all: Vec<(&str, &[u8])> = files.iter().map(|(n, t)| (&**n, t.as_bytes())).collect();
    let folder = folder(&all);
    let refused = |inside: &str| {
        let text = format!("WorldBegin\n{inside}");
        let read = import_pbrt(&text, folder.path(), &Options::default());
        told(read).map(drop).unwrap_err()
    };
    // Files that double their content at each level.
    assert_first(&refused("Include \"0.pbrt\""), "files are included");
    assert_first(
        &refused(&"AttributeBegin ".repeat(100_000)),
        "blocks are nested more than",
    );
    assert_first(
        &refused(&"Attribute \"shape\" \"float a\" 1 ".repeat(1000)),
        "attributes",
    );
    let object = "Shape \"sphere\" ".repeat(2000);
    let many = format!(
        "ObjectBegin \"o\" {object} ObjectEnd {}",
        "ObjectInstance \"o\" ".repeat(2000)
    );
    let causes = refused(&many);
    assert_eq!(causes.len(), 1, "{causes:?}");
    assert_first(&causes, "shapes, counting instances");
    // Textures that refer to one another in a long chain.
    let mut row = String::from("Texture \"t0\" \"spectrum\" \"constant\"\n");
    for i in 1..5000 {
        let before = i - 1;
        row += &format!("Texture \"t{i}\" \"spectrum\" \"scale\" \"texture tex\" \"t{before}\"\n");
    }
    row += "Material \"diffuse\" \"texture reflectance\" \"t4999\" Shape \"sphere\"";
    assert_first(&refused(&row), "too many textures are nested");
    // Materials that double their content at each level.
    let mut doubled = String::from("MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n");
    for i in 1..64 {
        let before = i - 1;
        doubled += &format!(
            "MakeNamedMaterial \"m{i}\" \"string type\" \"mix\" \"string materials\" [\"m{before}\" \"m{before}\"]\n"
        );
    }
    doubled += "NamedMaterial \"m63\" Shape \"sphere\"";
    assert_first(&refused(&doubled), "too many materials are nested");
    let causes = refused(&"ObjectEnd ".repeat(5000));
    assert_eq!(causes.len(), 101);
}
