//! Lays out a grid of pictures, with its columns split into blocks that fit the page width.

use crate::axis::COMFORTABLE;
use crate::bar;
use crate::color::{Shading, has_gaps, largest};
use crate::figure::Error;
use crate::panel::Panel;
use crate::picture::{Guide, Picture, PlateRow};
use crate::sizes::{HEAD_TEXT, LABEL_BASELINE};
use crate::style::Style;
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};

/// Left edge of the first picture. The row name, the axis label and the tick texts are to the left
/// of the first picture.
pub(crate) const LEFT: f64 = 75.0;
/// Width to the right of the last picture, for the color bars.
pub(crate) const RIGHT: f64 = 81.0;
/// Gaps between pictures that are side by side. The first gap is used if the right picture has no
/// numbers beside its axis, and the second gap if the right picture has such numbers.
pub(crate) const GAPS: [f64; 2] = [26.0, 56.0];
/// The gap that replaces the first of [`GAPS`] if many pictures are side by side.
const CLOSE: f64 = 16.0;
/// Gaps between a picture and the picture below. The first gap is used if the two pictures share
/// the x axis, and the second gap if they do not.
const ROW_GAPS: [f64; 2] = [14.0, LABEL_BASELINE + 18.0];
/// Distance from the left edge of the first picture to the row name.
const ROW_NAME: f64 = 63.0;

/// The two strokes of a line over spectra. The upper stroke is visible on dark colors,
/// and the lower stroke on pale colors.
pub(crate) fn guide_strokes(is_across: bool) -> [Stroke; 2] {
    let color = if is_across { "#8dff9c" } else { "#7fe0ff" };
    [Stroke::solid("#10304a", 3.2), Stroke::solid(color, 1.4)]
}

/// A line over a spectrum is drawn as two strokes at its ends. This is the length of a stroke, as a
/// fraction of the picture's side. The predicted ridge stays visible between the two strokes.
const GUIDE_END: f64 = 0.1;
/// Minimum distance between the texts of two adjacent pictures.
const TEXT_GAP: f64 = 4.0;
/// Maximum number of pictures side by side.
const MAX_COLUMNS: usize = 8;

/// A column of pictures with its position.
#[derive(Clone, Copy, Debug)]
struct PlacedColumn {
    column: usize,
    left: f64,
}

/// The width between the left edge of the first picture and the color bars.
pub(crate) fn inner(style: &Style) -> f64 {
    style.page() - LEFT - RIGHT
}

/// Rows of pictures laid out for a page.
#[derive(Debug)]
pub(crate) struct PageGrid<'b, 'a> {
    rows: &'b [PlateRow<'a>],
    style: Style,
    /// Width of a picture.
    pub(crate) side: f64,
    /// Gap between adjacent pictures, if the right picture has no numbers beside its axis.
    near: f64,
    /// Height of a picture divided by its width.
    shape: f64,
    blocks: Vec<Vec<PlacedColumn>>,
}

