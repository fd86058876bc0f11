//! The header of a file, which applies to all its particles.

use super::stat::{self, StatSum};
use crate::Fault;
use crate::cursor::ByteCursor;

/// The comment that marks the weights of a file as W.
pub const WATTS: &str = "power: the weight of a particle is its power in W";

/// The header of a file, without the number of its particles.
#[derive(Clone, Debug, PartialEq)]
pub struct McplHeader {
    /// The version, 2 or 3. The two versions pack directions differently.
    pub version: u32,
    /// Whether numbers are stored with the lowest byte first.
    pub little_endian: bool,
    /// Whether particles have user flags.
    pub user_flags: bool,
    /// Whether particles have a polarisation.
    pub polarisation: bool,
    /// Whether numbers of particles are stored as f32 and not as f64.
    pub single_precision: bool,
    /// The PDG code of all particles; `None` if each particle has its own code.
    pub universal_pdg: Option<i32>,
    /// The weight of all particles; `None` if each particle has its own weight.
    pub universal_weight: Option<f64>,
    /// The program that wrote the file, as bytes, usually UTF-8.
    pub source: Vec<u8>,
    /// Comments, as bytes, usually UTF-8. Comments that begin with `stat:sum:` hold sums, see
    /// [`StatSum`].
    pub comments: Vec<Vec<u8>>,
    /// The blobs of the file: keys and their data.
    pub blobs: Vec<(Vec<u8>, Vec<u8>)>,
}

impl Default for McplHeader {
    /// A header of version 3, little-endian, f64, with a PDG code and a weight for each
    /// particle.
    fn default() -> Self {
        Self {
            version: 3,
            little_endian: true,
            user_flags: false,
            polarisation: false,
            single_precision: false,
            universal_pdg: None,
            universal_weight: None,
            source: Vec::new(),
            comments: Vec::new(),
            blobs: Vec::new(),
        }
    }
}

impl McplHeader {
    /// The header, the number of particles, and the offset of the first particle.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, u64, usize), Fault> {
        let (version, little_endian) = signature(bytes)?;
        let mut cursor = ByteCursor::new(bytes, 8, little_endian);
        let count = cursor.u64("the number of particles")?;
        let comments = texts(&mut cursor, "the number of comments")?;
        let blobs = texts(&mut cursor, "the number of blobs")?;
        let user_flags = cursor.flag("the option of user flags")?;
        let polarisation = cursor.flag("the option of polarisation")?;
        let single_precision = cursor.flag("the option of single precision")?;
        let pdg = cursor.i32("the universal PDG code")?;
        let size_at = cursor.at();
        let size = cursor.u32("the size of a particle")?;
        let universal_weight = match cursor.flag("the option of a universal weight")? {
            true => Some(cursor.f64("the universal weight")?),
            false => None,
        };
        let mut header = Self {
            version,
            little_endian,
            user_flags,
            polarisation,
            single_precision,
            universal_pdg: Some(pdg).filter(|&pdg| pdg != 0),
            universal_weight,
            ..Self::default()
        };
        if size as usize != header.record_size() {
            let right = header.record_size();
            let message = format!(
                "a particle takes {size} bytes according to the header, but {right} bytes according to the options"
            );
            return Err(Fault::byte(size_at, message));
        }
        header.source = text(&mut cursor, "the name of the source")?;
        for _ in 0..comments {
            header.comments.push(text(&mut cursor, "a comment")?);
        }
        let mut keys = Vec::new();
        for _ in 0..blobs {
            keys.push(text(&mut cursor, "the key of a blob")?);
        }
        for key in keys {
            let data = text(&mut cursor, "a blob")?;
            header.blobs.push((key, data));
        }
        header.check()?;
        Ok((header, count, cursor.at()))
    }

    /// Refuses values that the format does not allow.
    pub(super) fn check(&self) -> Result<(), Fault> {
        if let Some(weight) = self.universal_weight
            && !(weight.is_finite() && weight > 0.0)
        {
            return Err(Fault::file(format!(
                "the universal weight is {weight}; allowed: positive numbers"
            )));
        }
        stat::sums(&self.comments).map(|_| ())
    }

    /// The sums stored in comments.
    #[must_use]
    pub fn stat_sums(&self) -> Vec<StatSum> {
        // Comments are checked when the header is read or written.
        stat::sums(&self.comments).unwrap_or_default()
    }

    /// The number of bytes of a particle.
    #[must_use]
    pub fn record_size(&self) -> usize {
        let number = if self.single_precision { 4 } else { 8 };
        let numbers =
            7 + 3 * usize::from(self.polarisation) + usize::from(self.universal_weight.is_none());
        let codes = usize::from(self.universal_pdg.is_none()) + usize::from(self.user_flags);
        number * numbers + 4 * codes
    }

    /// The bytes before the first particle, for files that are written incrementally.
    #[must_use]
    pub fn bytes(&self, count: u64) -> Vec<u8> {
        let little = self.little_endian;
        let mut bytes =
            format!("MCPL{:03}{}", self.version, if little { 'L' } else { 'B' }).into_bytes();
        bytes.extend(ordered(count.to_le_bytes(), little));
        let mut number = |value: u32| bytes.extend(ordered(value.to_le_bytes(), little));
        // All lengths fit into 32 bits, because no file is longer.
        let short = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        number(short(self.comments.len()));
        number(short(self.blobs.len()));
        number(self.user_flags.into());
        number(self.polarisation.into());
        number(self.single_precision.into());
        number(self.universal_pdg.unwrap_or(0).cast_unsigned());
        number(short(self.record_size()));
        number(self.universal_weight.is_some().into());
        if let Some(weight) = self.universal_weight {
            bytes.extend(ordered(weight.to_le_bytes(), little));
        }
        let keys = self.blobs.iter().map(|(key, _)| key);
        let blobs = self.blobs.iter().map(|(_, data)| data);
        let source = std::iter::once(&self.source);
        for text in source.chain(&self.comments).chain(keys).chain(blobs) {
            bytes.extend(ordered(short(text.len()).to_le_bytes(), little));
            bytes.extend(text);
        }
        bytes
    }
}

