//! Tests environments, and pictures read from files.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Environment, EnvironmentMap, LatLong, Light, Mask, Pattern, Raster};
use etendue_scene::{Event, Scene, SceneError, SceneFile, resolve};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
    f16,
};
use glam::DVec3;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

const LOBES: &str =
    "Lobes([(from: (0.2, 0.1, -1), width: 0.3, radiance: 2), (from: (0, 1, 0), width: 0.5)])";

fn text(map: &str) -> String {
    format!(
        r#"(
            light: Environment(center: (0, 0, 0), up: (0, 1, 0.2), front: (0.1, 0, -1), scale: 3, map: {map}),
            surfaces: [Smooth(name: "wall", center: (0, 0, 2), facing: (0, 0, -1), form: Plane, aperture: 0.5,
                event: Reflects(brdf: (lobe: Lambertian), texture: Picture(file: "wall.png", size: (0.4, 0.2))))],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["wall"]),
            planes: [(name: "arrival", at: Before("wall"))],
            window: (x: Hann(0.3), u: Hann(0.3)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: 1000),
        )"#
    )
}

fn resolved(text: &str, folder: &Path) -> Result<Scene, SceneError> {
    resolved_within(u64::MAX, text, folder)
}

/// Resolves a scene on a machine with the given memory.
fn resolved_within(memory: u64, text: &str, folder: &Path) -> Result<Scene, SceneError> {
    resolve("test", SceneFile::parse(text)?, folder, memory)
}

/// Writes an OpenEXR file of channels with the same size.
fn write_exr(
    file: &Path,
    size: [usize; 2],
    channels: Vec<(&str, FlatSamples)>,
    encoding: Encoding,
) {
    let channels = channels.into_iter();
    let channels = channels.map(|(name, samples)| AnyChannel::new(name, samples));
    let layer = Layer::new(
        (size[0], size[1]),
        LayerAttributes::default(),
        encoding,
        AnyChannels::sort(channels.collect()),
    );
    Image::from_layer(layer).write().to_file(file).unwrap();
}

fn singles(values: &[f64]) -> FlatSamples {
    let values = values.iter();
    #[expect(clippy::cast_possible_truncation, reason = "what the file holds")]
    let values = values.map(|value| *value as f32);
    FlatSamples::F32(values.collect())
}

/// Writes a PNG file of two rows of three pixels.
fn write_png(file: &Path, color: png::ColorType, depth: png::BitDepth, bytes: &[u8]) {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(file).unwrap()), 3, 2);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(bytes).unwrap();
}

/// A folder with the files of a valid scene.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let levels = [0, 51, 102, 153, 204, 255];
    write_png(
        &folder.path().join("wall.png"),
        png::ColorType::Grayscale,
        png::BitDepth::Eight,
        &levels,
    );
    folder
}

fn environment(scene: &Scene) -> &Environment {
    match &scene.light {
        Light::Environment { environment } => environment,
        other => panic!("{other:?}"),
    }
}

fn texture(scene: &Scene) -> &Raster {
    let Event::Reflects(reflectance) = &scene.patches[0].event else {
        panic!("{:?}", scene.patches[0]);
    };
    let Some(Pattern::Picture(picture)) = &reflectance.texture else {
        panic!("{reflectance:?}");
    };
    &picture.pixels
}

#[test]
fn lobes_are_where_the_axes_put_them() {
    let folder = folder();
    let scene = resolved(&text(LOBES), folder.path()).unwrap();
    let found = environment(&scene);
    // In this environment, `up` is used exactly, and `front` is adjusted.
    let up = DVec3::new(0.0, 1.0, 0.2).normalize();
    assert!((found.frame.y - up).length() < 1e-15 && found.frame.d.z < -0.9); // rounding
    assert!((found.frame.x.cross(found.frame.y) - found.frame.d).length() < 1e-15); // rounding
    // In the direction of `up`, the radiance is three times the radiance of a lobe with peak 1,
    // plus the tail of the other lobe.
    let other = ((0.1 / 1.05_f64.sqrt() - 1.0) / 0.09).exp();
    let expected = 3.0 + 6.0 * other;
    assert!((found.radiance(-up) - expected).abs() < 1e-13); // rounding
    assert!((texture(&scene).values()[1] - 0.2).abs() < 1e-15); // rounding of a quotient
}

