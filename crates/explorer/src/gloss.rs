//! The light field of a chain after a glossy lobe. The lobe convolves the field over slopes along x
//! (docs/theory.md (36a)).
//!
//! In flatland, a glossy reflection multiplies the spectrum by ρ̂'(Ωu), the spectrum of its lobe.
//! The window at the plane is applied last:
//!
//! S(ρ, ν) = ∫ Ŵ(ν − q) ρ̂'(q) I(ρ, q) dq,
//!
//! where I is the spectrum under a wider window. The wider window contains all slopes from which
//! lobes reach the plane's window. The integral is computed as a sum over q. A sum over q
//! corresponds to periodic copies of the field over slopes. The field under this window is bounded,
//! so the copies do not overlap if the spacing of the sum is small enough. Then the sum is exact up
//! to the lobe's tail. The lobe also blurs slopes along y, which moves a fraction of the light out
//! of the window. The result is therefore multiplied by the remaining fraction. This is exact if
//! the field is the product of a function of (x, u) and a function of (y, v), as behind slats along
//! y.

use etendue_field::{
    FrequencyAxis, Profile, Projection, ProjectionGrid, SliceGrid, Slices, Window, whole,
};
use etendue_theory::shading::PlanarLobe;
use etendue_theory::{Chain, projection, slices};
use ndarray::Array2;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The value of a lobe, relative to its peak, below which its tail is neglected in spectra and in
/// pictures.
const TAIL: f64 = 1e-10;
const SEEN_TAIL: f64 = 1e-4;
/// Distance between the periodic copies of the field, in widths of the field.
const APART: f64 = 1.05;
/// If the reach of a lobe exceeds this angle, in radians, the lobe is treated as cut off at a right
/// angle.
const BROAD: f64 = 1.5;
/// Maximum number of frequencies on each side of zero. Narrow lobes need this maximum number.
const MAX_FREQUENCIES: usize = 512;

/// The slice at azimuth 0 of the chain's field after a lobe, under a window.
///
/// # Panics
/// Panics if the grid has more than one azimuth.
pub(crate) fn blurred_slices(
    chain: &Chain,
    lobe: &PlanarLobe,
    window: &Window,
    grid: &SliceGrid,
) -> Slices {
    assert_eq!(grid.azimuths, 1, "flatland has one azimuth");
    let blur = Blur::new(lobe, &window.u);
    let sharp = SliceGrid {
        nu: blur.lattice,
        ..*grid
    };
    let wide = Window {
        u: blur.wide,
        ..*window
    };
    let sharp = slices(chain, &wide, &sharp);
    let weights: Vec<_> = grid
        .nu
        .values()
        .into_iter()
        .map(|nu| blur.weights(nu))
        .collect();
    let share = share(chain, lobe, window);
    let mut blurred = Slices::zeros(*grid);
    for ((k, m, n), value) in blurred.half.indexed_iter_mut() {
        let row = weights[n].iter().enumerate();
        *value = row
            .map(|(j, weight)| sharp.half[[k, m, j]] * weight * share)
            .sum();
    }
    blurred
}

/// The fraction of light that remains in the window after the lobe blurs slopes along y.
fn share(chain: &Chain, lobe: &PlanarLobe, window: &Window) -> f64 {
    let blur = Blur::new(lobe, &window.v);
    let none = FrequencyAxis {
        half: 0,
        spacing: 1.0,
    };
    // The grid has two azimuths; the second azimuth is along y.
    let grid = SliceGrid {
        azimuths: 2,
        rho: none,
        nu: blur.lattice,
    };
    let wide = Window {
        v: blur.wide,
        ..*window
    };
    let sharp = slices(chain, &wide, &grid);
    let row = blur.weights(0.0).into_iter().enumerate();
    let after: f64 = row
        .map(|(j, weight)| sharp.half[[1, 0, j]].re * weight)
        .sum();
    let before = slices(
        chain,
        window,
        &SliceGrid {
            azimuths: 1,
            rho: none,
            nu: none,
        },
    )
    .at_zero();
    if before > 0.0 { after / before } else { 1.0 }
}

