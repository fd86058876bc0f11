//! Reads and writes ray files: IES TM-25, MCPL (versions 2 and 3, plain or gzipped) and NPY.
//!
//! A file is read from bytes into a [`RayFile`], which keeps the whole content of the file. If a
//! file is read and written again, its bytes do not change (for TM-25, its values do not change,
//! see [`tm25`]). The common content of all formats is a [`RaySet`]: positions in metres, unit
//! directions, power and wavelengths. A conversion between formats returns a [`Converted`], whose
//! notes name everything that is dropped.
//!
//! Files are not trusted. Each count is checked against the length of the file before memory is
//! allocated. Reading takes at most [`MEMORY`] times the length of the unpacked file, plus
//! [`MEMORY_FREE`] bytes. A gzip file may unpack to at most [`gz::MOST_RATIO`] times its length.
//! NaN, infinite numbers and zero directions are refused, and each [`Fault`] gives the position
//! of the byte or the number of the ray.
//!
//! The crate `etendue-rayfile` does not access the disk and does not depend on light fields.
//!
//! ```
//! use etendue_rayfile::{Format, PowerUnit, RayFile, RaySet, Wavelengths, convert};
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
//! # Ok::<(), etendue_rayfile::Fault>(())
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
