//! Light fields as sums of products of polygons and waves.

use crate::parallel::chain::ChainSegment;
use crate::parallel::disc::{Discs, patches_of};
use crate::parallel::polygon::Polygon;
use crate::parallel::slope::Slope;
use crate::parallel::wave::SectionWave;
use crate::parallel::weighted_rectangle::WeightedRectangle;
use etendue_field::{Complex, HalfPlane, Hole, Mask, Profile, Shape, Window};
use std::collections::HashMap;

/// Polygons with an area below this threshold, in units of the window's half-widths, are dropped,
/// because their contribution is below rounding error.
const SMALLEST_MEASURE: f64 = 1e-15;
/// The limit on the number of tested pairs, divided by the maximum number of terms. A pair consists
/// of a term and a rectangle.
const PAIRS_PER_TERM: usize = 8;
/// An interval without lower or upper bound.
const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// The (position, slope) plane of one axis, and the polygons of this plane that light fills.
/// Coordinates are in units of the window's half-widths.
#[derive(Debug)]
pub(crate) struct AxisSection {
    /// Half-widths of the window in position (metres) and slope.
    pub(crate) half: [f64; 2],
    /// Unit of the polygons' measure. It is metre · slope, or slope for the segments of a point
    /// light.
    pub(crate) unit: f64,
    /// Directions of edges as vectors: (1, 0), (0, 1), and (shear, 1) for each distance of a
    /// plane.
    pub(crate) directions: Vec<[f64; 2]>,
    pub(crate) polygons: Vec<Polygon>,
    /// Whether the chain contains discs. If it does, its many parallelograms are transformed by
    /// [`Polygon::transform_by_sides`] wherever the contributions of corners cancel.
    pub(crate) has_discs: bool,
    /// Cache of polygons that were clipped to strips: the index of the clipped polygon for each
    /// (polygon, direction, bounds), or `None` if the clipped polygon is empty.
    known: HashMap<(usize, usize, [u64; 2]), Option<usize>>,
}

/// A term weight · 1_P(x, u) · 1_Q(y, v), where P and Q are polygons of the two sections.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PolygonTerm {
    /// The weight: ±1 times the weights of the rectangles that represent discs.
    pub(crate) weight: f64,
    /// Indices of P and Q.
    pub(crate) polygons: [usize; 2],
    /// The index of the term from which this term was clipped, and the index of the extent along x
    /// to which it was clipped. If two terms have the same two indices, they have the same P.
    column: [usize; 2],
}

/// Weights and indices of the summands of a weighted sum.
pub(crate) type Sum = Vec<(f64, usize)>;

/// Terms that are summed along y first. The indicator 1_P(x, u) of each polygon P is multiplied by
/// a weighted sum of entries of `sums`.
#[derive(Debug)]
pub(crate) struct SectionColumns {
    /// Sums of polygons of (y, v).
    pub(crate) sums: Vec<Sum>,
    /// For each polygon of (x, u), a weighted sum of entries of `sums`.
    pub(crate) beside: Vec<Sum>,
}

/// The light field of a path inside a window, expanded as brightness · Σ products · Σ terms
/// (docs/theory.md (4) and (5d)).
///
/// A rectangle in a plane at distance h is a strip x − h u ∈ [low, high] times a strip in (y, v).
/// The product source · Π_layers (1 − Σ blockers), in which an aperture has its hole as a factor, is
/// therefore a signed sum of products of convex polygons. All other factors are sums of products of
/// a wave of (x, u) and a wave of (y, v).
#[derive(Debug)]
pub(crate) struct Expansion {
    /// The sections (x, u) and (y, v).
    pub(crate) sections: [AxisSection; 2],
    pub(crate) terms: Vec<PolygonTerm>,
    /// The window times the gratings times the factor of slopes, expanded as a sum: each term is a
    /// sum of waves over (x, u) times a sum of waves over (y, v). Only a factor of slopes needs
    /// several terms.
    pub(crate) products: Vec<[Vec<SectionWave>; 2]>,
    /// The radiance of the light, or the intensity of a point light.
    pub(crate) brightness: f64,
    /// Number of column indices that have been assigned to terms so far.
    columns: usize,
}

