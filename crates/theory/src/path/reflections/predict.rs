//! Predicts the slices of light that several surfaces reflect in turn, by sums over scrambled nets
//! of paths.

use super::aim::DirectionCoordinates;
use super::path::FieldPaths;
use crate::model::{Over, ShiftedModels};
use crate::nets::{self, DIMENSIONS, Integrand, RayBudget, RayNets, RayNode};
use crate::path::Observed;
use crate::predicted::Predicted;

/// Returns the windowed spectrum, with the derivatives with respect to given parameters. The result
/// is bitwise identical on any number of threads.
///
/// The difference between the chain and the exact prediction is a sum of differences over the same
/// paths. The derivatives are also such sums. These sums are accurate to about a per cent of their
/// values.
pub(crate) fn predict(
    view: &Observed,
    moved: &[ShiftedModels<Observed>],
    over: Over<'_>,
    budget: RayBudget,
) -> Predicted {
    let (window, grid, picture) = over;
    let Some(paths) = best(view, over, budget) else {
        return Predicted::dark(grid, picture, moved.len());
    };
    let of = |view| {
        let mut moved = FieldPaths::new(view, window)?;
        if let Some(at_plane) = moved.at_plane().filter(|_| paths.is_aimed_at_plane()) {
            moved.aim_last_leg(at_plane);
        }
        Some(moved)
    };
    let sides = moved.iter().map(|moved| {
        let [above, below] = &moved.sides;
        (moved.apart, [of(above), of(below)])
    });
    let around = ChainDifferences {
        paths: &paths,
        moved: sides.collect(),
    };
    let found = nets::sums(&paths, (window, grid), picture.bins, budget);
    let mut means = nets::means(&around, (window, grid), &found).into_iter();
    Predicted {
        to_first_order: means.next(),
        derivatives: means.map(|mean| mean.slices).collect(),
        ..found
    }
}

/// Returns the prediction by paths from the light, also where
/// [`Model::predict`](crate::Model::predict) follows rays back from the plane. The exact sum and the
/// chain are then sums over the same paths.
#[must_use]
pub fn by_paths(view: &Observed, over: Over<'_>, budget: RayBudget) -> Predicted {
    predict(view, &[], over, budget)
}

/// Calls `then` with the paths that [`predict`] sums over nets, if there are any.
pub(crate) fn with_rays(
    view: &Observed,
    over: Over<'_>,
    budget: RayBudget,
    then: &mut dyn FnMut(&dyn RayNets),
) {
    if let Some(paths) = best(view, over, budget) {
        then(&nets::SampledNets::new(&paths, budget));
    }
}

/// Returns the paths whose last leg is aimed in the better way, at positions or by angles. Angles
/// are better for narrow slopes, and positions for a narrow window close to a wide surface.
fn best<'a>(
    view: &'a Observed,
    (window, grid, _): Over<'a>,
    budget: RayBudget,
) -> Option<FieldPaths<'a>> {
    let mut paths = FieldPaths::new(view, window)?;
    if let Some(at_plane) = paths.at_plane() {
        let error = |paths: &FieldPaths<'a>| nets::trial(paths, (window, grid), budget);
        let by_angle = error(&paths);
        paths.aim_last_leg(at_plane);
        if error(&paths) > by_angle {
            paths.aim_last_leg(DirectionCoordinates::Angles);
        }
    }
    Some(paths)
}

impl Integrand for FieldPaths<'_> {
    fn dimensions(&self) -> usize {
        FieldPaths::dimensions(self)
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], nodes: &mut [RayNode]) {
        if let Some(drawn) = self.draw(at) {
            nodes[0] = drawn.exact;
        }
    }
}

/// The difference between the chain and a light field, and the differences between light fields
/// with each parameter increased and decreased.
struct ChainDifferences<'a> {
    paths: &'a FieldPaths<'a>,
    moved: Vec<(f64, [Option<FieldPaths<'a>>; 2])>,
}

impl Integrand for ChainDifferences<'_> {
    fn fields(&self) -> usize {
        1 + self.moved.len()
    }

    fn dimensions(&self) -> usize {
        self.paths.dimensions()
    }

    fn rays(&self) -> usize {
        2
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], nodes: &mut [RayNode]) {
        let (chain, others) = nodes.split_at_mut(2);
        if let Some(drawn) = self.paths.draw(at) {
            chain[0] = drawn.first_order;
            chain[1] = drawn.exact;
            chain[1].weight *= -1.0;
        }
        for ((apart, sides), nodes) in self.moved.iter().zip(others.chunks_mut(2)) {
            let drawn = sides
                .each_ref()
                .map(|side| Some(side.as_ref()?.draw(at)?.exact));
            nets::difference(drawn, *apart, nodes);
        }
    }
}
