//! The number of rectangles into which the discs of a chain are split.

use crate::parallel::chain::ChainSegment;
use crate::parallel::disc::Discs;
use crate::parallel::expansion::Expansion;
use crate::parallel::slope::Slope;
use etendue_field::{Mask, Profile, Shape, Window, whole};
use std::f64::consts::PI;

/// The rule for discs has π R Ω nodes plus this number.
const SPARE_NODES: f64 = 6.0;
/// Maximum number of nodes of the rule for discs. With this number, a disc is split into 72²
/// rectangles.
const MOST_NODES: f64 = 72.0;
/// Edges in other planes increase the bandwidth up to this limit. The limit is a multiple of the
/// largest frequency of the spectra.
const MAX_FREQUENCIES: f64 = 4.0;
/// Edges in other planes increase the bandwidth, and only this fraction of the increased bandwidth
/// is resolved. Higher frequencies are reached only in the corners of the grid of frequencies,
/// where spectra are small.
const FAR_SHARE: f64 = 0.7;
/// Maximum number of terms of an expansion that results from splitting discs.
const MOST_TERMS: f64 = 3e5;
/// Maximum number of strips into which a disc is split.
const MOST_STRIPS: f64 = 64.0;

/// The methods by which the discs of a chain are split. The first method is for the discs of the
/// light, and the others are for the discs of each opaque mask or aperture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DiscResolution(pub(crate) Vec<Discs>);

impl DiscResolution {
    /// The resolution for spectra up to `frequency`, along position and slope
    /// (docs/theory.md, after Eq. 5b).
    pub(crate) fn for_spectrum(
        path: &ChainSegment<'_>,
        window: &Window,
        frequency: [f64; 2],
    ) -> Self {
        let nodes = Self::wanted(path, window, frequency);
        if path.has_discs() {
            nodes.affordable(path, window)
        } else {
            nodes
        }
    }

    /// Checks whether the resolution of discs that [`MOST_TERMS`] allows is approximately fine
    /// enough for spectra up to `frequency`. For a wide disc behind a narrow window, this
    /// resolution is too coarse, and a comparison with finer rules does not reveal the error.
    pub(crate) fn is_enough(path: &ChainSegment<'_>, window: &Window, frequency: [f64; 2]) -> bool {
        if !path.has_discs() {
            return true;
        }
        let wanted = Self::wanted(path, window, frequency);
        if wanted
            .0
            .iter()
            .any(|discs| discs.count() >= whole(MOST_NODES))
        {
            return false;
        }
        let affordable = wanted.clone().affordable(path, window);
        let mut both = wanted.0.iter().zip(&affordable.0);
        both.all(|(wanted, affordable)| wanted.count() <= 2 * affordable.count())
    }

    fn wanted(path: &ChainSegment<'_>, window: &Window, frequency: [f64; 2]) -> Self {
        let rates = EdgeBandwidth::new(path, window, frequency);
        Self::of(path, |radius, plane| {
            let nodes = (PI * radius * rates.at(plane)).ceil() + SPARE_NODES;
            Discs::Rule(whole(nodes.min(MOST_NODES)))
        })
    }

    /// Represents each disc by a single rectangle.
    pub(crate) fn single(path: &ChainSegment<'_>) -> Self {
        Self(vec![Discs::Rule(1); path.planes().len()])
    }

    /// Reduces the number of nodes if discs in several planes would result in more than
    /// [`MOST_TERMS`] terms.
    fn affordable(self, path: &ChainSegment<'_>, window: &Window) -> Self {
        let slope = Slope::new([&window.u, &window.v], 0.0);
        let single = Self::single(path);
        let seen = Expansion::new(path, window, &slope, &single.0).terms.len();
        let round = path
            .planes()
            .into_iter()
            .map(|shapes| largest(shapes) > 0.0);
        let planes: Vec<_> = self.0.iter().zip(round).collect();
        let (mut terms, mut count) = (seen as f64, 0.0);
        for (discs, _) in planes.iter().filter(|(_, round)| *round) {
            terms *= (discs.count() as f64).powi(2);
            count += 1.0;
        }
        let share = libm::pow(MOST_TERMS / terms, 0.5 / count).min(1.0);
        let fewer = |n: usize| whole((share * n as f64).round()).max(1);
        Self(
            planes
                .into_iter()
                .map(|(discs, _)| Discs::Rule(fewer(discs.count())))
                .collect(),
        )
    }