impl<'b, 'a> PageGrid<'b, 'a> {
    /// Lays out rows of `columns` pictures. The width of the pictures is between `least` and
    /// `largest`, if such a width fits. All pictures have the shape of the first picture.
    ///
    /// # Panics
    /// If a row does not have a picture for each column.
    pub(crate) fn new(
        rows: &'b [PlateRow<'a>],
        columns: usize,
        [least, largest]: [f64; 2],
        style: &Style,
    ) -> Self {
        // Maximum picture widths. The first maximum holds for one block, and the second for several
        // blocks, because several blocks of wide pictures would make a long page.
        const MAX_SIDES: [f64; 2] = [190.0, 112.0];
        for row in rows {
            assert_eq!(row.pictures.len(), columns, "pictures of {}", row.name);
        }
        let mut pictures = rows.iter().flat_map(|row| &row.pictures);
        let shape = pictures.next().map_or(1.0, Picture::shape);
        let mut grid = Self {
            rows,
            style: *style,
            side: 0.0,
            near: GAPS[0],
            shape,
            blocks: Vec::new(),
        };
        for count in columns.div_ceil(MAX_COLUMNS).max(1)..=columns.max(1) {
            let length = columns.div_ceil(count).max(1);
            let starts: Vec<usize> = (0..columns).step_by(length).collect();
            let most = largest.min(MAX_SIDES[usize::from(count > 1)] / shape);
            for near in [GAPS[0], CLOSE] {
                grid.near = near;
                let gaps = |start: &usize| -> f64 {
                    let after = start + 1..(start + length).min(columns);
                    after.map(|column| grid.gap(column)).sum()
                };
                let widest = starts.iter().map(gaps).fold(0.0, f64::max);
                grid.side = ((inner(style) - widest) / length as f64).min(most).floor();
                if grid.side >= COMFORTABLE {
                    break;
                }
            }
            if grid.side >= least || length == 1 {
                // Pictures of pixels keep their shape; others become lower, so that the texts of
                // a column keep their room.
                if rows.iter().any(PlateRow::counts_pixels) {
                    grid.side = (style.scale * grid.side).floor();
                } else {
                    grid.shape *= style.scale;
                }
                grid.blocks = starts
                    .iter()
                    .map(|start| grid.places(*start..(start + length).min(columns)))
                    .collect();
                break;
            }
        }
        grid
    }

    fn places(&self, columns: std::ops::Range<usize>) -> Vec<PlacedColumn> {
        let mut left = LEFT;
        let first = columns.start;
        let place = |column| {
            if column > first {
                left += self.side + self.gap(column);
            }
            PlacedColumn { column, left }
        };
        columns.map(place).collect()
    }

    /// The height of a picture.
    fn height(&self) -> f64 {
        self.shape * self.side
    }

    /// Checks whether the y axis of a picture differs from the y axis of the picture to its left.
    fn differs(row: &PlateRow<'_>, column: usize) -> bool {
        row.pictures[column].y != row.pictures[column - 1].y
    }

    /// The gap before a column.
    fn gap(&self, column: usize) -> f64 {
        let differs = self.rows.iter().any(|row| Self::differs(row, column));
        if differs { GAPS[1] } else { self.near }
    }

    /// The number of blocks, which are stacked on the page.
    pub(crate) fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// The columns of a block, each with its centre and the width available for a text
    /// below it.
    pub(crate) fn columns(&self, block: usize) -> impl Iterator<Item = (usize, f64, f64)> {
        let places = &self.blocks[block];
        let room = move |i: usize| {
            let near = &places[i.saturating_sub(1)..(i + 2).min(places.len())];
            let steps = near.windows(2).map(|pair| pair[1].left - pair[0].left);
            steps.fold(self.side + GAPS[1], f64::min) - TEXT_GAP
        };
        let middles = places.iter().enumerate();
        middles.map(move |(i, place)| (place.column, place.left + 0.5 * self.side, room(i)))
    }

    /// The width of the widest block.
    pub(crate) fn width(&self) -> f64 {
        let ends = self.blocks.iter().filter_map(|block| block.last());
        let right = ends
            .map(|place| place.left + self.side)
            .fold(LEFT, f64::max);
        right - LEFT
    }

    /// Checks whether the pictures of a row share their x axes with the pictures of the row
    /// below.
    fn shares_x(&self, row: usize) -> bool {
        self.rows.get(row + 1).is_some_and(|below| {
            let mut both = self.rows[row].pictures.iter().zip(&below.pictures);
            both.all(|(a, b)| a.x == b.x)
        })
    }

    /// The width over which the x label of a picture is centred. If the pictures of a block
    /// are narrow and have the same axis, this width is the width of the entire block. Returns
    /// `None` if the picture shares the label of a picture further to the left.
    fn labelled_across(&self, row: usize, places: &[PlacedColumn], i: usize) -> Option<f64> {
        let x = |place: &PlacedColumn| &self.rows[row].pictures[place.column].x;
        let is_same = places.iter().all(|place| x(place) == x(&places[0]));
        if self.side >= COMFORTABLE || !is_same {
            return Some(self.side);
        }
        let last = places.last().filter(|_| i == 0)?;
        Some(last.left + self.side - places[0].left)
    }

    /// The height over which the y label of a picture is centred. The height includes all
    /// pictures further down that have the same axes as the picture. Returns `None` if the picture
    /// shares the label of a picture further up.
    fn labelled_down(&self, row: usize, column: usize) -> Option<f64> {
        let y = |row: usize| &self.rows[row].pictures[column].y;
        let is_same = |above: usize| self.shares_x(above) && y(above) == y(above + 1);
        if row > 0 && is_same(row - 1) {
            return None;
        }
        let more = (row..self.rows.len()).take_while(|above| is_same(*above));
        Some(self.height() + more.count() as f64 * (self.height() + ROW_GAPS[0]))
    }

    /// Draws a block with its pictures starting at `top`; returns the lowest baseline.
    pub(crate) fn draw(&self, svg: &mut Svg, block: usize, top: f64) -> Result<f64, Error> {
        let mut y = top;
        // The rows that share a color bar, and the extent of this bar.
        let mut bars: Vec<(Shading, Area)> = Vec::new();
        let mut closest = ROW_GAPS[1];
        let places = &self.blocks[block];
        let Some(last) = places.last() else {
            return Ok(top);
        };
        for (index, row) in self.rows.iter().enumerate() {
            let shading = self.row(svg, index, places, y)?;
            let area = Area::new([last.left, y], [self.side, self.height()]);
            match bars.last_mut() {
                Some((bar, whole)) if index > 0 && row.has_bar_of(&self.rows[index - 1]) => {
                    bar.beyond = [0, 1].map(|end| bar.beyond[end] || shading.beyond[end]);
                    whole.height = area.bottom() - whole.y;
                }
                _ => {
                    if index > 0 {
                        closest = closest.min(ROW_GAPS[usize::from(!self.shares_x(index - 1))]);
                    }
                    bars.push((shading, area));
                }
            }
            y += self.height() + ROW_GAPS[usize::from(!self.shares_x(index))];
        }
        for (shading, area) in bars {
            bar::draw(svg, &shading, area.right() + 10.0, area, closest - 2.0)?;
        }
        Ok(y - ROW_GAPS[1] + LABEL_BASELINE)
    }

    /// The height that a text beside a row may have beyond the row, without those of other rows.
    fn beside(&self, row: usize) -> f64 {
        let gap = |above: usize| ROW_GAPS[usize::from(!self.shares_x(above))];
        let above = row.checked_sub(1).map_or(ROW_GAPS[1], gap);
        above.min(gap(row)) - 2.0 * TEXT_GAP
    }

    /// The largest value of the rows that share a color bar with the row `index`.
    fn peak(&self, index: usize) -> f64 {
        let rows = self.rows.iter().filter(|r| r.has_bar_of(&self.rows[index]));
        let peaks = rows.flat_map(|row| &row.pictures);
        let peaks = peaks.map(|picture| largest(picture.drawn()));
        peaks.fold(0.0, f64::max)
    }

    /// Draws the pictures of a row and the row's name; returns the colors of the row's color bar.
    fn row(
        &self,
        svg: &mut Svg,
        index: usize,
        places: &[PlacedColumn],
        y: f64,
    ) -> Result<Shading, Error> {
        let row = &self.rows[index];
        let highest = self.peak(index);
        let mut bar = row.shading(if row.shared { highest } else { 1.0 }, &self.style);
        for (i, place) in places.iter().enumerate() {
            let picture = &row.pictures[place.column];
            let values = picture.drawn();
            let area = Area::new([place.left, y], [self.side, self.height()]);
            let usual = Panel::new(area, &picture.x, &picture.y);
            let panel = Panel {
                label_x: !self.shares_x(index),
                label_y: i == 0 || Self::differs(row, place.column),
                labelled: [
                    self.labelled_across(index, places, i),
                    self.labelled_down(index, place.column),
                ],
                overhang: self.beside(index).max(usual.overhang),
                ..usual
            };
            let peak = if row.shared { highest } else { largest(values) };
            let shading = row.shading(peak, &self.style).showing(values);
            bar.beyond = [0, 1].map(|end| bar.beyond[end] || shading.beyond[end]);
            panel.heat_map(svg, values, &shading)?;
            draw_guides(svg, &panel, &picture.guides);
            panel.axes(svg);
        }
        let at = [LEFT - ROW_NAME, y + 0.5 * self.height()];
        let style = TextStyle::new(at, HEAD_TEXT, Anchor::Middle)
            .bold()
            .upwards();
        let room = |index: usize| self.height() + self.beside(index);
        let names = self.rows.iter().enumerate();
        let style = style.fitting(names.map(|(i, row)| (row.name, room(i))));
        svg.fitted(style, row.name, room(index));
        Ok(bar)
    }

    /// Checks whether any cell of any picture has no value.
    pub(crate) fn has_gaps(&self) -> bool {
        let mut pictures = self.rows.iter().flat_map(|row| &row.pictures);
        pictures.any(|picture| has_gaps(picture.drawn()))
    }
}

