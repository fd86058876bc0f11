//! The light field of a chain as means over cells of x and u.

use super::expansion::Expansion;
use crate::Chain;
use crate::parallel::chain::ChainSegment;
use crate::parallel::disc_resolution::DiscResolution;
use crate::parallel::polygon::{Polygon, cross};
use crate::parallel::slope::Slope;
use crate::parallel::wave::SectionWave;
use crate::quadrature::gauss_legendre;
use etendue_field::{CosineTerm, Grating, Mask, Projection, ProjectionGrid, Window, whole};
use ndarray::Array2;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Number of nodes of the Gauss rule along each direction of a triangle. The window is smooth
/// inside a cell, so with Hann profiles the error is below 1e-11 for 8 bins and below rounding
/// error for 32 bins. For gratings, nodes are added in proportion to the cycles in a cell.
const NODES: usize = 5;
/// Number of nodes that are added for each cycle of a grating in a cell.
const NODES_PER_CYCLE: f64 = 5.0;
/// Maximum number of nodes along each direction of a triangle. If a cell contains more periods than
/// they resolve, a single grating is replaced by its mean, from which its mean over a cell differs
/// by less than 2 %. Several gratings are undersampled, because their product may have a slow beat.
const MOST_NODES: f64 = 200.0;

/// The windowed light field, integrated over y and v, as means over cells of (x, u).
///
/// The integral over y and v is exact, because it is the (y, v) factor of the spectrum at frequency
/// zero. Each polygon is clipped to each cell, and the window is integrated over the clipped
/// polygon by a Gauss rule. Edges therefore cause no aliasing. Discs are split into strips of a
/// twentieth of a cell or wider. Unit: W m⁻² sr⁻¹ · m.
#[must_use]
pub fn projection(chain: &Chain, window: &Window, grid: &ProjectionGrid) -> Projection {
    let path = chain.path();
    if let Some(receiver) = path.receiver() {
        return receiver.projection(window, grid);
    }
    let fineness = DiscResolution::for_projection(&path, window, grid.bins);
    let slope = Slope::new([&window.u, &window.v], path.slope_power());
    let expansion = Expansion::new(&path, window, &slope, &fineness.0);
    let densities = densities(&expansion, &slope);
    let section = &expansion.sections[0];
    let polygons: Vec<_> = section.polygons.iter().zip(densities).collect();
    let cells = Cells::new(&path, window, &slope, grid);
    let columns: Vec<Vec<f64>> = (0..grid.bins)
        .into_par_iter()
        .map(|j| cells.column(j, &polygons))
        .collect();
    let scale = section.unit / grid.cell_area();
    Projection {
        grid: *grid,
        values: Array2::from_shape_fn((grid.bins, grid.bins), |(i, j)| columns[j][i] * scale),
    }
}

/// The factor that multiplies a polygon of (x, u) after integration over y and v.
#[derive(Clone, Debug)]
enum CellDensity {
    /// A constant factor; the slope profile of the window is applied separately.
    Uniform(f64),
    /// Amplitudes of a cosine series in u; the series includes the slope profile of the window.
    Series(Vec<f64>),
}

fn densities(expansion: &Expansion, slope: &Slope) -> Vec<CellDensity> {
    let parts = expansion.products.iter().zip(&slope.parts);
    let weights: Vec<_> = parts
        .map(|(waves, part)| (weights(expansion, &waves[1]), &part[0]))
        .collect();
    let polygons = 0..expansion.sections[0].polygons.len();
    if slope.is_profile {
        return polygons
            .map(|p| CellDensity::Uniform(weights[0].0[p]))
            .collect();
    }
    polygons
        .map(|p| {
            let mut series = vec![0.0; weights[0].1.len()];
            for (weights, terms) in &weights {
                let amplitudes = terms.iter().map(|term: &CosineTerm| term.weight);
                let sums = series.iter_mut().zip(amplitudes);
                sums.for_each(|(sum, amplitude)| *sum += weights[p] * amplitude);
            }
            CellDensity::Series(series)
        })
        .collect()
}

/// The factor of each polygon of (x, u): the integral over y and v of the terms with this
/// polygon, multiplied by the given waves in (y, v).
fn weights(expansion: &Expansion, waves: &[SectionWave]) -> Vec<f64> {
    let [x, y] = &expansion.sections;
    let polygons = y.polygons.iter();
    let integrals: Vec<_> = polygons.map(|p| y.value(waves, p, [0.0, 0.0]).re).collect();
    let mut weights = vec![0.0; x.polygons.len()];
    for term in &expansion.terms {
        let [p, q] = term.polygons;
        weights[p] += term.weight * expansion.brightness * integrals[q];
    }
    weights
}

