//! A ray file in any of the formats, which is recognised by the first bytes of the file.

use crate::mcpl::McplFile;
use crate::tm25::Tm25File;
use crate::{Fault, RaySet, gz, npy};
use std::fmt;

/// While a file is read and its [`RaySet`] is made, memory is at most this multiple of the length
/// of the unpacked file, plus [`MEMORY_FREE`] bytes.
///
/// The shortest record of a ray takes 28 bytes in memory and 64 bytes in the set. The unpacked
/// content of a gzip file may take twice its length in memory.
pub const MEMORY: usize = 6;

/// Bytes of memory that reading any file may take, even a short one. They are needed for at most
/// 65,536 texts and 65,536 tables.
pub const MEMORY_FREE: usize = 16 << 20;

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// IES TM-25.
    Tm25,
    /// MCPL.
    Mcpl,
    /// MCPL in gzip.
    McplGz,
    /// A NumPy array.
    Npy,
}

impl Format {
    /// The format that belongs to the extension of a file name, in upper or lower case.
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

/// A file that has been read, with all its content.
#[derive(Clone, Debug, PartialEq)]
pub enum RayFile {
    /// IES TM-25.
    Tm25(Box<Tm25File>),
    /// MCPL.
    Mcpl(McplFile),
    /// A NumPy array.
    Npy(RaySet),
}

impl RayFile {
    /// Reads a file, gzipped or not. The first bytes of the file determine the format; the name
    /// of the file is ignored.
    ///
    /// # Errors
    /// A [`Fault`] with its position and reason.
    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let bytes = &*gz::unpack(bytes)?;
        if bytes.starts_with(b"TM25") {
            Tm25File::read(bytes).map(|file| Self::Tm25(Box::new(file)))
        } else if bytes.starts_with(b"MCPL") {
            McplFile::read(bytes).map(Self::Mcpl)
        } else if bytes.starts_with(b"\x93NUMPY") {
            npy::read(bytes).map(Self::Npy)
        } else {
            let message = "not a supported ray file: IES TM-25, MCPL and NPY files begin with \"TM25\", \"MCPL\" and \"\\x93NUMPY\"";
            Err(Fault::byte(0, message))
        }
    }

    /// The rays of the file.
    #[must_use]
    pub fn rays(&self) -> RaySet {
        match self {
            Self::Tm25(file) => file.rays(),
            Self::Mcpl(file) => file.rays(),
            Self::Npy(set) => set.clone(),
        }
    }
}