fn draw_guides(svg: &mut Svg, panel: &Panel<'_>, guides: &[Guide]) {
    let length = GUIDE_END * panel.area.width.min(panel.area.height);
    for guide in guides {
        let Some([start, end]) = inside(panel, guide) else {
            continue;
        };
        for [from, to] in ends(start, end, length) {
            for stroke in guide_strokes(guide.is_across) {
                svg.line(from, to, stroke);
            }
        }
    }
}

/// The ends of the part of a line that is inside a picture; `None` if the line does not
/// cross the picture.
fn inside(panel: &Panel<'_>, guide: &Guide) -> Option<[[f64; 2]; 2]> {
    let [left, right] = panel.x.range();
    let [low, high] = panel.y.range();
    let at = |rho: f64| guide.through[1] + guide.slope * (rho - guide.through[0]);
    let mut rhos = [left, right];
    if guide.slope != 0.0 {
        let mut crossings =
            [low, high].map(|nu| guide.through[0] + (nu - guide.through[1]) / guide.slope);
        crossings.sort_by(f64::total_cmp);
        rhos = [left.max(crossings[0]), right.min(crossings[1])];
    }
    let middle = at(0.5 * (rhos[0] + rhos[1]));
    let is_seen = rhos[0] < rhos[1] && (low..=high).contains(&middle);
    is_seen.then(|| rhos.map(|rho| panel.point(rho, at(rho))))
}

/// Returns short strokes at the two ends of a line.
pub(crate) fn ends(start: [f64; 2], end: [f64; 2], length: f64) -> [[[f64; 2]; 2]; 2] {
    let along = [0, 1].map(|i| end[i] - start[i]);
    let share = length / libm::hypot(along[0], along[1]).max(2.0 * length);
    let from = |point: [f64; 2], share: f64| [point, [0, 1].map(|i| point[i] + share * along[i])];
    [from(start, share), from(end, -share)]
}
