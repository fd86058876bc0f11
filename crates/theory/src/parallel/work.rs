//! Estimates the work of a prediction before the prediction is computed.
//!
//! The estimate counts the corners, nodes, shapes and frequencies that the prediction uses. With
//! the estimate, a scene whose prediction would take days can be refused immediately. Each kind of
//! prediction has its own estimate; this file contains the estimate for the closed form.

use crate::Chain;
use crate::Model;
use crate::parallel::chain::ChainSegment;
use crate::parallel::disc_resolution::DiscResolution;
use crate::parallel::expansion::{AxisSection, Expansion};
use crate::parallel::projection::nodes_of_cells;
use crate::parallel::slices::fineness;
use crate::parallel::slope::Slope;
use crate::work::PredictionWork;
use etendue_field::{CosineTerm, Mask, Profile, ProjectionGrid, SliceGrid, Window};

/// Maximum number of products of shapes in different planes that are counted. With more products,
/// the prediction would take far too long.
pub(crate) const MOST_PARTS: usize = 500_000;

/// Estimates the work of the slices, their derivatives and the projection of a chain.
pub(crate) fn work(
    chain: &Chain,
    window: &Window,
    grid: &SliceGrid,
    picture: &ProjectionGrid,
) -> PredictionWork {
    let path = chain.path();
    let derivatives = chain.parameters().len() as f64;
    if let Some(receiver) = path.receiver() {
        return receiver.work(window, grid, picture, derivatives);
    }
    // The cosine series of a factor of slope has few terms, but its product with gratings may have
    // many terms.
    let slope = Slope::new([&window.u, &window.v], path.slope_power());
    let of = |fineness: &DiscResolution| Expansion::within(&path, window, &fineness.0, MOST_PARTS);
    let Some(single) = of(&DiscResolution::single(&path)) else {
        return too_many();
    };
    let round = path.has_discs().then(|| {
        let strips = DiscResolution::for_projection(&path, window, picture.bins);
        Some([of(&fineness(&path, window, grid))?, of(&strips)?])
    });
    let [slices, strips] = match &round {
        None => [&single; 2],
        Some(Some(round)) => round.each_ref(),
        Some(None) => return too_many(),
    };
    let waves = [0, 1].map(|axis| waves(&path, window, &slope, axis));
    // For the error estimate, a finer rule splits discs into (5/4)⁴ times as many terms.
    let finer = if path.has_discs() { 2.5 } else { 0.0 };
    of_slices(slices, waves, slope.parts.len() as f64, grid)
        .times(1.0 + derivatives + finer)
        .then(of_projection(strips, &path, &slope, picture))
}

fn too_many() -> PredictionWork {
    PredictionWork::endless(format!(
        "more than {MOST_PARTS} products of shapes in different planes"
    ))
}

/// The number of waves of a section in one product of waves.
fn waves(path: &ChainSegment<'_>, window: &Window, slope: &Slope, axis: usize) -> f64 {
    let position: &Profile = [&window.x, &window.y][axis];
    let position = position.cosine_terms().len() as f64;
    let terms = |part: &[Vec<CosineTerm>; 2]| part[axis].len() as f64;
    let slopes = slope.parts.iter().map(terms).fold(0.0, f64::max);
    let gratings = path
        .layers
        .iter()
        .filter(|layer| matches!(layer.mask, Mask::Grating(grating) if grating.axis == axis));
    // The product of two cosines has two waves, and a grating has a constant wave and a cosine.
    2.0 * position * slopes * 3.0_f64.powi(i32::try_from(gratings.count()).unwrap_or(i32::MAX))
}

/// Estimated computing steps at one frequency. They are for each wave and pair of directions
/// (`WAVE`), for each wave and polygon whose corners may cancel (`CANCELLED`), for each wave and
/// corner (`AT_CORNER`), for each corner (`CORNER`), and for each product of shapes (`TERM`).
const WAVE: f64 = 13.0;
const CANCELLED: f64 = 2.3;
const AT_CORNER: f64 = 0.4;
const CORNER: f64 = 1.9;
const TERM: f64 = 0.6;
/// Cost of starting a row, in units of the cost of a frequency.
const ROW: f64 = 40.0;

