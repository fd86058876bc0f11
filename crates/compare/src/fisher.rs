//! The Fisher information of slices about parameters.

use crate::normal::{NormalEquations, solved};
use ndarray::{Array2, Axis};

/// The smallest λ.
const MIN_SHRINKAGE: f64 = 1e-3;

/// The Fisher information DᵀC⁻¹D of the mean residual about the parameters, [n, n], if its noise is
/// normal. The covariance C is that of the residuals, shrunk towards noise that is independent at
/// all frequencies. The equations and `products`, Σ Re conj(r_b) r_c/σ² [R, R], may be sums over
/// planes. `None` if C is singular.
///
/// Residuals and derivatives are divided by √R σ, so that the noise of a real or imaginary part has
/// the variance 1/2. With Y = the residuals minus their mean as columns, C = λ/2 + (1 − λ)
/// Y Yᵀ/(R − 1), where λ is that of Ledoit and Wolf (2004). By Woodbury's identity, λ/2 C⁻¹ =
/// 1 − Y (c + YᵀY)⁻¹ Yᵀ with c = λ (R − 1)/(2 (1 − λ)).
#[must_use]
pub fn fisher_information(
    equations: &NormalEquations,
    products: &Array2<f64>,
) -> Option<Array2<f64>> {
    let count = products.nrows() as f64;
    let scores = &equations.scores - &equations.scores.mean_axis(Axis(0))?;
    let rows = products.mean_axis(Axis(0))?;
    let columns = rows.clone().insert_axis(Axis(1));
    let mut centred = (products - &rows - columns + rows.mean()?) / count;
    let shrinkage = shrinkage(&centred)?;
    let damping = 0.5 * shrinkage * (count - 1.0) / (1.0 - shrinkage);
    centred.diag_mut().mapv_inplace(|of| of + damping);
    let explained = scores.t().dot(&solved(&centred, &scores)?) / count;
    Some((&equations.information - explained) / (0.5 * shrinkage))
}

/// λ of Ledoit and Wolf (2004) for the target 1/2, from products of centred residuals. With C =
/// Σ y yᵀ/n and n = R − 1, λ = Σ ‖y yᵀ − C‖²/n²/‖C − 1/2‖².
fn shrinkage(products: &Array2<f64>) -> Option<f64> {
    let n = products.nrows() as f64 - 1.0;
    let trace = products.diag().sum() / n;
    let square: f64 = products.iter().map(|p| p * p).sum::<f64>() / (n * n);
    let each: f64 = products.diag().iter().map(|p| p * p).sum();
    let spread = (each / n - square).max(0.0) / n;
    // ‖C − 1/2‖² = ‖C‖² − tr C + m/4, and tr C = m/2 because of the division by σ.
    let apart = square - 0.5 * trace;
    (trace > 0.0).then(|| (spread / apart.max(spread)).clamp(MIN_SHRINKAGE, 1.0 - MIN_SHRINKAGE))
}
