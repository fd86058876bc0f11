//! Writes named arrays to memory as NPZ files, and reads them back. Every fault of a file has a
//! message.

use crate::Failure;
use etendue_field::{Complex, SliceGrid};
use etendue_rayfile::NpyHeader;
use ndarray::{Array, Array1, ArrayBase, Data, Dimension, IntoDimension, ShapeBuilder};
use std::fmt::{self, Display};
use std::io::{self, Cursor, Read, Write};
use std::path::PathBuf;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// A type of number that an array may hold.
pub trait Number: Copy {
    /// The type in NumPy's notation, with the lowest byte first.
    const DESCR: &'static str;
    /// Writes the bytes of the number to a slice of their length.
    fn write(self, bytes: &mut [u8]);
    /// Decodes a number. Returns `None` unless the number of bytes is exactly right.
    fn read(bytes: &[u8]) -> Option<Self>;
    /// Checks whether the number is finite, so not infinite and not NaN.
    fn is_finite(self) -> bool;
}

/// Implements [`Number`] for types that the standard library can convert to bytes.
macro_rules! plain_number {
    ($type:ty, $descr:literal, $is_finite:expr) => {
        impl Number for $type {
            const DESCR: &'static str = $descr;

            fn write(self, bytes: &mut [u8]) {
                bytes.copy_from_slice(&self.to_le_bytes());
            }

            fn read(bytes: &[u8]) -> Option<Self> {
                Some(Self::from_le_bytes(bytes.try_into().ok()?))
            }

            fn is_finite(self) -> bool {
                let is_finite: fn(Self) -> bool = $is_finite;
                is_finite(self)
            }
        }
    };
}

plain_number!(f64, "<f8", Self::is_finite);
plain_number!(u32, "<u4", |_| true);
plain_number!(u64, "<u8", |_| true);

impl Number for Complex {
    const DESCR: &'static str = "<c16";

    fn write(self, bytes: &mut [u8]) {
        let (re, im) = bytes.split_at_mut(size_of::<f64>());
        self.re.write(re);
        self.im.write(im);
    }

    fn read(bytes: &[u8]) -> Option<Self> {
        let (re, im) = bytes.split_at_checked(size_of::<f64>())?;
        Some(Self::new(f64::read(re)?, f64::read(im)?))
    }

