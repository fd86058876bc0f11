//! Comparison of the operators in 2D with a plain quadrature of the mapped field, and with rays
//! traced off a circle.

use super::path::MirrorPath;
use super::path::PathStage::{self, Back, Beyond, Curvature, Event, Incidence, Outgoing, Travel};
use super::quadrature::{apart, content, of_field, of_rays};
use crate::orders::{self, ORDER, slope};
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use crate::rows::Line;
use etendue_field::Complex;
use etendue_theory::geometry::{Matrix, Media};
use std::f64::consts::TAU;

/// Covariance over (x, θ) of the Gaussian light field in these tests. It is for a neighbourhood of
/// size 1.
const FIELD: Matrix<2> = [[1.0, 0.3], [0.3, 0.8]];
/// Relative sizes of the neighbourhood of the central ray.
const SIZES: [f64; 4] = [0.02, 0.01, 0.005, 0.0025];
/// Rounding error of a sum of 10⁴ terms.
const ROUNDING: f64 = 1e-12;

/// Distances travelled before and after the surface, in metres.
const TRAVELS: [f64; 2] = [1.0, 0.7];

const GLASS: Media = Media {
    before: 1.0,
    after: 1.5,
};
const OUT_OF_GLASS: Media = Media {
    before: 1.5,
    after: 1.0,
};

fn paths() -> Vec<(&'static str, MirrorPath)> {
    let path = |theta0, k, media| MirrorPath {
        travels: TRAVELS,
        theta0,
        k,
        media,
    };
    let mirror = |theta0, k| path(theta0, k, None);
    let glass = |theta0, k, media| path(theta0, k, Some(media));
    vec![
        ("plane mirror", mirror(0.65, 0.0)),
        ("convex mirror", mirror(0.0, 0.5)),
        ("convex mirror", mirror(0.65, 0.5)),
        ("convex mirror", mirror(1.1, 0.1)),
        ("concave mirror", mirror(0.0, -0.5)),
        ("concave mirror", mirror(0.65, -0.5)),
        ("concave mirror", mirror(1.1, -0.1)),
        ("into glass", glass(0.65, 0.5, GLASS)),
        ("out of glass", glass(0.4, -0.5, OUT_OF_GLASS)),
        ("into glass", glass(0.0, 0.5, GLASS)),
    ]
}

/// The section on Table 1 in 2D.
pub(super) fn planar() -> ReportSection {
    let mut rows = Vec::new();
    for (name, path) in paths() {
        for stage in [Travel, Incidence, Curvature, Event, Back, Outgoing, Beyond] {
            let found = path.found(stage);
            let cells = vec![
                format!("{stage:?}").to_lowercase(),
                name.to_owned(),
                format!("{}", path.theta0),
                format!("{}", path.k),
                format!("{:.1e}", found.map),
                format!("{:.2e}", found.traced[0]),
                format!("{:.2e}", found.traced[3]),
                format!("{:.3}", found.order),
                format!("{:.0}", found.known),
            ];
            rows.push(Row::new(cells, found.checks()).of([line(stage)]));
        }
    }
    ReportSection::new(
        "Operators in 2D: theory against quadrature",
        format!(
            "A Gaussian light field of width e travels over 1 m, meets a circle of curvature k at \
             the angle θ₀, and travels over 0.7 m. The spectrum that the operators give is \
             compared with two quadratures at 24 frequencies. *Up to* names the last operator that \
             is applied. *Map* is the difference from a plain quadrature of the field that the \
             operators map. *Traced* is the difference from a quadrature of the field that is \
             traced off the circle, at e = 0.02 and at 0.0025, and *order* is the exponent with \
             which this difference falls. Required: *map* is below {ROUNDING:.0e}. The order is \
             within {ORDER} of the known one, which is 1 where light comes at an angle and 2 where \
             it comes along the normal. It is also 2 where the only approximation is that angles \
             replace tangents: for travel, and off a plane mirror."
        ),
        "up to | surface | θ₀ | k | map | traced, e = 0.02 | traced, e = 0.0025 | order | known \
         order | verdict",
        rows,
    )
}

const fn line(stage: PathStage) -> Line {
    match stage {
        Travel | Beyond => Line::Travel,
        Incidence => Line::Incidence,
        Curvature | Back => Line::Curvature,
        Event => Line::Mirror,
        Outgoing => Line::Outgoing,
    }
}

/// The errors of the composed operators at one stage of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct StageFound {
    /// Error of the operators' spectrum relative to a quadrature of the mapped field.
    pub(super) map: f64,
    /// Relative errors of the operators' spectrum, compared with the traced field at all sizes.
    pub(super) traced: [f64; 4],
    pub(super) order: f64,
    pub(super) known: f64,
}

impl StageFound {
    pub(super) fn checks(&self) -> Vec<Check> {
        vec![
            Check::new("map", self.map, Below(ROUNDING)).because("rounding error of a sum"),
            orders::check(self.order, self.known),
        ]
    }
}

impl MirrorPath {
    /// Returns both comparisons.
    pub(super) fn found(&self, stage: PathStage) -> StageFound {
        let traced = SIZES.map(|size| {
            let (said, frequencies, field) = self.said(stage, size);
            apart(
                &said,
                &of_rays(&field, &|z| self.trace(stage, z), &frequencies),
            )
        });
        let (said, frequencies, field) = self.said(stage, SIZES[0]);
        let logs = [0, 1, 2, 3].map(|i: usize| [SIZES[i].ln(), traced[i].ln()]);
        StageFound {
            map: apart(&said, &of_field(&field, &self.map(stage), &frequencies)),
            order: slope(&logs),
            known: self.known(stage),
            traced,
        }
    }

    /// The order of the error, which is known in advance. The order is 1 at oblique
    /// incidence. It is 2 at normal incidence, and also if the only approximation is that angles
    /// replace tangents.
    fn known(&self, stage: PathStage) -> f64 {
        let flat_mirror = self.k == 0.0 && self.media.is_none();
        match stage {
            Travel => 2.0,
            Outgoing | Beyond if flat_mirror => 2.0,
            _ if self.theta0 == 0.0 => 2.0,
            _ => 1.0,
        }
    }

    /// The spectrum that the operators give for a field of this size, the frequencies, and
    /// the covariance of the field.
    fn said(&self, stage: PathStage, size: f64) -> (Vec<Complex>, Vec<[f64; 2]>, Matrix<2>) {
        let map = self.map(stage);
        let field = FIELD.map(|row| row.map(|s| s * size * size));
        let frequency = |i: i32| {
            // Frequencies of the original field, transformed by the map.
            let radius = 0.06 * f64::from(i / 6) / size;
            let angle = TAU * f64::from(i % 6) / 6.0 + 0.2;
            content(&map, [radius * angle.cos(), radius * angle.sin()])
        };
        let frequencies: Vec<[f64; 2]> = (0..24).filter_map(frequency).collect();
        let before = |omega| Complex::from(gaussian_spectrum(&field, omega));
        let said = frequencies.iter().map(|w| map.spectrum(*w, &before));
        (said.collect(), frequencies, field)
    }
}

/// The spectrum of exp(−½ zᵀ S⁻¹ z): 2π √det S exp(−2π² Ωᵀ S Ω).
fn gaussian_spectrum([[a, b], [_, d]]: &Matrix<2>, [x, theta]: [f64; 2]) -> f64 {
    let form = a * x * x + 2.0 * b * x * theta + d * theta * theta;
    TAU * (a * d - b * b).sqrt() * (-0.5 * TAU * TAU * form).exp()
}
