//! Defines densities for drawing rays that pass a window.

use crate::lanes::lanes;
use etendue_field::Profile;

/// A density over t for |t| < half. It follows a window's profile and can be sampled on any
/// interval.
///
/// A Hann profile is approximated by a tent, 1 − |t|/half. The ratio of a Hann profile to the tent
/// stays between 0 and 1.14 and falls to zero at the edge, so the weights of rays are bounded.
/// Profiles other than Hann do not vanish at their edge, and are approximated by a constant. For
/// light that a surface receives, the density follows the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ProfileDensity {
    half: f64,
    kind: ProposalKind,
    /// 1 / `half`. Products with it replace divisions, which would take a third of the time of
    /// emission.
    inverse: f64,
    /// The sine of the angle whose slope is `half`, and its inverse.
    sine: [f64; 2],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ProposalKind {
    Constant,
    Tent,
    /// A density in proportion to g(t) = (1 + t²)^(−3/2).
    Cosine,
}

impl ProfileDensity {
    pub(crate) fn new(profile: &Profile) -> Self {
        let kind = match profile {
            Profile::Hann(_) => ProposalKind::Tent,
            Profile::Box(_) | Profile::Gaussian { .. } => ProposalKind::Constant,
        };
        Self::of(kind, profile.half_width())
    }

    pub(crate) fn constant(half: f64) -> Self {
        Self::of(ProposalKind::Constant, half)
    }

    /// The density for slopes of light that a surface receives. The slopes are at most
    /// `half`. The density is weighted by the cosine as in 2D (docs/theory.md (6)).
    pub(crate) fn cosine(half: f64) -> Self {
        Self::of(ProposalKind::Cosine, half)
    }

    fn of(kind: ProposalKind, half: f64) -> Self {
        let sine = half / (1.0 + half * half).sqrt();
        Self {
            half,
            kind,
            inverse: 1.0 / half,
            sine: [sine, 1.0 / sine],
        }
    }

    /// The share of the density below `t`.
    #[inline(always)]
    fn cumulative(&self, t: f64) -> f64 {
        let s = (t * self.inverse).clamp(-1.0, 1.0);
        match self.kind {
            ProposalKind::Constant => 0.5 * (1.0 + s),
            ProposalKind::Tent => {
                let beyond = 0.5 * (1.0 - s.abs()) * (1.0 - s.abs());
                if s < 0.0 { beyond } else { 1.0 - beyond }
            }
            ProposalKind::Cosine => {
                let t = s * self.half;
                0.5 * (1.0 + t * self.sine[1] / (1.0 + t * t).sqrt())
            }
        }
    }

    /// Inverse of [`Self::cumulative`].
    #[inline(always)]
    pub(crate) fn quantile(&self, p: f64) -> f64 {
        let s = match self.kind {
            ProposalKind::Constant => 2.0 * p - 1.0,
            // One formula is used for both signs of t, because the processor would mispredict a
            // branch half of the time.
            ProposalKind::Tent => {
                let beyond = p.min(1.0 - p).max(0.0);
                (1.0 - (2.0 * beyond).sqrt()).copysign(p - 0.5)
            }
            ProposalKind::Cosine => {
                let sine = (2.0 * p - 1.0) * self.sine[0];
                return sine / (1.0 - sine * sine).sqrt();
            }
        };
        s * self.half
    }

    /// The density with respect to dt.
    #[inline(always)]
    pub(crate) fn density(&self, t: f64) -> f64 {
        let s = (t * self.inverse).abs();
        if s >= 1.0 {
            return 0.0;
        }
        match self.kind {
            ProposalKind::Constant => 0.5 * self.inverse,
            ProposalKind::Tent => (1.0 - s) * self.inverse,
            ProposalKind::Cosine => {
                let secant_squared = 1.0 + t * t;
                0.5 * self.sine[1] / (secant_squared * secant_squared.sqrt())
            }
        }
    }