#[test]
fn maps_come_back_as_they_were_written() {
    let folder = folder();
    let file = folder.path().join("sky.exr");
    let map = LatLong::from_fn(16, 8, |d| {
        // All pixel values are numbers that f16 represents exactly.
        ((2.0 + d.x + 0.5 * d.y) * 64.0).round() / 64.0
    });
    let values = map.raster().values();
    let wanted: Vec<f64> = values.iter().map(|value| 3.0 * value).collect();
    let grey = |samples: fn(&[f64]) -> FlatSamples| vec![("Y", samples(values))];
    let halves: fn(&[f64]) -> FlatSamples =
        |values| FlatSamples::F16(values.iter().map(|v| f16::from_f64(*v)).collect());
    let rgb = vec![
        ("R", singles(values)),
        ("G", singles(values)),
        ("B", singles(values)),
        ("A", singles(&[1.0; 128])),
    ];
    for (channels, encoding) in [
        (grey(singles), Encoding::UNCOMPRESSED),
        (grey(halves), Encoding::SMALL_LOSSLESS),
        (rgb, Encoding::FAST_LOSSLESS),
    ] {
        write_exr(&file, [16, 8], channels, encoding);
        let scene = resolved(&text("File(\"sky.exr\")"), folder.path()).unwrap();
        let EnvironmentMap::LatLong(found) = &environment(&scene).map else {
            panic!("{:?}", scene.light);
        };
        assert_eq!((found.raster().width(), found.raster().height()), (16, 8));
        for (a, b) in found.raster().values().iter().zip(&wanted) {
            // The tolerance is the rounding error of the weights of red, green and blue.
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
        assert_eq!(
            scene.inputs.keys().collect::<Vec<_>>(),
            ["sky.exr", "wall.png"]
        );
    }
    // Each channel of the picture has its own weight in luminance.
    let channels = vec![
        ("R", singles(&[1.0, 0.0, 0.0])),
        ("G", singles(&[0.0, 1.0, 0.0])),
        ("B", singles(&[0.0, 0.0, 1.0])),
    ];
    write_exr(&file, [3, 1], channels, Encoding::UNCOMPRESSED);
    let scene = resolved(&text("File(\"sky.exr\")"), folder.path()).unwrap();
    let EnvironmentMap::LatLong(found) = &environment(&scene).map else {
        panic!("{:?}", scene.light);
    };
    for (value, weight) in found
        .raster()
        .values()
        .iter()
        .zip([0.212_671, 0.715_160, 0.072_169])
    {
        assert!((value - 3.0 * weight).abs() < 1e-15); // rounding of a product
    }
    let green = text("File(\"sky.exr\")").replace("photons: 1000", "photons: 1000, color: Green");
    let scene = resolved(&green, folder.path()).unwrap();
    let EnvironmentMap::LatLong(found) = &environment(&scene).map else {
        panic!("{:?}", scene.light);
    };
    assert_eq!(found.raster().values(), [0.0, 3.0, 0.0]);
}

#[test]
fn png_levels_are_read_as_they_are() {
    let folder = folder();
    let file = folder.path().join("wall.png");
    let words: Vec<u8> = [0_u16, 1, 256, 257, 65_534, 65_535]
        .iter()
        .flat_map(|word| word.to_be_bytes())
        .collect();
    let red: Vec<u8> = (0..6).flat_map(|i| [51 * i, 0, 0]).collect();
    let clear: Vec<u8> = (0..6).flat_map(|i| [51 * i, 51 * i, 51 * i, 9]).collect();
    for (color, depth, bytes, last) in [
        (
            png::ColorType::Grayscale,
            png::BitDepth::Sixteen,
            &words,
            65_534.0 / 65_535.0,
        ),
        (
            png::ColorType::Rgb,
            png::BitDepth::Eight,
            &red,
            0.8 * 0.212_671,
        ),
        (png::ColorType::Rgba, png::BitDepth::Eight, &clear, 0.8),
    ] {
        write_png(&file, color, depth, bytes);
        let scene = resolved(&text(LOBES), folder.path()).unwrap();
        let found = texture(&scene);
        assert_eq!((found.width(), found.height()), (3, 2));
        // The tolerance is the rounding error of one value.
        assert!((found.values()[4] - last).abs() < 1e-15, "{found:?}");
    }
}

/// For each case: the text that is replaced, its replacement, and the beginning of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "up: (0, 1, 0.2)",
        "up: (0.1, 0, -1)",
        "light.up and light.front",
    ),
    (
        "up: (0, 1, 0.2)",
        "up: (0, 0, 0)",
        "light.up and light.front",
    ),
    ("up: (0, 1, 0.2)", "up: (0, NaN, 0)", "light.up[1] is NaN"),
    (
        "front: (0.1, 0, -1)",
        "front: (0, 2, 0.4)",
        "light.up and light.front",
    ),
    ("scale: 3", "scale: 0", "light.scale is 0;"),
    ("scale: 3", "scale: -1", "light.scale is -1;"),
    (LOBES, "Lobes([])", "light.map is no lobe"),
    ("width: 0.3", "width: 0", "light.map[0].width is 0;"),
    ("width: 0.3", "width: inf", "light.map[0].width is inf"),
    ("width: 0.3", "width: 0.1", "light.map[0].from is"), // it comes from behind, and is narrow
    (
        "radiance: 2",
        "radiance: -2",
        "light.map[0].radiance is -2;",
    ),
    ("from: (0, 1, 0)", "from: (0, 0, 0)", "light.map[1].from is"),
    (
        LOBES,
        "File(\"nowhere.exr\")",
        "light.map is \"nowhere.exr\" (No such file",
    ),
    (
        LOBES,
        "File(\"../sky.exr\")",
        "light.map is \"../sky.exr\" (outside of the required folder",
    ),
    (
        LOBES,
        "File(\"/sky.exr\")",
        "light.map is \"/sky.exr\" (outside of the required folder",
    ),
    (
        LOBES,
        "File(\"wall.png\")",
        "light.map, \"wall.png\": the extension is \"png\"; allowed: exr",
    ),
    (
        LOBES,
        "File(\"folder.exr\")",
        "light.map is \"folder.exr\" (not a regular file)",
    ),
    (
        LOBES,
        "File(\"empty.exr\")",
        "light.map, \"empty.exr\": the file is",
    ),
    (
        LOBES,
        "File(\"cut.exr\")",
        "light.map, \"cut.exr\": the file is",
    ),
    (
        LOBES,
        "File(\"depth.exr\")",
        "light.map, \"depth.exr\": the channels is Z; allowed: R, G and B, or Y",
    ),
    (
        LOBES,
        "File(\"dark.exr\")",
        "light.map is \"dark.exr\"; allowed: a picture that is not dark everywhere",
    ),
    (
        LOBES,
        "File(\"negative.exr\")",
        "light.map, \"negative.exr\": pixel 1 of row 1 is -1;",
    ),
    (
        LOBES,
        "File(\"nan.exr\")",
        "light.map, \"nan.exr\": pixel 0 of row 1 is NaN",
    ),
    (
        LOBES,
        "File(\"infinite.exr\")",
        "light.map, \"infinite.exr\": pixel 0 of row 0 is inf",
    ),
    (
        "wall.png",
        "bright.exr",
        "surfaces[0].event.texture.file, \"bright.exr\": pixel 0 of row 0 is 1.5; allowed: 0 to 1",
    ),
    (
        "wall.png",
        "cut.png",
        "surfaces[0].event.texture.file, \"cut.png\": the file is",
    ),
    (
        "wall.png",
        "wall.jpg",
        "surfaces[0].event.texture.file, \"wall.jpg\": the extension is \"jpg\"; allowed: exr, png",
    ),
    (
        "size: (0.4, 0.2)",
        "size: (0.4, 0)",
        "surfaces[0].event.texture.size[1] is 0;",
    ),
];