fn of_slices(
    expansion: &Expansion,
    waves: [f64; 2],
    products: f64,
    grid: &SliceGrid,
) -> PredictionWork {
    let [azimuths, rows, count] = grid.half_shape().map(|n| n as f64);
    let count_of =
        |of: fn(&AxisSection) -> usize| expansion.sections.each_ref().map(|s| of(s) as f64);
    let polygons = count_of(|section| section.polygons.len());
    let corners = count_of(|section| section.polygons.iter().map(|p| p.corners().len()).sum());
    let directions = count_of(|section| section.directions.len());
    let columns = expansion.columns();
    let sums = columns.sums.iter().chain(&columns.beside);
    let summands = sums.map(Vec::len).sum::<usize>();
    let terms = summands.min(expansion.terms.len()) as f64;
    let pairs = directions.map(|n| 0.5 * n * (n - 1.0));
    let along = |axis: usize| {
        let wave = WAVE * pairs[axis] + CANCELLED * polygons[axis] + AT_CORNER * corners[axis];
        waves[axis] * wave + CORNER * corners[axis]
    };
    let row = (ROW + count) * products * (along(0) + along(1) + TERM * terms);
    let [p, q] = polygons;
    let phases = corners[0] * waves[0] + corners[1] * waves[1];
    PredictionWork {
        steps: azimuths * rows * row,
        bytes: products * (16.0 * phases + 64.0 * (waves[0] + waves[1]))
            + 48.0 * expansion.terms.len() as f64
            + 400.0 * (p + q),
        // Each thread stores the factors of all polygons and the quotients of a group of waves.
        bytes_each: count * (64.0 * (p + q) + 16.0 * 32.0 * pairs[0].max(pairs[1])),
        drivers: format!(
            "{azimuths} x {rows} x {count} frequencies x ({terms} products of shapes + {} corners of polygons x {} waves x {products} products of series)",
            corners[0] + corners[1],
            waves[0].max(waves[1]),
        ),
    }
}

/// Estimated number of computing steps to evaluate the window at a node.
const NODE: f64 = 12.0;

fn of_projection(
    expansion: &Expansion,
    path: &ChainSegment<'_>,
    slope: &Slope,
    picture: &ProjectionGrid,
) -> PredictionWork {
    let bins = picture.bins as f64;
    let nodes = nodes_of_cells(path, picture) as f64;
    let series = if slope.is_profile {
        0.0
    } else {
        slope.parts[0][0].len() as f64
    };
    let gratings = path.layers.len() as f64;
    let touched = |polygon: &crate::parallel::polygon::Polygon| {
        let slopes = polygon.corners().iter().map(|c| c.at[1]);
        let low = slopes.clone().fold(f64::INFINITY, f64::min);
        let columns = 0.5 * bins * (slopes.fold(f64::NEG_INFINITY, f64::max) - low) + 1.0;
        let whole = if polygon.is_segment() {
            0.0
        } else {
            0.25 * polygon.measure() * bins * bins
        };
        whole + 2.0 * columns
    };
    let polygons = &expansion.sections[0].polygons;
    let touched: f64 = polygons.iter().map(touched).sum();
    // The part of a polygon in one cell consists of two triangles or a few more. Three triangles
    // are assumed.
    let each = 3.0 * nodes * nodes * (NODE + 2.0 * series + 10.0 * gratings);
    PredictionWork {
        steps: touched * each + expansion.terms.len() as f64 * 20.0 * slope.parts.len() as f64,
        bytes: 400.0 * polygons.len() as f64,
        bytes_each: 0.0,
        drivers: format!(
            "a picture of {touched:.0} pieces of polygons in cells x {nodes} x {nodes} nodes"
        ),
    }
}

impl PredictionWork {
    pub(crate) fn times(self, times: f64) -> Self {
        Self {
            steps: self.steps * times,
            drivers: format!("{times} x {}", self.drivers),
            ..self
        }
    }
}
