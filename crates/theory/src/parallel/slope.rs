//! Expands the factor (1 + u² + v²)^p times the slope profiles of a window in a short sum of
//! products of cosine series (docs/theory.md (5d)).
//!
//! The function is decomposed by elimination with complete pivoting, one product a(u) b(v) at a
//! time (Townsend and Trefethen 2013). Each factor is smooth in the window and is fitted by cosines
//! whose period is longer than the window (a Fourier extension, Huybrechs 2010). The decomposition
//! and each fit stop when their measured residual is below a threshold.

use crate::quadrature::gauss_legendre;
use etendue_field::{CosineTerm, Profile};
use std::f64::consts::{PI, TAU};
use std::sync::{Mutex, PoisonError};

/// The elimination stops at this residual, relative to the largest value of the function.
const RANK_RESIDUAL: f64 = 6e-9;
/// The fits of a(u) and b(v) stop at this residual, relative to the largest value.
const FIT_RESIDUAL: f64 = 2e-9;
/// Number of nodes along half of a window's width.
const NODES: usize = 192;
/// Maximum number of terms of a cosine series.
const MOST_TERMS: usize = 120;
/// Half periods of the cosine series that are tried, in half-widths of the window. If the factor
/// varies slowly, longer periods need fewer terms.
const EXTENSIONS: [f64; 3] = [2.0, 1.5, 1.15];
/// The largest allowed coefficient of a cosine series. Terms with larger coefficients would nearly
/// cancel, which amplifies rounding errors.
const LARGEST_COEFFICIENT: f64 = 30.0;

/// Maximum number of expansions that are kept.
const MOST_KEPT: usize = 64;

/// The expansions computed last, with their profiles and powers. Estimates of work and predictions
/// ask for the same expansion many times.
static KEPT: Mutex<Vec<([Profile; 2], f64, Slope)>> = Mutex::new(Vec::new());

/// The function W(u) W(v) (1 + u² + v²)^p inside a window.
#[derive(Clone, Debug)]
pub(crate) struct Slope {
    /// The summands. Each is a product of a cosine series along u and a cosine series along v.
    /// Frequencies are in cycles per unit slope.
    pub(crate) parts: Vec<[Vec<CosineTerm>; 2]>,
    /// Root mean square error over the window, divided by the root mean square of the function. The
    /// residual is 0 if p = 0.
    pub(crate) residual: f64,
    /// Whether the power p is 0.
    pub(crate) is_profile: bool,
}

impl Slope {
    pub(crate) fn new(profiles: [&Profile; 2], power: f64) -> Self {
        if power == 0.0 {
            return Self {
                parts: vec![profiles.map(Profile::cosine_terms)],
                residual: 0.0,
                is_profile: true,
            };
        }
        let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same = |known: &&([Profile; 2], f64, Self)| {
            known.0.iter().eq(profiles) && known.1.total_cmp(&power).is_eq()
        };
        if let Some((.., slope)) = kept().iter().find(is_same) {
            return slope.clone();
        }
        let slope = Self::expanded(profiles, power);
        let mut kept = kept();
        if kept.len() == MOST_KEPT {
            kept.remove(0);
        }
        kept.push((profiles.map(Clone::clone), power, slope.clone()));
        slope
    }

    fn expanded(profiles: [&Profile; 2], power: f64) -> Self {
        let nodes = profiles.map(|p| nodes(p.half_width()));
        let value = |u: f64, v: f64| {
            profiles[0].value(u) * profiles[1].value(v) * libm::pow(1.0 + u * u + v * v, power)
        };
        let factors = eliminate(&nodes, value);
        let series = [0, 1].map(|axis| {
            let columns: Vec<_> = factors.iter().map(|f| f[axis].clone()).collect();
            fit(profiles[axis].half_width(), &nodes[axis], &columns)
        });
        let [u, v] = series;
        let parts: Vec<_> = u.into_iter().zip(v).map(|(a, b)| [a, b]).collect();
        let residual = residual(&nodes, value, &parts);
        Self {
            parts,
            residual,
            is_profile: false,
        }
    }
}

/// The sum of cosine terms at `t`, which must be inside the window.
fn sum(terms: &[CosineTerm], t: f64) -> f64 {
    let values = terms
        .iter()
        .map(|term| term.weight * libm::cos(TAU * term.frequency * t));
    values.sum()
}

/// Gauss nodes on (0, half).
fn nodes(half: f64) -> Vec<f64> {
    let rule = gauss_legendre(NODES).into_iter();
    rule.map(|(x, _)| 0.5 * half * (x + 1.0)).collect()
}