#[test]
fn each_bad_value_is_named() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let four = |values: [f64; 4]| vec![("Y", singles(&values))];
    for (name, channels) in [
        ("dark.exr", four([0.0; 4])),
        ("negative.exr", four([1.0, 0.0, 0.0, -1.0])),
        ("nan.exr", four([1.0, 0.0, f64::NAN, 1.0])),
        ("infinite.exr", four([f64::INFINITY, 0.0, 0.0, 1.0])),
        ("bright.exr", four([1.5, 0.0, 0.0, 1.0])),
        ("depth.exr", vec![("Z", singles(&[1.0; 4]))]),
    ] {
        write_exr(&at(name), [2, 2], channels, Encoding::UNCOMPRESSED);
    }
    std::fs::create_dir(at("folder.exr")).unwrap();
    std::fs::write(at("wall.jpg"), []).unwrap();
    std::fs::write(at("empty.exr"), []).unwrap();
    for (from, to) in [("bright.exr", "cut.exr"), ("wall.png", "cut.png")] {
        let bytes = std::fs::read(at(from)).unwrap();
        std::fs::write(at(to), &bytes[..bytes.len() - 20]).unwrap();
    }
    for (from, to, told) in BAD {
        let text = text(LOBES);
        assert!(text.contains(from), "{from}");
        let error = resolved(&text.replacen(from, to, 1), folder.path()).expect_err(to);
        let error = error.to_string();
        assert!(
            error.starts_with(told) && error.lines().count() == 1,
            "{to}: {error}"
        );
    }
}

