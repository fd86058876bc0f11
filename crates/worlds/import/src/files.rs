//! Access to the files that a scene may refer to.

use etendue_scene::{ReadError, read_file};
use std::cell::Cell;
use std::io;
use std::path::{Path, PathBuf};

/// Maximum number of bytes that one import reads, unpacks or keeps, over all files.
const MOST_BYTES: u64 = 4 << 30;

/// The files that a scene may refer to. After links are followed, all files of a scene must lie
/// within one folder.
#[derive(Debug)]
pub(crate) struct Files {
    root: PathBuf,
    /// The number of bytes that may be read, unpacked or kept.
    most: u64,
    left: Cell<u64>,
    is_short: Cell<bool>,
}

impl Files {
    /// Creates access to the files below the folder `root`, within `memory` bytes.
    pub(crate) fn below(root: &Path, memory: Option<u64>) -> io::Result<Self> {
        let most = memory.map_or(MOST_BYTES, |memory| memory.min(MOST_BYTES));
        let root = match root.as_os_str() {
            empty if empty.is_empty() => Path::new("."),
            _ => root,
        };
        Ok(Self {
            root: root.canonicalize()?,
            most,
            left: Cell::new(most),
            is_short: Cell::new(false),
        })
    }

    /// The path of the file or folder `name`, which is searched for in the given folders
    /// in order.
    ///
    /// The name may contain `..`, because only the path to which it resolves must lie below the
    /// root.
    pub(crate) fn find(&self, folders: &[PathBuf], name: &str) -> Result<PathBuf, String> {
        let mut is_outside = false;
        for folder in folders {
            // If the name is absolute, `join` ignores the folder.
            let Ok(path) = folder.join(name).canonicalize() else {
                continue;
            };
            if path.starts_with(&self.root) {
                return Ok(path);
            }
            is_outside = true;
        }
        Err(if is_outside {
            "is outside of the folder that a scene may read from, after links are followed; --root DIR allows a folder above"
                .to_owned()
        } else {
            "is not found".to_owned()
        })
    }

    /// The bytes of a file found by [`Self::find`].
    pub(crate) fn read(&self, path: &Path) -> Result<Vec<u8>, String> {
        let bytes = read_file(path, self.left.get()).map_err(|error| {
            if matches!(error, ReadError::TooLong { .. }) {
                self.fall_short();
            }
            error.to_string()
        })?;
        if bytes.starts_with(b"version https://git-lfs.github.com/spec/") {
            return Err("is a pointer of Git LFS; `git lfs pull` fetches its content".to_owned());
        }
        self.spend(bytes.len() as u64)?;
        Ok(bytes)
    }

    /// The number of bytes that may still be read or unpacked.
    pub(crate) fn left(&self) -> u64 {
        self.left.get()
    }

    /// Records that more bytes are needed than are left.
    pub(crate) fn fall_short(&self) {
        self.is_short.set(true);
    }

    /// Checks whether the free memory of the machine did not suffice.
    pub(crate) fn lacks_memory(&self) -> bool {
        self.is_short.get() && self.most < MOST_BYTES
    }

    /// Counts unpacked bytes.
    pub(crate) fn spend(&self, bytes: u64) -> Result<(), String> {
        let left = self.left.get().checked_sub(bytes);
        self.left.set(left.unwrap_or_default());
        left.map(|_| ()).ok_or_else(|| {
            self.fall_short();
            let most = self.most;
            let why = if most < MOST_BYTES {
                ", the free memory,"
            } else {
                ""
            };
            format!("exceeds the limit: at most {most} bytes{why} are read for one scene")
        })
    }
}

/// Checks whether the name of a file has an extension, in upper or lower case.
pub(crate) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

/// Decodes the bytes of a file as text.
pub(crate) fn text(bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|_| "is no UTF-8".to_owned())
}