/// Decomposes the function `value` at nodes into a sum of products a(u) b(v).
fn eliminate(nodes: &[Vec<f64>; 2], value: impl Fn(f64, f64) -> f64) -> Vec<[Vec<f64>; 2]> {
    let [u, v] = nodes;
    let mut rest: Vec<Vec<f64>> = u
        .iter()
        .map(|&u| v.iter().map(|&v| value(u, v)).collect())
        .collect();
    let mut factors = Vec::new();
    let (_, _, first) = pivot(&rest);
    loop {
        let (i, j, largest) = pivot(&rest);
        if largest <= RANK_RESIDUAL * first || factors.len() == NODES {
            return factors;
        }
        // The magnitude is split evenly between a and b, so that the fits of both are equally
        // accurate.
        let root = largest.sqrt();
        let a: Vec<f64> = rest.iter().map(|row| row[j] / root).collect();
        let b: Vec<f64> = rest[i]
            .iter()
            .map(|value| value * root / rest[i][j])
            .collect();
        for (row, a) in rest.iter_mut().zip(&a) {
            row.iter_mut()
                .zip(&b)
                .for_each(|(value, b)| *value -= a * b);
        }
        factors.push([a, b]);
    }
}

/// Finds the element of a matrix that has the largest absolute value. Returns the row, the column
/// and the absolute value of this element.
fn pivot(matrix: &[Vec<f64>]) -> (usize, usize, f64) {
    let mut best = (0, 0, 0.0);
    for (i, row) in matrix.iter().enumerate() {
        for (j, value) in row.iter().enumerate() {
            if value.abs() > best.2 {
                best = (i, j, value.abs());
            }
        }
    }
    best
}

/// Fits cosine series to functions of one variable that are given at nodes. Tries several periods
/// and returns the series with the fewest terms.
fn fit(half: f64, nodes: &[f64], functions: &[Vec<f64>]) -> Vec<Vec<CosineTerm>> {
    let mut best: Option<CosineFit> = None;
    for extension in EXTENSIONS {
        let most = best
            .as_ref()
            .filter(|fit| fit.is_good())
            .map_or(MOST_TERMS, CosineFit::terms);
        let fit = CosineFit::new(extension * half, nodes, functions, most);
        if best.as_ref().is_none_or(|best| fit.beats(best)) {
            best = Some(fit);
        }
    }
    best.map(|fit| fit.series()).unwrap_or_default()
}

/// A least-squares fit by cosines, computed by modified Gram–Schmidt orthogonalisation with the
/// functions as additional columns (Björck 1967).
struct CosineFit {
    half_period: f64,
    /// Coefficients of the cosines, as [function][term].
    coefficients: Vec<Vec<f64>>,
    /// Largest residual of the fitted functions.
    residual: f64,
}

impl CosineFit {
    fn new(half_period: f64, nodes: &[f64], functions: &[Vec<f64>], most: usize) -> Self {
        let largest = functions.iter().map(|f| peak(f)).fold(0.0, f64::max);
        let mut rests = functions.to_vec();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        // `triangle` is the upper triangular matrix of the basis, column by column. The projections
        // of the functions are stored separately.
        let mut triangle: Vec<Vec<f64>> = Vec::new();
        let mut projections = vec![Vec::new(); functions.len()];
        for n in 0..most {
            let mut column: Vec<f64> = nodes
                .iter()
                .map(|t| libm::cos(PI * n as f64 * t / half_period))
                .collect();
            let mut entries: Vec<f64> = basis.iter().map(|q| remove(q, &mut column)).collect();
            let norm = dot(&column, &column).sqrt();
            entries.push(norm);
            column.iter_mut().for_each(|c| *c /= norm);
            for (rest, projection) in rests.iter_mut().zip(&mut projections) {
                projection.push(remove(&column, rest));
            }
            basis.push(column);
            triangle.push(entries);
            if rests
                .iter()
                .all(|rest| peak(rest) <= FIT_RESIDUAL * largest)
            {
                break;
            }
        }
        Self {
            half_period,
            coefficients: projections
                .into_iter()
                .map(|p| solve(&triangle, p))
                .collect(),
            residual: rests.iter().map(|r| peak(r)).fold(0.0, f64::max) / largest,
        }
    }

    fn terms(&self) -> usize {
        self.coefficients.first().map_or(0, Vec::len)
    }

    fn is_good(&self) -> bool {
        let largest = self
            .coefficients
            .iter()
            .map(|c| peak(c))
            .fold(0.0, f64::max);
        self.residual <= FIT_RESIDUAL && largest < LARGEST_COEFFICIENT
    }

