//! Defines axes, the quantities along them, and their ticks.

use crate::sizes::{LEAST_TEXT, TICK_TEXT};
use crate::text::width;

/// A named quantity and its unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AxisQuantity {
    /// The name of the quantity, as markup such as `|*S*|^{2}`.
    pub name: String,
    /// The unit of the quantity, as markup; empty for a pure number.
    pub unit: String,
}

impl AxisQuantity {
    /// The quantity called `name` with the unit `unit`.
    #[must_use]
    pub fn new(name: &str, unit: &str) -> Self {
        Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
        }
    }

    /// The label "name (unit)" as markup. The unit includes the factor 10 to the power
    /// `exponent`.
    pub(crate) fn label(&self, exponent: i32) -> String {
        let power = match exponent {
            0 => String::new(),
            n => format!("10^{{{}}}", minus(&n.to_string())),
        };
        let unit = [power, self.unit.clone()]
            .into_iter()
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join(" ");
        if unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} ({unit})", self.name)
        }
    }

    /// The table heading "name [unit]" without markup.
    pub(crate) fn heading(&self) -> String {
        let name = crate::text::plain(&self.name);
        match crate::text::plain(&self.unit).as_str() {
            "" => name,
            unit => format!("{name} [{unit}]"),
        }
    }
}

/// One axis of a picture: its quantity and its outer edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity along the axis.
    pub quantity: AxisQuantity,
    /// Outer edge of the cell with the lowest values, in the quantity's unit.
    pub min: f64,
    /// Outer edge of the cell with the highest values, in the quantity's unit.
    pub max: f64,
    /// Whether the axis is logarithmic; if it is, both edges are above 0.
    pub is_log: bool,
    /// Whether the numbers decrease to the right or upwards, like the row numbers of a photograph,
    /// which are counted from the top. If the numbers decrease, the first cell of an array is at
    /// the edge with the highest values.
    pub is_reversed: bool,
}

/// A tick: its position in the unit of the axis, and its text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) text: String,
}

impl Axis {
    /// An axis whose cells fill the range from `min` to `max`.
    #[must_use]
    pub fn edges(name: &str, unit: &str, [min, max]: [f64; 2]) -> Self {
        Self {
            quantity: AxisQuantity::new(name, unit),
            min,
            max,
            is_log: false,
            is_reversed: false,
        }
    }

    /// The axis of a quantity over a range.
    pub(crate) fn of(quantity: &AxisQuantity, [min, max]: [f64; 2]) -> Self {
        Self::edges(&quantity.name, &quantity.unit, [min, max])
    }

