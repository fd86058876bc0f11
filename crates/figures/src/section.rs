//! The scene cut along the central ray, and to scale: what is drawn.

use etendue_field::Side;

/// What a line of the cut is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SegmentKind {
    /// Emits.
    Light,
    /// Stops light and scatters none.
    Blocker,
    /// Receives, and reflects; it has a dark side.
    Surface,
    /// Lets light through.
    Glass,
    /// Shines from far away, wherever it is drawn.
    Sky,
}

/// A straight piece of something the cut passes through; points are (z, x), metres. An infinite x goes on beyond the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// What it is.
    pub kind: SegmentKind,
    /// One end (z, x).
    pub start: [f64; 2],
    /// The other end.
    pub end: [f64; 2],
    /// Its name; one piece of several is enough to carry it.
    pub label: Option<String>,
}

/// A virtual plane on the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneMark {
    /// Its name.
    pub name: String,
    /// Distance from the light along the central ray, metres.
    pub distance: f64,
    /// On which side of what stands there; drawn a little to that side.
    pub side: Side,
}

/// The plane of z, the distance along the central ray, and x, or y, all in metres.
///
/// Not to scale: z fills the width. What sticks out is cut off.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The coordinate across, markup.
    pub across: String,
    /// Length of the central ray, metres.
    pub length: f64,
    /// Whether the central ray has turned on the way.
    pub unfolded: bool,
    /// Largest x shown, metres.
    pub half_width: f64,
    /// Lights, blockers and surfaces.
    pub segments: Vec<Segment>,
    /// The virtual planes, in the order of their numbers.
    pub planes: Vec<PlaneMark>,
    /// Outlines (z, x) of bodies, filled; segments draw their edges.
    pub bodies: Vec<Vec<[f64; 2]>>,
    /// The cut through y, where it shows something else; drawn above.
    pub other: Option<Box<Self>>,
    /// The scene to scale; drawn above all.
    pub world: Option<DrawnWorld>,
}

/// Something in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnObject {
    /// What it is; points are (z, x).
    pub segment: Segment,
    /// Where light goes that arrives at it, (z, x).
    pub light: [f64; 2],
}

/// The plane of D and X at the light; points are (z, x), metres.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnWorld {
    /// Corners and ends of the central ray.
    pub path: Vec<[f64; 2]>,
    /// Lights, blockers and surfaces.
    pub objects: Vec<DrawnObject>,
    /// The virtual planes, as wide as their windows.
    pub planes: Vec<[[f64; 2]; 2]>,
}
