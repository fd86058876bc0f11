//! The rows of pictures under a strip's cut.

use super::{Guide, Row, Strip};
use crate::axis::Axis;
use crate::bar;
use crate::color::{Colors, Shading, has_gaps, hex, largest};
use crate::figure::Error;
use crate::panel::Panel;
use crate::style::{HEAD_TEXT, LABEL_BASELINE, SOFT, TICK_TEXT};
use crate::svg::{Anchor, Area, Stroke, Svg, Text};

/// Left edge of the first picture: row name, axis label, tick texts.
pub(super) const LEFT: f64 = 92.0;
/// Between the lower edge of a picture and the upper edge of the one below.
pub(super) const ROW_GAP: f64 = LABEL_BASELINE + 24.0;
/// From the left edge of the first picture to the row name.
const ROW_NAME: f64 = 68.0;

/// The dashed lines: on dark colors by themselves, on pale ones by what is under them.
const GUIDE: [Stroke; 2] = [
    Stroke {
        color: "#10304a",
        width: 2.6,
        dash: GUIDE_DASH,
    },
    Stroke {
        color: "#7fe0ff",
        width: 1.0,
        dash: GUIDE_DASH,
    },
];
const GUIDE_DASH: &str = "4 5";

/// Horizontal measures.
#[derive(Debug)]
pub(super) struct Layout {
    /// Side of a picture.
    pub(super) panel: f64,
    /// Between two pictures.
    pub(super) gap: f64,
    /// Left edge of the first picture.
    start: f64,
    /// Width of the cut and of all pictures.
    pub(super) inner: f64,
    /// Rows in which all columns have the same y axis.
    shared: Vec<Row>,
}

impl Layout {
    pub(super) fn new(strip: &Strip<'_>) -> Self {
        let count = strip.columns.len().max(1) as f64;
        let rows = Row::of(strip);
        let is_shared = |row: &Row| {
            let axes: Vec<&Axis> = strip.columns.iter().map(|c| &row.picture(c).y).collect();
            axes.windows(2).all(|pair| pair[0] == pair[1])
        };
        let shared: Vec<Row> = rows.iter().copied().filter(is_shared).collect();
        let gap = if shared == rows { 34.0 } else { 76.0 };
        let panel = ((900.0 - gap * (count - 1.0)) / count)
            .clamp(140.0, 190.0)
            .floor();
        let pictures = count * panel + (count - 1.0) * gap;
        let inner = pictures.max(600.0);
        Self {
            panel,
            gap,
            start: LEFT + 0.5 * (inner - pictures),
            inner,
            shared,
        }
    }

    fn left(&self, column: usize) -> f64 {
        self.start + column as f64 * (self.panel + self.gap)
    }

    fn area(&self, column: usize, y: f64) -> Area {
        Area {
            x: self.left(column),
            y,
            width: self.panel,
            height: self.panel,
        }
    }

    fn is_shared(&self, row: Row) -> bool {
        self.shared.contains(&row)
    }

    pub(super) fn middle(&self, column: usize) -> f64 {
        self.left(column) + 0.5 * self.panel
    }
}

/// The colors of a row, for pictures whose largest value is `peak`; the bar is that of a peak of 1.
fn shading(strip: &Strip<'_>, row: Row, peak: f64) -> Shading {
    let name = "relative to each peak";
    match row {
        Row::LightField => {
            let top = if peak > 0.0 { peak } else { 1.0 };
            Shading::linear(Colors::Sequential, Axis::edges(name, "", [0.0, top]))
        }
        Row::Spectrum | Row::Predicted => Shading::decibel(name, strip.floor, peak),
    }
}

/// The pictures of a row, its name and their common color bar.
pub(super) fn draw_row(
    svg: &mut Svg,
    strip: &Strip<'_>,
    layout: &Layout,
    row: Row,
    y: f64,
) -> Result<(), Error> {
    let mut bar = shading(strip, row, 1.0);
    for (index, column) in strip.columns.iter().enumerate() {
        let picture = row.picture(column);
        let panel = Panel {
            area: layout.area(index, y),
            x: &picture.x,
            y: &picture.y,
            label_y: index == 0 || !layout.is_shared(row),
        };
        let shading = shading(strip, row, largest(picture.values)).showing(picture.values);
        bar.beyond[0] |= shading.beyond[0];
        panel.heat_map(svg, picture.values, &shading)?;
        if row != Row::LightField {
            guides(svg, &panel, &column.guides);
        }
        panel.axes(svg);
    }
    if let Some(last) = strip.columns.len().checked_sub(1) {
        let area = layout.area(last, y);
        let at = [layout.start - ROW_NAME, area.middle()[1]];
        let style = Text::new(at, HEAD_TEXT, Anchor::Middle).bold().upwards();
        svg.text(style, row.name());
        bar::draw(svg, &bar, area.right() + 12.0, area)?;
    }
    Ok(())
}

/// The dashed lines over a spectrum.
fn guides(svg: &mut Svg, panel: &Panel<'_>, guides: &[Guide]) {
    if guides.is_empty() {
        return;
    }
    svg.clipped(panel.area, |svg| {
        for guide in guides {
            let ends = panel.x.range().map(|rho| {
                let nu = guide.through[1] + guide.slope * (rho - guide.through[0]);
                panel.point(rho, nu)
            });
            for stroke in GUIDE {
                svg.line(ends[0], ends[1], stroke);
            }
        }
    });
}

/// Verdicts, the key to the dashed lines and to cells without a value; returns the lower edge of the figure.
pub(super) fn footer(svg: &mut Svg, strip: &Strip<'_>, layout: &Layout, baseline: f64) -> f64 {
    let mut y = baseline;
    if strip
        .columns
        .iter()
        .any(|column| !column.verdict.is_empty())
    {
        y += 21.0;
        for (index, column) in strip.columns.iter().enumerate() {
            let room = layout.panel + layout.gap - 6.0;
            let style = Text::new([layout.middle(index), y], TICK_TEXT, Anchor::Middle);
            svg.fitted(style, &column.verdict, room);
        }
    }
    let guided = strip.columns.iter().any(|column| !column.guides.is_empty());
    let gaps = strip
        .columns
        .iter()
        .any(|c| has_gaps(c.light_field.values) || has_gaps(c.spectrum.values));
    if guided || gaps {
        y += 24.0;
    }
    if guided {
        guide_key(svg, [layout.start, y]);
    }
    if gaps {
        bar::gap_key(svg, LEFT + layout.inner, y);
    }
    y + 14.0
}

fn guide_key(svg: &mut Svg, [x, y]: [f64; 2]) {
    let swatch = Area {
        x,
        y: y - 10.0,
        width: 34.0,
        height: 12.0,
    };
    svg.fill(swatch, &hex(Colors::Sequential.at(0.0)));
    for stroke in GUIDE {
        svg.line([x, y - 4.0], [swatch.right(), y - 4.0], stroke);
    }
    let style = Text::new([swatch.right() + 7.0, y], TICK_TEXT, Anchor::Start).fill(SOFT);
    svg.text(style, "predicted shear");
}
