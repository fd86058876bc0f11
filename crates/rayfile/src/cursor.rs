//! Reads the numbers of a file in sequence, in either byte order, and never past the end of the
//! file.

use crate::Fault;

/// The current position in a file.
pub(crate) struct ByteCursor<'a> {
    bytes: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> ByteCursor<'a> {
    pub(crate) fn new(bytes: &'a [u8], at: usize, little: bool) -> Self {
        Self { bytes, at, little }
    }

    /// The offset of the next byte.
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// The number of bytes that have not been read.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }

    /// The next bytes; `what` names them in an error message.
    pub(crate) fn take(&mut self, length: usize, what: &str) -> Result<&'a [u8], Fault> {
        let found = self.at.checked_add(length);
        let found = found.and_then(|end| self.bytes.get(self.at..end));
        let found = found.ok_or_else(|| {
            let left = self.left();
            Fault::byte(
                self.at,
                format!("{what} takes {length} bytes, but {left} are left"),
            )
        })?;
        self.at += length;
        Ok(found)
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Fault> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        if !self.little {
            array.reverse();
        }
        Ok(array)
    }

    pub(crate) fn u32(&mut self, what: &str) -> Result<u32, Fault> {
        self.array(what).map(u32::from_le_bytes)
    }

    pub(crate) fn i32(&mut self, what: &str) -> Result<i32, Fault> {
        self.array(what).map(i32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self, what: &str) -> Result<u64, Fault> {
        self.array(what).map(u64::from_le_bytes)
    }

    pub(crate) fn f32(&mut self, what: &str) -> Result<f32, Fault> {
        self.array(what).map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self, what: &str) -> Result<f64, Fault> {
        self.array(what).map(f64::from_le_bytes)
    }

    /// Reads a number that must be 0 or 1.
    pub(crate) fn flag(&mut self, what: &str) -> Result<bool, Fault> {
        let at = self.at;
        match self.u32(what)? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(Fault::byte(at, format!("{what} is {other}; allowed: 0, 1"))),
        }
    }
}
