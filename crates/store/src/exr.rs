//! Writes OpenEXR files. Each part of a file has one channel, Y, and a record of the source of its
//! numbers.

use crate::Failure;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, Text, WritableImage,
};
use serde_json::Value;
use std::io::Cursor;

/// One part of a file. The rows are in order from the top, and each row is in order from left to
/// right.
#[derive(Debug)]
pub struct Part {
    /// Name of the channel.
    pub name: &'static str,
    /// One number for each pixel, row by row from the top.
    pub samples: Vec<f32>,
}

/// The bytes of a file; `provenance` is an attribute of each part.
pub fn exr(
    [width, height]: [usize; 2],
    parts: Vec<Part>,
    provenance: &Value,
) -> Result<Vec<u8>, Failure> {
    let layers = parts.into_iter().map(|Part { name, samples }| {
        let mut attributes = LayerAttributes::named(name);
        attributes.other.extend([attribute(provenance)]);
        let channel = AnyChannel::new("Y", FlatSamples::F32(samples));
        let channels = AnyChannels::sort(std::iter::once(channel).collect());
        Layer::new(
            (width, height),
            attributes,
            Encoding::FAST_LOSSLESS,
            channels,
        )
    });
    let image = Image::from_layers(
        ImageAttributes::new(IntegerBounds::from_dimensions((width, height))),
        layers.collect::<Vec<_>>(),
    );
    let mut bytes = Cursor::new(Vec::new());
    image
        .write()
        // Chunks are written by one thread, because several threads would write them in random
        // order.
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(Failure::cannot_run)?;
    Ok(bytes.into_inner())
}

/// All provenance as one attribute, because several attributes would be written in random
/// order.
fn attribute(provenance: &Value) -> (Text, AttributeValue) {
    // OpenEXR stores text as Latin-1, so characters other than ASCII are written as JSON escapes.
    let mut ascii = String::new();
    for unit in provenance.to_string().encode_utf16() {
        match u8::try_from(unit).ok().filter(u8::is_ascii) {
            Some(byte) => ascii.push(char::from(byte)),
            None => ascii.push_str(&format!("\\u{unit:04x}")),
        }
    }
    let text = Text::new_or_panic(ascii);
    (Text::new_or_panic("provenance"), AttributeValue::Text(text))
}
