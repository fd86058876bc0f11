//! Computes moments of the coordinates of a light field's rays.

use etendue_field::TwoPlane;
use ndarray::Array2;

/// Integrals of the windowed light field over rays, up to second order. With z = (x, y, u, v), they
/// are ∫ ℓW, ∫ ℓW zᵢ, and ∫ ℓW zᵢ zⱼ for i ≤ j, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayMoments(pub [f64; Self::COUNT]);

impl RayMoments {
    /// Number of sums.
    pub const COUNT: usize = 15;

    /// Adds a ray.
    #[inline]
    pub(crate) fn deposit(&mut self, ray: &TwoPlane, weight: f64) {
        let z = [ray.x, ray.y, ray.u, ray.v];
        self.0[0] += weight;
        let mut next = 5;
        for i in 0..4 {
            let first = weight * z[i];
            self.0[1 + i] += first;
            for other in &z[i..] {
                self.0[next] += first * other;
                next += 1;
            }
        }
    }

    /// Returns the sums of the recorded rays times `scale`, and resets the sums for the next
    /// part.
    pub(crate) fn finish(&mut self, scale: f64) -> Self {
        let sums = std::mem::take(self);
        Self(sums.0.map(|s| s * scale))
    }

    /// Returns the central second moments, [4, 4]; `None` if no light arrived.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_four_rays_are_what_a_hand_makes_of_them() {
        let mut moments = RayMoments::default();
        let ray = |x, y, u, v| TwoPlane { x, y, u, v };
        for (ray, weight) in [
            (ray(1.0, 0.0, 2.0, 0.0), 1.0),
            (ray(-1.0, 0.0, -2.0, 0.5), 1.0),
            (ray(3.0, 1.0, 0.0, 0.0), 2.0),
        ] {
            moments.deposit(&ray, weight);
        }
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
