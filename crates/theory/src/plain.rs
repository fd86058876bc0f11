use crate::{Chain, expansion::Expansion};
use etendue_field::{Complex, Window};

/// The spectrum ℓ̂(Ωx, Ωy, Ωu, Ωv) of the windowed light field at one frequency.
///
/// Exact for uniform rectangles: radiance · Σ terms ± F(Ωx, Ωu) F(Ωy, Ωv), the factors being transforms of
/// convex polygons, evaluated one by one. It is the truth for [`slices`](crate::slices).
/// Unit: W m⁻² sr⁻¹ · m².
#[must_use]
pub fn at(chain: &Chain, window: &Window, frequency: [f64; 4]) -> Complex {
    let expansion = Expansion::new(chain, window);
    let [x, y, u, v] = frequency;
    let factors = [[x, u], [y, v]];
    expansion.sum(|axis| {
        let section = &expansion.sections[axis];
        let polygons = section.polygons.iter();
        polygons.map(|p| section.value(p, factors[axis])).collect()
    })
}

impl Expansion {
    /// radiance · Σ terms, from the factors of all polygons of section `axis`.
    fn sum(&self, factors: impl Fn(usize) -> Vec<Complex>) -> Complex {
        let [x, y] = [factors(0), factors(1)];
        let terms = self.terms.iter();
        let sum: Complex = terms
            .map(|t| x[t.polygons[0]] * y[t.polygons[1]] * t.sign)
            .sum();
        sum * self.radiance
    }
}
