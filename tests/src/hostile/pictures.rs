//! Mutated pictures in variants of OpenEXR and PNG, used as an environment and as a texture.

use super::bytes;
use super::case::Attack;
use super::dice::Dice;
use super::folder;
use super::scenes::{SCENE, on_scene};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, LineOrder, Vec2, WritableImage, f16,
};
use std::io::{self, Cursor};

/// A scene with an environment picture as light.
const SKY: &str = r#"(
    light: Environment(center: (0, 0, 0), map: File("NAME")),
    surfaces: [Rectangle(name: "floor", center: (0, 0, 1), size: (6, 6))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "receiver", at: Before("floor"))],
    window: (x: Hann(0.5), u: Hann(0.5)),
    frequencies: (azimuths: 2, rho: (max: 4), nu: (max: 4)),
)"#;

/// A scene with a picture as texture of a glossy sphere.
const TEXTURE: &str = r#"(
    light: Projector(center: (0, 0, 0), image: (width: (0.15, 0.15))),
    surfaces: [Smooth(name: "sphere", center: (0, 0, 1), facing: (0, 0, -1), form: Sphere(0.5),
        aperture: 0.6, event: Reflects(brdf: (lobe: Phong(20), albedo: 0.8),
        texture: Picture(file: "NAME", size: (0.4, 0.4))))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["sphere"]),
    planes: [(name: "outgoing", at: After("sphere"))],
    window: (x: Hann(0.15), u: Hann(0.3)),
    frequencies: (azimuths: 2, rho: (max: 10), nu: (max: 8)),
)"#;

/// Width and height of the pictures.
const SIZE: [usize; 2] = [16, 8];
/// Number of pixels of a large picture, across and down.
const LARGE: [usize; 2] = [8000, 4000];

/// Valid pictures: OpenEXR, then PNG.
pub(crate) fn seeds() -> io::Result<[Vec<Vec<u8>>; 2]> {
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
    ];
    let tiles = [Blocks::ScanLines, Blocks::Tiles(Vec2(4, 4))];
    let mut exr = Vec::new();
    for (i, compression) in compressions.into_iter().enumerate() {
        for blocks in tiles {
            let names: &[&str] = if i % 2 == 0 { &["R", "G", "B"] } else { &["Y"] };
            exr.push(one_exr(compression, blocks, names, i % 3 == 0)?);
        }
    }
    let mut png = Vec::new();
    for color in [
        png::ColorType::Grayscale,
        png::ColorType::GrayscaleAlpha,
        png::ColorType::Rgb,
        png::ColorType::Rgba,
        png::ColorType::Indexed,
    ] {
        for depth in [png::BitDepth::Eight, png::BitDepth::Sixteen] {
            if (color, depth) != (png::ColorType::Indexed, png::BitDepth::Sixteen) {
                png.push(one_png(SIZE, color, depth)?);
            }
        }
    }
    // A small file with many pixels.
    png.push(one_png(
        LARGE,
        png::ColorType::Rgba,
        png::BitDepth::Sixteen,
    )?);
    Ok([exr, png])
}

fn one_exr(
    compression: Compression,
    blocks: Blocks,
    names: &[&str],
    halves: bool,
) -> io::Result<Vec<u8>> {
    let count = SIZE[0] * SIZE[1];
    let values = (0..count).map(|i| i as f32 / count as f32);
    let samples = if halves {
        FlatSamples::F16(values.map(f16::from_f32).collect())
    } else {
        FlatSamples::F32(values.collect())
    };
    let channels = names
        .iter()
        .map(|name| AnyChannel::new(*name, samples.clone()));
    let encoding = Encoding {
        compression,
        blocks,
        line_order: LineOrder::Increasing,
    };
    let size = (SIZE[0], SIZE[1]);
    let layer = Layer::new(
        size,
        LayerAttributes::named("picture"),
        encoding,
        AnyChannels::sort(channels.collect()),
    );
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layers(attributes, vec![layer])
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(io::Error::other)?;
    Ok(bytes.into_inner())
}

fn one_png(size: [usize; 2], color: png::ColorType, depth: png::BitDepth) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let [width, height] = size.map(|n| u32::try_from(n).unwrap_or(1));
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette((0..=255).flat_map(|i| [i, i, i]).collect::<Vec<u8>>());
    }
    let wide = 1 + usize::from(depth == png::BitDepth::Sixteen);
    let count = size[0] * size[1] * color.samples() * wide;
    let data: Vec<u8> = (0..count).map(|i| (i % 251).to_le_bytes()[0]).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(bytes)
}

/// A mutated picture in a valid scene.
pub(crate) fn attack(seeds: &[Vec<Vec<u8>>; 2], dice: &mut Dice) -> Attack {
    let format = dice.below(2);
    let mut picture = dice.pick(&seeds[format]).clone();
    // Half of the mutations stay within the metadata at the start of the file, where faults are
    // more likely than among pixels.
    let head = 0..picture.len().min(if format == 0 { 400 } else { 60 });
    if dice.one_in(2) {
        bytes::mutate(&mut picture, dice);
    } else {
        bytes::mutate_within(&mut picture, &head, dice);
    }
    if format == 1 && !dice.one_in(4) {
        repair(&mut picture);
    }
    let name = ["picture.exr", "picture.png"][format];
    let scene = if format == 0 && dice.one_in(2) {
        SKY
    } else {
        TEXTURE
    };
    let scene = scene.replace("NAME", name);
    on_scene(folder::of([(SCENE, scene.into()), (name, picture)]), dice)
}

/// Repairs the checksums of the chunks of a PNG file, up to the first chunk that cannot be parsed.
fn repair(png: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = png.get(at..at + 4) {
        let length = length.iter().fold(0, |sum, b| sum * 256 + usize::from(*b));
        let end = at + 8 + length;
        let Some(chunk) = png.get(at + 4..end) else {
            return;
        };
        let check = crc(chunk).to_be_bytes();
        let Some(place) = png.get_mut(end..end + 4) else {
            return;
        };
        place.copy_from_slice(&check);
        at = end + 4;
    }
}

/// CRC-32 as defined for PNG (ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        let shift = |crc: u32, _| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
        (0..8).fold(crc ^ u32::from(*byte), shift)
    };
    !bytes.iter().fold(u32::MAX, step)
}