    /// This axis with its numbers decreasing.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self {
            is_reversed: true,
            ..self
        }
    }

    /// An axis of `count` samples from `first` to `last`; each sample fills a cell
    /// centred on it.
    #[must_use]
    pub fn centers(name: &str, unit: &str, [first, last]: [f64; 2], count: usize) -> Self {
        let half = 0.5 * (last - first) / (count.max(2) - 1) as f64;
        Self::edges(name, unit, [first - half, last + half])
    }

    /// The centre of the cell `index` of `count` cells.
    pub(crate) fn center(&self, index: usize, count: usize) -> f64 {
        // The formula is symmetric in the two edges, so the middle of a symmetric axis is exactly
        // 0.
        let along = index as f64 + 0.5;
        let above = if self.is_reversed {
            count as f64 - along
        } else {
            along
        };
        ((count as f64 - above) * self.min + above * self.max) / count as f64
    }

    /// The edges of the axis. If the edges coincide or are reversed, they are moved apart.
    pub(crate) fn range(&self) -> [f64; 2] {
        if self.max > self.min && (self.max - self.min).is_finite() {
            [self.min, self.max]
        } else if self.min.is_finite() {
            [self.min - 0.5, self.min + 0.5]
        } else {
            [-0.5, 0.5]
        }
    }

    /// The position of `value` along the axis: 0 at the outer edge of the first cell, and
    /// 1 at the outer edge of the last cell.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        let [min, max] = self.range();
        let above = if self.is_log {
            libm::log(value / min) / libm::log(max / min)
        } else {
            (value - min) / (max - min)
        };
        if self.is_reversed { 1.0 - above } else { above }
    }

    /// The power of ten that is factored out of the tick texts.
    pub(crate) fn exponent(&self) -> i32 {
        let [min, max] = self.range();
        if self.is_log {
            return 0;
        }
        let decade = order(min.abs().max(max.abs()));
        // Numbers from 0.01 to 9999 are shorter without a factored power of ten.
        if (-2..=3).contains(&decade) {
            0
        } else {
            decade
        }
    }

    /// Returns ticks at multiples of 1, 2 or 5 × 10ⁿ, with at most `most` steps along the axis.
    pub(crate) fn ticks(&self, most: f64) -> Vec<Tick> {
        if self.is_log {
            let close = [1.0, 2.0, 3.0, 4.0, 5.0, 7.0];
            let digits = [&close[..], &USUAL, &[1.0, 3.0]];
            let mut closest = digits.iter().map(|digits| self.powers(digits));
            let fitting = closest.find(|ticks| ticks.len() as f64 <= most + 1.0);
            return fitting.unwrap_or_else(|| self.powers(&[1.0]));
        }
        let [min, max] = self.range();
        self.ticks_every(step((max - min) / most.max(1.0), &USUAL))
    }

    /// The ticks of a logarithmic axis, at `digits` × 10ⁿ.
    fn powers(&self, digits: &[f64]) -> Vec<Tick> {
        let [min, max] = self.range();
        let tick = |n: i32, digit: f64| {
            let text = if (-4..5).contains(&n) {
                let places = usize::try_from(-n).unwrap_or(0);
                format!("{:.places$}", digit * 10_f64.powi(n))
            } else {
                format!("{digit}e{n}")
            };
            Tick {
                value: digit * 10_f64.powi(n),
                text: minus(&text),
            }
        };
        let ticks = (order(min)..=order(max)).flat_map(|n| digits.iter().map(move |d| tick(n, *d)));
        let inside = |tick: &Tick| (min..=max).contains(&tick.value);
        ticks.filter(inside).collect()
    }

    /// Returns ticks at multiples of `step`, which has at most two significant digits.
    fn ticks_every(&self, step: f64) -> Vec<Tick> {
        let [min, max] = self.range();
        let exponent = self.exponent();
        let unit = 10_f64.powi(exponent);
        let digits = step / 10_f64.powi(order(step));
        let is_whole = (digits - digits.round()).abs() < 1e-6;
        let last = order(step) - i32::from(!is_whole);
        let places = usize::try_from(exponent - last).unwrap_or(0);
        // In spite of rounding errors, a tick on the edge belongs to the axis.
        let slack = 1e-9 * (max - min);
        let mut multiple = ((min - slack) / step).ceil();
        let mut ticks = Vec::new();
        while multiple * step <= max + slack {
            // Adding zero changes −0 to 0.
            let value = multiple * step + 0.0;
            ticks.push(Tick {
                value,
                text: minus(&format!("{:.places$}", value / unit)),
            });
            multiple += 1.0;
        }
        ticks
    }
}

/// If an axis has at least this length, its tick texts may be close to the tick texts of the next
/// panel.
pub(crate) const COMFORTABLE: f64 = 64.0;
/// Tick texts may extend beyond an axis by this length if the axis is shorter than [`COMFORTABLE`].
const OVERHANG: f64 = 7.0;

/// The usual first digits of the distance between ticks.
const USUAL: [f64; 3] = [1.0, 2.0, 5.0];
/// If the usual first digits give fewer than three ticks, the distance between ticks may have these
/// first digits.
const MORE: [f64; 7] = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 8.0];

