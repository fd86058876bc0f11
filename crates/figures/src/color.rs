//! Maps values to colors.

use crate::axis::{Axis, AxisQuantity};
use crate::grey::level;
use etendue_field::whole;
use ndarray::ArrayView2;
use serde::{Deserialize, Serialize};

/// The mapping of values to colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// A linear scale from 0 to the largest value shown; negative values are drawn as 0.
    Linear,
    /// A scale from `floor` to 0 dB, which shows 10 log₁₀ of a power divided by the largest
    /// reference value. Powers of 0 or less are below the floor.
    Decibel {
        /// Lower end of the color scale in decibels, a number below 0.
        floor: f64,
    },
    /// A linear scale from −`most` to `most`, with colors from blue to red.
    Signed {
        /// Upper end of the color scale, a number above 0.
        most: f64,
    },
    /// A scale of angles in degrees, once around the circle.
    Phase,
}

impl Scale {
    /// The colors of a quantity whose largest value is `peak`. Scales in decibels have
    /// their own label, `decibels`.
    pub(crate) fn shading(
        self,
        colors: Colors,
        quantity: &AxisQuantity,
        peak: f64,
        decibels: &str,
    ) -> Shading {
        let AxisQuantity { name, unit } = quantity;
        match self {
            Self::Linear => {
                let top = if peak > 0.0 { peak } else { 1.0 };
                Shading::linear(colors, Axis::edges(name, unit, [0.0, top]))
            }
            Self::Decibel { floor } => Shading::decibel(colors, decibels, floor, peak),
            Self::Signed { most } => {
                Shading::linear(Colors::Diverging, Axis::edges(name, unit, [-most, most]))
            }
            Self::Phase => Shading::phase(name),
        }
    }
}

/// A color as red, green and blue.
pub(crate) type Rgb = [u8; 3];

/// The grey that marks cells without a value (NaN). No color map contains this grey.
pub(crate) const NO_VALUE: Rgb = [158, 158, 158];

/// The colors of magnitudes, from dark to pale. The lightness of the colors increases evenly, so
/// the colors remain distinct when printed in grey.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Palette {
    /// The colors run from black through purple and orange to pale yellow.
    Inferno,
    /// The colors run from black through purple and pink to pale yellow.
    Magma,
    /// The colors run from purple through blue and green to yellow.
    Viridis,
    /// The colors run from blue through grey to yellow, and look nearly the same for all types of
    /// colour vision.
    Cividis,
    /// The colors run from black to white by the transfer curve of sRGB, as in photographs.
    Grey,
}

/// A color map over 0 ≤ t ≤ 1.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Colors {
    /// Colors from dark to pale.
    Sequential(Palette),
    /// Blue, white, red.
    Diverging,
    /// Cyclic colors, which run from pale through blue, dark and red back to pale.
    Cyclic,
}

/// Eight colors of the color circle, between which all other colors are interpolated.
const CIRCLE: [[f64; 3]; 8] = [
    [226.0, 217.0, 226.0],
    [150.0, 182.0, 203.0],
    [97.0, 118.0, 186.0],
    [89.0, 49.0, 140.0],
    [47.0, 20.0, 54.0],
    [120.0, 32.0, 76.0],
    [178.0, 91.0, 80.0],
    [205.0, 164.0, 145.0],
];

impl Colors {
    /// The default colors of magnitudes.
    pub(crate) const MAGNITUDES: Self = Self::Sequential(Palette::Inferno);

    pub(crate) fn at(self, t: f64) -> Rgb {
        let t = t.clamp(0.0, 1.0);
        let color = match self {
            Self::Sequential(Palette::Inferno) => colorous::INFERNO.eval_continuous(t),
            Self::Sequential(Palette::Magma) => colorous::MAGMA.eval_continuous(t),
            Self::Sequential(Palette::Viridis) => colorous::VIRIDIS.eval_continuous(t),
            Self::Sequential(Palette::Cividis) => colorous::CIVIDIS.eval_continuous(t),
            Self::Sequential(Palette::Grey) => return [level(t); 3],
            Self::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - t),
            Self::Cyclic => return on_circle(t),
        };
        color.as_array()
    }
}

/// The 256 colors of magnitudes, from dark to pale, and the 256 colors of differences,
/// from blue to red. Each color is given as red, green and blue.
#[must_use]
pub fn palettes() -> [Vec<u8>; 2] {
    [Colors::MAGNITUDES, Colors::Diverging].map(|colors| {
        let levels = (0..=255u8).map(|level| f64::from(level) / 255.0);
        levels.flat_map(|t| colors.at(t)).collect()
    })
}

/// The color at fraction `t` of the color circle.
fn on_circle(t: f64) -> Rgb {
    let place = t * CIRCLE.len() as f64;
    let before = whole(place);
    let share = place - before as f64;
    let [a, b] = [before, before + 1].map(|i| CIRCLE[i % CIRCLE.len()]);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a mean of two numbers of type u8"
    )]
    [0, 1, 2].map(|i| ((1.0 - share) * a[i] + share * b[i]).round() as u8)
}

