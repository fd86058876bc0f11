//! Temporary.
use crate::failure::Failure;
use crate::results::Results;
use etendue_compare::{PlaneComparison, Prediction};
use etendue_scene::Scene;
use std::path::Path;
pub(crate) fn plane(
    _r: &mut Results,
    _p: &Prediction,
    _c: &PlaneComparison,
) -> Result<(), Failure> {
    Ok(())
}
pub(crate) fn path(
    _r: &mut Results,
    _s: &Scene,
    _p: &[Prediction],
    _c: &[PlaneComparison],
) -> Result<(), Failure> {
    Ok(())
}
pub(crate) fn draw_scene(_s: &Scene, _p: &Path) -> Result<(), Failure> {
    Ok(())
}
