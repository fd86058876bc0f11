//! Where things of a cut go.

use crate::section::{PlaneMark, Section, Segment, SegmentKind};
use crate::style::TICK_TEXT;
use crate::svg::Area;
use crate::text::width;
use etendue_field::Side;

/// Distance of a plane's line from what stands at its place, and half that of two lines.
const ASIDE: f64 = 9.0;
/// The same of a plane behind a surface, beyond its hatching.
const BEHIND: f64 = 16.0;
/// Where a segment's name is written.
#[derive(Debug)]
pub(super) struct Name {
    pub(super) text: String,
    pub(super) middle: f64,
    pub(super) row: usize,
}

/// Places of the planes' lines: to their side of what stands there, if anything does, and apart from each other.
pub(super) fn plane_places(section: &Section, across: impl Fn(f64) -> f64) -> Vec<f64> {
    // What stands within reach of a place.
    let there = |place: f64, kind: Option<SegmentKind>| {
        section.segments.iter().any(|s| {
            let ends = [across(s.start[0]), across(s.end[0])];
            let reach = ends[0].min(ends[1]) - ASIDE..ends[0].max(ends[1]) + ASIDE;
            kind.is_none_or(|kind| s.kind == kind) && reach.contains(&place)
        })
    };
    let aside = |plane: &PlaneMark| {
        let place = across(plane.distance);
        match plane.side {
            _ if !there(place, None) => place,
            Side::Before => place - ASIDE,
            Side::After if there(place, Some(SegmentKind::Surface)) => place + BEHIND,
            Side::After => place + ASIDE,
        }
    };
    let mut places: Vec<f64> = section.planes.iter().map(aside).collect();
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
    // Those before something make room in front of it, the others behind.
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

/// Names above their segments, in as many rows as it takes to keep them apart.
pub(super) fn names(segments: &[Segment], area: Area, across: impl Fn(f64) -> f64) -> Vec<Name> {
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
        names.push(Name {
            text: text.to_owned(),
            middle,
            row,
        });
    }
    names
}
