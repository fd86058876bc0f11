//! A probability density of one coordinate, which is sampled by its quantile function.

use etendue_field::{Profile, whole};

/// Number of equal cells into which the interval is divided. The density is linear in each cell.
const CELLS: usize = 512;
/// Number of lookup-table entries for each cell. With more entries, the first cell that a search
/// tries contains the quantile more often.
const SHARES: usize = 4;

/// A density on an interval, linear between values at equal steps.
#[derive(Clone, Debug)]
pub(crate) struct LinearDensity {
    low: f64,
    step: f64,
    /// The value and the cumulative density, from 0 to 1, at the ends of the cells.
    ends: Vec<[f64; 2]>,
    /// Lookup table: for each entry, the cell at which the search for a quantile starts. Small
    /// entries keep the tables of several densities in the fastest cache.
    first: Vec<u16>,
}

impl LinearDensity {
    /// The density that is proportional to a non-negative function, or `None` if the
    /// function is zero everywhere.
    pub(crate) fn new([low, high]: [f64; 2], function: impl Fn(f64) -> f64) -> Option<Self> {
        let step = (high - low) / CELLS as f64;
        let values = (0..=CELLS).map(|i| function(low + i as f64 * step));
        let mut ends: Vec<[f64; 2]> = Vec::with_capacity(CELLS + 1);
        for value in values {
            let below = ends
                .last()
                .map_or(0.0, |[last, below]| below + 0.5 * step * (last + value));
            ends.push([value, below]);
        }
        let [_, total] = ends[CELLS];
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let ends = ends.into_iter().map(|end| end.map(|x| x / total));
        Some(Self::linear(low, step, ends.collect()))
    }

    fn linear(low: f64, step: f64, ends: Vec<[f64; 2]>) -> Self {
        let cells = ends.len() - 1;
        let shares = SHARES * cells;
        let cell = |k: usize| {
            let share = k as f64 / shares as f64;
            let after = ends.partition_point(|[_, below]| *below <= share);
            u16::try_from(after.clamp(1, cells) - 1).expect("at most `CELLS` cells")
        };
        Self {
            low,
            step,
            first: (0..=shares).map(cell).collect(),
            ends,
        }
    }

    /// The density for a window's profile. Next to the window's border the density is
    /// slightly larger than the profile, so the weights of rays near the border are bounded.
    pub(crate) fn of(profile: &Profile) -> Self {
        let half = profile.half_width();
        let inside = |t: f64| profile.value(t * (1.0 - 1e-9)) + 1e-3;
        let even = || {
            Self::linear(
                -half,
                2.0 * half,
                vec![[0.5 / half, 0.0], [0.5 / half, 1.0]],
            )
        };
        Self::new([-half, half], inside).unwrap_or_else(even)
    }

    /// The quantile: the coordinate at which the cumulative density equals `share`.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        self.draw(share)[0]
    }

    /// The quantile at which the cumulative density equals `share`, and the density at
    /// this quantile.
    pub(crate) fn draw(&self, share: f64) -> [f64; 2] {
        let last = self.ends.len() - 2;
        let mut cell = usize::from(self.first[whole(share * (self.first.len() - 1) as f64)]);
        while cell < last && self.ends[cell + 1][1] <= share {
            cell += 1;
        }
        let [[a, below], [b, _]] = [self.ends[cell], self.ends[cell + 1]];
        // Solves a t + (b − a) t²/2 = (remaining cumulative density) / step.
        let left = (share - below) / self.step;
        let root = (a * a + 2.0 * (b - a) * left).max(0.0).sqrt();
        let t = if a + root > 0.0 {
            2.0 * left / (a + root)
        } else {
            0.0
        };
        [
            self.low + (cell as f64 + t.clamp(0.0, 1.0)) * self.step,
            root,
        ]
    }

    /// The value of the density; zero outside the interval.
    pub(crate) fn value(&self, t: f64) -> f64 {
        let at = (t - self.low) / self.step;
        let cells = self.ends.len() - 1;
        if !(0.0..=cells as f64).contains(&at) {
            return 0.0;
        }
        let cell = whole(at).min(cells - 1);
        let share = at - cell as f64;
        let [[a, _], [b, _]] = [self.ends[cell], self.ends[cell + 1]];
        a + share * (b - a)
    }
}

