//! Error estimates of predictions in closed form.

use crate::Chain;
use crate::parallel::slices::{fineness, slices_at_fineness};
use crate::parallel::slope::Slope;
use etendue_field::{SliceGrid, Slices, Window};

/// The lowest order at which the quadrature for discs converges.
const ORDER: i32 = 4;

/// Estimates the relative error ‖error‖/‖F‖ of `slices` over the grid. `slices` is the prediction
/// of the given chain. Returns `None` if the prediction is a closed form.
///
/// * Discs: the estimate is the difference between `slices` and a prediction that splits discs with
///   a quarter more nodes, divided by 1 − 0.8⁴. The error falls as n⁻⁴ if masks or windows have
///   corners within a disc, and faster than exponentially otherwise (docs/theory.md, section 3).
///   The difference between the two predictions is therefore nearly equal to the error.
/// * Diffuse reflection: the estimate is a third of the difference between `slices` and a
///   prediction with half as many nodes, because the rule is of second order.
/// * Spots, points and cosines: the estimate is the residual of the series of (1 + u² + v²)^p over
///   the window, which is about 10⁻⁹.
#[must_use]
pub fn quadrature_error(
    chain: &Chain,
    window: &Window,
    grid: &SliceGrid,
    slices: &Slices,
) -> Option<f64> {
    let path = chain.path();
    if let Some(receiver) = path.receiver() {
        return receiver.quadrature_error(window, grid, slices);
    }
    let power = path.slope_power();
    if power == 0.0 && !path.has_discs() {
        return None;
    }
    let mut error = Slope::new([&window.u, &window.v], power).residual;
    if path.has_discs() {
        let finer = fineness(&path, window, grid).finer();
        let finer = slices_at_fineness(&path, window, grid, &finer);
        error += slices.relative_difference(&finer) / (1.0 - 0.8_f64.powi(ORDER));
    }
    Some(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::disc::Discs;
    use crate::parallel::disc_resolution::DiscResolution;
    use crate::slices;
    use crate::testing::*;
    use etendue_field::{FrequencyAxis, Profile};

    fn grid() -> SliceGrid {
        let axis = |half, spacing| FrequencyAxis { half, spacing };
        SliceGrid {
            azimuths: 4,
            rho: axis(16, 1.0),
            nu: axis(32, 1.0),
        }
    }

    fn error(chain: &Chain, window: &Window) -> Option<f64> {
        let slices = slices(chain, window, &grid());
        quadrature_error(chain, window, &grid(), &slices)
    }

    /// Two errors: for a light that is a disc, and for a disc that blocks a square light.
    /// `distances` are the distances of travel before and after the blocker.
    fn errors(profile: fn(f64) -> Profile, radius: f64, distances: [f64; 2]) -> [f64; 2] {
        let round = disc([0.02, 0.01], radius);
        let light = chain_of(spot(round, 0.0), distances.map(|d| (d, None)));
        let square = lambertian(square([0.0; 2], 0.2));
        let masks = [Some(opaque(vec![round])), None];
        let blocker = chain_of(square, distances.into_iter().zip(masks));
        let window = window(profile(0.5), profile(0.5));
        [light, blocker].map(|chain| error(&chain, &window).unwrap())
    }

    #[test]
    fn discs_are_good_to_a_few_in_a_hundred_thousand() {
        for radius in [0.03, 0.1, 0.3] {
            for distances in [[1.0, 0.0], [1.0, 1.0]] {
                let smooth = errors(Profile::Hann, radius, distances);
                let hard = errors(Profile::Box, radius, distances);
                let said = format!("{radius} {distances:?}: {smooth:?} {hard:?}");
                // The rule converges exponentially if it has more than π R Ω nodes.
                assert!(smooth.iter().all(|e| *e < 1e-7), "{said}");
                // A box window has corners, so the error falls as n⁻⁴. The largest disc transmits
                // 1/500 of the light.
                assert!(hard.iter().all(|e| *e < 5e-5), "{said}");
            }
        }
    }

    /// Tests `quadrature_error` against the known transform.
    #[test]
    fn too_coarse_a_rule_is_told() {
        let chain = chain_of(spot(disc([0.0; 2], 0.3), 0.0), [(0.0, None)]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.5));
        let path = chain.path();
        let coarse = DiscResolution(vec![Discs::Rule(12)]);
        let coarse = slices_at_fineness(&path, &window, &grid(), &coarse);
        let said = quadrature_error(&chain, &window, &grid(), &coarse).unwrap();
        let true_error = coarse.relative_difference(&slices(&chain, &window, &grid()));
        // The error of the coarse rule is much larger than the error of the finer rule, so the
        // difference is already nearly equal to the error. The estimate then exceeds the error by
        // the factor 1/(1 − 0.8⁴), because this factor is for rules of order 4.
        let most = 1.0 / (1.0 - 0.8_f64.powi(ORDER));
        assert!((said / true_error / most - 1.0).abs() < 1e-3);
        assert!(said > 1e-5, "{said}"); // π R Ω = 15 > 12
    }

    #[test]
    fn closed_forms_have_none() {
        let window = window(Profile::Hann(0.5), Profile::Hann(0.5));
        let steps = [
            (1.0, Some(grating(0, 3.0, 0.0))),
            (1.0, Some(half_plane(0, 0.1, true))),
        ];
        let closed = chain_of(lambertian(square([0.0; 2], 0.2)), steps);
        assert_eq!(error(&closed, &window), None);
        let mut shaded = closed;
        shaded.operators.push(cosine());
        let error = error(&shaded, &window).unwrap();
        assert!(error > 0.0 && error < 1e-8, "{error:e}"); // slope.rs stops at 1e-9
    }
}
