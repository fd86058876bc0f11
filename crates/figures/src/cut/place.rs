//! Where things of a cut go.

use crate::section::{PlaneMark, Section, Segment, SegmentKind};
use crate::style::TICK_TEXT;
use crate::svg::Area;
use crate::text::width;
use etendue_field::Side;

/// Distance of a plane's line from what stands at its place, and half that of two lines.
const ASIDE: f64 = 9.0;
/// Where a segment's name is written.
#[derive(Debug)]
pub(super) struct Name {
    pub(super) text: String,
    pub(super) middle: f64,
    pub(super) row: usize,
}

/// The x shown: just beyond lights and blockers; lights alone get more room, surfaces alone all they have.
pub(super) fn x_range(section: &Section) -> [f64; 2] {
    let reach = |kind: SegmentKind| {
        let of_kind = section.segments.iter().filter(|s| s.kind == kind);
        let ends = of_kind.flat_map(|s| [s.start[1].abs(), s.end[1].abs()]);
        ends.filter(|x| x.is_finite()).fold(0.0, f64::max)
    };
    let (light, blocker) = (reach(SegmentKind::Light), reach(SegmentKind::Blocker));
    let half = if blocker > 0.0 {
        1.12 * light.max(blocker)
    } else if light > 0.0 {
        3.0 * light
    } else {
        1.12 * reach(SegmentKind::Surface)
    };
    if half > 0.0 {
        [-half, half]
    } else {
        [-1.0, 1.0]
    }
}

/// Places of the planes' lines: to their side of what stands there, if anything does, and apart from each other.
pub(super) fn plane_places(section: &Section, across: impl Fn(f64) -> f64) -> Vec<f64> {
    let occupied = |place: f64| {
        section.segments.iter().any(|s| {
            let ends = [across(s.start[0]), across(s.end[0])];
            (ends[0].min(ends[1]) - ASIDE..ends[0].max(ends[1]) + ASIDE).contains(&place)
        })
    };
    let aside = |plane: &PlaneMark| {
        let place = across(plane.distance);
        match plane.side {
            _ if !occupied(place) => place,
            Side::Before => place - ASIDE,
            Side::After => place + ASIDE,
        }
    };
    let mut places: Vec<f64> = section.planes.iter().map(aside).collect();
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
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