/// A density of the points at which rays are aimed, along one coordinate of a plane. Rays land
/// slightly beside these points, so the density is wider than the window, and unbounded.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    near: LinearDensity,
    half: f64,
}

/// Fraction of rays that are aimed at points anywhere on the plane, independently of the window.
const ANYWHERE_SHARE: f64 = 0.04;
/// Width of the density for rays aimed near the window, divided by the window's width.
const WIDER: f64 = 1.2;

impl Target {
    /// The density of aimed points along one coordinate. `profile` is the window's profile
    /// along this coordinate.
    pub(crate) fn new(profile: &Profile) -> Self {
        let half = profile.half_width();
        let reach = 1.2 * WIDER * half;
        let around = |t: f64| profile.value(t / WIDER) + 0.05;
        let near = LinearDensity::new([-reach, reach], around);
        Self {
            near: near.unwrap_or_else(|| LinearDensity::of(profile)),
            half,
        }
    }

    /// A target coordinate for a uniform random number `share`: small numbers give points
    /// anywhere on the plane, and larger numbers give points near the window.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        if share >= ANYWHERE_SHARE {
            return self
                .near
                .quantile((share - ANYWHERE_SHARE) / (1.0 - ANYWHERE_SHARE));
        }
        let to_side = 2.0 * share / ANYWHERE_SHARE - 1.0;
        self.half * to_side / (1.0 - to_side.abs())
    }

    /// The value of the density.
    pub(crate) fn value(&self, t: f64) -> f64 {
        let far = 0.5 / (self.half * (1.0 + t.abs() / self.half).powi(2));
        (1.0 - ANYWHERE_SHARE) * self.near.value(t) + ANYWHERE_SHARE * far
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests that the mean of f/density over quantiles is the integral of f, wherever the function
    /// f is centred.
    #[test]
    fn targets_reach_everywhere() {
        let target = Target::new(&Profile::Hann(0.5));
        let n = 1_000_000;
        for center in [0.2, 0.7, 6.0] {
            let sum: f64 = (0..n)
                .map(|i| {
                    let t = target.quantile((f64::from(i) + 0.5) / f64::from(n));
                    let apart = t - center;
                    libm::exp(-std::f64::consts::PI * apart * apart) / target.value(t)
                })
                .sum();
            // The nodes are the quantiles of n midpoints of (0, 1); a step in the density causes
            // an error of 1/n.
            assert!((sum / f64::from(n) - 1.0).abs() < 1e-4, "{center}");
        }
    }

    #[test]
    fn quantiles_are_drawn_by_the_density() {
        let profile = Profile::Hann(0.5);
        let density = LinearDensity::of(&profile);
        let n = 100_000;
        // The mean of f/density over quantiles is the integral of f.
        let sum: f64 = (0..n)
            .map(|i| {
                let t = density.quantile((f64::from(i) + 0.5) / f64::from(n));
                profile.value(t) * (1.0 + t).powi(2) / density.value(t)
            })
            .sum();
        // The integral of cos²(πt) (1 + t)² over |t| < ½ is ½ (1 + 1/12 − 1/(2π²)).
        let pi = std::f64::consts::PI;
        let expected = 0.5 * (1.0 + 1.0 / 12.0 - 0.5 / (pi * pi));
        assert!(
            (sum / f64::from(n) - expected).abs() < 1e-7,
            "{}",
            sum / f64::from(n)
        );
        assert_eq!(density.value(0.51).to_bits(), 0.0_f64.to_bits());
        let low = density.quantile(0.0);
        let high = density.quantile(1.0);
        assert!((low + 0.5).abs() < 1e-12 && (high - 0.5).abs() < 1e-12); // rounding
    }
}
