//! Predicts the slices of light that several surfaces reflect in turn, by sums over scrambled nets
//! of paths.

use super::aim::DirectionCoordinates;
use super::path::FieldPaths;
use crate::model::{Over, ShiftedModels};
use crate::nets::{self, DIMENSIONS, Integrand, RayBudget, RayNets, RayNode};
use crate::path::differences::{Differences, DrawnField};
use crate::path::{AtMask, Observed, PreparedPath};
use crate::predicted::Predicted;

/// The windowed spectrum, with the derivatives with respect to given parameters. The result
/// is bitwise identical on any number of threads.
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
    let found = nets::sums(&paths, (window, grid), picture.bins, budget);
    Differences::new(&paths, moved, of).complete(found, over)
}

/// The prediction by paths from the light, also where
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

/// The paths whose last leg is aimed in the better way, at positions or by angles. Angles
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
        DrawnField::dimensions(self)
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], _: &[bool], nodes: &mut [RayNode]) {
        if let Some(ray) = DrawnField::draw(self, at, &mut self.path().at_mask()) {
            nodes[0] = ray;
        }
    }
}

impl DrawnField for FieldPaths<'_> {
    fn path(&self) -> &PreparedPath<'_> {
        &self.occluders
    }

    fn dimensions(&self) -> usize {
        4 + 2 * self.scatterers()
    }

    fn draw(&self, at: &[f64; DIMENSIONS], at_mask: AtMask<'_>) -> Option<RayNode> {
        Some(self.drawn(at, at_mask)?.exact)
    }

    fn has_chain(&self) -> bool {
        true
    }

    fn beside_chain(&self, at: &[f64; DIMENSIONS]) -> [Option<RayNode>; 2] {
        let drawn = self.drawn(at, &mut self.path().at_mask());
        drawn.map_or([None; 2], |drawn| {
            [Some(drawn.first_order), Some(drawn.exact)]
        })
    }
}
