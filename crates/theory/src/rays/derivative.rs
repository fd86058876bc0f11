use super::predict::exact_field;
use super::region::Finder;
use super::sums::sums;
use super::{Parameter, Plane, RaySlices, System};
use etendue_field::{Complex, SliceGrid, Slices, Window};

/// Step of the central difference, relative to the value or to one unit.
///
/// Its error is a sixth of the third derivative times its square. Rays at the ends of both regions differ, which adds about
/// 10⁻¹²/10⁻³ of the spectrum.
const STEP: f64 = 1e-3;

/// The derivative of the exact slices by a parameter, per unit of it: a central difference of the rule of a prediction of the same system, before
/// its last refinement, and coarser behind an area light: good to about a per cent there. `None` if the system does not have the parameter, or no light arrives.
#[must_use]
pub fn derivative(
    system: &System,
    plane: &Plane,
    parameter: Parameter,
    window: &Window,
    grid: &SliceGrid,
    prediction: &RaySlices,
) -> Option<Slices> {
    let value = system.value(plane, parameter)?;
    let size = match parameter {
        Parameter::Incidence(_) | Parameter::Curvature(..) => value.abs().max(0.1),
        _ => value.abs(),
    };
    let step = STEP * size;
    let at = |value: f64| {
        let (system, plane) = system.with(plane, parameter, value)?;
        let (open, opaque) = system.apart();
        let field = exact_field(&open, &plane);
        let finder = Finder::new(&field, window, open.emission(), opaque)?;
        Some(sums(&finder.nodes(prediction.rule.coarse()), grid))
    };
    let (mut above, below) = (at(value + step)?, at(value - step)?);
    above.half -= &below.half;
    above.half /= Complex::from(2.0 * step);
    Some(above)
}