/// A lobe as a function of one slope, represented by a sum over frequencies.
struct Blur {
    /// A profile that contains all slopes from which lobes reach the window.
    wide: Profile,
    lattice: FrequencyAxis,
    /// The values of ρ̂' at the frequencies of the sum, multiplied by the spacing of these
    /// frequencies.
    hats: Vec<f64>,
    window: Profile,
}

impl Blur {
    fn new(lobe: &PlanarLobe, window: &Profile) -> Self {
        let reach = reach(lobe, TAIL);
        let half = window.half_width() + reach;
        let period = 2.0 * APART * half;
        let lattice = FrequencyAxis {
            half: whole((highest(reach) * period).ceil()).min(MAX_FREQUENCIES),
            spacing: 1.0 / period,
        };
        let frequencies = lattice.values().into_iter();
        let hats = frequencies
            .map(|q| lattice.spacing * lobe.spectrum(q))
            .collect();
        Self {
            wide: Profile::Box(half),
            lattice,
            hats,
            window: *window,
        }
    }

    /// The weights with which the spectrum's frequencies q before the lobe contribute to
    /// the frequency ν after the lobe.
    fn weights(&self, nu: f64) -> Vec<f64> {
        let frequencies = self.lattice.values().into_iter().zip(&self.hats);
        frequencies
            .map(|(q, hat)| hat * self.window.transform(nu - q))
            .collect()
    }
}

/// The picture of the chain's field after a lobe, like [`projection`] without a lobe. The
/// lobe is treated as constant over a fraction of a cell, so the picture is accurate to this
/// fraction of a cell.
pub(crate) fn blurred_projection(
    chain: &Chain,
    lobe: &PlanarLobe,
    window: &Window,
    grid: &ProjectionGrid,
) -> Projection {
    let half_u = window.u.half_width() + reach(lobe, SEEN_TAIL);
    let u = Profile::Box(half_u);
    let wide = Window { u, ..*window };
    let sharp = projection(chain, &wide, &ProjectionGrid { half_u, ..*grid });
    let n = grid.bins;
    let cell = 2.0 * half_u / n as f64;
    let share = share(chain, lobe, window);
    let weights = Array2::from_shape_fn((n, n), |(to, from)| {
        let u = grid.center(to, grid.half_u);
        share * cell * window.u.value(u) * lobe.value(u - grid.center(from, half_u))
    });
    Projection {
        grid: *grid,
        values: sharp.values.dot(&weights.t()),
    }
}

