//! Reads pictures from OpenEXR and PNG files, as one number for each pixel.

use etendue_field::Raster;
use etendue_scenefile::{Color, Fault, fault};
use exr::meta::MetaData;
use exr::prelude::{AnyChannels, FlatSamples, ReadChannels, ReadLayers};
use std::io::Cursor;
use std::path::Path;

/// The maximum number of values in a file: 8192 × 4096 pixels of red, green, blue and alpha.
const MAX_NUMBERS: usize = 1 << 27;

/// The maximum number of values per byte of a file, because DEFLATE expands one byte to at most
/// 1032 bytes (RFC 1951; zlib's technical notes). These 1032 bytes hold 1032 values of a PNG
/// file, or 516 values of an OpenEXR file. With this maximum, a false size in a header cannot
/// make the program allocate more memory than the file can fill.
const MOST_PER_BYTE: usize = 1032;

/// A picture whose pixels are grey, or red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// Number of pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Values of the pixels; each pixel has one or three values.
    pub values: Vec<f64>,
    /// Values per pixel, 1 or 3.
    pub count: usize,
    /// Whether the values are levels from 0 to 1, as encoded by the file's transfer curve. If they
    /// are not levels, the values are proportional to light.
    pub are_levels: bool,
}

impl Channels {
    /// Returns the picture as one number for each pixel, computed by `number`.
    ///
    /// # Errors
    /// When the picture has no pixels.
    pub fn raster(&self, number: impl Fn([f64; 3]) -> f64) -> Result<Raster, Fault> {
        let values = match self.count {
            1 => self.values.iter().map(|v| number([*v; 3])).collect(),
            _ => {
                let pixels = self.values.chunks_exact(3);
                pixels.map(|p| number([p[0], p[1], p[2]])).collect()
            }
        };
        raster(self.width, self.height, values)
    }
}

/// Reads the bytes of a picture. The extension of `file`, in upper or lower case, determines the
/// format.
///
/// An OpenEXR file gives the number `color` of the first layer with channels R, G and B, or the
/// layer's channel Y, over the entire data window. A PNG file gives grey or colour of 8 or 16 bits,
/// with levels scaled to 1 and without an inverse transfer curve; alpha is ignored.
pub(crate) fn parse(
    file: &Path,
    bytes: &[u8],
    extensions: &[&str],
    color: Color,
) -> Result<Raster, Fault> {
    let extension = extension(file);
    if !extensions.contains(&extension.as_str()) {
        let shown = format!("{extension:?}");
        return Err(fault("the extension", shown, extensions.join(", ")));
    }
    let channels = read_channels(file, bytes)?;
    match channels.count {
        1 => raster(channels.width, channels.height, channels.values),
        _ => channels.raster(|rgb| color.of(rgb)),
    }
}

/// Reads the bytes of an OpenEXR or a PNG file. The extension of `file`, in upper or lower case,
/// determines the format.
///
/// An OpenEXR file gives the first layer with channels R, G and B, or Y, over the entire data
/// window. A PNG file gives grey or colour of 8 or 16 bits. Alpha is ignored.
///
/// # Errors
/// When the file is damaged, or when it is larger than allowed.
pub fn read_channels(file: &Path, bytes: &[u8]) -> Result<Channels, Fault> {
    match extension(file).as_str() {
        "png" => png(bytes),
        "exr" => exr(bytes),
        other => Err(fault("the extension", format!("{other:?}"), "exr, png")),
    }
}

fn extension(file: &Path) -> String {
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    extension.to_ascii_lowercase()
}

/// Refuses a picture that has too many values, or more values than its file of `length` bytes can
/// hold.
fn limited(numbers: Option<usize>, length: usize) -> Result<(), Fault> {
    let most = MAX_NUMBERS.min(length.saturating_mul(MOST_PER_BYTE));
    match numbers {
        Some(numbers) if numbers <= most => Ok(()),
        _ => {
            let shown = numbers.map_or("countless".to_owned(), |n| n.to_string());
            let allowed = format!("at most {most} numbers in a file of {length} bytes");
            Err(fault(
                "the number of pixels times the number of channels",
                shown,
                allowed,
            ))
        }
    }
}