/// Returns as many ticks as fit along `length` without overlaps of their texts. Also returns the
/// font size of these texts. If fewer than three ticks fit, smaller texts or less usual steps are
/// tried.
pub(crate) fn spaced_ticks(axis: &Axis, length: f64) -> (Vec<Tick>, f64) {
    const SIZES: [f64; 3] = [TICK_TEXT, 9.5, LEAST_TEXT];
    let [min, max] = axis.range();
    let most = || (1..=8).rev().map(f64::from);
    let usual = |size| {
        let mut ticks = most().map(|most| axis.ticks(most));
        ticks.find(|ticks| fit(axis, ticks, length, size))
    };
    let unusual = |size| {
        let mut ticks = most().map(|most| axis.ticks_every(step((max - min) / most, &MORE)));
        ticks.find(|ticks| ticks.len() >= 3 && fit(axis, ticks, length, size))
    };
    let first = (usual(TICK_TEXT).unwrap_or_default(), TICK_TEXT);
    let mut smaller = SIZES
        .into_iter()
        .filter_map(|size| Some((usual(size)?, size)));
    let mut enough = smaller.clone().filter(|(ticks, _)| ticks.len() >= 3);
    if axis.is_log {
        return enough.next().unwrap_or(first);
    }
    let others = SIZES
        .into_iter()
        .filter_map(|size| Some((unusual(size)?, size)));
    let two = smaller.find(|(ticks, _)| ticks.len() >= 2);
    enough.chain(others).next().or(two).unwrap_or(first)
}

/// Checks that tick texts at the font size `size` do not overlap. Along a short axis, tick texts
/// must also be clear of the tick texts of the next panel.
fn fit(axis: &Axis, ticks: &[Tick], length: f64, size: f64) -> bool {
    let beyond = |tick: &Tick| {
        let at = axis.fraction(tick.value) * length;
        0.5 * width(&tick.text, size) - at.min(length - at)
    };
    if length < COMFORTABLE && ticks.iter().any(|tick| beyond(tick) > OVERHANG) {
        return false;
    }
    ticks.windows(2).all(|pair| {
        let step = (axis.fraction(pair[1].value) - axis.fraction(pair[0].value)).abs();
        let [a, b] = [0, 1].map(|i| width(&pair[i].text, size));
        step * length >= 0.5 * (a + b) + 3.0
    })
}

/// Minimum distance between the baselines of tick texts above each other.
const LINE: f64 = 13.0;

/// The ticks of a vertical axis: one per 36 units of its height, or more if fewer than three ticks
/// would fit, but so few that their texts do not overlap.
pub(crate) fn upright_ticks(axis: &Axis, height: f64) -> Vec<Tick> {
    let most = (height / 36.0).max(2.0);
    let are_apart = |ticks: &Vec<Tick>| {
        ticks.windows(2).all(|pair| {
            let step = axis.fraction(pair[1].value) - axis.fraction(pair[0].value);
            step.abs() * height >= LINE
        })
    };
    let closer = (0..7).map(|more| axis.ticks(most + f64::from(more)));
    let mut enough = closer.filter(|ticks| ticks.len() >= 3 && are_apart(ticks));
    let mut fewer = [most, 1.0].into_iter().map(|most| axis.ticks(most));
    let few = || fewer.find(are_apart).unwrap_or_default();
    enough.next().unwrap_or_else(few)
}

/// The smallest number of the form `digits` × 10ⁿ that is at least `least`, which is
/// above 0.
fn step(least: f64, digits: &[f64]) -> f64 {
    let decade = 10_f64.powi(order(least));
    // The tolerance prevents a step of 0.2, computed as 0.20000000000000004, from becoming 0.5.
    let mut steps = digits.iter().map(|digit| digit * decade);
    steps
        .find(|candidate| *candidate >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// The exponent n with 10ⁿ ≤ `value` < 10ⁿ⁺¹, up to rounding errors, or 0 if the value is
/// zero.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the logarithm of a finite f64 is within ±324"
)]
fn order(value: f64) -> i32 {
    if value > 0.0 && value.is_finite() {
        (libm::log10(value) + 1e-9).floor() as i32
    } else {
        0
    }
}