/// The angle beyond which a lobe is below the fraction `share` of its peak.
fn reach(lobe: &PlanarLobe, share: f64) -> f64 {
    let least = share * lobe.value(0.0);
    let (mut inside, mut outside) = (0.0, FRAC_PI_2);
    for _ in 0..20 {
        let middle = 0.5 * (inside + outside);
        if lobe.value(middle) > least {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    outside
}

/// A frequency beyond which the spectrum of a lobe is negligible. This is the frequency for
/// a Gaussian with the same reach. Lobes that end at a right angle have transforms with tails, so
/// for them the frequency is three times as high.
fn highest(reach: f64) -> f64 {
    let deviations = (-2.0 * libm::log(TAIL)).sqrt();
    let tail = if reach < BROAD { 1.0 } else { 3.0 };
    tail * deviations * deviations / (TAU * reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{Complex, Light, Mask, Rectangle, Shape};
    use etendue_theory::{Operator, Source};

    fn square(center: [f64; 2], side: f64) -> Shape {
        Shape::Rectangle(Rectangle {
            center,
            size: [side; 2],
        })
    }

    fn behind(shapes: Vec<Shape>) -> Chain {
        let travel = |from: &str, to: &str| Operator::Travel {
            from: from.into(),
            to: to.into(),
            distance: 0.5,
        };
        let mask = Mask::Opaque {
            shapes,
            half_planes: Vec::new(),
        };
        let blockers = Operator::Visibility {
            name: "blockers".into(),
            mask,
        };
        let light = Light::Area {
            shape: square([0.0; 2], 0.2),
            radiance: 1.0,
            exponent: 0.0,
        };
        Chain {
            source: Source {
                name: "light".into(),
                light,
            },
            operators: vec![
                travel("light", "blockers"),
                blockers,
                travel("blockers", "end"),
            ],
        }
    }

    fn behind_blockers() -> Chain {
        let square_at = |i: usize, j: usize| {
            let (i, j) = (i as f64, j as f64);
            let jitter = [libm::sin(3.1 * i + 7.7 * j), libm::cos(5.3 * i - 2.9 * j)];
            let center = [0.2 * (i - 1.0), 0.2 * (j - 1.0)];
            square([0, 1].map(|k| center[k] + 0.05 * jitter[k]), 0.1)
        };
        behind((0..9).map(|k| square_at(k / 3, k % 3)).collect())
    }

    fn seen() -> Window {
        Window {
            x: Profile::Hann(0.3),
            y: Profile::Hann(0.3),
            u: Profile::Hann(0.3),
            v: Profile::Hann(0.3),
        }
    }

    fn grid(half: usize, spacing: f64) -> SliceGrid {
        let axis = FrequencyAxis { half, spacing };
        SliceGrid {
            azimuths: 1,
            rho: axis,
            nu: axis,
        }
    }

    fn largest(slices: &Slices) -> f64 {
        slices.half.iter().map(|s| s.norm()).fold(0.0, f64::max)
    }

    #[test]
    fn what_a_narrow_lobe_takes_is_in_proportion_to_its_width_squared() {
        let (chain, window, grid) = (behind_blockers(), seen(), grid(8, 1.0));
        let plain = slices(&chain, &window, &grid);
        let off = |deviation: f64| {
            let lobe = PlanarLobe::Gaussian { deviation };
            let blurred = blurred_slices(&chain, &lobe, &window, &grid);
            largest(&Slices {
                half: &blurred.half - &plain.half,
                ..plain.clone()
            }) / largest(&plain)
        };
        let [narrow, twice] = [0.002, 0.004].map(off);
        assert!(
            narrow < 0.001 && (twice / narrow - 4.0).abs() < 0.1,
            "{narrow:e} {twice:e}"
        );
    }

    #[test]
    fn a_square_light_loses_as_much_along_y_as_along_x() {
        let (chain, window, grid) = (behind(Vec::new()), seen(), grid(0, 1.0));
        let lobe = PlanarLobe::Phong { exponent: 30.0 };
        let plain = slices(&chain, &window, &grid).at_zero();
        let left = blurred_slices(&chain, &lobe, &window, &grid).at_zero() / plain;
        let along_y = share(&chain, &lobe, &window);
        // The tolerance is the rounding error of about a hundred terms.
        assert!(along_y < 0.9 && (left / along_y.powi(2) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn pictures_add_up_to_the_spectrum() {
        for exponent in [5.0, 12.0, 60.0, 400.0] {
            let lobe = PlanarLobe::Phong { exponent };
            let (chain, window, grid) = (behind_blockers(), seen(), grid(3, 1.5));
            let spectrum = blurred_slices(&chain, &lobe, &window, &grid);
            let cells = ProjectionGrid::new(&window, 256);
            let picture = blurred_projection(&chain, &lobe, &window, &cells);
            for (m, n) in [(0, 3), (1, 4), (3, 2), (2, 6)] {
                let (rho, nu) = (grid.rho.value(m + 3), grid.nu.value(n));
                let sum: Complex = picture
                    .values
                    .indexed_iter()
                    .map(|((i, j), value)| {
                        let [x, u] = [cells.center(i, cells.half_x), cells.center(j, cells.half_u)];
                        etendue_field::cis(-TAU * (rho * x + nu * u)) * value
                    })
                    .sum();
                let off = (sum * cells.cell_area() - spectrum.half[[0, m, n]]).norm();
                // The tolerance covers the error of cells of 1/128 of the half-width, and the
                // lobe's tail that is neglected in pictures.
                assert!(
                    off < 1e-3 * spectrum.at_zero(),
                    "{exponent} {m} {n}: {off:e}"
                );
            }
        }
    }
}