    /// Evaluates a function of the density for several numbers. The kind of density is fixed inside
    /// each loop, so the compiler can vectorise the loops.
    #[inline(always)]
    fn each<const N: usize>(&self, t: [f64; N], f: impl Fn(&Self, f64) -> f64) -> [f64; N] {
        let of = |kind: ProposalKind| Self { kind, ..*self };
        match self.kind {
            ProposalKind::Constant => lanes(|i| f(&of(ProposalKind::Constant), t[i])),
            ProposalKind::Tent => lanes(|i| f(&of(ProposalKind::Tent), t[i])),
            ProposalKind::Cosine => lanes(|i| f(&of(ProposalKind::Cosine), t[i])),
        }
    }
}

/// A sampler of slopes along one axis. The slopes belong to rays that leave a point of a surface
/// and cross a window at some distance. The slopes follow the window's profile over the range of
/// slopes that cross the window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    distance: f64,
    half: f64,
    slope: ProfileDensity,
}

impl Aim {
    pub(crate) fn new(distance: f64, space: &Profile, slope: ProfileDensity) -> Self {
        Self {
            distance,
            half: space.half_width(),
            slope,
        }
    }

    /// A range of slopes leads from `x`, at the distance `from`, through the window. Returns the
    /// cumulative densities at both ends of this range; `None` if the range is empty.
    #[inline]
    fn range(&self, x: f64, from: f64) -> Option<[f64; 2]> {
        let distance = self.distance - from;
        let range = if distance > 0.0 {
            [-self.half, self.half].map(|end| self.slope.cumulative((end - x) / distance))
        } else if distance < 0.0 {
            [self.half, -self.half].map(|end| self.slope.cumulative((end - x) / distance))
        } else if x.abs() < self.half {
            [0.0, 1.0]
        } else {
            return None;
        };
        (range[0] < range[1]).then_some(range)
    }

    /// A slope for a ray from `x` at the distance `from`, drawn with a random number in
    /// (0, 1).
    #[inline]
    pub(crate) fn sample(&self, x: f64, from: f64, random: f64) -> Option<f64> {
        let [low, high] = self.range(x, from)?;
        Some(self.slope.quantile(low + random * (high - low)))
    }

    /// The density of [`Self::sample`] with respect to du.
    #[inline]
    pub(crate) fn density(&self, x: f64, from: f64, u: f64) -> f64 {
        let crosses = (x + (self.distance - from) * u).abs() < self.half;
        match self.range(x, from) {
            Some([low, high]) if crosses => self.slope.density(u) / (high - low),
            _ => 0.0,
        }
    }
}

/// Rays in one pair of coordinates, (x, u) or (y, v), that leave the light and cross a window.
///
/// One of the position in the window and the slope is drawn first, by its density over the range
/// that rays from the light to the window have. The other is drawn second, from the range that it
/// has for the first. All samples start on the light and cross the window. For a point light, the
/// slope alone is drawn, and the density is that of the slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Proposal {
    order: DrawOrder,
    /// Distance of the window from the light.
    distance: f64,
    /// 1 / `distance`, or 0 at the light.
    nearness: f64,
    /// Extent of the light along this axis.
    light: [f64; 2],
    space: ProfileDensity,
    slope: ProfileDensity,
    /// The cumulative densities at the two ends of the range of the first coordinate.
    range: [f64; 2],
}

/// The coordinate that is drawn first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DrawOrder {
    /// The position in the window. It has a smooth window, so numbers that are evenly distributed
    /// have less noise than with the other order.
    Position,
    /// The slope. Light at small angles to a surface reaches a large part of it, and most of this
    /// part receives little light.
    Slope,
}

impl Proposal {
    /// Builds the proposal for light of extent `extent` and a window with the profiles `space` and
    /// `slope` at `distance`. For a point light, the order has no influence.
    ///
    /// Returns `None` if no ray from the light crosses the window.
    pub(crate) fn new(
        order: DrawOrder,
        distance: f64,
        extent: [f64; 2],
        space: ProfileDensity,
        slope: ProfileDensity,
    ) -> Option<Self> {
        let [low, high] = extent;
        let order = if high > low { order } else { DrawOrder::Slope };
        let range = if order == DrawOrder::Position {
            let reach = distance.max(0.0) * slope.half;
            [low - reach, high + reach].map(|x| space.cumulative(x))
        } else if distance > 0.0 {
            // A ray from x in the light is in the window when |x + distance·u| < half-width.
            [-space.half - high, space.half - low].map(|x| slope.cumulative(x / distance))
        } else if low < space.half && high > -space.half {
            [0.0, 1.0]
        } else {
            return None;
        };
        (range[0] < range[1]).then_some(Self {
            order,
            distance,
            nearness: if distance > 0.0 { 1.0 / distance } else { 0.0 },
            light: extent,
            space,
            slope,
            range,
        })
    }

