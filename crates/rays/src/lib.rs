//! Ray files, read and written: IES TM-25, MCPL (versions 2 and 3, plain or gzipped) and NPY.
//!
//! A file is read from bytes into a [`RayFile`], which keeps all the file holds: written again, it has the same bytes (TM-25: the same values, see
//! [`tm25`]). What formats have in common is a [`RaySet`]: positions in metres, unit directions, power and wavelengths. It goes from one format to
//! the other with a [`Converted`], whose notes name all that is dropped.
//!
//! Files may be hostile. Each count is held against the length of the file before memory is taken. Reading takes at most [`MEMORY`] times the bytes of the file,
//! unpacked, and [`MEMORY_FREE`]; gzip may unpack to at most [`gz::MOST_RATIO`] times its length. NaN, infinite numbers and zero directions are refused, and each
//! [`Fault`] says at which byte or ray.
//!
//! This crate touches no disk and knows nothing of light fields.
//!
//! ```
//! use etendue_rays::{Format, PowerUnit, RayFile, RaySet, Wavelengths, convert};
//!
//! let set = RaySet {
//!     positions: vec![[0.0, 0.0, 0.001]],
//!     directions: vec![[0.0, 0.6, 0.8]],
//!     powers: vec![0.5],
//!     unit: PowerUnit::Watt,
//!     wavelengths: Wavelengths::One(500e-9),
//! };
//! let converted = convert(&RayFile::Npy(set), Format::Tm25)?;
//! let again = RayFile::read(&converted.bytes)?.rays();
//! assert_eq!(again.powers, [0.5]);
//! # Ok::<(), etendue_rays::Fault>(())
//! ```

mod convert;
mod cursor;
mod fault;
mod file;
pub mod gz;
pub mod mcpl;
mod npy;
mod npy_header;
mod set;
pub mod tm25;

pub use convert::{Converted, convert};
pub use fault::{Fault, FilePosition};
pub use file::{Format, MEMORY, MEMORY_FREE, RayFile};
pub use npy_header::NpyHeader;
pub use set::{PHOTON_ENERGY_LENGTH, PowerUnit, RaySet, Wavelengths};
