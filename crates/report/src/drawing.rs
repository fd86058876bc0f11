//! Draws the scene in two cross-sections along the central ray: in the plane of X, where y = 0,
//! and in the plane of Y, where x = 0.

mod cut;
mod world;

use cut::CuttingPlane;
use etendue_field::VirtualPlane;
use etendue_figures::{Section, Segment, SegmentKind};
use etendue_scene::Scene;

/// The cut through X with the given planes. If the cut through Y differs from it, the
/// result also contains the cut through Y. If the path turns, the result also contains a drawing to
/// scale. The path is unfolded: each surface is cut in the frame of the light that arrives at it.
pub(crate) fn cross_section<'a>(
    scene: &Scene,
    planes: impl Iterator<Item = &'a VirtualPlane>,
) -> Section {
    let planes: Vec<&VirtualPlane> = planes.collect();
    let cut = CuttingPlane { scene, axis: 0 }.section(&planes);
    let other = CuttingPlane { scene, axis: 1 }.section(&planes);
    Section {
        other: (!alike(&cut, &other)).then(|| Box::new(other)),
        world: world::world(scene, &planes),
        ..cut
    }
}

/// Checks whether two cuts are the same except for jitter.
fn alike(a: &Section, b: &Section) -> bool {
    const JITTER: f64 = 0.05;
    let width = a.half_width.max(b.half_width);
    let near = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a - b).abs() < JITTER * width;
    let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|i| near(a[i], b[i]));
    let [a, b] = [a, b].map(|cut| sorted(&cut.segments));
    a.len() == b.len()
        && a.iter()
            .zip(&b)
            .all(|(a, b)| a.0 == b.0 && close(a.1[0], b.1[0]) && close(a.1[1], b.1[1]))
}

/// Returns segments sorted by kind and start, regardless of their direction.
fn sorted(segments: &[Segment]) -> Vec<(SegmentKind, [[f64; 2]; 2])> {
    let before = |a: &[f64; 2], b: &[f64; 2]| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0]));
    let upwards = segments.iter().map(|s| {
        let mut ends = [s.start, s.end];
        ends.sort_by(before);
        (s.kind, ends)
    });
    let mut all: Vec<_> = upwards.collect();
    all.sort_by(|(_, a), (_, b)| before(&a[0], &b[0]));
    all.sort_by_key(|(kind, _)| *kind);
    all
}
