//! Derivatives of slices with respect to parameters of the chain.

use crate::model::Model;
use crate::parallel::slices::{fineness, several};
use crate::{Chain, Parameter};
use etendue_field::{SliceGrid, Slices, Window};

/// The step of the forward difference divided by the scale of the parameter; also the largest change
/// of phases, in turns.
///
/// The error of the difference is half the second derivative times the step. Since a parameter
/// changes phases by at most some tens of radians, this error is about 10⁻³ of the derivative.
/// Rounding errors add 10⁻¹²/10⁻⁴ = 10⁻⁸ of the spectrum.
const RELATIVE_STEP: f64 = 1e-4;

/// The largest number of chains whose slices are computed together, which bounds their memory.
const MAX_TOGETHER: usize = 16;

/// The slices, and their derivatives with respect to parameters, per unit of each parameter. The
/// derivatives are forward differences with a step of at most 10⁻⁴ of the parameter's scale.
///
/// # Panics
/// Panics if the chain has no such parameter.
#[must_use]
pub fn with_derivatives(
    chain: &Chain,
    parameters: &[Parameter],
    window: &Window,
    grid: &SliceGrid,
) -> (Slices, Vec<Slices>) {
    let moved = parameters.iter().map(|parameter| {
        let value = chain.value(*parameter).expect("a parameter of the chain");
        let step = chain.step(*parameter, (window, grid), [RELATIVE_STEP; 2]);
        let moved = value + step.expect("the same");
        (
            chain.with(*parameter, moved).expect("the same"),
            moved - value,
        )
    });
    let moved: Vec<(Chain, f64)> = moved.collect();
    let path = chain.path();
    let (slices, mut derivatives) = if let Some(receiver) = path.receiver() {
        let nodes = || receiver.nodes(window, grid.rho.max());
        let of_moved = moved.iter().map(|(moved, _)| {
            let moved = moved.path();
            let moved = moved.receiver().expect("a step removes no receiver");
            moved.slices_with(nodes(), window, grid)
        });
        (receiver.slices(window, grid), of_moved.collect())
    } else {
        // Discs are split into the same rectangles in all chains, so the quadrature errors cancel in
        // the differences.
        let fineness = fineness(&path, window, grid);
        let mut derivatives = Vec::new();
        let mut slices = None;
        for moved in moved
            .chunks(MAX_TOGETHER)
            .chain(parameters.is_empty().then_some(&[][..]))
        {
            let paths = std::iter::once(chain).chain(moved.iter().map(|(moved, _)| moved));
            let paths: Vec<_> = paths.map(Chain::path).collect();
            let mut all = several(&paths, window, grid, &fineness).into_iter();
            slices = all.next();
            derivatives.extend(all);
        }
        (slices.expect("at least one pass"), derivatives)
    };
    for (derivative, (_, step)) in derivatives.iter_mut().zip(&moved) {
        derivative.half -= &slices.half;
        derivative.half /= etendue_field::Complex::from(*step);
    }
    (slices, derivatives)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slices;
    use crate::testing::*;
    use etendue_field::{FrequencyAxis, Profile};

    fn chains() -> [Chain; 3] {
        let light = |exponent| spot(disc([0.05, 0.0], 0.2), exponent);
        let steps = [
            (1.0, Some(half_plane(0, 0.1, true))),
            (0.5, Some(grating(1, 2.0, 0.4))),
            (0.3, Some(opaque(vec![disc([-0.1, 0.0], 0.1)]))),
            (0.5, None),
        ];
        [
            chain(0.2, &[(1.0, blockers(3, 0.2, 0.1)), (0.7, vec![])]),
            chain_of(light(0.0), steps.clone()),
            chain_of(light(20.0), steps),
        ]
    }

    #[test]
    fn agrees_with_central_differences() {
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        let axis = |spacing| FrequencyAxis { half: 2, spacing };
        let grid = SliceGrid {
            azimuths: 3,
            rho: axis(0.8),
            nu: axis(1.1),
        };
        for chain in chains() {
            let parameters = chain.parameters();
            let (prediction, all) = with_derivatives(&chain, &parameters, &window, &grid);
            assert_eq!(prediction, slices(&chain, &window, &grid));
            for (parameter, forward) in parameters.into_iter().zip(all) {
                let value = chain.value(parameter).unwrap();
                let step = 1e-3 * value.abs().max(0.1);
                let moved = |v| slices(&chain.with(parameter, v).unwrap(), &window, &grid);
                let [up, down] = [value + step, value - step].map(moved);
                let (mut worst, mut largest) = (0.0, 0.0);
                for (index, derivative) in forward.half.indexed_iter() {
                    let central = (up.half[index] - down.half[index]) / (2.0 * step);
                    worst = f64::max(worst, (derivative - central).norm());
                    largest = f64::max(largest, central.norm());
                }
                // The error of the forward difference is half a second derivative times the step
                // of 1e-4, and phases in this test stay below 20.
                let close = 2e-3 * largest;
                assert!(worst < close, "{parameter:?}: {}", worst / largest);
            }
        }
    }

    #[test]
    fn of_a_travel_of_nothing() {
        let chain = chain(0.2, &[(0.0, vec![])]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        let axis = FrequencyAxis {
            half: 2,
            spacing: 1.0,
        };
        let grid = SliceGrid {
            azimuths: 1,
            rho: axis,
            nu: axis,
        };
        let (prediction, slopes) =
            with_derivatives(&chain, &[Parameter::Travel(0)], &window, &grid);
        let slope = &slopes[0];
        assert!(slope.half.iter().all(|s| s.is_finite()));
        assert!(
            slope
                .half
                .iter()
                .any(|s| s.norm() > 0.1 * prediction.at_zero())
        ); // travel shears
    }
}
