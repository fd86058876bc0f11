//! Mutated scenes of other programs: Mitsuba, pbrt, glTF and OBJ.

use super::case::Attack;
use super::dice::Dice;
use super::folder::Folder;
use super::stages::words;
use super::text;

/// Tokens of the formats.
const WORDS: &str = "< | /> | \" | \n | directionalarea | envmap | dielectric | principled | \
    mask | instance | shapegroup | ref | $res | matrix | ObjectBegin | ObjectInstance | \
    AttributeEnd | Include | trianglemesh | [ | nodes | children | usemtl | -1";

const MITSUBA: &str = r#"<scene version="3.0.0"><default name="res" value="8"/>
<integrator type="path"><integer name="max_depth" value="4"/></integrator>
<sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
<lookat origin="0, -4, 2" target="0, 0, 0.3" up="0, 0, 1"/></transform>
<film type="hdrfilm"><integer name="width" value="$res"/><integer name="height" value="8"/></film></sensor>
<shape type="shapegroup" id="group"><shape type="sphere"><point name="center" x="0" y="0" z="0.5"/>
<float name="radius" value="0.5"/></shape></shape>
<shape type="instance"><ref id="group"/><transform name="to_world"><rotate x="1" angle="30"/></transform></shape>
<shape type="rectangle"><transform name="to_world"><scale value="3"/></transform><bsdf type="mask">
<float name="opacity" value="0.5"/><bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.7"/></bsdf></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><translate z="3"/></transform>
<emitter type="directionalarea"><float name="radiance" value="2"/></emitter></shape>
<emitter type="spot"><float name="cutoff_angle" value="90"/><float name="beam_width" value="60"/>
<transform name="to_world"><translate z="-1"/></transform></emitter></scene>"#;

const PBRT: &str = r#"LookAt 0 -4 2 0 0 0.3 0 0 1
Camera "perspective" "float fov" [40]
Film "rgb" "integer xresolution" [8] "integer yresolution" [8]
WorldBegin
LightSource "point" "rgb I" [9 9 8] "point3 from" [1 -2 3]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [1 1 1]
Translate 0 0 3 Rotate 180 1 0 0
Shape "disk" "float radius" [0.5]
AttributeEnd
ObjectBegin "one"
Material "coateddiffuse" "rgb reflectance" [0.5 0.5 0.5] "float roughness" [0.1]
Shape "sphere" "float radius" [0.5] "float phimax" [270]
ObjectEnd
ObjectInstance "one"
Material "diffuse" "rgb reflectance" [0.3 0.3 0.3]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-3 -3 0 3 -3 0 3 3 0 -3 3 0]
"#;

const OBJ: &str = "mtllib world.mtl\nv -3 -3 0\nv 3 -3 0\nv 3 3 0\nv -3 3 0\nv 0 0 2\nvn 0 0 1\n\
    vt 0 0\nvt 1 1\nusemtl floor\nf 1/1/1 2/2/1 3/2/1 4/1/1\nusemtl lamp\nf 1 2 5\n";

const MTL: &str = "newmtl floor\nKd 0.5 0.6 0.7\nKs 0.1 0.1 0.1\nNs 20\nillum 2\nd 0.5\n\
    newmtl lamp\nKe 3 3 2\nKd 0 0 0\n";

/// A triangle of three points, in a buffer within the file, with a camera and a light.
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],
"nodes":[{"mesh":0,"scale":[3,3,3]},{"camera":0,"translation":[0,0,4]},
{"translation":[0,1,3],"extensions":{"KHR_lights_punctual":{"light":0}}}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}],
"extensionsUsed":["KHR_lights_punctual"],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":9,"spot":{"outerConeAngle":0.7}}]}},
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.6,0.7,0.5],"roughnessFactor":0.4},"alphaMode":"BLEND"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;

/// A mutated scene. The program always imports it, and then renders or probes it.
pub(crate) fn attack(dice: &mut Dice) -> Attack {
    let formats = [
        ("xml", MITSUBA),
        ("pbrt", PBRT),
        ("gltf", GLTF),
        ("obj", OBJ),
    ];
    let (extension, sound) = *dice.pick(&formats);
    let name = format!("world.{extension}");
    let mut files = Folder::from([("world.mtl".to_owned(), Some(MTL.into()))]);
    if extension == "obj" && dice.one_in(2) {
        let mutated = text::mutated(MTL, WORDS, dice);
        files.insert("world.mtl".to_owned(), Some(mutated));
        files.insert(name.clone(), Some(sound.into()));
    } else {
        files.insert(name.clone(), Some(text::mutated(sound, WORDS, dice)));
    }
    let command = *dice.pick(&[
        "render NAME --size 8x8 --samples 2",
        "probe NAME --size 8x8 --pixel 4,5 --window 4 --rays 2000 --photons 2000",
    ]);
    let view = if extension == "obj" {
        "--look-from 0,-4,2 --look-at 0,0,0.3 --up 0,0,1"
    } else {
        ""
    };
    let then = format!("{command} {view} --quiet --threads 2 --out out");
    Attack {
        files,
        arguments: words(&format!("import {name}")),
        then: Some(words(&then.replace("NAME", &name))),
        open_files: dice.one_in(4).then(|| 4 + dice.below(12)),
        ..Attack::default()
    }
}