fn raster(width: usize, height: usize, values: Vec<f64>) -> Result<Raster, Fault> {
    let allowed = "one number for each pixel, and at least one pixel";
    Raster::new(width, height, values)
        .ok_or_else(|| fault("the size", format!("{width} × {height}"), allowed))
}

fn exr(bytes: &[u8]) -> Result<Channels, Fault> {
    let unsound = |error: exr::error::Error| {
        fault(
            "the file",
            format!("damaged ({error})"),
            "an OpenEXR picture",
        )
    };
    let meta = MetaData::read_from_buffered(bytes, false).map_err(unsound)?;
    let sizes = meta.headers.iter().map(|header| {
        let pixels = header.layer_size.0.checked_mul(header.layer_size.1)?;
        pixels.checked_mul(header.channels.list.len())
    });
    limited(sizes.sum::<Option<usize>>(), bytes.len())?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(unsound)?;
    let names = |channels: &AnyChannels<FlatSamples>| -> Vec<String> {
        let list = channels.list.iter();
        list.map(|channel| channel.name.to_string()).collect()
    };
    for layer in &image.layer_data {
        if let Some((count, values)) = colours(&layer.channel_data) {
            return Ok(Channels {
                width: layer.size.0,
                height: layer.size.1,
                values,
                count,
                are_levels: false,
            });
        }
    }
    let found: Vec<String> = image
        .layer_data
        .iter()
        .flat_map(|layer| names(&layer.channel_data))
        .collect();
    Err(fault(
        "the channels",
        found.join(", "),
        "R, G and B, or Y, in one layer",
    ))
}

/// Returns the number of values per pixel of a layer, and these values; `None` if the channels
/// are missing.
fn colours(channels: &AnyChannels<FlatSamples>) -> Option<(usize, Vec<f64>)> {
    let channel = |name: &str| {
        let mut list = channels.list.iter();
        list.find(|channel| channel.name.eq(name))
    };
    let Some(((red, green), blue)) = channel("R").zip(channel("G")).zip(channel("B")) else {
        let grey = channel("Y")?.sample_data.values_as_f32();
        return Some((1, grey.map(f64::from).collect()));
    };
    let [red, green, blue] = [red, green, blue].map(|c| c.sample_data.values_as_f32());
    let pixels = red.zip(green).zip(blue);
    let values = pixels.flat_map(|((r, g), b)| [r, g, b].map(f64::from));
    Some((3, values.collect()))
}

fn png(bytes: &[u8]) -> Result<Channels, Fault> {
    let unsound = |error: png::DecodingError| {
        fault("the file", format!("damaged ({error})"), "a PNG picture")
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    // Palettes and levels of less than 8 bits are expanded to bytes.
    decoder.set_transformations(png::Transformations::EXPAND);
    let info = decoder.read_header_info().map_err(unsound)?;
    let [width, height] =
        [info.width, info.height].map(|n| usize::try_from(n).unwrap_or(MAX_NUMBERS));
    let pixels = width.checked_mul(height);
    limited(pixels, bytes.len())?;
    limited(pixels.and_then(|n| n.checked_mul(4)), usize::MAX)?;
    let mut reader = decoder.read_info().map_err(unsound)?;
    let size = reader.output_buffer_size();
    limited(size.map(|bytes| bytes / 2), bytes.len())?;
    let mut buffer = vec![0; size.unwrap_or_default()];
    let frame = reader.next_frame(&mut buffer).map_err(unsound)?;
    let levels: Vec<f64> = match frame.bit_depth {
        png::BitDepth::Sixteen => {
            let words = buffer.chunks_exact(2);
            words
                .map(|w| f64::from(u16::from_be_bytes([w[0], w[1]])) / 65_535.0)
                .collect()
        }
        _ => buffer.iter().map(|b| f64::from(*b) / 255.0).collect(),
    };
    let (count, values) = match frame.color_type {
        png::ColorType::Grayscale => (1, levels),
        png::ColorType::GrayscaleAlpha => (1, levels.chunks_exact(2).map(|p| p[0]).collect()),
        png::ColorType::Rgba => {
            let pixels = levels.chunks_exact(4);
            (3, pixels.flat_map(|p| [p[0], p[1], p[2]]).collect())
        }
        _ => (3, levels),
    };
    Ok(Channels {
        width,
        height,
        values,
        count,
        are_levels: true,
    })
}
