//! Computes moments of the coordinates of a light field's rays.

use ndarray::Array2;

/// Number of rays that are added side by side.
pub(crate) const LANES: usize = 8;

/// Integrals of the windowed light field over rays, up to second order. With z = (x, y, u, v), they
/// are ∫ ℓW, ∫ ℓW zᵢ, and ∫ ℓW zᵢ zⱼ for i ≤ j, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayMoments(pub [f64; Self::COUNT]);

impl RayMoments {
    /// Number of sums.
    pub const COUNT: usize = 15;

    /// The central second moments, [4, 4]; `None` if no light arrived.
    pub(crate) fn covariance(&self) -> Option<Array2<f64>> {
        let [total, sums @ ..] = self.0;
        if total <= 0.0 {
            return None;
        }
        let (first, second) = sums.split_at(4);
        let mut covariance = Array2::zeros((4, 4));
        let pairs = (0..4).flat_map(|i| (i..4).map(move |j| (i, j)));
        for ((i, j), sum) in pairs.zip(second) {
            let value = sum / total - first[i] * first[j] / (total * total);
            covariance[[i, j]] = value;
            covariance[[j, i]] = value;
        }
        Some(covariance)
    }
}

/// Sums of moments over rays, each in several parts that are added side by side.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MomentSums([[f64; LANES]; RayMoments::COUNT]);

impl MomentSums {
    /// Adds rays given as columns of x, y, u, v and weight. The weights beyond `count`, up to a
    /// multiple of [`LANES`], must be zero.
    #[inline(always)]
    pub(crate) fn deposit<const N: usize>(&mut self, columns: &[[f64; N]; 5], count: usize) {
        let [x, y, u, v, weight] = columns
            .each_ref()
            .map(|column| column.as_chunks::<LANES>().0);
        const { assert!(N.is_multiple_of(LANES)) };
        let mut sums = self.0;
        for i in 0..count.div_ceil(LANES) {
            let (z, weight) = ([&x[i], &y[i], &u[i], &v[i]], &weight[i]);
            add(&mut sums[0], weight, &[1.0; LANES]);
            let mut next = 5;
            for i in 0..4 {
                add(&mut sums[1 + i], weight, z[i]);
                let mut first = [0.0; LANES];
                add(&mut first, weight, z[i]);
                for other in &z[i..] {
                    add(&mut sums[next], &first, other);
                    next += 1;
                }
            }
        }
        self.0 = sums;
    }

    /// The sums of the recorded rays times `scale`, and resets the sums for the next
    /// part.
    pub(crate) fn finish(&mut self, scale: f64) -> RayMoments {
        let sums = std::mem::take(self);
        RayMoments(sums.0.map(|parts| parts.iter().sum::<f64>() * scale))
    }
}

/// Adds the products of two columns to a sum.
#[inline(always)]
fn add(sum: &mut [f64; LANES], a: &[f64; LANES], b: &[f64; LANES]) {
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        *sum += a * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_four_rays_are_what_a_hand_makes_of_them() {
        // Each row has x, y, u, v and the weight of a ray.
        let rays = [
            [1.0, 0.0, 2.0, 0.0, 1.0],
            [-1.0, 0.0, -2.0, 0.5, 1.0],
            [3.0, 1.0, 0.0, 0.0, 2.0],
        ];
        let mut columns = [[0.0; 2 * LANES]; 5];
        for (i, column) in columns.iter_mut().enumerate() {
            for (to, ray) in column.iter_mut().zip(rays) {
                *to = ray[i];
            }
        }
        let mut moments = MomentSums::default();
        moments.deposit(&columns, rays.len());
        let covariance = moments.finish(0.25).covariance().unwrap_or_default();
        // The means of the four coordinates are 1.5, 0.5, 0 and 0.125.
        let expected = [
            (0, 0, 2.75),
            (0, 1, 0.75),
            (0, 2, 1.0),
            (1, 1, 0.25),
            (2, 2, 2.0),
            (2, 3, -0.25),
            (3, 3, 0.046875),
        ];
        for (i, j, value) in expected {
            assert!((covariance[[i, j]] - value).abs() < 1e-15, "{i} {j}"); // rounding
        }
        assert!(RayMoments::default().covariance().is_none());
    }
}