/// A scene whose only blockers are a picture.
const MASKED: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
    blockers: [Picture(name: "mask", center: (0.1, 0, 1), file: "wall.png", size: (0.6, 0.2))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    surfaces: [Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))],
    planes: [(name: "behind", at: After("mask"))],
    window: (x: Hann(0.5), u: Hann(0.5)),
    frequencies: (rho: (max: 4), nu: (max: 4)),
)"#;

#[test]
fn dark_pixels_are_opaque() {
    let folder = folder();
    let scene = resolved(MASKED, folder.path()).unwrap();
    let mask = &scene.blockers[0].mask;
    // The first row has levels of 0, 0.2 and 0.4, which make one rectangle. The second row is
    // bright.
    let Mask::Opaque { shapes, .. } = mask else {
        panic!("{mask:?}");
    };
    assert_eq!(shapes.len(), 1);
    for (x, y, passes) in [
        (-0.19, 0.09, 0.0),
        (0.39, 0.01, 0.0),
        (0.1, -0.01, 1.0),
        (-0.21, 0.05, 1.0),
        (0.41, 0.05, 1.0),
        (0.1, 0.11, 1.0),
    ] {
        assert!(
            mask.transmittance(x, y).total_cmp(&passes).is_eq(),
            "{x}, {y}"
        );
    }
}

/// A red filter stops green light, and is clear for red light.
#[test]
fn a_filter_is_clear_in_its_own_channel() {
    let folder = folder();
    let file = folder.path().join("wall.png");
    let pixels = [255, 0, 0].repeat(6);
    write_png(&file, png::ColorType::Rgb, png::BitDepth::Eight, &pixels);
    for (color, passes) in [("Red", 1.0), ("Green", 0.0), ("Luminance", 0.0)] {
        let file = SceneFile::parse(MASKED).unwrap();
        let file = file.with("run.color", color).unwrap();
        let scene = resolve("test", file, folder.path(), u64::MAX).unwrap();
        let found = scene.blockers[0].mask.transmittance(0.1, 0.0);
        assert!(found.total_cmp(&passes).is_eq(), "{color}: {found}");
    }
}

#[test]
fn a_picture_without_dark_pixels_is_refused_as_a_mask() {
    let folder = folder();
    let levels = [128, 255, 255, 255, 255, 255];
    write_png(
        &folder.path().join("wall.png"),
        png::ColorType::Grayscale,
        png::BitDepth::Eight,
        &levels,
    );
    let error = resolved(MASKED, folder.path()).unwrap_err().to_string();
    assert_eq!(
        error,
        "blockers[0].file is \"wall.png\" with 0 opaque rectangles; allowed: a picture whose pixels below 0.5 form 1 to 100000 rectangles"
    );
}

/// A picture is counted before it is decoded: its pixels as the file holds them, and one number of
/// eight bytes for each.
#[test]
fn a_picture_that_does_not_fit_into_memory_is_refused() {
    let folder = folder();
    let file = folder.path().join("wall.png");
    // 3 × 2 pixels of four channels with two bytes each.
    let bytes = [128; 48];
    write_png(&file, png::ColorType::Rgba, png::BitDepth::Sixteen, &bytes);
    let needed = 3 * 2 * (4 * 2 + 8);
    let error = resolved_within(needed - 1, &text(LOBES), folder.path()).unwrap_err();
    let SceneError::Values(faults) = &error else {
        panic!("{error}")
    };
    let of_picture = faults
        .iter()
        .find(|f| f.field.contains("wall.png"))
        .unwrap();
    assert!(of_picture.memory, "{error}");
    assert_eq!(of_picture.value, format!("{needed} bytes"));
    let error = resolved_within(needed, &text(LOBES), folder.path()).unwrap_err();
    assert!(!error.to_string().contains("wall.png"), "{error}");
}
