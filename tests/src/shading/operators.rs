//! The section on the operators of shading in 2D.

use super::{brdfs, factors, small, visibility};
use crate::report::Bound::{Above, Below};
use crate::report::{Check, ReportSection, Row};
use crate::rows::Line;

/// Maximum difference between operator and quadrature. Both are accurate to about 10⁻¹².
const REQUIRED: f64 = 1e-9;
/// Minimum difference that a planted fault must cause.
const SEEN: f64 = 1e-3;

/// An operator compared with the primal domain.
pub(super) struct OperatorComparison {
    pub(super) operator: &'static str,
    /// The row of the operator in the paper's Table 1, if there is one.
    pub(super) line: Option<Line>,
    pub(super) compared: String,
    /// ‖predicted − quadrature‖/‖quadrature‖.
    pub(super) off: f64,
    /// Name of a wrong form of the operator, and the relative error of this form.
    pub(super) fault: (&'static str, f64),
}

/// The section on all operators of shading in 2D.
pub(super) fn operators() -> ReportSection {
    let row = |found: OperatorComparison| {
        let cells = vec![
            found.operator.to_owned(),
            found.compared,
            small(found.off),
            small(REQUIRED),
            found.fault.0.to_owned(),
            small(found.fault.1),
        ];
        let checks = vec![
            Check::new("off", found.off, Below(REQUIRED))
                .because("both sides are accurate to 1e-12"),
            Check::new("fault", found.fault.1, Above(SEEN))
                .because("a fault changes far more than the tolerance"),
        ];
        Row::new(cells, checks).of(found.line)
    };
    let factors = visibility::all().into_iter().chain(factors::all());
    ReportSection::new(
        "Operators of shading in 2D: theory against quadrature",
        format!(
            "No photons are traced here. The spectrum that theory states is compared with a plain \
             quadrature in ray space. Masks are compared by what passes them, at 12 frequencies. \
             Factors and lobes are compared alone, over 24 frequencies up to 6 cycles per radian. \
             Reflections are compared for two Gaussians, about 0.25 m and 0.28 rad wide, at k = \
             0.5 /m, θ₀ = 0.5, θ₁ = −0.4, after all seven steps to first order, over 18 \
             frequencies. The horizon cuts this light, except for the ideal mirror, whose spectrum \
             has no horizon. The bounds in this part were fixed before the run. Required: the \
             relative difference is below {REQUIRED:.0e}, since both sides are accurate to 1e-12. \
             With the fault that is named beside each operator, planted in the theory's formula, \
             the difference is above {SEEN:.0e}."
        ),
        "operator | compared | relative difference | required: below | planted fault | difference \
         with this fault | verdict",
        factors.chain(brdfs::all()).map(row),
    )
}

#[cfg(test)]
mod tests {
    use super::operators;

    #[test]
    fn operators_are_as_quadrature_gives_them_and_planted_faults_are_seen() {
        let section = operators();
        assert!(section.passes(), "{}", section.markdown());
    }
}
