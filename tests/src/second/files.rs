//! Pictures on surfaces as scene files define them: file formats, placement on the surface, and
//! use as blend and texture.

use super::check::{SecondCheck, if_planted, largest};
use super::masks::{against, layer, misplaced, words};
use super::pattern::{Levels, Pattern, Varied};
use super::smooth::Smooth;
use super::textures::apart;
use super::vector::scale;
use super::world::{World, pair};
use crate::hostile::dice::Dice;
use etendue_field::{Brdf, Fresnel, Grating, Lobe};
use etendue_scene::Event;
use std::io;
use std::path::Path;
use std::rc::Rc;
use tempfile::TempDir;

/// Points per scene.
const EACH: u32 = 20;

const FAULTS: &[&str] = &[
    "blend order swapped",
    "flipped",
    "left and right swapped",
    "axes swapped",
    "sign of t",
    "direction along reversed",
];

/// The file name of the picture.
const FILE: &str = "blend.png";

/// The luminance of red, green and blue (Rec. ITU-R BT.709).
pub(super) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.212_671 * r + 0.715_160 * g + 0.072_169 * b
}

const MASK: &[&str] = &[
    "flipped",
    "left and right swapped",
    "sizes swapped",
    "bright pixels opaque",
    "from the central ray",
];

pub(super) fn checks(folder: &Rc<TempDir>, picture: &Levels) -> Vec<SecondCheck> {
    let check = |name, faults, tolerance, difference: Pictured| {
        let (folder, picture) = (Rc::clone(folder), picture.clone());
        SecondCheck {
            name,
            rounds: [150, EACH],
            tolerance,
            faults,
            difference: Box::new(move |dice, fault| {
                difference(dice, fault, folder.path(), &picture)
            }),
        }
    };
    let places = (1e-11, "rounding of places and levels");
    let exact = (0.0, "a number of two"); // 0 or 1 on both sides
    vec![
        check("blend over a picture of a file", FAULTS, places, pictured),
        check("mask of a picture", MASK, exact, masked),
    ]
}

/// A comparison that uses the picture in a folder.
type Pictured = fn(&mut Dice, &str, &Path, &Levels) -> f64;

/// Checks masks from pictures. Pixels below one half are opaque, and all outside is clear.
fn masked(dice: &mut Dice, fault: &str, folder: &Path, picture: &Levels) -> f64 {
    let (mut world, center, place) = layer(dice);
    let size = [dice.between(0.5, 2.0), dice.between(0.5, 2.0)];
    world.blockers = format!("Picture({place}, file: \"{FILE}\", size: {})", pair(size));
    let scene = world.scene(folder);
    let [width, height] = if_planted(fault, "sizes swapped", [size[1], size[0]], size);
    against(dice, &scene, center, |at| {
        let at = misplaced(at, center, fault);
        let across = (at[0] / width + 0.5) * picture.width as f64;
        let down = (0.5 - at[1] / height) * picture.height as f64;
        let is_opaque = |(i, level): (usize, &f64)| {
            let [column, row] = [i % picture.width, i / picture.width].map(|k| k as f64);
            let is_dark = (*level < 0.5) != (fault == "bright pixels opaque");
            is_dark && (column..column + 1.0).contains(&across) && (row..row + 1.0).contains(&down)
        };
        if picture.values.iter().enumerate().any(is_opaque) {
            0.0
        } else {
            1.0
        }
    })
}

fn pictured(dice: &mut Dice, fault: &str, folder: &Path, picture: &Levels) -> f64 {
    let mut world = World::new(dice);
    let (smooth, text) = Smooth::new(dice, &world, 0.7);
    let size = [dice.between(0.3, 0.8), dice.between(0.3, 0.8)];
    let mut brdf = || {
        let lobe = Lobe::Ggx {
            roughness: scale(dice, 1e-2, 1.0),
        };
        let albedo = dice.unit();
        let index = scale(dice, 1.1, 3.0);
        Brdf::new(lobe, albedo, Fresnel::Dielectric { index })
    };
    let (one, two) = (brdf(), brdf());
    let grating = Grating {
        axis: 1,
        frequency: dice.between(1.0, 9.0),
        modulation: dice.unit(),
        phase: dice.unit(),
    };
    world.surfaces = format!(
        "{text}Reflects(brdf: {}, other: {}, blend: Picture(file: \"{FILE}\", size: {}), \
         texture: Cosine({})))",
        in_words(&one),
        in_words(&two),
        pair(size),
        words(&grating),
    );
    let scene = world.scene(folder);
    let object = &scene.patches[0];
    let Event::Reflects(reflectance) = &object.event else {
        return f64::NAN;
    };
    let varied = Varied {
        brdf: one,
        other: two,
        blend: Pattern::Picture(picture.clone(), size),
        texture: Pattern::Cosine(grating),
    };
    largest(EACH, || {
        let at = [dice.between(-0.4, 0.4), dice.between(-0.4, 0.4)];
        let point = smooth.point(at[0], at[1]);
        let [s, t, _] = smooth.wrong(fault).axes.coordinates(point);
        let place = object.patch.frame.to_local(world.resolved(point).into());
        apart(&reflectance.at(place.x, place.y), varied.at([s, t], fault))
    })
}

fn in_words(brdf: &Brdf) -> String {
    let (Lobe::Ggx { roughness }, Fresnel::Dielectric { index }) = (brdf.lobe, brdf.fresnel) else {
        return String::new();
    };
    let albedo = brdf.albedo;
    format!("(lobe: Ggx({roughness:?}), albedo: {albedo:?}, fresnel: Dielectric({index:?}))")
}

/// Writes a colour picture with 16 bits per channel, and returns the levels of its pixels.
pub(super) fn write_picture(folder: &Path, dice: &mut Dice) -> io::Result<Levels> {
    let (width, height) = (7_u16, 5_u16);
    let count = usize::from(width) * usize::from(height);
    let colors: Vec<[u16; 3]> = (0..count)
        .map(|_| [0; 3].map(|_| u16::from_be_bytes([dice.byte(), dice.byte()])))
        .collect();
    let file = std::fs::File::create(folder.join(FILE))?;
    let mut encoder = png::Encoder::new(file, width.into(), height.into());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    let bytes: Vec<u8> = colors
        .as_flattened()
        .iter()
        .flat_map(|level| level.to_be_bytes())
        .collect();
    encoder.write_header()?.write_image_data(&bytes)?;
    let values = colors
        .iter()
        .map(|color| luminance(color.map(|level| f64::from(level) / 65_535.0)));
    Ok(Levels {
        width: width.into(),
        height: height.into(),
        values: values.collect(),
    })
}

/// Writes a map of the sky in 32-bit colour, and returns the levels of its pixels.
pub(super) fn write_map(path: &Path, dice: &mut Dice) -> io::Result<Levels> {
    let (width, height) = (16_u16, 9_u16);
    let count = usize::from(width) * usize::from(height);
    let colors: Vec<[f32; 3]> = (0..count)
        .map(|_| [0; 3].map(|_| f32::from(dice.byte()) + 1.0))
        .collect();
    let (w, h) = (usize::from(width), usize::from(height));
    exr::prelude::write_rgb_file(path, w, h, |column, row| {
        let [r, g, b] = colors[row * w + column];
        (r, g, b)
    })
    .map_err(io::Error::other)?;
    let values = colors.iter().map(|color| luminance(color.map(f64::from)));
    Ok(Levels {
        width: w,
        height: h,
        values: values.collect(),
    })
}
