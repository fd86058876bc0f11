//! Places the numbers and names in a cut.

use crate::section::{PlaneMark, Section, Segment};
use crate::sizes::TICK_TEXT;
use crate::svg::Area;
use crate::text::width;
use etendue_field::Side;

/// Half of the minimum distance between the numbers of two planes.
const ASIDE: f64 = 9.0;
/// The position of a segment's name.
#[derive(Debug)]
pub(super) struct SegmentName {
    pub(super) text: String,
    pub(super) middle: f64,
    pub(super) row: usize,
}

/// Positions of the planes' numbers that do not overlap. The number of a plane is below
/// the plane's line, or to the side of it if other numbers are near.
pub(super) fn number_places(section: &Section, across: impl Fn(f64) -> f64) -> Vec<f64> {
    let true_places = || section.planes.iter().map(|plane| across(plane.distance));
    let aside = |(i, plane): (usize, &PlaneMark)| {
        let place = across(plane.distance);
        let near = |(j, other): (usize, f64)| i != j && (other - place).abs() < 2.0 * ASIDE;
        match plane.side {
            _ if !true_places().enumerate().any(near) => place,
            Side::Before => place - ASIDE,
            Side::After => place + ASIDE,
        }
    };
    let mut places: Vec<f64> = section.planes.iter().enumerate().map(aside).collect();
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
    // The numbers of planes before an object move towards the light, and the numbers of planes
    // after the object move away from the light.
    for pair in order.windows(2).rev() {
        if section.planes[pair[0]].side == Side::Before {
            places[pair[0]] = places[pair[0]].min(places[pair[1]] - 2.0 * ASIDE);
        }
    }
    for pair in order.windows(2) {
        places[pair[1]] = places[pair[1]].max(places[pair[0]] + 2.0 * ASIDE);
    }
    places
}

/// Places names above their segments, in as many rows as needed to avoid overlaps.
pub(super) fn names(
    segments: &[Segment],
    area: Area,
    across: impl Fn(f64) -> f64,
) -> Vec<SegmentName> {
    let mut wanted: Vec<(f64, &str)> = segments
        .iter()
        .filter_map(|s| Some((across(0.5 * (s.start[0] + s.end[0])), s.label.as_deref()?)))
        .collect();
    wanted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)));
    wanted.dedup_by(|a, b| a.1 == b.1 && (a.0 - b.0).abs() < 1.0);
    let mut row_ends: Vec<f64> = Vec::new();
    let mut names = Vec::new();
    for (place, text) in wanted {
        let half = 0.5 * width(text, TICK_TEXT);
        let middle = place.min(area.right() - half).max(area.x + half);
        let free = row_ends.iter().position(|end| end + 12.0 < middle - half);
        let row = free.unwrap_or(row_ends.len());
        row_ends.resize(row_ends.len().max(row + 1), 0.0);
        row_ends[row] = middle + half;
        names.push(SegmentName {
            text: text.to_owned(),
            middle,
            row,
        });
    }
    names
}
