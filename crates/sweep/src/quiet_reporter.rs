//! The work within a point of a sweep, which is not shown: the sweep shows its points.

use etendue_pipeline::{Progress, Reporter, Work};

/// Tells the progress of the sweep that its work goes on, whenever a point has done something. Notes and warnings of single points are
/// dropped.
pub(crate) struct Unshown<'a>(pub(crate) &'a dyn Progress);

impl Reporter for Unshown<'_> {
    fn note(&self, _text: &str) {}

    fn warn(&self, _text: &str) {}

    fn begin(&self, _work: Work) -> Box<dyn Progress + '_> {
        self.0.advance(0);
        Box::new(Unshown(self.0))
    }
}

impl Progress for Unshown<'_> {
    fn advance(&self, _steps: u64) {
        self.0.advance(0);
    }

    fn set(&self, _steps: u64) {}

    fn name(&self, _step: &str) {}
}
