//! A fault of a mesh file.

use crate::fault::Fault;

/// Where in the file, what is there, and what is allowed.
pub(super) fn fault(
    place: impl Into<String>,
    value: impl ToString,
    allowed: impl Into<String>,
) -> Fault {
    Fault {
        field: place.into(),
        value: value.to_string(),
        allowed: allowed.into(),
        memory: false,
    }
}