/// A color for every value, shared by the panels and their color bar.
#[derive(Clone, Debug)]
pub(crate) struct Shading {
    pub(crate) colors: Colors,
    /// The axis of the color bar, from its lower to its upper end.
    pub(crate) axis: Axis,
    /// The power at 0 dB; `None` on linear scales.
    reference: Option<f64>,
    /// Whether any values are below the range of the colors, and whether any are above it.
    pub(crate) beyond: [bool; 2],
}

/// The smallest part of a range of colors that is seen.
const VISIBLE: f64 = 0.01;

impl Shading {
    /// A shading with linear colors on an axis.
    pub(crate) fn linear(colors: Colors, axis: Axis) -> Self {
        Self {
            colors,
            axis,
            reference: None,
            beyond: [false; 2],
        }
    }

    /// A shading for angles in degrees, once around the circle.
    pub(crate) fn phase(name: &str) -> Self {
        Self::linear(
            Colors::Cyclic,
            Axis::edges(name, "degrees", [-180.0, 180.0]),
        )
    }

    /// A shading in decibels below `peak`, on an axis from `floor` to 0.
    pub(crate) fn decibel(colors: Colors, name: &str, floor: f64, peak: f64) -> Self {
        let floor = if floor < 0.0 { floor } else { -60.0 };
        Self {
            colors,
            axis: Axis::edges(name, "dB", [floor, 0.0]),
            reference: Some(if peak > 0.0 { peak } else { 1.0 }),
            beyond: [false; 2],
        }
    }

    /// The same shading. If any of `values` are beyond its range by a visible part of it, its ends
    /// are marked.
    pub(crate) fn showing(mut self, values: ArrayView2<'_, f64>) -> Self {
        let [low, high] = self.axis.range();
        for value in values {
            let level = self.level(*value);
            self.beyond[0] |= level < low - VISIBLE * (high - low);
            self.beyond[1] |= level > high + VISIBLE * (high - low);
        }
        self
    }

    pub(crate) fn color(&self, value: f64) -> Rgb {
        if value.is_nan() {
            return NO_VALUE;
        }
        self.colors.at(self.axis.fraction(self.level(value)))
    }

    /// Converts a value to a position on the axis of the color bar.
    fn level(&self, value: f64) -> f64 {
        match self.reference {
            None => value,
            // A power that is negative after noise removal is below any floor of the color scale.
            Some(reference) => 10.0 * libm::log10((value / reference).max(0.0)),
        }
    }
}

/// The largest finite value, or 0 if no value is positive.
pub(crate) fn largest(values: ArrayView2<'_, f64>) -> f64 {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    finite.fold(0.0, f64::max)
}

/// Checks whether any cell has no value.
pub(crate) fn has_gaps(values: ArrayView2<'_, f64>) -> bool {
    values.iter().any(|v| v.is_nan())
}

/// "#rrggbb".
pub(crate) fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn powers_below_the_floor_and_negative_ones_share_its_color() {
        let shading = Shading::decibel(Colors::MAGNITUDES, "", -60.0, 2.0);
        let floor = Colors::MAGNITUDES.at(0.0);
        for power in [2e-6, 1e-9, 0.0, -1.0, f64::NEG_INFINITY] {
            assert_eq!(shading.color(power), floor, "{power}");
        }
        assert_eq!(shading.color(2.0), Colors::MAGNITUDES.at(1.0));
        assert_eq!(shading.color(f64::INFINITY), Colors::MAGNITUDES.at(1.0));
        assert_ne!(shading.color(2e-5), floor);
    }

    #[test]
    fn the_diverging_map_is_neutral_at_zero_and_warm_above() {
        let shading = Shading::linear(Colors::Diverging, Axis::edges("", "", [-4.0, 4.0]));
        let [r, g, b] = shading.color(0.0);
        assert!(r.min(g).min(b) > 235, "nearly white");
        let ([hot, _, cold], [r, _, b]) = (shading.color(4.0), shading.color(-4.0));
        assert!(hot > cold && b > r);
        assert_eq!(shading.color(9.0), shading.color(4.0));
    }

    #[test]
    fn the_circle_of_phases_is_closed_and_turns_evenly() {
        let at = |degrees: f64| Shading::phase("").color(degrees).map(f64::from);
        let apart =
            |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        assert!(apart(at(-180.0), at(180.0)) < 0.5);
        for degrees in -180..180 {
            let step = apart(at(f64::from(degrees)), at(f64::from(degrees + 1)));
            assert!(step < 3.0, "{step} at {degrees}"); // 77 in 45 degrees, and rounding
        }
        assert!(apart(at(-90.0), at(90.0)) > 50.0, "signs are told apart");
    }

    #[test]
    fn gaps_are_grey_and_not_saturation() {
        let shading = Shading::linear(Colors::MAGNITUDES, Axis::edges("", "", [0.0, 1.0]));
        assert_eq!(shading.color(f64::NAN), NO_VALUE);
        let values = array![[f64::NAN, 0.5], [0.0, 1.0]];
        assert_eq!(
            shading.clone().showing(values.view()).beyond,
            [false, false]
        );
        let values = array![[f64::NAN, 0.5], [-0.1, 1.1]];
        assert_eq!(shading.showing(values.view()).beyond, [true, true]);
        assert!(has_gaps(values.view()));
    }
}
