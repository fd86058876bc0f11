//! The assumptions of the theory that predicts spectra. They are identified by phrases in the
//! reasons that `check` gives for violations.

/// Each assumption, with a phrase from the reasons that `check` gives for its violation. A reason
/// is assigned to the first phrase that it contains.
const PHRASES: [(&str, &str); 13] = [
    (
        "a smooth mesh is one smooth surface",
        "its osculating patch",
    ),
    (
        "no fine mesh is beside the path",
        "triangles beside the path",
    ),
    ("no mesh is in the way", "triangles at"),
    ("no surface is in the way", "visibility of"),
    (
        "surfaces are flat and across the path, which turns straight back",
        "incidence on",
    ),
    ("light is not of a picture", "light of a picture"),
    ("light is not of an environment", "light of an environment"),
    (ACROSS, "Tangent"),
    (ACROSS, "LocalNormals"),
    (ACROSS, "Mirrored"),
    (
        "a cosine comes before all reflections",
        "the cosine of light",
    ),
    ("one reflection at most", "reflections in a row"),
    ("a receiver has no edge in view", "the edge of"),
];

const ACROSS: &str = "the plane is across the path";

/// The assumption that is violated where a plane is said to be dark.
pub(super) const DARK: &str = "some light comes";

/// The name for reasons with unknown wording, and for panics of a check.
pub(super) const UNKNOWN: &str = "not in this list";

/// The violated assumption that a reason names, or `None` if no phrase matches.
pub(super) fn assumption(reason: &str) -> Option<&'static str> {
    let found = PHRASES.iter().find(|(_, phrase)| reason.contains(phrase));
    found.map(|(assumption, _)| *assumption)
}

/// All assumptions, each once.
pub(super) fn assumptions() -> Vec<&'static str> {
    let mut all: Vec<&str> = PHRASES.iter().map(|(assumption, _)| *assumption).collect();
    all.extend([DARK, UNKNOWN]);
    all.dedup();
    all
}
