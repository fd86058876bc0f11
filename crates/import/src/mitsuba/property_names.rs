//! Elements that are properties.

/// Their names, in order.
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
