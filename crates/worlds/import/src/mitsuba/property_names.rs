//! Elements that are properties.

/// The element names, sorted.
pub(super) const VALUES: [&str; 9] = [
    "boolean",
    "float",
    "integer",
    "point",
    "rgb",
    "spectrum",
    "string",
    "transform",
    "vector",
];