/// Cells of (x, u) in units of the half-widths of the window.
struct Cells<'a> {
    window: &'a Window,
    gratings: CellGratings<'a>,
    /// The lowest frequency of the series in u, cycles per unit slope.
    series: f64,
    bins: usize,
    /// Half-widths of the grid in units of the window's half-widths. They are 1 if the grid covers
    /// exactly the window.
    half: [f64; 2],
    /// Nodes and weights of a Gauss rule on (0, 1).
    nodes: Vec<(f64, f64)>,
}

/// The gratings along x of a path.
struct CellGratings<'a> {
    /// The gratings that nodes resolve, each with its distance upstream of the plane.
    resolved: Vec<(&'a Grating, f64)>,
    /// The mean transmittance of the others.
    mean: f64,
    /// Number of nodes along each direction of a triangle within a cell.
    nodes: usize,
}

fn gratings<'a>(path: &ChainSegment<'a>, grid: &ProjectionGrid) -> CellGratings<'a> {
    let layers = path.layers.iter();
    let along_x = layers.filter_map(|layer| match layer.mask {
        Mask::Grating(grating) if grating.axis == 0 => Some((grating, layer.distance)),
        _ => None,
    });
    let mut resolved: Vec<(&Grating, f64)> = along_x.collect();
    let cell = [grid.half_x, grid.half_u].map(|half| 2.0 * half / grid.bins as f64);
    let cycles = resolved
        .iter()
        .map(|(g, h)| g.frequency.abs() * (cell[0] + h.abs() * cell[1]));
    let mut more = cycles.sum::<f64>() * NODES_PER_CYCLE;
    let mut mean = 1.0;
    if resolved.len() == 1 && more > MOST_NODES {
        resolved.clear();
        (mean, more) = (0.5, 0.0);
    }
    CellGratings {
        resolved,
        mean,
        nodes: NODES + whole(more.min(MOST_NODES)),
    }
}

/// The number of nodes for the picture of a path.
pub(crate) fn nodes_of_cells(path: &ChainSegment<'_>, grid: &ProjectionGrid) -> usize {
    gratings(path, grid).nodes
}

impl<'a> Cells<'a> {
    fn new(
        path: &ChainSegment<'a>,
        window: &'a Window,
        slope: &Slope,
        grid: &ProjectionGrid,
    ) -> Self {
        let gratings = gratings(path, grid);
        let nodes = gauss_legendre(gratings.nodes).into_iter();
        Self {
            window,
            gratings,
            series: slope.parts[0][0].get(1).map_or(0.0, |term| term.frequency),
            bins: grid.bins,
            half: [
                grid.half_x / window.x.half_width(),
                grid.half_u / window.u.half_width(),
            ],
            nodes: nodes.map(|(x, w)| (0.5 * (x + 1.0), 0.5 * w)).collect(),
        }
    }

    /// The coordinate of the lower edge of the cells with index `i` along an axis.
    fn edge(&self, i: usize, axis: usize) -> f64 {
        (2.0 * i as f64 / self.bins as f64 - 1.0) * self.half[axis]
    }

    /// The values of all cells in slope bin `j`, one for each position bin. The value of a
    /// cell is the integral of density · W over the cell, summed over polygons.
    fn column(&self, j: usize, polygons: &[(&Polygon, CellDensity)]) -> Vec<f64> {
        let mut sums = vec![0.0; self.bins];
        let [low, high] = [self.edge(j, 1), self.edge(j + 1, 1)];
        for (polygon, density) in polygons {
            let part = polygon
                .clipped([0.0, 1.0], high, 0)
                .clipped([0.0, -1.0], -low, 0);
            for i in self.touched(&part) {
                let cell = part.strip(0.0, [self.edge(i, 0), self.edge(i + 1, 0)], 1);
                sums[i] += match density {
                    CellDensity::Uniform(weight) => {
                        weight * self.integral(&cell, |u| self.window.u.value(u))
                    }
                    CellDensity::Series(terms) => self.integral(&cell, |u| self.sum(terms, u)),
                };
            }
        }
        sums
    }

    /// The range of position bins that a polygon overlaps.
    fn touched(&self, polygon: &Polygon) -> std::ops::Range<usize> {
        let n = self.bins as f64;
        if polygon.corners().is_empty() {
            return 0..0;
        }
        let bins = polygon
            .corners()
            .iter()
            .map(|c| (0.5 * n * (c.at[0] / self.half[0] + 1.0)).clamp(0.0, n));
        let low = bins.clone().fold(n, f64::min);
        let high = bins.fold(0.0, f64::max);
        let first = whole(low);
        // A segment on the edge between two cells belongs to the upper cell.
        first..whole(high.ceil()).max((first + 1).min(self.bins))
    }

