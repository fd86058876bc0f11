//! The spectrum of a chain at one frequency.

use super::expansion::Expansion;
use crate::Chain;
use crate::parallel::disc_resolution::DiscResolution;
use crate::parallel::slope::Slope;
use etendue_field::{Complex, Window};

/// The spectrum ℓ̂(Ωx, Ωy, Ωu, Ωv) of the windowed light field at one frequency.
///
/// The spectrum is brightness · Σ terms ± F(Ωx, Ωu) F(Ωy, Ωv), where each factor F is the transform
/// of a convex polygon and is evaluated separately. The result is exact for uniform rectangles,
/// half-planes and gratings, and accurate to 10⁻⁸ for factors that depend on slopes. For discs and
/// for diffuse reflection, the result has the error of a quadrature (see
/// [`quadrature_error`](crate::quadrature_error)). This function is the reference for
/// [`slices`](crate::slices). Unit: W m⁻² sr⁻¹ · m².
#[must_use]
pub fn at(chain: &Chain, window: &Window, frequency: [f64; 4]) -> Complex {
    let path = chain.path();
    if let Some(receiver) = path.receiver() {
        return receiver.at(window, frequency);
    }
    let [x, y, u, v] = frequency.map(f64::abs);
    let fineness = DiscResolution::for_spectrum(&path, window, [x.max(y), u.max(v)]);
    let slope = Slope::new([&window.u, &window.v], path.slope_power());
    Expansion::new(&path, window, &slope, &fineness.0).at(frequency)
}

impl Expansion {
    /// The spectrum at one frequency.
    pub(crate) fn at(&self, [x, y, u, v]: [f64; 4]) -> Complex {
        let k = [[x, u], [y, v]];
        let products = self.products.iter();
        products
            .map(|waves| {
                self.sum(|axis| {
                    let section = &self.sections[axis];
                    let polygons = section.polygons.iter();
                    polygons
                        .map(|p| section.value(&waves[axis], p, k[axis]))
                        .collect()
                })
            })
            .sum()
    }

    /// Returns brightness · Σ terms; `factors` returns the factors of all polygons of the section
    /// with the given axis.
    fn sum(&self, factors: impl Fn(usize) -> Vec<Complex>) -> Complex {
        let [x, y] = [factors(0), factors(1)];
        let terms = self.terms.iter();
        let sum: Complex = terms
            .map(|t| x[t.polygons[0]] * y[t.polygons[1]] * t.weight)
            .sum();
        sum * self.brightness
    }
}
