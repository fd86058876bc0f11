//! Color bars.

use crate::color::{NO_VALUE, Shading, hex};
use crate::figure::Error;
use crate::image::color_strip;
use crate::sizes::{LABEL_TEXT, LEAST_TEXT, SOFT, TICK, TICK_TEXT};
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};
use crate::text::{plain, width};

/// Width of the color bar without its texts.
pub(crate) const WIDTH: f64 = 12.0;
/// Height of the pointed end that marks values beyond the range of the colors.
const POINT: f64 = 9.0;

/// Draws the bar of `shading` to the right of a panel, with its left edge at `x` and as high as
/// `panel`. The label of the color bar may be longer than the bar by `overhang`.
pub(crate) fn draw(
    svg: &mut Svg,
    shading: &Shading,
    x: f64,
    panel: Area,
    overhang: f64,
) -> Result<(), Error> {
    let [low, high] = shading.beyond;
    let top = panel.y + if high { POINT } else { 0.0 };
    let bottom = panel.bottom() - if low { POINT } else { 0.0 };
    let area = Area::new([x, top], [WIDTH, bottom - top]);
    if let Some(href) = color_strip(shading)? {
        svg.image(area, &href);
    }
    outline(svg, shading, area);
    scale(svg, shading, area, overhang);
    Ok(())
}

/// Draws the frame of a color bar, with a pointed end where values exceed the range of the
/// colors.
fn outline(svg: &mut Svg, shading: &Shading, area: Area) {
    let [middle, _] = area.middle();
    let [low, high] = shading.beyond;
    let mut frame = vec![[area.x, area.bottom()], [area.x, area.y]];
    if high {
        let tip = [middle, area.y - POINT];
        let point = [[area.x, area.y], tip, [area.right(), area.y]];
        svg.polygon(&point, &hex(shading.colors.at(1.0)));
        frame.push(tip);
    }
    frame.extend([[area.right(), area.y], [area.right(), area.bottom()]]);
    if low {
        let tip = [middle, area.bottom() + POINT];
        let point = [[area.x, area.bottom()], tip, [area.right(), area.bottom()]];
        svg.polygon(&point, &hex(shading.colors.at(0.0)));
        frame.push(tip);
    }
    frame.push([area.x, area.bottom()]);
    svg.polyline(&frame, Stroke::FRAME);
}

/// Draws the ticks and the label to the right of a color bar.
fn scale(svg: &mut Svg, shading: &Shading, area: Area, overhang: f64) {
    let axis = &shading.axis;
    let mut widest: f64 = 0.0;
    for tick in axis.ticks((area.height / 24.0).min(6.0)) {
        let at = area.bottom() - axis.fraction(tick.value) * area.height;
        svg.line([area.right(), at], [area.right() + TICK, at], Stroke::FRAME);
        let place = [area.right() + TICK + 3.0, at + 4.0];
        svg.text(TextStyle::new(place, TICK_TEXT, Anchor::Start), &tick.text);
        widest = widest.max(width(&tick.text, TICK_TEXT));
    }
    let at = [area.right() + TICK + 3.0 + widest + 16.0, area.middle()[1]];
    let style = TextStyle::new(at, LABEL_TEXT, Anchor::Middle).upwards();
    let room = area.height + overhang;
    let mut label = axis.quantity.label(axis.exponent());
    // If the name does not fit beside a low picture, only the unit is written.
    if !axis.quantity.unit.is_empty() && width(&plain(&label), LEAST_TEXT) > room {
        label.clone_from(&axis.quantity.unit);
    }
    svg.fitted(style, &label, room);
}

/// Draws the key for cells without a value; the key ends at `right` on the baseline `y`.
pub(crate) fn gap_key(svg: &mut Svg, right: f64, y: f64) {
    let text = "no value";
    let style = TextStyle::new([right, y], TICK_TEXT, Anchor::End).fill(SOFT);
    svg.text(style, text);
    let left = right - width(text, TICK_TEXT) - 18.0;
    let swatch = Area::new([left, y - 9.0], [10.0; 2]);
    svg.fill(swatch, &hex(NO_VALUE));
    svg.frame(swatch);
}