    /// ∫∫ W over a polygon that lies within a cell; `slope` is the factor of W that
    /// depends on u.
    fn integral(&self, polygon: &Polygon, slope: impl Fn(f64) -> f64) -> f64 {
        let Some(first) = polygon.corners().first() else {
            return 0.0;
        };
        if polygon.is_segment() {
            return polygon.measure() * self.mean_along(polygon, slope);
        }
        let triangles = polygon.triangles();
        triangles
            .map(|[b, c]| cross(b, c) * self.mean(first.at, b, c, &slope))
            .sum()
    }

    /// ∫ W along a segment, divided by its length.
    fn mean_along(&self, segment: &Polygon, slope: impl Fn(f64) -> f64) -> f64 {
        let [a, b] = [0, 1].map(|end| segment.corners()[end].at);
        let nodes = self.nodes.iter();
        nodes
            .map(|&(t, weight)| {
                let [x, u] = [0, 1].map(|i| a[i] + t * (b[i] - a[i]));
                weight * self.value(x, u, &slope)
            })
            .sum()
    }

    /// ∫∫ s W(p + s((1 − t) b + t c)) ds dt over the unit square. The result is half the
    /// mean of W over the triangle with the vertices p, p + b and p + c.
    fn mean(&self, p: [f64; 2], b: [f64; 2], c: [f64; 2], slope: impl Fn(f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for &(t, weight) in &self.nodes {
            let side = [0, 1].map(|i| b[i] + t * (c[i] - b[i]));
            for &(s, other) in &self.nodes {
                let [x, u] = [0, 1].map(|i| p[i] + s * side[i]);
                sum += weight * other * s * self.value(x, u, &slope);
            }
        }
        sum
    }

    fn value(&self, x: f64, u: f64, slope: impl Fn(f64) -> f64) -> f64 {
        let Window {
            x: along, u: angle, ..
        } = self.window;
        let (x, u) = (x * along.half_width(), u * angle.half_width());
        let CellGratings { resolved, mean, .. } = &self.gratings;
        let seen = resolved.iter();
        let seen = seen.map(|(grating, h)| grating.transmittance(x - h * u, 0.0));
        along.value(x) * slope(u) * mean * seen.product::<f64>()
    }

    /// The cosine series Σ termsₙ cos(2π n f u) at u, by Clenshaw's recurrence.
    fn sum(&self, terms: &[f64], u: f64) -> f64 {
        let cos = libm::cos(TAU * self.series * u);
        let (mut next, mut last) = (0.0, 0.0);
        for term in terms.iter().skip(1).rev() {
            (next, last) = (term + 2.0 * cos * next - last, next);
        }
        terms[0] + cos * next - last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::at;
    use crate::quadrature::integrate;
    use crate::testing::*;
    use etendue_field::{Light, Profile, Rectangle, Shape};

    #[test]
    fn sums_to_the_spectrum_at_zero() {
        let chain = chain(0.2, &[(1.0, blockers(4, 0.2, 0.1)), (1.0, vec![])]);
        let gaussian = Profile::Gaussian {
            width: 0.3,
            cut: 0.4,
        };
        for (window, bins, close) in [
            (window(Profile::Hann(0.5), Profile::Hann(0.3)), 64, 1e-13), // rounding
            (window(Profile::Hann(0.5), Profile::Hann(0.3)), 8, 1e-11),  // stated at NODES
            (window(gaussian, Profile::Box(0.3)), 37, 1e-13),            // rounding
        ] {
            let grid = ProjectionGrid::new(&window, bins);
            let projection = projection(&chain, &window, &grid);
            let sum = projection.values.sum() * grid.cell_area();
            let zero = at(&chain, &window, [0.0; 4]).re;
            assert!((sum / zero - 1.0).abs() < close, "{}", sum / zero - 1.0);
        }
    }

    #[test]
    fn every_kind_sums_to_the_spectrum_at_zero() {
        let point = Light::Point { intensity: 2.0 };
        let square = lambertian(square([0.0, 0.05], 0.3));
        let oblong = Shape::Rectangle(Rectangle {
            center: [0.1, 0.0],
            size: [0.2, 0.4],
        });
        let masks = [
            (0.5, Some(grating(0, 9.0, 0.3))),
            (0.5, Some(half_plane(1, 0.1, true))),
            (0.3, Some(grating(1, 4.0, 0.0))),
            (0.2, None),
        ];
        let mut shaded = chain_of(square.clone(), masks.clone());
        shaded.operators.push(cosine());
        let round = chain_of(spot(disc([0.05, 0.0], 0.2), 0.0), masks.clone());
        for (chain, close) in [
            (chain_of(square, masks.clone()), 1e-11), // stated at NODES
            (chain_of(point.clone(), masks.clone()), 1e-11), // stated at NODES
            (chain_of(point, [(0.0, None)]), 1e-11),  // on an edge between cells
            (chain_of(spot(oblong, 20.0), masks), 1e-11), // the same series on both sides
            (shaded, 1e-11),                          // the same series on both sides
            (round, 1e-4),                            // strips between sines of 64 angles
        ] {
            let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
            let grid = ProjectionGrid::new(&window, 16);
            let projection = projection(&chain, &window, &grid);
            let sum = projection.values.sum() * grid.cell_area();
            let error = (sum / at(&chain, &window, [0.0; 4]).re - 1.0).abs();
            assert!(error < close, "{error:e} {:?}", chain.describe());
        }
    }

    #[test]
    fn cell_behind_a_grating_is_the_mean_of_rays_through_it() {
        let light = spot(Shape::Rectangle(square([0.0, 0.0], 5.0)), 6.0);
        let chain = chain_of(light, [(1.0, Some(grating(0, 4.0, 0.7))), (0.8, None)]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        let grid = ProjectionGrid::new(&window, 16);
        let projection = projection(&chain, &window, &grid);
        let seen = grating(0, 4.0, 0.7);
        let Mask::Grating(seen) = seen else {
            unreachable!()
        };
        for index in [[8, 8], [3, 11]] {
            let center = [0, 1].map(|k| grid.center(index[k], [grid.half_x, grid.half_u][k]));
            let half = [grid.half_x, grid.half_u].map(|half| half / 16.0);
            let expected = mean(100, center, half, |x, u| {
                // The lobe cos⁶θ integrated over v; all light along v is within the window.
                let lobe = integrate(40, [-0.3, 0.3], |v| {
                    window.v.value(v) * (1.0 + u * u + v * v).powi(-3)
                });
                // ∫ W dy is the half-width of a Hann profile.
                let along = window.x.value(x) * window.u.value(u) * 0.5;
                along * seen.transmittance(x - 0.8 * u, 0.0) * lobe
            });
            let error = (projection.values[index] / expected - 1.0).abs();
            assert!(error < 1e-4, "{error:e}"); // midpoints of 100 points: (2π/50)²/24 and less
        }
    }

    /// The mean of f over n × n points in the box with the given centre and half-widths.
    fn mean(n: u32, center: [f64; 2], half: [f64; 2], f: impl Fn(f64, f64) -> f64) -> f64 {
        let place = |i: u32, k: usize| {
            center[k] + half[k] * ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0)
        };
        let points = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let sum: f64 = points.map(|(i, j)| f(place(i, 0), place(j, 1))).sum();
        sum / f64::from(n * n)
    }

    #[test]
    fn cell_is_the_mean_of_rays_through_it() {
        let blocker = vec![square([0.0, 0.0], 0.3)];
        let chain = chain(0.4, &[(1.0, blocker), (1.0, vec![])]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        let grid = ProjectionGrid::new(&window, 16);
        let projection = projection(&chain, &window, &grid);
        // `lit` is 1 if a ray (x, u) comes from the light, and `met` is 1 if the ray meets the
        // strip of the blocker.
        let lit = |x: f64, u: f64| f64::from(u8::from((x - 2.0 * u).abs() < 0.2));
        let met = |x: f64, u: f64| f64::from(u8::from((x - u).abs() < 0.15));
        let weight = |x: f64, u: f64| lit(x, u) * window.x.value(x) * window.u.value(u);
        let support = [grid.half_x, grid.half_u];
        let area = 4.0 * support[0] * support[1];
        let all = area * mean(400, [0.0; 2], support, weight);
        let behind = area * mean(400, [0.0; 2], support, |y, v| weight(y, v) * met(y, v));
        for index in [[8, 8], [9, 9], [12, 11], [4, 5]] {
            let center = [0, 1].map(|k| grid.center(index[k], support[k]));
            let cell = support.map(|half| half / 16.0);
            let expected = mean(200, center, cell, |x, u| {
                weight(x, u) * (all - met(x, u) * behind)
            });
            // If an edge crosses a grid of n × n points, the error is less than 1/n of the
            // integral.
            assert!((projection.values[index] - expected).abs() < all / 200.0);
        }
        // The tested cells are partly lit and partly blocked, and blocking changes their values by
        // far more than this tolerance.
        assert!(behind > 0.1 * all);
    }
}
