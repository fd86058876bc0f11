//! JPEG pictures.

use super::size::check_size;
use crate::files::Files;
use etendue_scene::{Channels, Samples};
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

pub(super) fn read(bytes: &[u8], files: &Files) -> Result<Channels, String> {
    let damaged = |error: zune_jpeg::errors::DecodeErrors| format!("is damaged ({error})");
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(damaged)?;
    let (width, height) = decoder.dimensions().ok_or("has no size")?;
    check_size((width, height), [3, 1], bytes.len(), files)?;
    let levels = decoder.decode().map_err(damaged)?;
    if levels.len() != 3 * width * height {
        return Err("does not have the number of pixels that its header states".to_owned());
    }
    Ok(Channels {
        width,
        height,
        samples: Samples::Bytes(levels),
        count: 3,
    })
}
