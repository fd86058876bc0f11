//! The version of this program, and the format of the files that it writes.

use std::sync::OnceLock;

/// The version of this program; stages of different versions cannot be combined.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The number of the format of indices and of the files that they list. It increases when a reader
/// of the earlier format would misread a new file. A file without a number has format 1.
pub(crate) const FORMAT: u64 = 1;

/// The Git commit from which the program was built. The program sets it when it starts, because
/// only the program is built again for each commit. An empty or missing value means that the commit
/// is not known.
pub static COMMIT: OnceLock<&'static str> = OnceLock::new();