impl AxisSection {
    fn new(position: &Profile, slope: &Profile) -> Self {
        let half = [position.half_width(), slope.half_width()];
        Self {
            half,
            unit: half[0] * half[1],
            directions: vec![[1.0, 0.0], [0.0, 1.0]],
            polygons: vec![Polygon::square([0, 1])],
            has_discs: false,
            known: HashMap::new(),
        }
    }

    /// Checks whether the polygons of another section have the same transforms.
    pub(crate) fn has_same_factors(&self, other: &Self) -> bool {
        (self.half, self.unit) == (other.half, other.unit)
            && self.directions == other.directions
            && self.polygons == other.polygons
            && self.has_discs == other.has_discs
    }

    /// Replaces the square by the segment that represents δ(x − distance · u).
    fn become_segment(&mut self, distance: f64) {
        let edge = self.direction(self.shear(distance));
        self.polygons = vec![Polygon::segment(self.directions[edge][0], edge)];
        self.unit = self.half[1];
    }

    /// The shear by a distance, which is the change of position per slope, in units of the
    /// window's half-widths.
    fn shear(&self, distance: f64) -> f64 {
        distance * self.half[1] / self.half[0]
    }

    /// Returns the index of the direction (shear, 1), and appends this direction if the list does
    /// not contain it.
    fn direction(&mut self, shear: f64) -> usize {
        let same = |d: &[f64; 2]| d[1] > 0.0 && d[0] - shear == 0.0;
        self.directions.iter().position(same).unwrap_or_else(|| {
            self.directions.push([shear, 1.0]);
            self.directions.len() - 1
        })
    }

    /// The part of a polygon that contains the rays from a strip. These rays were at
    /// positions in `extent` (metres) at the given `distance` upstream. Returns `None` if the part
    /// is empty.
    fn strip(&mut self, polygon: usize, distance: f64, extent: [f64; 2]) -> Option<usize> {
        if extent.map(f64::to_bits) == EVERYWHERE.map(f64::to_bits) {
            return Some(polygon);
        }
        let shear = self.shear(distance);
        let edge = self.direction(shear);
        let key = (polygon, edge, extent.map(f64::to_bits));
        if let Some(&part) = self.known.get(&key) {
            return part;
        }
        let part = self.polygons[polygon].strip(shear, extent.map(|e| e / self.half[0]), edge);
        let index = (part.measure() > SMALLEST_MEASURE).then(|| {
            self.polygons.push(part);
            self.polygons.len() - 1
        });
        self.known.insert(key, index);
        index
    }

    /// ∫∫ Σ waves exp(−2πi k·(position, slope)) over a polygon, where k is in cycles per
    /// metre and per unit slope. The function computes one polygon transform for each complex
    /// exponential of the waves. The unit is metre · slope, or slope for segments.
    pub(crate) fn value(&self, waves: &[SectionWave], polygon: &Polygon, k: [f64; 2]) -> Complex {
        let k = self.reduced(k);
        let shifts = waves.iter().flat_map(SectionWave::shifts);
        let sum: Complex = shifts
            .map(|s| polygon.transform([k[0] + s.frequency[0], k[1] + s.frequency[1]]) * s.weight)
            .sum();
        sum * self.unit
    }

    /// Converts a frequency from cycles per metre and per unit slope to cycles per half-width of
    /// the window.
    pub(crate) fn reduced(&self, k: [f64; 2]) -> [f64; 2] {
        [k[0] * self.half[0], k[1] * self.half[1]]
    }
}

impl Expansion {
    pub(crate) fn new(
        path: &ChainSegment<'_>,
        window: &Window,
        slope: &Slope,
        fineness: &[Discs],
    ) -> Self {
        let mut expansion = Self::empty(window);
        expansion.products = products(path, window, slope, &expansion.sections);
        expansion.multiply_out(path, fineness, usize::MAX);
        expansion
    }