    fn is_finite(self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

/// Writes an array as an NPY file, in C order.
pub fn write_npy<A, S, D>(file: &mut dyn Write, array: &ArrayBase<S, D>) -> io::Result<()>
where
    A: Number,
    S: Data<Elem = A>,
    D: Dimension,
{
    /// The number of values that are converted to bytes at a time.
    const BLOCK: usize = 1 << 13;
    let shape: Vec<u64> = array.shape().iter().map(|length| *length as u64).collect();
    file.write_all(&NpyHeader::new(A::DESCR, &shape).bytes())?;
    let mut bytes = vec![0; BLOCK * size_of::<A>()];
    let mut numbers = array.iter();
    while numbers.len() > 0 {
        let full = numbers.len().min(BLOCK) * size_of::<A>();
        for (bytes, number) in bytes.chunks_exact_mut(size_of::<A>()).zip(&mut numbers) {
            number.write(bytes);
        }
        file.write_all(&bytes[..full])?;
    }
    Ok(())
}

/// A file of named arrays that is being written.
#[derive(Debug)]
pub struct Npz(ZipWriter<Cursor<Vec<u8>>>);

impl Default for Npz {
    /// A file without arrays.
    fn default() -> Self {
        Self(ZipWriter::new(Cursor::new(Vec::new())))
    }
}

impl Npz {
    /// Adds an array by its name.
    pub fn add<A, S, D>(mut self, name: &str, array: &ArrayBase<S, D>) -> Result<Self, Failure>
    where
        A: Number,
        S: Data<Elem = A>,
        D: Dimension,
    {
        let bytes = array.len().saturating_mul(size_of::<A>());
        self.entry(name, bytes, &mut |file| write_npy(file, array))?;
        Ok(self)
    }

    /// Adds the frequencies of arrays [azimuth, ρ ≥ 0, ν].
    pub fn add_half_axes(self, grid: &SliceGrid) -> Result<Self, Failure> {
        let mut axes = half_axes(grid).into_iter();
        axes.try_fold(self, |npz, (name, values)| npz.add(name, &values))
    }

    /// Writes an entry of about `bytes` bytes.
    fn entry(
        &mut self,
        name: &str,
        bytes: usize,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(bytes >= MAX_SMALL_FILE);
        self.0
            .start_file(format!("{name}.npy"), options)
            .map_err(io::Error::from)
            .and_then(|()| write(&mut self.0))
            .map_err(|e| Failure::cannot_run(format!("array {name}: {e}")))
    }

    /// Adds an array of texts by its name, as NumPy stores them: `<U` and the largest number of
    /// characters, each in four bytes.
    pub fn add_texts(mut self, name: &str, texts: &[String]) -> Result<Self, Failure> {
        let width = texts.iter().map(|text| text.chars().count()).max();
        let width = width.unwrap_or(0).max(1);
        let mut bytes = NpyHeader::new(&format!("<U{width}"), &[texts.len() as u64]).bytes();
        for text in texts {
            let characters = text.chars().map(u32::from).chain(std::iter::repeat(0));
            bytes.extend(characters.take(width).flat_map(u32::to_le_bytes));
        }
        self.entry(name, bytes.len(), &mut |file| file.write_all(&bytes))?;
        Ok(self)
    }

    /// The bytes of the file.
    pub fn bytes(self) -> Result<Vec<u8>, Failure> {
        let finished = self.0.finish().map_err(Failure::cannot_run)?;
        Ok(finished.into_inner())
    }
}

/// Arrays with more bytes than this limit need the 64-bit fields of ZIP, which NumPy can read.
const MAX_SMALL_FILE: usize = 1 << 31;

/// The axes of arrays [azimuth, ρ ≥ 0, ν].
pub(super) fn half_axes(grid: &SliceGrid) -> [(&'static str, Array1<f64>); 3] {
    let rho = (0..=grid.rho.half).map(|i| grid.rho.value(grid.rho.half + i));
    [
        ("azimuth", azimuths(grid)),
        ("rho", rho.collect()),
        ("nu", Array1::from(grid.nu.values())),
    ]
}

/// A file from which arrays are read.
pub struct NpzFile {
    path: PathBuf,
    archive: ZipArchive<Cursor<Vec<u8>>>,
    length: usize,
}

impl fmt::Debug for NpzFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NpzFile")
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

/// The largest number of bytes of an NPY file before its data.
const HEADER: usize = 1 << 16;

impl NpzFile {
    /// The file with these bytes. Messages name the file as `path`.
    pub fn new(path: PathBuf, bytes: Vec<u8>) -> Result<Self, Failure> {
        let length = bytes.len();
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| {
            let what = "no NPZ file, as numpy.savez writes it";
            Failure::bad_input(format!("{}: {what}: {e}", path.display()))
        })?;
        Ok(Self {
            path,
            archive,
            length,
        })
    }

    /// The array `name`, in C order. The array must have the given shape and hold finite
    /// numbers.
    pub fn array<A: Number, I: IntoDimension>(
        &mut self,
        name: &str,
        shape: I,
    ) -> Result<Array<A, I::Dim>, Failure> {
        let shape = shape.into_dimension();
        let bytes = shape.size().saturating_mul(size_of::<A>());
        let (found, numbers) = self.numbers(name, bytes)?;
        let wanted = shape.slice().iter().map(|length| *length as u64);
        if !wanted.eq(found.shape.iter().copied()) {
            let is = format!(
                "its shape is {:?}; must be {:?}",
                found.shape,
                shape.slice()
            );
            return Err(self.fault(name, is));
        }
        let array = Array::from_shape_vec(shape.set_f(found.fortran_order), numbers)
            .map_err(|e| self.fault(name, e))?;
        Ok(if array.is_standard_layout() {
            array
        } else {
            array.as_standard_layout().into_owned()
        })
    }

    /// The numbers of an axis, of any length.
    pub fn axis(&mut self, name: &str) -> Result<Array1<f64>, Failure> {
        // Uncompressed data are no larger than the file.
        let (found, numbers) = self.numbers(name, self.length)?;
        match found.shape[..] {
            [_] => Ok(Array1::from(numbers)),
            _ => {
                let is = format!("its shape is {:?}; must have one axis", found.shape);
                Err(self.fault(name, is))
            }
        }
    }

    /// Checks whether the file is long enough to hold this many uncompressed numbers of eight
    /// bytes.
    pub fn may_hold(&self, numbers: usize) -> bool {
        numbers <= self.length / size_of::<f64>()
    }

    /// The finite numbers of an array that needs at most `bytes`, in the order of the file.
    fn numbers<A: Number>(
        &mut self,
        name: &str,
        bytes: usize,
    ) -> Result<(NpyHeader, Vec<A>), Failure> {
        let bytes = self.entry(name, self.limit(bytes))?;
        let (header, start) = self.header(name, &bytes)?;
        if header.descr != A::DESCR {
            let [is, must] = [&header.descr, A::DESCR].map(dtype);
            let is = format!("its dtype is {is}; must be {must}");
            return Err(self.fault(name, is));
        }
        let data = &bytes[start..];
        let counted = |count: u64, length: &u64| count.checked_mul(*length);
        let count = header.shape.iter().try_fold(1, counted);
        if count.and_then(|count| count.checked_mul(size_of::<A>() as u64))
            != Some(data.len() as u64)
        {
            let is = format!(
                "its shape is {:?}, and {} bytes of numbers follow",
                header.shape,
                data.len()
            );
            return Err(self.fault(name, is));
        }
        let numbers: Vec<A> = data
            .chunks_exact(size_of::<A>())
            .filter_map(A::read)
            .collect();
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(self.fault(name, "the array holds numbers that are not finite"));
        }
        Ok((header, numbers))
    }

    /// The shape of an array.
    pub fn shape(&mut self, name: &str) -> Result<Vec<u64>, Failure> {
        let bytes = self.entry(name, HEADER)?;
        Ok(self.header(name, &bytes)?.0.shape)
    }

    /// A list of texts.
    pub fn texts(&mut self, name: &str) -> Result<Vec<String>, Failure> {
        let bytes = self.entry(name, self.limit(self.length))?;
        let (header, start) = self.header(name, &bytes)?;
        let width = header.descr.strip_prefix("<U");
        let width = width.and_then(|width| width.parse::<usize>().ok());
        let (Some(width @ 1..), [count]) = (width, &header.shape[..]) else {
            return Err(self.fault(name, "must be a list of texts (dtype str)"));
        };
        let texts = bytes[start..].chunks_exact(width.saturating_mul(4));
        let text = |of: &[u8]| -> Option<String> {
            let codes = of.chunks_exact(4).map(|code| code.try_into().ok());
            let codes = codes.map(|code| Some(u32::from_le_bytes(code?)));
            let codes = codes.take_while(|code| *code != Some(0));
            codes.map(|code| char::from_u32(code?)).collect()
        };
        let texts: Option<Vec<String>> = texts.map(text).collect();
        let texts = texts.filter(|texts| texts.len() as u64 == *count);
        texts.ok_or_else(|| self.fault(name, "is damaged"))
    }

    /// The names of all arrays, sorted.
    pub fn names(&self) -> Vec<String> {
        let names = self.archive.file_names();
        let names = names.map(|name| name.strip_suffix(".npy").unwrap_or(name).to_owned());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    /// Checks whether the file has an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.archive
            .index_for_name(&format!("{name}.npy"))
            .is_some()
    }

    /// Checks that the axes are exactly the axes of a grid.
    pub fn check_half_axes(&mut self, grid: &SliceGrid) -> Result<(), Failure> {
        for (name, values) in half_axes(grid) {
            let found: Array1<f64> = self.array(name, [values.len()])?;
            if found != values {
                return Err(self.fault(name, "must be the axis of the scene's plane"));
            }
        }
        Ok(())
    }

    /// The message for a fault of array `name`.
    pub fn fault(&self, name: &str, what: impl Display) -> Failure {
        let path = self.path.display();
        Failure::bad_input(format!("{path}: array {name}: {what}"))
    }

    /// The header of array `name`, whose file has these bytes, and the offset of the data.
    fn header(&self, name: &str, bytes: &[u8]) -> Result<(NpyHeader, usize), Failure> {
        let what = "its header does not describe an array of numbers";
        NpyHeader::read(bytes).ok_or_else(|| self.fault(name, what))
    }

    /// The number of bytes that are unpacked at most for `numbers` bytes of numbers: as many more
    /// as the archive and a header have.
    fn limit(&self, numbers: usize) -> usize {
        numbers.saturating_add(self.length).saturating_add(HEADER)
    }

    /// The first `limit` bytes of the NPY file `name` in the archive.
    fn entry(&mut self, name: &str, limit: usize) -> Result<Vec<u8>, Failure> {
        if !self.has(name) {
            return Err(self.fault(name, "is missing"));
        }
        let mut bytes = Vec::new();
        let limit = u64::try_from(limit).unwrap_or(u64::MAX);
        self.archive
            .by_name(&format!("{name}.npy"))
            .map_err(|e| e.to_string())
            .and_then(|file| {
                let read = file.take(limit).read_to_end(&mut bytes);
                read.map_err(|e| e.to_string())
            })
            .map_err(|e| self.fault(name, e))?;
        Ok(bytes)
    }
}

/// NumPy's name of a type of numbers, such as complex64 for `<c8`; other types as they are written.
fn dtype(descr: &str) -> String {
    let kinds = [
        ("<f", "float"),
        ("<c", "complex"),
        ("<i", "int"),
        ("<u", "uint"),
    ];
    let named = kinds.iter().find_map(|(prefix, kind)| {
        let bytes: u32 = descr.strip_prefix(prefix)?.parse().ok()?;
        Some(format!("{kind}{}", bytes.checked_mul(8)?))
    });
    named.unwrap_or_else(|| format!("'{descr}'"))
}

/// The azimuths of slices.
pub(super) fn azimuths(grid: &SliceGrid) -> Array1<f64> {
    (0..grid.azimuths).map(|k| grid.azimuth(k)).collect()
}
