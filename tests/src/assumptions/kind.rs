//! The assumptions of theory, told apart by the words in which `check` says that one does not hold.

/// Each assumption, and a phrase of the reasons that are given where it does not hold. A reason
/// belongs to the first phrase it has.
const PHRASES: [(&str, &str); 15] = [
    ("surfaces are met in their order", "out of turn"),
    (
        "a surface is met once, and not in its own shadow",
        "in its own shadow",
    ),
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

/// What a check decides besides: where it does not hold, theory is right, and takes longer.
pub(super) const DARK: &str = "some light comes";

/// What a reason is of whose words are new, and a check that panics.
pub(super) const UNKNOWN: &str = "not in this list";

/// The assumption that a reason says not to hold; `None` where it is in none of the words above.
pub(super) fn assumption(reason: &str) -> Option<&'static str> {
    let found = PHRASES.iter().find(|(_, phrase)| reason.contains(phrase));
    found.map(|(assumption, _)| *assumption)
}

/// All of them, each once.
pub(super) fn assumptions() -> Vec<&'static str> {
    let mut all: Vec<&str> = PHRASES.iter().map(|(assumption, _)| *assumption).collect();
    all.extend([DARK, UNKNOWN]);
    all.dedup();
    all
}