    /// An expansion with polygons and terms but without waves, or `None` if the number of
    /// polygons or of terms exceeds `most`.
    pub(crate) fn within(
        path: &ChainSegment<'_>,
        window: &Window,
        fineness: &[Discs],
        most: usize,
    ) -> Option<Self> {
        let mut expansion = Self::empty(window);
        let fits = expansion.multiply_out(path, fineness, most);
        fits.then_some(expansion)
    }

    /// The expansion of the window without any light.
    fn empty(window: &Window) -> Self {
        let sections = [
            AxisSection::new(&window.x, &window.u),
            AxisSection::new(&window.y, &window.v),
        ];
        Self {
            sections,
            terms: vec![PolygonTerm {
                weight: 1.0,
                polygons: [0, 0],
                column: [0, 0],
            }],
            products: Vec::new(),
            brightness: 0.0,
            columns: 1,
        }
    }

    /// Expands the product of the light and the opaque masks; stops and returns `false` if there
    /// are more than `most` terms or polygons.
    fn multiply_out(&mut self, path: &ChainSegment<'_>, fineness: &[Discs], most: usize) -> bool {
        for section in &mut self.sections {
            section.has_discs = path.has_discs();
        }
        self.shine(path, fineness[0]);
        let layers = path.layers.iter();
        let with_edges = layers.filter(|layer| !matches!(layer.mask, Mask::Grating(_)));
        for (layer, &discs) in with_edges.zip(&fineness[1..]) {
            let patches = patches(layer.mask, discs);
            // Every pair of a term and a rectangle is tested, although only few pairs may overlap.
            if self.terms.len().saturating_mul(patches.len()) > most.saturating_mul(PAIRS_PER_TERM)
            {
                return false;
            }
            if let Mask::Aperture(_) = layer.mask {
                self.terms = self.inside(&patches, layer.distance);
            } else {
                self.block(&patches, layer.distance);
            }
            let polygons = self.sections.each_ref().map(|s| s.polygons.len());
            if self.terms.len() > most || polygons.iter().any(|n| *n > most) {
                return false;
            }
        }
        self.drop_unused();
        true
    }

    /// Expands a chain of rectangles, which does not depend on how discs are split.
    #[cfg(test)]
    pub(crate) fn of_rectangles(chain: &crate::Chain, window: &Window) -> Self {
        let path = chain.path();
        let slope = Slope::new([&window.u, &window.v], path.slope_power());
        let fineness = vec![Discs::Rule(1); path.planes().len()];
        Self::new(&path, window, &slope, &fineness)
    }

    /// Replaces the terms of the window by the terms of the light's shape.
    fn shine(&mut self, path: &ChainSegment<'_>, discs: Discs) {
        self.brightness = path.light.brightness;
        if let Some(shape) = &path.light.shape {
            self.terms = self.inside(&patches_of(shape, discs), path.distance);
        } else {
            for section in &mut self.sections {
                section.become_segment(path.distance);
            }
        }
    }

    /// Multiplies the terms by 1 − Σ patches, where the patches are the rectangles of a mask.
    fn block(&mut self, patches: &[WeightedRectangle], distance: f64) {
        let blocked = self.inside(patches, distance);
        self.terms
            .extend(blocked.into_iter().map(|term| PolygonTerm {
                weight: -term.weight,
                ..term
            }));
    }

    /// The product of the terms and the sum of the patches in a plane, without empty
    /// terms.
    fn inside(&mut self, patches: &[WeightedRectangle], distance: f64) -> Vec<PolygonTerm> {
        let mut parts = Vec::new();
        let polygons = self.sections[1].polygons.len();
        for (parent, term) in self.terms.iter().enumerate() {
            let mut first = 0;
            for (i, patch) in patches.iter().enumerate() {
                let along_x = |patch: &WeightedRectangle| patch.extent[0].map(f64::to_bits);
                if along_x(patch) != along_x(&patches[first]) {
                    first = i;
                }
                let [x, y] = [0, 1].map(|axis| {
                    let extent = patch.extent[axis];
                    self.sections[axis].strip(term.polygons[axis], distance, extent)
                });
                if let (Some(x), Some(y)) = (x, y) {
                    let column = self.columns + term.polygons[1] * patches.len() + first;
                    parts.push(PolygonTerm {
                        weight: term.weight * patch.weight,
                        polygons: [x, y],
                        column: [parent, column],
                    });
                }
            }
        }
        self.columns += polygons * patches.len();
        parts
    }

