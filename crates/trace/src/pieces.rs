//! Surfaces in pieces of which points can be drawn.

use glam::DVec3;

/// Parallelograms or triangles in the frame at the light, with their running share of the area.
#[derive(Debug)]
pub(crate) struct Pieces {
    upto: Vec<(f64, Piece)>,
    area: f64,
}

/// A corner and two edges, of a parallelogram or of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    corner: DVec3,
    edges: [DVec3; 2],
    is_triangle: bool,
}

impl Pieces {
    pub(crate) fn new(pieces: Vec<Piece>) -> Self {
        let mut area = 0.0;
        let upto = pieces.into_iter().map(|piece| {
            area += piece.area();
            (area, piece)
        });
        Self {
            upto: upto.collect(),
            area,
        }
    }

    /// The whole area.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }

    /// A uniform point of it and a normal there, from three numbers in (0, 1).
    pub(crate) fn point(&self, r: [f64; 3]) -> (DVec3, DVec3) {
        let wanted = r[2] * self.area;
        let i = self.upto.partition_point(|(upto, _)| *upto < wanted);
        let (_, piece) = self.upto[i.min(self.upto.len() - 1)];
        let [a, b] = piece.edges;
        let folded = piece.is_triangle && r[0] + r[1] > 1.0;
        let [s, t] = if folded {
            [1.0 - r[0], 1.0 - r[1]]
        } else {
            [r[0], r[1]]
        };
        (piece.corner + s * a + t * b, a.cross(b).normalize())
    }
}

impl Piece {
    pub(crate) fn new(corner: DVec3, ends: [DVec3; 2], is_triangle: bool) -> Self {
        Self {
            corner,
            edges: ends.map(|end| end - corner),
            is_triangle,
        }
    }

    fn area(&self) -> f64 {
        let [a, b] = self.edges;
        let whole = a.cross(b).length();
        if self.is_triangle { 0.5 * whole } else { whole }
    }
}