/// The text with the minus sign − in place of hyphens.
pub(crate) fn minus(text: &str) -> String {
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(range: [f64; 2], most: f64) -> Vec<String> {
        let ticks = Axis::edges("x", "m", range).ticks(most);
        ticks.into_iter().map(|tick| tick.text).collect()
    }

    #[test]
    fn ticks_are_at_round_numbers_with_true_minus_signs() {
        assert_eq!(texts([-0.5, 0.5], 3.0), ["−0.5", "0.0", "0.5"]);
        assert_eq!(texts([-16.5, 16.5], 5.0), ["−10", "0", "10"]);
        assert_eq!(texts([-60.0, 0.0], 3.0), ["−60", "−40", "−20", "0"]);
        assert_eq!(texts([0.0, 2.0], 10.0).len(), 11);
    }

    #[test]
    fn an_upright_axis_has_three_ticks() {
        for (range, height) in [
            ([-4.33, 4.33], 152.0),
            ([-32.5, 32.5], 80.0),
            ([0.0, 1.0], 60.0),
        ] {
            let ticks = upright_ticks(&Axis::edges("y", "", range), height);
            assert!((3..=6).contains(&ticks.len()), "{range:?}: {ticks:?}");
        }
    }

    #[test]
    fn a_level_axis_has_three_ticks_where_two_numbers_fit_beside_another() {
        for (range, length, first) in [([-16.5, 16.5], 40.0, "−15"), ([-0.15, 0.15], 58.0, "−0.1")]
        {
            let (ticks, _) = spaced_ticks(&Axis::edges("x", "", range), length);
            assert!(ticks.len() >= 3, "{range:?}: {ticks:?}");
            assert_eq!(ticks[0].text, first);
        }
    }

    #[test]
    fn a_logarithmic_axis_has_equal_factors_equally_far_apart() {
        let axis = |min, max| Axis {
            is_log: true,
            ..Axis::edges("*e*", "", [min, max])
        };
        let decades = axis(1e-4, 1.0);
        assert!((decades.fraction(1e-2) - 0.5).abs() < 1e-12); // rounding
        let texts = |axis: &Axis, most| {
            let ticks = axis.ticks(most);
            ticks.into_iter().map(|tick| tick.text).collect::<Vec<_>>()
        };
        assert_eq!(
            texts(&decades, 4.0),
            ["0.0001", "0.001", "0.01", "0.1", "1"]
        );
        assert_eq!(texts(&axis(0.09, 1.1), 4.0), ["0.1", "0.2", "0.5", "1"]);
        assert_eq!(texts(&axis(1e5, 1e6), 4.0), ["1e5", "2e5", "5e5", "1e6"]);
    }

    #[test]
    fn a_reversed_axis_counts_from_the_other_edge() {
        let axis = Axis::edges("row", "pixels", [0.0, 8.0]).reversed();
        let places = [0.0, 2.0, 8.0].map(|row| axis.fraction(row));
        assert!(
            places
                .iter()
                .zip([1.0, 0.75, 0.0])
                .all(|(a, b)| (a - b).abs() < 1e-12)
        ); // rounding
        assert!((axis.center(0, 4) - 7.0).abs() < 1e-12);
        let (ticks, _) = spaced_ticks(&axis, 200.0);
        assert!(ticks.len() >= 3);
    }

    #[test]
    fn small_and_large_numbers_share_a_power_of_ten() {
        let axis = Axis::edges("*L*", "W", [0.0, 3e-5]);
        assert_eq!(axis.exponent(), -5);
        assert_eq!(
            axis.ticks(3.0).last().map(|t| t.text.clone()),
            Some("3".into())
        );
        assert_eq!(axis.quantity.label(axis.exponent()), "*L* (10^{−5} W)");
    }

    #[test]
    fn degenerate_axes_still_have_ticks() {
        for range in [
            [0.0, 0.0],
            [3.0, 1.0],
            [f64::NAN, 1.0],
            [0.0, f64::INFINITY],
        ] {
            let count = texts(range, 4.0).len();
            assert!((1..10).contains(&count), "{range:?}: {count}");
        }
    }

    #[test]
    fn samples_sit_at_cell_centers() {
        let axis = Axis::centers("*ρ*", "", [-16.0, 16.0], 33);
        assert!((axis.center(0, 33) + 16.0).abs() < 1e-12); // rounding
        assert!((axis.center(16, 33)).abs() < 1e-12);
        assert!((axis.max - 16.5).abs() < 1e-12);
    }
}
