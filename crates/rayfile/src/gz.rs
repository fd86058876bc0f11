//! Gzip compression of a file.

use crate::Fault;
use flate2::Compression;
use flate2::bufread::MultiGzDecoder;
use flate2::write::GzEncoder;
use std::borrow::Cow;
use std::io::{Read, Write};

/// A file may unpack to at most this multiple of its packed length, plus [`FREE`] bytes. A packed
/// file of rays has about half of its original length; a packed test file with repeated rays has a
/// tenth.
pub const MOST_RATIO: usize = 64;

/// Number of bytes to which any packed file may unpack, regardless of its length.
pub const FREE: usize = 1 << 20;

/// Checks whether a file begins like a gzip file.
#[must_use]
pub fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

/// The unpacked bytes of a file, or its bytes unchanged if it is not packed.
///
/// # Errors
/// When gzip cannot read the bytes, or the unpacked bytes are more than [`MOST_RATIO`] and
/// [`FREE`] allow.
pub fn unpack(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Fault> {
    if !is_packed(bytes) {
        return Ok(Cow::Borrowed(bytes));
    }
    let most = bytes.len().saturating_mul(MOST_RATIO).saturating_add(FREE);
    let mut unpacked = Vec::new();
    let read = MultiGzDecoder::new(bytes)
        .take(most as u64 + 1)
        .read_to_end(&mut unpacked);
    read.map_err(|e| Fault::file(format!("gzip: {e}")))?;
    if unpacked.len() > most {
        let message = format!(
            "gzip: the file unpacks to more than {most} bytes, which is {MOST_RATIO} times its length plus {FREE} bytes"
        );
        return Err(Fault::file(message));
    }
    Ok(Cow::Owned(unpacked))
}

/// Packs bytes. The gzip file states no name and no time, so equal contents give equal files.
#[must_use]
pub fn pack(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    // Writing to memory cannot fail.
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    packed.unwrap_or_default()
}