    fn beats(&self, other: &Self) -> bool {
        match (self.is_good(), other.is_good()) {
            (true, true) => self.terms() < other.terms(),
            (false, false) => self.half_period < other.half_period,
            (good, _) => good,
        }
    }

    fn series(&self) -> Vec<Vec<CosineTerm>> {
        let term = |(n, &weight): (usize, &f64)| CosineTerm {
            frequency: n as f64 / (2.0 * self.half_period),
            weight,
        };
        let all = self.coefficients.iter();
        all.map(|c| c.iter().enumerate().map(term).collect())
            .collect()
    }
}

/// Removes the component of `column` along the unit vector `q`, and returns the length of this
/// component.
fn remove(q: &[f64], column: &mut [f64]) -> f64 {
    let along = dot(q, column);
    column.iter_mut().zip(q).for_each(|(c, q)| *c -= along * q);
    along
}

/// The solution of an upper triangular system whose matrix is given by columns.
fn solve(triangle: &[Vec<f64>], mut right: Vec<f64>) -> Vec<f64> {
    for n in (0..right.len()).rev() {
        right[n] /= triangle[n][n];
        let value = right[n];
        for (r, entry) in right[..n].iter_mut().zip(&triangle[n]) {
            *r -= value * entry;
        }
    }
    right
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The largest absolute value of a slice of numbers.
fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// The root mean square of the difference between the function and the sum of `parts`,
/// divided by the root mean square of the function.
fn residual(
    nodes: &[Vec<f64>; 2],
    value: impl Fn(f64, f64) -> f64,
    parts: &[[Vec<CosineTerm>; 2]],
) -> f64 {
    let tables = [0, 1].map(|axis| -> Vec<Vec<f64>> {
        let row = |&t: &f64| parts.iter().map(|part| sum(&part[axis], t)).collect();
        nodes[axis].iter().map(row).collect()
    });
    let (mut error, mut size) = (0.0, 0.0);
    for (&u, a) in nodes[0].iter().zip(&tables[0]) {
        for (&v, b) in nodes[1].iter().zip(&tables[1]) {
            let expected = value(u, v);
            error += (dot(a, b) - expected).powi(2);
            size += expected.powi(2);
        }
    }
    (error / size).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest error at points between the nodes, the number of products, and the
    /// number of terms.
    fn check(profiles: [Profile; 2], power: f64) -> (f64, usize, usize) {
        let slope = Slope::new([&profiles[0], &profiles[1]], power);
        let mut worst = 0.0;
        for i in 0..60 {
            for j in 0..60 {
                let [u, v] = [(0, i), (1, j)].map(|(axis, i): (usize, i32)| {
                    profiles[axis].half_width() * (f64::from(i) / 30.0 - 0.99)
                });
                let window = profiles[0].value(u) * profiles[1].value(v);
                let expected = window * libm::pow(1.0 + u * u + v * v, power);
                let parts = slope.parts.iter();
                let got: f64 = parts.map(|p| sum(&p[0], u) * sum(&p[1], v)).sum();
                worst = f64::max(worst, (got - expected).abs());
            }
        }
        let terms = slope.parts[0].iter().map(Vec::len).max();
        assert!(
            slope.residual < 3.0 * worst + 1e-15,
            "{} {worst}",
            slope.residual
        );
        (worst, slope.parts.len(), terms.unwrap_or(0))
    }

    #[test]
    fn parts_add_up_to_the_power() {
        for half in [0.1, 0.3, 0.5, 1.0, 1.5] {
            let gaussian = Profile::Gaussian {
                width: 0.6 * half,
                cut: half,
            };
            for profile in [Profile::Hann(half), Profile::Box(half), gaussian] {
                for power in [0.5, -1.5, -2.0, -10.0, -50.0] {
                    let (worst, rank, terms) = check([profile, profile], power);
                    let scale = libm::pow(1.0 + 2.0 * half * half, f64::max(power, 0.0));
                    // The tolerance is a few times the residuals of 6e-9 and 2e-9.
                    assert!(worst < 2e-8 * scale, "{profile:?} {power}: {worst:e}");
                    assert!(half > 0.5 || rank <= 5 && terms <= 24, "{rank} {terms}");
                }
            }
        }
    }

    #[test]
    fn profiles_may_differ() {
        let (worst, ..) = check([Profile::Hann(0.3), Profile::Box(1.1)], -2.0);
        assert!(worst < 2e-8); // the same residuals
    }

    #[test]
    fn no_power_is_the_profile_itself() {
        let profile = Profile::Hann(0.5);
        let slope = Slope::new([&profile, &profile], 0.0);
        let terms = profile.cosine_terms();
        assert_eq!(slope.parts, [[terms.clone(), terms]]);
    }
}
