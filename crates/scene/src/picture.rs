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

/// A picture, with the values of its pixels as they are in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// Number of pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Values of the pixels, row by row.
    pub samples: Samples,
    /// Values per pixel: 1 for grey, 2 for grey and alpha, 3 for red, green and blue, and 4 for
    /// these and alpha.
    pub count: usize,
}

/// The values of the pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Levels of 8 bits, as encoded by the file's transfer curve.
    Bytes(Vec<u8>),
    /// Levels of 16 bits, each as two bytes with the higher byte first.
    Words(Vec<u8>),
    /// Numbers that are proportional to light.
    Numbers(Vec<f32>),
}

impl Samples {
    fn len(&self) -> usize {
        match self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Words(bytes) => bytes.len() / 2,
            Self::Numbers(numbers) => numbers.len(),
        }
    }

    /// The memory that reading the values takes, in bytes. OpenEXR channels are copied.
    fn bytes(&self) -> usize {
        match self {
            Self::Bytes(bytes) | Self::Words(bytes) => bytes.len(),
            Self::Numbers(numbers) => 2 * size_of_val(numbers.as_slice()),
        }
    }

    /// Returns `curve` of all levels that a value may have, scaled to 1; none for numbers.
    fn levels(&self, curve: impl Fn(f64) -> f64) -> Vec<f64> {
        let all = |most: u16| (0..=most).map(move |n| f64::from(n) / f64::from(most));
        match self {
            Self::Bytes(_) => all(u8::MAX.into()).map(curve).collect(),
            Self::Words(_) => all(u16::MAX).map(curve).collect(),
            Self::Numbers(_) => Vec::new(),
        }
    }

    /// A value, which is a number or one of the `levels`.
    #[inline]
    fn value(&self, index: usize, levels: &[f64]) -> f64 {
        match self {
            Self::Bytes(bytes) => levels[usize::from(bytes[index])],
            Self::Words(bytes) => {
                let word = [bytes[2 * index], bytes[2 * index + 1]];
                levels[usize::from(u16::from_be_bytes(word))]
            }
            Self::Numbers(numbers) => f64::from(numbers[index]),
        }
    }
}

impl Channels {
    /// Checks whether the pixels have no colour.
    #[must_use]
    pub fn is_grey(&self) -> bool {
        self.count < 3
    }

    /// The picture as one number for each pixel, computed by `number` from red, green and
    /// blue. Levels from 0 to 1 become light by `curve`; other values are proportional to light.
    ///
    /// # Errors
    /// When the picture has no pixels.
    pub fn raster(
        &self,
        curve: impl Fn(f64) -> f64,
        number: impl Fn([f64; 3]) -> f64,
    ) -> Result<Raster, Fault> {
        let others = if self.is_grey() { [0, 0] } else { [1, 2] };
        let levels = self.samples.levels(curve);
        let value = |at| self.samples.value(at, &levels);
        self.pixels(|at| number([value(at), value(at + others[0]), value(at + others[1])]))
    }

    /// The number that `number` computes from the alpha of each pixel, which is 1 in
    /// pictures without alpha.
    ///
    /// # Errors
    /// When the picture has no pixels.
    pub fn alphas(&self, number: impl Fn(f64) -> f64) -> Result<Raster, Fault> {
        let alpha = self.count.is_multiple_of(2).then(|| self.count - 1);
        let levels = self.samples.levels(&number);
        self.pixels(|at| match alpha {
            Some(alpha) => self.samples.value(at + alpha, &levels),
            None => number(1.0),
        })
    }

    /// The raster of a function of the position of each pixel's first value.
    fn pixels(&self, number: impl Fn(usize) -> f64) -> Result<Raster, Fault> {
        let starts = (0..self.samples.len()).step_by(self.count.max(1));
        raster(self.width, self.height, starts.map(number).collect())
    }
}

/// Reads the bytes of a picture. The extension of `file`, in upper or lower case, determines the
/// format.
///
/// An OpenEXR file gives the number `color` of the first layer with channels R, G and B, or the
/// layer's channel Y, over the entire data window. A PNG file gives grey or colour of 8 or 16 bits,
/// with levels scaled to 1 and without an inverse transfer curve; alpha is ignored. The second
/// number is the memory that reading the picture took besides its numbers, in bytes.
pub(crate) fn parse(
    file: &Path,
    bytes: &[u8],
    extensions: &[&str],
    color: Color,
    memory: u64,
) -> Result<(Raster, usize), Fault> {
    let extension = extension(file);
    if !extensions.contains(&extension.as_str()) {
        let shown = format!("{extension:?}");
        return Err(fault("the extension", shown, extensions.join(", ")));
    }
    let channels = read_channels(file, bytes, memory)?;
    let raster = match channels.is_grey() {
        true => channels.raster(|level| level, |rgb| rgb[0]),
        false => channels.raster(|level| level, |rgb| color.of(rgb)),
    };
    Ok((raster?, channels.samples.bytes()))
}

/// Reads the bytes of an OpenEXR or a PNG file. The extension of `file`, in upper or lower case,
/// determines the format.
///
/// An OpenEXR file gives the first layer with channels R, G and B, or Y, over the entire data
/// window. A PNG file gives grey or colour of 8 or 16 bits, and alpha. `memory` is the memory for
/// the picture and for one number of each pixel, in bytes.
///
/// # Errors
/// When the file is damaged, or when it is larger than allowed.
pub fn read_channels(file: &Path, bytes: &[u8], memory: u64) -> Result<Channels, Fault> {
    match extension(file).as_str() {
        "png" => png(bytes, memory),
        "exr" => exr(bytes, memory),
        other => Err(fault("the extension", format!("{other:?}"), "exr, png")),
    }
}