    /// Chooses strips for the light field on a grid of `bins` positions.
    pub(crate) fn for_projection(path: &ChainSegment<'_>, window: &Window, bins: usize) -> Self {
        let cell = 2.0 * window.x.half_width() / bins as f64;
        Self::of(path, |radius, _| {
            let strips = (8.0 * radius / cell).ceil().clamp(8.0, MOST_STRIPS);
            Discs::Strips(whole(strips))
        })
    }

    /// Builds a resolution by calling `discs` for each plane. `discs` receives the largest radius
    /// of the discs in the plane and the plane's index, and returns the method for splitting these
    /// discs.
    fn of(path: &ChainSegment<'_>, discs: impl Fn(f64, usize) -> Discs) -> Self {
        let planes = path.planes().into_iter().enumerate();
        Self(
            planes
                .map(|(i, shapes)| discs(largest(shapes), i))
                .collect(),
        )
    }

    /// A resolution that splits discs into a quarter more nodes or strips.
    pub(crate) fn finer(&self) -> Self {
        let more = |n: usize| n + n.div_ceil(4);
        Self(
            self.0
                .iter()
                .map(|discs| match *discs {
                    Discs::Rule(n) => Discs::Rule(more(n)),
                    Discs::Strips(n) => Discs::Strips(more(n)),
                })
                .collect(),
        )
    }
}

/// A bound on the bandwidth of a function of c, which is the integral of the field along the line x
/// − h u = c. The spectrum of this function at frequency γ is the spectrum of the other factors of
/// the field at (Ωx − γ, Ωu + h γ).
struct EdgeBandwidth {
    /// The largest |Ωx| and |Ωu|, shifted by gratings.
    frequency: [f64; 2],
    /// The half-width of the window's spectrum. The window blurs |Ωx| and |Ωu| by this half-width.
    blur: [f64; 2],
    /// Distances of the planes that have edges: first of the light's plane, then of each opaque
    /// mask or aperture.
    planes: Vec<f64>,
}

impl EdgeBandwidth {
    fn new(path: &ChainSegment<'_>, window: &Window, frequency: [f64; 2]) -> Self {
        let [x, y, u, v] = [&window.x, &window.y, &window.u, &window.v].map(Profile::half_width);
        // The width of the lobe cosⁿθ of a spot is 1/√n.
        let lobe = 1.0 / (-2.0 * path.slope_power()).max(1e-9).sqrt();
        let mut rates = Self {
            frequency,
            blur: [2.0 / x.min(y), 2.0 / u.min(v).min(lobe)],
            planes: vec![path.distance],
        };
        for layer in &path.layers {
            if let Some(grating) = layer.mask.grating() {
                rates.frequency[0] += grating.frequency.abs();
                rates.frequency[1] += (grating.frequency * layer.distance).abs();
            }
            if !matches!(layer.mask, Mask::Grating(_)) {
                rates.planes.push(layer.distance);
            }
        }
        rates
    }

    /// The bandwidth for the edges in a plane. If the window is the only other factor, its
    /// spectrum is concentrated near zero, so γ is near both Ωx and −Ωu/h. Edges in a plane at
    /// distance g spread the spectrum along Ωu = −g Ωx. The frequencies (Ωx − γ, Ωu + h γ) meet
    /// this line at γ = (Ωu + g Ωx)/(g − h). Large γ are limited, because the spectrum is small at
    /// large frequencies.
    fn at(&self, plane: usize) -> f64 {
        let h = self.planes[plane];
        let [x, u] = self.frequency;
        let widest = x + self.blur[0];
        let own = widest.min((u + self.blur[1]) / h.abs());
        let others = self.planes.iter().enumerate().filter(|(j, _)| *j != plane);
        // For another plane at the same distance the quotient is infinite.
        let meets = others.map(|(_, g)| (u + g.abs() * x) / (g - h).abs());
        let farthest = meets.fold(0.0, f64::max).min(MAX_FREQUENCIES * widest);
        own.max(FAR_SHARE * farthest)
    }
}

/// The largest radius of the discs among shapes, or 0 if no shape is a disc.
fn largest(shapes: &[Shape]) -> f64 {
    let radii = shapes.iter().map(|shape| match shape {
        Shape::Disc(disc) => disc.radius,
        Shape::Rectangle(_) => 0.0,
    });
    radii.fold(0.0, f64::max)
}
