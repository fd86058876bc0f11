//! Draws a heat map in its frame, with ticks and axis labels.

use crate::axis::{Axis, COMFORTABLE, spaced_ticks, upright_ticks};
use crate::color::Shading;
use crate::figure::Error;
use crate::image::heat_map;
use crate::sizes::{LABEL_BASELINE, LABEL_TEXT, TICK, TICK_BASELINE, TICK_TEXT};
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};
use crate::text::width;
use ndarray::ArrayView2;

/// An axis label may be longer than its panel by these lengths, along x and y.
const OVERHANG: [f64; 2] = [24.0, 13.0];
/// If the next panel is near, an axis label may be longer than its panel along x by this length.
const CLOSE_OVERHANG: f64 = 10.0;

/// The position of a heat map, and the texts around it.
#[derive(Debug)]
pub(crate) struct Panel<'a> {
    pub(crate) area: Area,
    pub(crate) x: &'a Axis,
    pub(crate) y: &'a Axis,
    /// Whether tick texts and labels are written; ticks are always drawn.
    pub(crate) label_x: bool,
    pub(crate) label_y: bool,
    /// The lengths along which the x label and the y label are centred, measured from the left and
    /// from the top of the panel. These lengths may include panels to the right and below. A label
    /// whose length is `None` is not written.
    pub(crate) labelled: [Option<f64>; 2],
    /// The y label may be longer than its length by this length.
    pub(crate) overhang: f64,
}

impl<'a> Panel<'a> {
    /// A panel with labels along both of its axes.
    pub(crate) fn new(area: Area, x: &'a Axis, y: &'a Axis) -> Self {
        Self {
            area,
            x,
            y,
            label_x: true,
            label_y: true,
            labelled: [Some(area.width), Some(area.height)],
            overhang: OVERHANG[1],
        }
    }

    /// Draws the heat map of `values` [x, y].
    pub(crate) fn heat_map(
        &self,
        svg: &mut Svg,
        values: ArrayView2<'_, f64>,
        shading: &Shading,
    ) -> Result<(), Error> {
        if let Some(href) = heat_map(values, shading)? {
            svg.image(self.area, &href);
        }
        Ok(())
    }

    /// Draws the frame, the ticks and the labels over the heat map.
    pub(crate) fn axes(&self, svg: &mut Svg) {
        svg.frame(self.area);
        self.x_axis(svg);
        self.y_axis(svg);
    }

    /// The position in the drawing of the point (x, y) of the axes.
    pub(crate) fn point(&self, x: f64, y: f64) -> [f64; 2] {
        [
            self.area.x + self.x.fraction(x) * self.area.width,
            self.area.bottom() - self.y.fraction(y) * self.area.height,
        ]
    }

    /// Draws only the frame and the y axis, for a panel without an x axis.
    pub(crate) fn frame(&self, svg: &mut Svg) {
        svg.frame(self.area);
        self.y_axis(svg);
    }

    fn x_axis(&self, svg: &mut Svg) {
        let bottom = self.area.bottom();
        let (ticks, size) = spaced_ticks(self.x, self.area.width);
        for tick in ticks {
            let [at, _] = self.point(tick.value, 0.0);
            svg.line([at, bottom], [at, bottom + TICK], Stroke::FRAME);
            if !self.label_x {
                continue;
            }
            let style = TextStyle::new([at, bottom + TICK_BASELINE], size, Anchor::Middle);
            svg.text(style, &tick.text);
        }
        let Some(length) = self.labelled[0].filter(|_| self.label_x) else {
            return;
        };
        let middle = self.area.x + 0.5 * length;
        let style = TextStyle::new(
            [middle, bottom + LABEL_BASELINE],
            LABEL_TEXT,
            Anchor::Middle,
        );
        let label = self.x.quantity.label(self.x.exponent());
        let overhang = if length < COMFORTABLE {
            CLOSE_OVERHANG
        } else {
            OVERHANG[0]
        };
        svg.fitted(style, &label, length + overhang);
    }

    /// Draws the ticks and the label to the left of the panel.
    pub(crate) fn y_axis(&self, svg: &mut Svg) {
        let left = self.area.x;
        let mut widest: f64 = 0.0;
        for tick in upright_ticks(self.y, self.area.height) {
            let [_, at] = self.point(0.0, tick.value);
            svg.line([left - TICK, at], [left, at], Stroke::FRAME);
            if self.label_y {
                let style = TextStyle::new([left - TICK - 3.0, at + 4.0], TICK_TEXT, Anchor::End);
                svg.text(style, &tick.text);
                widest = widest.max(width(&tick.text, TICK_TEXT));
            }
        }
        if let Some(height) = self.labelled[1].filter(|_| self.label_y) {
            let middle = self.area.y + 0.5 * height;
            let at = [left - TICK - 3.0 - widest - 8.0, middle];
            let style = TextStyle::new(at, LABEL_TEXT, Anchor::Middle).upwards();
            let label = self.y.quantity.label(self.y.exponent());
            svg.fitted(style, &label, height + self.overhang);
        }
    }
}
