use super::predict::exact_field;
use super::quadrature::Rule;
use super::region::Finder;
use super::{Plane, System};
use crate::geometry::Matrix;
use etendue_field::Window;

/// Nodes along each of a picture's coordinates, and those of slopes from each point of an area light.
const INNER: [usize; 2] = [256, 48];
/// Gauss nodes along each side of an area light.
const OUTER: usize = 12;

/// The second central moments of the windowed light field, in (x, y, u, v) or what stands for them, by rays as in [`exact`](super::exact).
///
/// Relative error about 10⁻⁶ where nothing has edges. `None` if no light arrives.
#[must_use]
pub fn covariance(system: &System, plane: &Plane, window: &Window) -> Option<Matrix<4>> {
    let (open, opaque) = system.apart();
    let field = exact_field(&open, plane);
    let emission = open.emission();
    let rule = if emission.shape.is_some() {
        Rule {
            outer: OUTER,
            inner: INNER[1],
        }
    } else {
        Rule {
            outer: 1,
            inner: INNER[0],
        }
    };
    let nodes = Finder::new(&field, window, emission, opaque)?.nodes(rule);
    let total: f64 = nodes.iter().map(|node| node.weight).sum();
    if total <= 0.0 {
        return None;
    }
    let mean = |f: &dyn Fn(&[f64; 4]) -> f64| {
        nodes
            .iter()
            .map(|node| node.weight * f(&node.z))
            .sum::<f64>()
            / total
    };
    let center: [f64; 4] = std::array::from_fn(|i| mean(&|z| z[i]));
    let moment = |i: usize, j: usize| mean(&|z| (z[i] - center[i]) * (z[j] - center[j]));
    Some(std::array::from_fn(|i| {
        std::array::from_fn(|j| moment(i, j))
    }))
}