fn extension(file: &Path) -> String {
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    extension.to_ascii_lowercase()
}

/// The size of a picture, as its file states it.
#[derive(Clone, Copy, Debug)]
pub struct PictureSize {
    /// Number of pixels; `None` if there are too many to count.
    pub pixels: Option<usize>,
    /// Values per pixel.
    pub channels: usize,
    /// Bytes of a value while the picture is read.
    pub bytes: usize,
    /// Number of bytes or values that the file holds compressed, if this is not one for each value.
    pub packed: Option<usize>,
}

impl PictureSize {
    /// Refuses a picture before it is decoded: a picture that has no pixels or too many values,
    /// that has more values than its file of `length` bytes can hold, or that takes more than
    /// `memory` bytes together with one number for each pixel.
    ///
    /// # Errors
    /// Describes the size and the limit.
    pub fn check(self, length: usize, memory: u64) -> Result<(), Fault> {
        let numbers = self.pixels.and_then(|n| n.checked_mul(self.channels));
        let possible = length.saturating_mul(MOST_PER_BYTE);
        let fits = |n: &usize| *n <= MAX_NUMBERS && self.packed.unwrap_or(*n) <= possible;
        let (Some(pixels), Some(numbers @ 1..)) = (self.pixels, numbers.filter(fits)) else {
            return Err(fault(
                "the number of pixels times the number of channels",
                numbers.map_or("countless".to_owned(), |n| n.to_string()),
                format!("1 to {MAX_NUMBERS}, and no more than {length} bytes can hold"),
            ));
        };
        let needed = (size_of::<f64>() * pixels + self.bytes * numbers) as u64;
        if needed > memory {
            return Err(Fault {
                memory: true,
                ..fault(
                    "the memory to read the picture",
                    format!("{needed} bytes"),
                    format!("at most {memory} bytes, which are left"),
                )
            });
        }
        Ok(())
    }
}

fn raster(width: usize, height: usize, values: Vec<f64>) -> Result<Raster, Fault> {
    let allowed = "one number for each pixel, and at least one pixel";
    Raster::new(width, height, values)
        .ok_or_else(|| fault("the size", format!("{width} × {height}"), allowed))
}

fn exr(bytes: &[u8], memory: u64) -> Result<Channels, Fault> {
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
    let size = PictureSize {
        pixels: sizes.sum(),
        channels: 1,
        bytes: 2 * size_of::<f32>(),
        packed: None,
    };
    size.check(bytes.len(), memory)?;
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
        if let Some((count, numbers)) = colours(&layer.channel_data) {
            return Ok(Channels {
                width: layer.size.0,
                height: layer.size.1,
                samples: Samples::Numbers(numbers),
                count,
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

/// The number of values per pixel of a layer, and these values; `None` if the channels
/// are missing.
fn colours(channels: &AnyChannels<FlatSamples>) -> Option<(usize, Vec<f32>)> {
    let channel = |name: &str| {
        let mut list = channels.list.iter();
        list.find(|channel| channel.name.eq(name))
    };
    let Some(((red, green), blue)) = channel("R").zip(channel("G")).zip(channel("B")) else {
        let grey = channel("Y")?.sample_data.values_as_f32();
        return Some((1, grey.collect()));
    };
    let [red, green, blue] = [red, green, blue].map(|c| c.sample_data.values_as_f32());
    let pixels = red.zip(green).zip(blue);
    let values = pixels.flat_map(|((r, g), b)| [r, g, b]);
    Some((3, values.collect()))
}

fn png(bytes: &[u8], memory: u64) -> Result<Channels, Fault> {
    let unsound = |error: png::DecodingError| {
        fault("the file", format!("damaged ({error})"), "a PNG picture")
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    // Palettes and levels of less than 8 bits are expanded to bytes.
    decoder.set_transformations(png::Transformations::EXPAND);
    let info = decoder.read_header_info().map_err(unsound)?;
    let [width, height] =
        [info.width, info.height].map(|n| usize::try_from(n).unwrap_or(MAX_NUMBERS));
    let packed = height.checked_mul(info.raw_row_length());
    let mut size = PictureSize {
        pixels: width.checked_mul(height),
        channels: 4,
        bytes: 0,
        packed: Some(packed.unwrap_or(usize::MAX)),
    };
    // The reader allocates memory for a row, so the size is checked first, as if every pixel had
    // four values.
    size.check(bytes.len(), memory)?;
    let mut reader = decoder.read_info().map_err(unsound)?;
    let (color, depth) = reader.output_color_type();
    size.channels = color.samples();
    size.bytes = if depth == png::BitDepth::Sixteen {
        2
    } else {
        1
    };
    size.check(bytes.len(), memory)?;
    let mut buffer = vec![0; reader.output_buffer_size().unwrap_or_default()];
    reader.next_frame(&mut buffer).map_err(unsound)?;
    Ok(Channels {
        width,
        height,
        samples: match depth {
            png::BitDepth::Sixteen => Samples::Words(buffer),
            _ => Samples::Bytes(buffer),
        },
        count: size.channels,
    })
}