    /// The terms after summation along y. If a disc of n × n rectangles is behind another
    /// disc of n × n rectangles, there are n⁴ terms. For one extent along x, the sum along y over
    /// n² of these terms is the same for all n polygons of (x, u) that are clipped to this extent.
    /// Therefore n³ terms with n³ summands are sufficient.
    pub(crate) fn columns(&self) -> SectionColumns {
        let mut known = HashMap::new();
        let mut sums: Vec<Sum> = Vec::new();
        let mut beside = vec![Sum::new(); self.sections[0].polygons.len()];
        for run in self.terms.chunk_by(|a, b| a.column == b.column) {
            let PolygonTerm {
                weight,
                polygons: [x, _],
                column: [_, column],
            } = run[0];
            let sum = *known.entry(column).or_insert_with(|| {
                let along_y = run.iter().map(|t| (t.weight / weight, t.polygons[1]));
                sums.push(along_y.collect());
                sums.len() - 1
            });
            beside[x].push((weight, sum));
        }
        SectionColumns { sums, beside }
    }

    /// Removes the polygons that no term uses, and sorts the other polygons in the order of the
    /// terms.
    fn drop_unused(&mut self) {
        for (axis, section) in self.sections.iter_mut().enumerate() {
            let all = std::mem::take(&mut section.polygons);
            let mut index = vec![None; all.len()];
            for term in &mut self.terms {
                let old = term.polygons[axis];
                term.polygons[axis] = *index[old].get_or_insert_with(|| {
                    section.polygons.push(all[old].clone());
                    section.polygons.len() - 1
                });
            }
            section.known.clear();
        }
    }
}

/// The product of the window, the factors that depend on slopes and the gratings along the
/// path, expanded in waves.
fn products(
    path: &ChainSegment<'_>,
    window: &Window,
    slope: &Slope,
    sections: &[AxisSection; 2],
) -> Vec<[Vec<SectionWave>; 2]> {
    let positions = [&window.x, &window.y].map(|profile| profile.cosine_terms());
    let product = |slopes: &[Vec<_>; 2]| {
        [0, 1].map(|axis| {
            let half = sections[axis].half;
            let waves = SectionWave::of_terms([&positions[axis], &slopes[axis]], half);
            let gratings = path.layers.iter().filter_map(|layer| match layer.mask {
                Mask::Grating(grating) if grating.axis == axis => {
                    Some(SectionWave::of_grating(grating, layer.distance, half))
                }
                _ => None,
            });
            gratings.fold(waves, |waves, grating| {
                SectionWave::products(&waves, &grating)
            })
        })
    };
    slope.parts.iter().map(product).collect()
}

/// The rectangles of an opaque mask, or the rectangles of the hole of an aperture. Discs are
/// split by the given method.
///
/// # Panics
/// Panics if the hole is a polygon; nets of rays predict light behind such an aperture.
fn patches(mask: &Mask, discs: Discs) -> Vec<WeightedRectangle> {
    let (shapes, half_planes): (&[Shape], &[HalfPlane]) = match mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => (shapes, half_planes),
        Mask::Aperture(Hole::Shape(shape)) => (std::slice::from_ref(shape), &[]),
        Mask::Aperture(Hole::Polygon(_)) => panic!("a polygon has no closed form here"),
        Mask::Grating(_) => return Vec::new(),
    };
    let shapes = shapes.iter().flat_map(|s| patches_of(s, discs));
    shapes
        .chain(half_planes.iter().map(WeightedRectangle::of_half_plane))
        .collect()
}
