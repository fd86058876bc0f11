//! NPZ files: named arrays, written to memory and read back with every fault named.

use crate::Failure;
use etendue_field::{Complex, SliceGrid};
use ndarray::{Array, Array1, ArrayBase, ArrayView, Data, Dimension, IntoDimension};
use ndarray_npy::{
    NpzWriter, ReadNpyExt, ReadableElement, ViewElement, ViewNpyError, ViewNpyExt, WritableElement,
};
use std::fmt::{self, Display};
use std::io::{Cursor, Read};
use std::path::PathBuf;
use zip::ZipArchive;

/// Named arrays in the making of a file.
pub struct Npz(NpzWriter<Cursor<Vec<u8>>>);

impl fmt::Debug for Npz {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Npz").finish_non_exhaustive()
    }
}

impl Default for Npz {
    fn default() -> Self {
        Self::new()
    }
}

impl Npz {
    /// No arrays yet.
    #[must_use]
    pub fn new() -> Self {
        Self(NpzWriter::new(Cursor::new(Vec::new())))
    }

    /// Adds an array by its name.
    pub fn add<A, S, D>(mut self, name: &str, array: &ArrayBase<S, D>) -> Result<Self, Failure>
    where
        A: WritableElement,
        S: Data<Elem = A>,
        D: Dimension,
    {
        self.0
            .add_array(name, array)
            .map_err(|e| Failure::cannot_run(format!("array {name}: {e}")))?;
        Ok(self)
    }

    /// Adds the frequencies of arrays [azimuth, ρ ≥ 0, ν].
    pub fn add_half_axes(self, grid: &SliceGrid) -> Result<Self, Failure> {
        let mut axes = half_axes(grid).into_iter();
        axes.try_fold(self, |npz, (name, values)| npz.add(name, &values))
    }

    /// The bytes of the file.
    pub fn bytes(self) -> Result<Vec<u8>, Failure> {
        let finished = self.0.finish().map_err(Failure::cannot_run)?;
        Ok(finished.into_inner())
    }
}

/// The axes of arrays [azimuth, ρ ≥ 0, ν].
fn half_axes(grid: &SliceGrid) -> [(&'static str, Array1<f64>); 3] {
    let rho = (0..=grid.rho.half).map(|i| grid.rho.value(grid.rho.half + i));
    [
        ("azimuth", azimuths(grid)),
        ("rho", rho.collect()),
        ("nu", Array1::from(grid.nu.values())),
    ]
}

/// A file to read arrays from.
pub struct NpzFile {
    path: PathBuf,
    archive: ZipArchive<Cursor<Vec<u8>>>,
    length: usize,
}

impl fmt::Debug for NpzFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = &self.path;
        f.debug_struct("NpzFile")
            .field("path", path)
            .finish_non_exhaustive()
    }
}

/// A number an array may hold.
pub trait Number: ReadableElement + ViewElement + Copy {
    /// Whether it is neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

impl Number for f64 {
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

impl Number for Complex {
    fn is_finite(self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

impl Number for u32 {
    fn is_finite(self) -> bool {
        true
    }
}

impl Number for u64 {
    fn is_finite(self) -> bool {
        true
    }
}

/// Whether the header of an NPY file is short and flat, as those of arrays of numbers are: the library takes
/// time that doubles with each bracket inside another.
fn has_plain_header(bytes: &[u8]) -> bool {
    /// Those of Étendue and of NumPy have 118.
    const LONGEST: usize = 1024;
    let header = &bytes[..bytes.len().min(LONGEST)];
    let length = match header {
        // Magic, version, and the length in two or four bytes.
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _, a, b, ..] => {
            Some(10 + usize::from(u16::from_le_bytes([*a, *b])))
        }
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _, a, b, 0, 0, ..] => {
            Some(12 + usize::from(u16::from_le_bytes([*a, *b])))
        }
        _ => None,
    };
    let header = length.and_then(|length| header.get(..length));
    // One for the dictionary and one for the shape.
    let opening = |byte: &&u8| matches!(byte, b'{' | b'(' | b'[');
    header.is_some_and(|header| header.iter().filter(opening).count() <= 2)
}

/// The most an NPY file has before its numbers.
const HEADER: usize = 1 << 16;

impl NpzFile {
    /// The file of these bytes; `path` is for messages.
    pub fn new(path: PathBuf, bytes: Vec<u8>) -> Result<Self, Failure> {
        let length = bytes.len();
        match ZipArchive::new(Cursor::new(bytes)) {
            Ok(archive) => Ok(Self {
                path,
                archive,
                length,
            }),
            Err(e) => Err(Failure::bad_input(format!("{}: {e}", path.display()))),
        }
    }

