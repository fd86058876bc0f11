//! The reason why a mesh is refused, and the position of the fault.

/// A value that a mesh cannot have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} is {value}; allowed: {allowed}")]
pub struct Fault {
    /// Position of the fault in the file, or name of a parameter.
    pub field: String,
    /// The value found.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
}

/// A fault with its position, the text at this position, and what is allowed there.
pub(crate) fn fault(
    field: impl Into<String>,
    value: impl ToString,
    allowed: impl Into<String>,
) -> Fault {
    Fault {
        field: field.into(),
        value: value.to_string(),
        allowed: allowed.into(),
    }
}
