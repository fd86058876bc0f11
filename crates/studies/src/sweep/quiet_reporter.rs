//! Hides the progress within a point of a sweep, because the sweep shows its progress over the
//! points.

use etendue_pipeline::{Progress, Reporter, Work};

/// Reports to the progress of the sweep that work continues, whenever a point has advanced. Notes
/// and warnings of single points are not shown.
pub(crate) struct Unshown<'a>(pub(crate) &'a dyn Progress);

impl Reporter for Unshown<'_> {
    fn begin(&self, _work: Work) -> Box<dyn Progress + '_> {
        self.0.advance(0);
        Box::new(Unshown(self.0))
    }
}

impl Progress for Unshown<'_> {
    fn advance(&self, _steps: u64) {
        self.0.advance(0);
    }
}
