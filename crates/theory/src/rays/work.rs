//! What a prediction by rays takes, counted from its first rule.

use super::predict::exact_field;
use super::quadrature::{Rule, nodes_inside};
use super::region::{Field, Finder};
use super::{Plane, System};
use crate::shadow::open_within;
use crate::work::{MOST_PARTS, Work};
use etendue_field::{Mask, SliceGrid, Window};

/// Nodes beyond which no rule is refined: a rule and a finer one are a gigabyte.
const MOST_NODES: f64 = 6e6;
/// Steps of a sum beyond which no rule is refined.
const MOST_STEPS: f64 = 3e10;
/// Steps to follow a ray, through a surface, and past a shape that is not a rectangle.
const RAY: f64 = 100.0;
const SURFACE: f64 = 150.0;
const SHAPE: f64 = 2.0;
/// Rules that a refined one and the trials on the way to it are worth.
const REFINED: f64 = 12.0;
/// Rays tried to find the region of those from a point of the light.
const TRIED: f64 = 6.0 * 1024.0;
/// Rays of a picture.
const PICTURE: f64 = 2e6;
/// Bytes for each node: a rule, its parts and a finer rule are held together.
const NODE: f64 = 170.0;

/// How large the rules of a quadrature are.
pub(super) struct Size {
    /// Shares that opaque rectangles have of the region's sides, seen from the middle of the light; `None` if they are too many.
    parts: Option<Vec<[f64; 2]>>,
    /// Sums of a node, at all frequencies.
    sums: f64,
}

/// A rule counted.
pub(super) struct Counted {
    nodes: f64,
    steps: f64,
}

impl Size {
    pub(super) fn new<F: Field>(finder: &Finder<'_, F>, grid: &SliceGrid) -> Self {
        let region = finder.region([0.0; 2]).unwrap_or([[0.0, 1.0]; 2]);
        let parts = open_within(region, &finder.seen([0.0; 2]), MOST_PARTS);
        let share = |sides: [[f64; 2]; 2]| {
            [0, 1].map(|k| (sides[k][1] - sides[k][0]) / (region[k][1] - region[k][0]))
        };
        let [azimuths, rows, _] = grid.half_shape().map(|n| n as f64);
        let columns = grid.nu.half as f64 + 1.0;
        Self {
            parts: parts.map(|parts| parts.into_iter().skip(1).map(|(_, s)| share(s)).collect()),
            // Two factors of each frequency, and a product of matrices of their parts.
            sums: azimuths * (4.0 * (rows + columns) + 0.6 * rows * columns),
        }
    }

    /// All nodes of a rule, and the steps of sums over them.
    pub(super) fn of(&self, rule: Rule) -> Counted {
        let inside = |[a, b]: &[f64; 2]| {
            let [a, b] = [a, b].map(|share| nodes_inside(*share, rule.inner) as f64);
            a * b
        };
        let parts = self.parts.as_ref();
        let parts = parts.map_or(f64::INFINITY, |parts| parts.iter().map(inside).sum());
        let points = (rule.outer * rule.outer) as f64;
        let nodes = rule.nodes() as f64 + points * parts;
        Counted {
            nodes,
            steps: nodes * self.sums,
        }
    }
}

impl Counted {
    /// Whether a rule is too large to be taken in place of a coarser one.
    pub(super) fn is_beyond(&self) -> bool {
        self.nodes > MOST_NODES || self.steps > MOST_STEPS
    }
}

/// What the slices, the first-order slices, all derivatives and the projection take. Rules are refined a few times at the most.
#[must_use]
pub fn work(system: &System, plane: &Plane, window: &Window, grid: &SliceGrid) -> Work {
    let (open, opaque) = system.apart();
    let shapes = |layers: &[(f64, Mask)]| -> f64 {
        let each = layers.iter().map(|(_, mask)| match mask {
            Mask::Opaque { shapes, .. } => shapes.len(),
            Mask::Grating(_) => 10,
        });
        each.sum::<usize>() as f64
    };
    let ray = RAY + SURFACE * open.elements.len() as f64 + SHAPE * shapes(&open.layers);
    let rectangles = shapes(&opaque);
    let field = exact_field(&open, plane);
    let Some(finder) = Finder::new(&field, window, open.emission(), opaque) else {
        return Work::none();
    };
    let size = Size::new(&finder, grid);
    let Some(parts) = size.parts.as_ref().map(Vec::len) else {
        return Work::endless(format!(
            "more than {MOST_PARTS} parts that shapes in different planes leave of the light"
        ));
    };
    let rule = finder.rule(grid);
    let Counted { nodes, .. } = size.of(rule);
    let points = (rule.outer * rule.outer) as f64;
    let followed = nodes * ray + points * (TRIED * ray + 20.0 * rectangles);
    // The exact slices and the chain's are each refined a few times, derivatives are differences.
    let derivatives = 2.0 * system.parameters(plane).len() as f64;
    let rules = 2.0 * REFINED + derivatives;
    let [azimuths, rows, columns] = grid.half_shape();
    Work {
        steps: rules * (followed + nodes * size.sums) + PICTURE * (ray + SHAPE * rectangles),
        bytes: NODE * nodes + 16.0 * 16.0 * 2.0 * (azimuths * rows * columns) as f64,
        bytes_each: 256.0 * 32.0 * (rows + columns) as f64,
        drivers: format!(
            "{rules} rules of {nodes:.0} rays from {points} points of the light, past {rectangles} rectangles of which {parts} parts are seen, x {azimuths} x {rows} x {columns} frequencies"
        ),
    }
}
