//! Checks the holes of apertures.

use super::Resolver;
use etendue_field::{ConvexPolygon, Disc, Hole, Rectangle, Shape};
use etendue_scenefile::HoleFile;
use etendue_scenefile::limits;

impl Resolver<'_> {
    /// Checks the number of corners of a hole.
    pub(super) fn corners(&mut self, of: &str, file: &HoleFile) {
        if let HoleFile::Polygon { corners } = file
            && !(3..=limits::HOLE_CORNERS).contains(&corners.len())
        {
            let allowed = format!("3 to {} corners", limits::HOLE_CORNERS);
            let found = format!("{} corners", corners.len());
            self.faults.add(format!("{of}.corners"), found, allowed);
        }
    }

    /// The hole of an aperture, with coordinates as in the file; `None` if the hole is not
    /// allowed.
    pub(super) fn hole(&mut self, of: &str, file: &HoleFile) -> Option<Hole> {
        let corners = match file {
            HoleFile::Disc { center, radius } => {
                let (center, radius) = (*center, *radius);
                return Some(Hole::Shape(Shape::Disc(Disc { center, radius })));
            }
            HoleFile::Rectangle { center, size } => {
                let (center, size) = (*center, *size);
                return Some(Hole::Shape(Shape::Rectangle(Rectangle { center, size })));
            }
            HoleFile::Polygon { corners } => corners,
        };
        let polygon = ConvexPolygon::new(corners.clone());
        if polygon.is_none() && self.faults.all.is_empty() {
            self.faults.add(
                format!("{of}.corners"),
                format!("{} corners that form no convex polygon", corners.len()),
                "corners in order around a convex polygon, no three of them on a line",
            );
        }
        polygon.map(Hole::Polygon)
    }
}