    /// Checks whether the light is a point along this axis.
    #[inline]
    pub(crate) fn is_point(&self) -> bool {
        self.light[1] <= self.light[0]
    }

    /// Checks whether the position in the window is drawn first.
    pub(crate) fn begins_in_window(&self) -> bool {
        self.order == DrawOrder::Position
    }

    /// The cumulative densities at the two ends of the range of the second coordinate.
    #[inline(always)]
    fn ranges<const N: usize>(&self, first: &[f64; N]) -> [[f64; N]; 2] {
        let [low, high] = self.light;
        match self.order {
            // At the light, rays of all slopes have the same position.
            DrawOrder::Position if self.nearness == 0.0 => [[0.0; N], [1.0; N]],
            DrawOrder::Position => [high, low].map(|end| {
                let slopes: [f64; N] = lanes(|i| (first[i] - end) * self.nearness);
                self.slope.each(slopes, ProfileDensity::cumulative)
            }),
            DrawOrder::Slope => [low, high].map(|end| {
                let positions: [f64; N] = lanes(|i| end + self.distance * first[i]);
                self.space.each(positions, ProfileDensity::cumulative)
            }),
        }
    }

    /// Positions on the light and slopes, each pair drawn with two random numbers in (0,
    /// 1).
    #[inline(always)]
    pub(crate) fn samples<const N: usize>(&self, numbers: [[f64; N]; 2]) -> [[f64; N]; 2] {
        self.samples_and_ranges(numbers).0
    }

    /// Returns [`Self::samples`], and the density of each pair with respect to dx du.
    #[inline(always)]
    pub(crate) fn samples_and_densities<const N: usize>(
        &self,
        numbers: [[f64; N]; 2],
    ) -> ([[f64; N]; 2], [f64; N]) {
        let ([x, u], ranges) = self.samples_and_ranges(numbers);
        ([x, u], self.densities_of([&x, &u], ranges))
    }

    /// The density of [`Self::samples`] with respect to dx du.
    #[inline(always)]
    pub(crate) fn densities<const N: usize>(&self, [x, u]: [&[f64; N]; 2]) -> [f64; N] {
        let ranges = (!self.is_point()).then(|| match self.order {
            DrawOrder::Position => self.ranges(&lanes(|i| x[i] + self.distance * u[i])),
            DrawOrder::Slope => self.ranges(u),
        });
        self.densities_of([x, u], ranges)
    }

    /// Returns [`Self::samples`], and [`Self::ranges`] for light of some extent.
    #[inline(always)]
    fn samples_and_ranges<const N: usize>(
        &self,
        [a, b]: [[f64; N]; 2],
    ) -> ([[f64; N]; 2], Option<[[f64; N]; 2]>) {
        let between = |low: f64, high: f64, r: f64| low + r * (high - low);
        let [first, second] = match self.order {
            DrawOrder::Position => [&self.space, &self.slope],
            DrawOrder::Slope => [&self.slope, &self.space],
        };
        let [low, high] = self.range;
        let shares: [f64; N] = lanes(|i| between(low, high, a[i]));
        let first = first.each(shares, ProfileDensity::quantile);
        if self.is_point() {
            return ([[self.light[0]; N], first], None);
        }
        let [low, high] = self.ranges(&first);
        let shares: [f64; N] = lanes(|i| between(low[i], high[i], b[i]));
        let second = second.each(shares, ProfileDensity::quantile);
        let [seen, u] = match self.order {
            DrawOrder::Position => [first, second],
            DrawOrder::Slope => [second, first],
        };
        let x = lanes(|i| seen[i] - self.distance * u[i]);
        ([x, u], Some([low, high]))
    }

