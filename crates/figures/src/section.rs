//! Defines the content of drawings of a scene: the cut along the central ray, and the drawing to
//! scale.

use etendue_field::Side;

/// The kind of a segment in the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SegmentKind {
    /// A light.
    Light,
    /// A blocker, which stops light and scatters none.
    Blocker,
    /// A surface that receives and reflects light on one side and is dark on the other side.
    Surface,
    /// A surface that transmits light.
    Glass,
    /// A distant light, which may be drawn anywhere.
    Sky,
}

/// A straight segment of an object in the cut; its points are (z, x) in metres. If x is infinite,
/// the segment continues beyond the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The kind of the object.
    pub kind: SegmentKind,
    /// One end of the segment, (z, x).
    pub start: [f64; 2],
    /// The other end.
    pub end: [f64; 2],
    /// The name of the object, which only one of the object's segments needs.
    pub label: Option<String>,
}

/// A virtual plane on the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneMark {
    /// Its name.
    pub name: String,
    /// Distance from the light along the central ray, metres.
    pub distance: f64,
    /// The side of an object on which the plane lies, if the object is at the same distance. The
    /// plane is drawn slightly towards this side.
    pub side: Side,
}

/// A cut of the scene. One coordinate is z, the distance along the central ray, and the other
/// coordinate is x or y. All coordinates are in metres.
///
/// The cut is not drawn to scale, because z fills the width of the drawing. Parts outside the
/// range of z and x are not drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Name of the coordinate perpendicular to the central ray, as markup.
    pub across: String,
    /// Length of the central ray, metres.
    pub length: f64,
    /// Whether the central ray has bends; if it has bends, the cut is drawn unfolded.
    pub unfolded: bool,
    /// Largest x shown, in metres.
    pub half_width: f64,
    /// Segments of lights, blockers and surfaces.
    pub segments: Vec<Segment>,
    /// The virtual planes, in the order of their numbers.
    pub planes: Vec<PlaneMark>,
    /// Outlines (z, x) of filled bodies, whose edges are drawn as segments.
    pub bodies: Vec<Vec<[f64; 2]>>,
    /// The cut through y, which is drawn above this cut if the two cuts differ.
    pub other: Option<Box<Self>>,
    /// The drawing of the scene to scale, which is at the top.
    pub world: Option<DrawnWorld>,
}

/// An object in the drawing to scale.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnObject {
    /// The segment of the object; its points are (z, x).
    pub segment: Segment,
    /// The direction of the light that arrives at the object, (z, x).
    pub light: [f64; 2],
}

/// The scene in the plane of D and X at the light; points are (z, x) in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnWorld {
    /// Points of the central ray: its corners and its two ends.
    pub path: Vec<[f64; 2]>,
    /// Lights, blockers and surfaces.
    pub objects: Vec<DrawnObject>,
    /// Lines of the virtual planes, as wide as the planes' windows.
    pub planes: Vec<[[f64; 2]; 2]>,
}
