//! Sources that a `uri` refers to: data within the file, or another file.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// Decoder of Base64 with optional padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The source of the bytes.
pub(super) enum BufferSource {
    /// Embedded data.
    Data(Vec<u8>),
    /// A file with the given name.
    File(String),
}

/// Parses a URI; data may have at most `most` bytes.
pub(super) fn source(uri: &str, most: u64) -> Result<BufferSource, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (kind, text) = data
            .split_once(',')
            .ok_or("is a data URI without a comma")?;
        if !kind.ends_with(";base64") {
            return Err("is a data URI that is not in base64; allowed: base64".to_owned());
        }
        // Four characters of Base64 encode three bytes.
        if (text.len() as u64) / 4 * 3 > most {
            return Err("is a data URI of more bytes than an import may read".to_owned());
        }
        let bytes = BASE64.decode(text);
        let bytes = bytes.map_err(|error| format!("is a data URI in damaged base64 ({error})"))?;
        return Ok(BufferSource::Data(bytes));
    }
    if uri.contains("://") {
        return Err(
            "is the address of a remote file; allowed: local files and data URIs".to_owned(),
        );
    }
    unescaped(uri).map(BufferSource::File)
}

/// Decodes the percent encoding of a name.
fn unescaped(uri: &str) -> Result<String, String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let code = after.get(..2).and_then(|two| str::from_utf8(two).ok());
        let code = code.and_then(|two| u8::from_str_radix(two, 16).ok());
        rest = match (first, code) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                &after[2..]
            }
            _ => {
                bytes.push(*first);
                after
            }
        };
    }
    String::from_utf8(bytes).map_err(|_| "is no UTF-8".to_owned())
}