    /// The matrix that takes frequencies over the two random numbers of [`Self::samples`] to
    /// frequencies over (x, u), where samples are a linear function of the random numbers. The
    /// linear function has the mean derivatives of samples in the middle half of each number.
    pub(crate) fn frequencies(&self) -> [[f64; 2]; 2] {
        let [x, u] = self.samples([[0.25, 0.75, 0.5, 0.5], [0.5, 0.5, 0.25, 0.75]]);
        let derivatives = |of: [f64; 4]| [2.0 * (of[1] - of[0]), 2.0 * (of[3] - of[2])];
        let ([xa, xb], [ua, ub]) = (derivatives(x), derivatives(u));
        let determinant = xa * ub - ua * xb;
        [[ub, -ua], [-xb, xa]].map(|row| row.map(|value| value / determinant))
    }

    #[inline(always)]
    fn densities_of<const N: usize>(
        &self,
        [x, u]: [&[f64; N]; 2],
        ranges: Option<[[f64; N]; 2]>,
    ) -> [f64; N] {
        let [left, right] = self.light;
        let share = self.range[1] - self.range[0];
        let slope = self.slope.each(*u, ProfileDensity::density);
        let seen: [f64; N] = lanes(|i| x[i] + self.distance * u[i]);
        let Some([low, high]) = ranges else {
            return lanes(|i| {
                let is_seen = x[i] >= left && x[i] <= right && seen[i].abs() < self.space.half;
                if is_seen { slope[i] / share } else { 0.0 }
            });
        };
        let space = self.space.each(seen, ProfileDensity::density);
        lanes(|i| {
            let density = slope[i] * space[i] / (share * (high[i] - low[i]));
            let is_lit = x[i] >= left && x[i] <= right && high[i] > low[i];
            if is_lit { density } else { 0.0 }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_sampling::chi_square::RectangleCells;
    use etendue_transform::random::{self, Stream};

    #[test]
    fn samples_follow_the_density() {
        let hann = Profile::Hann;
        let tent = |half| ProfileDensity::new(&Profile::Hann(half));
        for (distance, light, space, slope) in [
            (0.0, [-0.1, 0.1], hann(0.5), tent(0.5)),
            (0.0, [-0.7, 0.2], hann(0.5), tent(0.3)),
            (1.0, [-0.1, 0.1], hann(0.5), tent(0.5)),
            (
                2.0,
                [-0.5, 0.5],
                hann(0.25),
                ProfileDensity::new(&Profile::Box(0.5)),
            ),
            (2.0, [0.3, 0.4], Profile::Box(0.25), tent(0.5)),
            (
                0.5,
                [-1.0, 1.0],
                Profile::Box(0.5),
                ProfileDensity::cosine(3.0),
            ),
        ] {
            let [by_position, by_slope] = [DrawOrder::Position, DrawOrder::Slope].map(|order| {
                let space = ProfileDensity::new(&space);
                Proposal::new(order, distance, light, space, slope).unwrap()
            });
            let cells = RectangleCells::new([light, [-slope.half, slope.half]], [24, 24]);
            for proposal in [by_position, by_slope] {
                let samples = (0..100_000).map(|index| {
                    let [a, b, ..] = random::words(9, Stream::Photon, index, 0).map(random::unit);
                    let [[x], [u]] = proposal.samples([[a], [b]]);
                    Some([x, u])
                });
                let found = cells.compare(samples, |[x, u]| proposal.densities([&[x], &[u]])[0]);
                assert!(found.agrees(), "{found:?} of {proposal:?}");
            }
        }
    }

    #[test]
    fn out_of_reach_is_none() {
        let hann = ProfileDensity::new(&Profile::Hann(0.1));
        for order in [DrawOrder::Position, DrawOrder::Slope] {
            let is_reached =
                |distance, light| Proposal::new(order, distance, light, hann, hann).is_some();
            assert!(!is_reached(0.0, [0.2, 0.3]));
            assert!(!is_reached(1.0, [0.3, 0.4]));
            assert!(is_reached(1.0, [0.15, 0.4]));
        }
    }
}
