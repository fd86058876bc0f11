//! The content of drawings of a scene: the cut along the central ray, and the scene to scale.

use etendue_field::Side;

/// The kind of a segment in the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SegmentKind {
    /// A light.
    Light,
    /// A blocker, which stops light and scatters none.
    Blocker,
    /// A surface that receives and reflects light on one side; its other side is dark.
    Surface,
    /// A surface that transmits light.
    Glass,
    /// A distant light, regardless of where it is drawn.
    Sky,
}

/// A straight segment of an object in the cut; points are (z, x), metres. An infinite x continues
/// beyond the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The kind of object.
    pub kind: SegmentKind,
    /// One end (z, x).
    pub start: [f64; 2],
    /// The other end.
    pub end: [f64; 2],
    /// The name; only one segment of an object needs it.
    pub label: Option<String>,
}

/// A virtual plane on the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneMark {
    /// Its name.
    pub name: String,
    /// Distance from the light along the central ray, metres.
    pub distance: f64,
    /// The side on which the plane is if an object is at the same place; the plane is drawn
    /// slightly towards this side.
    pub side: Side,
}

/// A cut in z, the distance along the central ray, and x or y, all in metres.
///
/// The cut is not to scale, because z fills the width. Parts outside the range of z and x are not
/// drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The coordinate across, markup.
    pub across: String,
    /// Length of the central ray, metres.
    pub length: f64,
    /// Whether the central ray has bends, so that the cut is unfolded.
    pub unfolded: bool,
    /// Largest x shown, metres.
    pub half_width: f64,
    /// Lights, blockers and surfaces.
    pub segments: Vec<Segment>,
    /// The virtual planes, in the order of their numbers.
    pub planes: Vec<PlaneMark>,
    /// Outlines (z, x) of filled bodies; segments draw their edges.
    pub bodies: Vec<Vec<[f64; 2]>>,
    /// The cut through y, which is drawn above this cut if the two differ.
    pub other: Option<Box<Self>>,
    /// The scene to scale; drawn at the top.
    pub world: Option<DrawnWorld>,
}

/// An object in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnObject {
    /// The segment of the object; points are (z, x).
    pub segment: Segment,
    /// The direction of the light that arrives at the object, (z, x).
    pub light: [f64; 2],
}

/// The scene in the plane of D and X at the light; points are (z, x), metres.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnWorld {
    /// Corners and ends of the central ray.
    pub path: Vec<[f64; 2]>,
    /// Lights, blockers and surfaces.
    pub objects: Vec<DrawnObject>,
    /// The virtual planes, as wide as their windows.
    pub planes: Vec<[[f64; 2]; 2]>,
}
