use crate::chain::{Chain, Layer};
use crate::polygon::Polygon;
use crate::wave::Wave;
use etendue_field::{Complex, Profile, Window};
use std::collections::HashMap;

/// Polygons smaller than this, in units of the window's half-widths, are left out: below rounding.
const SMALLEST_AREA: f64 = 1e-15;

/// The (position, slope) plane of one axis: the polygons that light fills in it, in units of the half-widths
/// of the window.
#[derive(Debug)]
pub(crate) struct Section {
    /// Half-widths in position (metres) and slope.
    pub(crate) half: [f64; 2],
    /// The window inside the square |p| < 1.
    pub(crate) waves: Vec<Wave>,
    /// Directions of edges, as vectors: (1, 0), (0, 1), then (shear, 1) for each distance.
    pub(crate) directions: Vec<[f64; 2]>,
    pub(crate) polygons: Vec<Polygon>,
    /// Strips already cut: (polygon, direction, bounds) to the part's index, `None` if empty.
    known: HashMap<(usize, usize, [u64; 2]), Option<usize>>,
}

/// sign · 1_P(x, u) · 1_Q(y, v), P and Q being polygons of the two sections.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term {
    pub(crate) sign: f64,
    /// Indices of P and Q.
    pub(crate) polygons: [usize; 2],
}

/// The light field of a chain inside a window, multiplied out: radiance · Σ terms (docs/theory.md, Eq. 4).
///
/// A rectangle in a plane at distance h is a strip x − h u ∈ [low, high] times one in (y, v), so the product
/// source · Π_layers (1 − Σ blockers) is a signed sum of products of convex polygons.
#[derive(Debug)]
pub(crate) struct Expansion {
    /// (x, u) and (y, v).
    pub(crate) sections: [Section; 2],
    pub(crate) terms: Vec<Term>,
    pub(crate) radiance: f64,
}

impl Section {
    fn new(position: &Profile, slope: &Profile) -> Self {
        Self {
            half: [position.half_width(), slope.half_width()],
            waves: Wave::of_window(position, slope),
            directions: vec![[1.0, 0.0], [0.0, 1.0]],
            polygons: vec![Polygon::square([0, 1])],
            known: HashMap::new(),
        }
    }

    /// The index of direction (shear, 1); equal ones share it.
    fn direction(&mut self, shear: f64) -> usize {
        let same = |d: &[f64; 2]| d[1] > 0.0 && d[0] - shear == 0.0;
        self.directions.iter().position(same).unwrap_or_else(|| {
            self.directions.push([shear, 1.0]);
            self.directions.len() - 1
        })
    }

    /// The part of a polygon whose rays were in `extent` (metres) a `distance` ago; `None` if empty.
    fn strip(&mut self, polygon: usize, distance: f64, extent: [f64; 2]) -> Option<usize> {
        let shear = distance * self.half[1] / self.half[0];
        let edge = self.direction(shear);
        let key = (polygon, edge, extent.map(f64::to_bits));
        if let Some(&part) = self.known.get(&key) {
            return part;
        }
        let part = self.polygons[polygon].strip(shear, extent.map(|e| e / self.half[0]), edge);
        let index = (part.area() > SMALLEST_AREA).then(|| {
            self.polygons.push(part);
            self.polygons.len() - 1
        });
        self.known.insert(key, index);
        index
    }

    /// ∫∫ W exp(−2πi k·(position, slope)) over a polygon, k in cycles per metre and per unit slope: one
    /// polygon transform for each exponential of the window. Unit: metre · slope.
    pub(crate) fn value(&self, polygon: &Polygon, k: [f64; 2]) -> Complex {
        let k = self.reduced(k);
        let shifts = self.waves.iter().flat_map(Wave::shifts);
        let sum: Complex = shifts
            .map(|s| polygon.transform([k[0] + s.frequency[0], k[1] + s.frequency[1]]) * s.weight)
            .sum();
        sum * (self.half[0] * self.half[1])
    }

    /// A frequency in cycles per half-width.
    pub(crate) fn reduced(&self, k: [f64; 2]) -> [f64; 2] {
        [k[0] * self.half[0], k[1] * self.half[1]]
    }
}

impl Expansion {
    pub(crate) fn new(chain: &Chain, window: &Window) -> Self {
        let sections = [
            Section::new(&window.x, &window.u),
            Section::new(&window.y, &window.v),
        ];
        let mut expansion = Self {
            sections,
            terms: vec![Term {
                sign: 1.0,
                polygons: [0, 0],
            }],
            radiance: chain.source.radiance,
        };
        let layers = chain.layers();
        expansion.terms = expansion.inside(&layers[0]);
        for layer in &layers[1..] {
            let blocked = expansion.inside(layer);
            expansion.terms.extend(blocked.into_iter().map(|term| Term {
                sign: -term.sign,
                ..term
            }));
        }
        expansion.drop_unused();
        expansion
    }

    /// The terms times Σ rectangles of a layer, the empty ones dropped.
    fn inside(&mut self, layer: &Layer<'_>) -> Vec<Term> {
        let mut parts = Vec::new();
        for term in &self.terms {
            for rectangle in layer.rectangles {
                let [x, y] = [0, 1].map(|axis| {
                    let extent = rectangle.extent(axis);
                    self.sections[axis].strip(term.polygons[axis], layer.distance, extent)
                });
                if let (Some(x), Some(y)) = (x, y) {
                    parts.push(Term {
                        sign: term.sign,
                        polygons: [x, y],
                    });
                }
            }
        }
        parts
    }

    /// Keeps only the polygons that terms refer to, in the order of the terms.
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