    /// The array `name`, in C order; it must have this shape and hold finite numbers.
    pub fn array<A: Number, I: IntoDimension>(
        &mut self,
        name: &str,
        shape: I,
    ) -> Result<Array<A, I::Dim>, Failure> {
        let shape = shape.into_dimension();
        let found: Array<A, I::Dim> =
            self.finite(name, shape.size().saturating_mul(size_of::<A>()))?;
        if found.raw_dim() != shape {
            let is = format!(
                "its shape is {:?}; must be {:?}",
                found.shape(),
                shape.slice()
            );
            return Err(self.fault(name, is));
        }
        Ok(found.as_standard_layout().into_owned())
    }

    /// The numbers of an axis, of any length.
    pub fn axis(&mut self, name: &str) -> Result<Array1<f64>, Failure> {
        // What is not compressed is no larger than the file.
        self.finite(name, self.length)
    }

    /// Whether the file is long enough for so many numbers of eight bytes, as it is where nothing is compressed.
    pub fn may_hold(&self, numbers: usize) -> bool {
        numbers <= self.length / size_of::<f64>()
    }

    /// An array of finite numbers that needs at most `bytes`.
    fn finite<A: Number, D: Dimension>(
        &mut self,
        name: &str,
        bytes: usize,
    ) -> Result<Array<A, D>, Failure> {
        let bytes = self.entry(name, bytes)?;
        if !has_plain_header(&bytes) {
            return Err(self.fault(name, "its header is not one of an array of numbers"));
        }
        // A view takes no memory, whatever size the file claims the array to have: it sees that it is too short.
        let found = match ArrayView::<A, D>::view_npy(&bytes) {
            Ok(view) => view.to_owned(),
            Err(ViewNpyError::MisalignedData) => {
                Array::read_npy(&bytes[..]).map_err(|e| self.fault(name, e))?
            }
            Err(e) => return Err(self.fault(name, e)),
        };
        if !found.iter().all(|number| number.is_finite()) {
            return Err(self.fault(name, "it holds numbers that are not finite"));
        }
        Ok(found)
    }

    /// Whether it has an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.archive
            .index_for_name(&format!("{name}.npy"))
            .is_some()
    }

    /// Its axes must be those of a grid, to the bit.
    pub fn check_half_axes(&mut self, grid: &SliceGrid) -> Result<(), Failure> {
        for (name, values) in half_axes(grid) {
            let found: Array1<f64> = self.array(name, [values.len()])?;
            if found != values {
                return Err(self.fault(name, "must be the axis of the scene's plane"));
            }
        }
        Ok(())
    }

    /// What is wrong with array `name`, for the user.
    pub fn fault(&self, name: &str, what: impl Display) -> Failure {
        let path = self.path.display();
        Failure::bad_input(format!("{path}: array {name}: {what}"))
    }

    /// The NPY file `name` in the archive. What is compressed is not unpacked to more than `numbers` bytes
    /// need or the whole archive holds.
    fn entry(&mut self, name: &str, numbers: usize) -> Result<Vec<u8>, Failure> {
        let limit = numbers.saturating_add(self.length).saturating_add(HEADER);
        let mut bytes = Vec::new();
        let read = match self.archive.by_name(&format!("{name}.npy")) {
            Ok(file) => file
                .take(u64::try_from(limit).unwrap_or(u64::MAX))
                .read_to_end(&mut bytes)
                .map_err(|e| e.to_string()),
            Err(e) => Err(e.to_string()),
        };
        match read {
            Ok(_) => Ok(bytes),
            Err(e) => Err(self.fault(name, e)),
        }
    }
}

/// The azimuths of slices.
pub(super) fn azimuths(grid: &SliceGrid) -> Array1<f64> {
    (0..grid.azimuths).map(|k| grid.azimuth(k)).collect()
}
