use crate::Chain;
use crate::fast::{fineness, slices_at_fineness};
use crate::slope::Slope;
use etendue_field::{SliceGrid, Slices, Window};

/// How far `slices`, the prediction of the same chain, may be off: ‖error‖/‖F‖ over the grid. `None` where it is
/// a closed form.
///
/// * Discs: the difference to a prediction that takes them apart half as fine again. The error falls faster than
///   that (as n⁻⁴ or exponentially, docs/theory.md, section 3), so it is the error of `slices` to a fifth or better.
/// * Spots, points and cosines: the residual of the series of (1 + u² + v²)^p over the window, about 10⁻⁹.
#[must_use]
pub fn quadrature_error(
    chain: &Chain,
    window: &Window,
    grid: &SliceGrid,
    slices: &Slices,
) -> Option<f64> {
    let path = chain.path();
    let power = path.slope_power();
    if power == 0.0 && !path.has_discs() {
        return None;
    }
    let mut error = Slope::new([&window.u, &window.v], power).residual;
    if path.has_discs() {
        let finer = fineness(&path, window, grid).finer();
        error += distance(slices, &slices_at_fineness(&path, window, grid, &finer));
    }
    Some(error)
}

/// ‖a − b‖/‖b‖; 0 if both are dark.
fn distance(a: &Slices, b: &Slices) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for (a, b) in a.half.iter().zip(&b.half) {
        error += (a - b).norm_sqr();
        size += b.norm_sqr();
    }
    if error == 0.0 {
        0.0
    } else {
        (error / size).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    #[test]
    fn discs_are_good_to_five_digits() {
        let hann = window(Profile::Hann(0.5), Profile::Hann(0.5));
        let boxed = window(Profile::Box(0.5), Profile::Box(0.5));
        for window in [hann, boxed] {
            for radius in [0.03, 0.1, 0.3] {
                for distances in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]] {
                    let round = disc([0.02, 0.01], radius);
                    let light = chain_of(spot(round, 0.0), distances.map(|d| (d, None)));
                    let blocker = Some(opaque(vec![round]));
                    let square = lambertian(square([0.0; 2], 0.2));
                    let blocker = chain_of(square, [(distances[0], blocker), (distances[1], None)]);
                    for chain in [light, blocker] {
                        let error = error(&chain, &window).unwrap();
                        let open = chain_of(chain.source.light, distances.map(|d| (d, None)));
                        let open = slices(&open, &window, &grid());
                        let ratio = (slices(&chain, &window, &grid())
                            .half
                            .iter()
                            .map(|s| s.norm_sqr())
                            .sum::<f64>()
                            / open.half.iter().map(|s| s.norm_sqr()).sum::<f64>())
                        .sqrt();
                        println!(
                            "{:e} {:?} {radius} {distances:?} {error:e}",
                            error * ratio,
                            window.x
                        );
                    }
                }
            }
        }
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
