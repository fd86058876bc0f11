//! Chains and windows for the tests of this crate.

use crate::{Chain, Operator, Source};
use etendue_field::{Profile, Rectangle, Window};

/// A square light of unit radiance on the central ray, then travel and blockers by turns; the planes are
/// named a, b, c, …
pub(crate) fn chain(light: f64, steps: &[(f64, Vec<Rectangle>)]) -> Chain {
    let mut names = ('a'..='z').map(String::from);
    let mut from = names.next().unwrap();
    let mut operators = Vec::new();
    for (distance, blockers) in steps {
        let to = names.next().unwrap();
        operators.push(Operator::Travel {
            from: std::mem::replace(&mut from, to.clone()),
            to: to.clone(),
            distance: *distance,
        });
        if !blockers.is_empty() {
            operators.push(Operator::Visibility {
                name: to,
                blockers: blockers.clone(),
            });
        }
    }
    Chain {
        source: Source {
            name: "light".into(),
            rectangle: square([0.0, 0.0], light),
            radiance: 1.0,
        },
        operators,
    }
}

pub(crate) fn square(center: [f64; 2], side: f64) -> Rectangle {
    Rectangle {
        center,
        size: [side, side],
    }
}

/// `count` × `count` squares, moved off a grid by a fixed pattern.
pub(crate) fn blockers(count: u32, pitch: f64, side: f64) -> Vec<Rectangle> {
    let cells = (0..count).flat_map(|i| (0..count).map(move |j| (f64::from(i), f64::from(j))));
    let middle = 0.5 * (f64::from(count) - 1.0);
    let slack = 0.5 * (pitch - side);
    cells
        .map(|(i, j)| {
            let jitter = [(3.1 * i + 7.7 * j).sin(), (5.3 * i - 2.9 * j).cos()];
            let center = [i - middle, j - middle];
            square([0, 1].map(|k| center[k] * pitch + jitter[k] * slack), side)
        })
        .collect()
}

/// The same profiles along both axes.
pub(crate) fn window(position: Profile, slope: Profile) -> Window {
    Window {
        x: position,
        y: position,
        u: slope,
        v: slope,
    }
}
