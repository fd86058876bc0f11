//! A file of any of the formats, which its first bytes tell.

use crate::mcpl::McplFile;
use crate::tm25::Tm25File;
use crate::{Fault, RaySet, gz, npy};
use std::fmt;

/// Reading a file and making its [`RaySet`] takes at most so many times the bytes of the file, unpacked, and [`MEMORY_FREE`] bytes.
///
/// The shortest record, 28 bytes, is kept once and becomes 64 bytes of a set. What gzip unpacks to may take twice its length.
pub const MEMORY: usize = 6;

/// Bytes that reading may take whatever the length of the file: its texts and tables, of which there are at most 65,536 each.
pub const MEMORY_FREE: usize = 16 << 20;

/// How a file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// IES TM-25.
    Tm25,
    /// MCPL.
    Mcpl,
    /// MCPL in gzip.
    McplGz,
    /// An array of NumPy.
    Npy,
}

impl Format {
    /// The format of a file with this name, by its ending in any case.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        let name = name.to_ascii_lowercase();
        let endings = [
            (".tm25ray", Self::Tm25),
            (".tm25", Self::Tm25),
            (".mcpl", Self::Mcpl),
            (".mcpl.gz", Self::McplGz),
            (".npy", Self::Npy),
        ];
        let found = endings.iter().find(|(ending, _)| name.ends_with(ending));
        found.map(|(_, format)| *format)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tm25 => "IES TM-25",
            Self::Mcpl => "MCPL",
            Self::McplGz => "MCPL in gzip",
            Self::Npy => "NPY",
        })
    }
}

/// A file that has been read, with all it holds.
#[derive(Clone, Debug, PartialEq)]
pub enum RayFile {
    /// IES TM-25.
    Tm25(Box<Tm25File>),
    /// MCPL.
    Mcpl(McplFile),
    /// An array of NumPy.
    Npy(RaySet),
}

impl RayFile {
    /// Reads a file, gzipped or not. Its format is told by its first bytes, whatever its name.
    ///
    /// # Errors
    /// A [`Fault`] that says where and why.
    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let bytes = &*gz::unpack(bytes)?;
        if bytes.starts_with(b"TM25") {
            Tm25File::read(bytes).map(|file| Self::Tm25(Box::new(file)))
        } else if bytes.starts_with(b"MCPL") {
            McplFile::read(bytes).map(Self::Mcpl)
        } else if bytes.starts_with(b"\x93NUMPY") {
            npy::read(bytes).map(Self::Npy)
        } else {
            let message = "no ray file that is read here: IES TM-25, MCPL and NPY begin with \"TM25\", \"MCPL\" and \"\\x93NUMPY\"";
            Err(Fault::byte(0, message))
        }
    }

    /// Its rays.
    #[must_use]
    pub fn rays(&self) -> RaySet {
        match self {
            Self::Tm25(file) => file.rays(),
            Self::Mcpl(file) => file.rays(),
            Self::Npy(set) => set.clone(),
        }
    }
}