/// The version and the byte order.
fn signature(bytes: &[u8]) -> Result<(u32, bool), Fault> {
    let mut cursor = ByteCursor::new(bytes, 0, true);
    let start = cursor.take(8, "the signature of MCPL")?;
    let version = match &start[..7] {
        b"MCPL002" => 2,
        b"MCPL003" => 3,
        other => {
            let shown = String::from_utf8_lossy(other);
            let message = format!("it begins with {shown:?}; allowed: MCPL002, MCPL003");
            return Err(Fault::byte(0, message));
        }
    };
    match start[7] {
        b'L' => Ok((version, true)),
        b'B' => Ok((version, false)),
        other => {
            let message = format!("the byte order is {:?}; allowed: L, B", char::from(other));
            Err(Fault::byte(7, message))
        }
    }
}

/// The largest number of comments, and of blobs, in a file. The number is limited because an empty
/// comment takes more bytes in memory than in the file.
const MOST_TEXTS: u32 = 65_536;

/// The number of comments or blobs.
fn texts(cursor: &mut ByteCursor<'_>, what: &str) -> Result<u32, Fault> {
    let at = cursor.at();
    let count = cursor.u32(what)?;
    if count > MOST_TEXTS {
        let message = format!("{what} is {count}; allowed: at most {MOST_TEXTS}");
        return Err(Fault::byte(at, message));
    }
    Ok(count)
}

/// Reads a byte string that is preceded by its length.
fn text(cursor: &mut ByteCursor<'_>, what: &str) -> Result<Vec<u8>, Fault> {
    let length = cursor.u32(what)?;
    cursor.take(length as usize, what).map(<[u8]>::to_vec)
}

/// Converts the bytes of a number, stored with the lowest byte first, to the byte order of a
/// file.
pub(super) fn ordered<const N: usize>(mut bytes: [u8; N], little: bool) -> [u8; N] {
    if !little {
        bytes.reverse();
    }
    bytes
}
