//! Checks of the expected power of jittered strips.

use etendue_field::sinc;

/// Opaque strips in a row, each displaced by an independent offset that is uniformly distributed
/// within ± half the jitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JitteredArray {
    /// Number N of strips.
    pub(crate) count: usize,
    /// Width s of a strip, in metres.
    pub(crate) size: f64,
    /// Distance p between neighbours before jitter, in metres.
    pub(crate) pitch: f64,
    /// Full width j of the offsets' distribution, in metres.
    pub(crate) jitter: f64,
}

/// The expected power E|B̂(Ω)|² of the blocked part B = Σ rect((x − xₙ)/s) of a jittered
/// array, in m²: s² sinc²(sΩ) [N (1 − sinc²(jΩ)) + D² sinc²(jΩ)], D = sin(πNpΩ)/sin(πpΩ)
/// (docs/theory.md (10)).
///
/// The first term is the noise that the offsets cause. The second term is the remainder of the
/// spectral lines of a regular array.
#[must_use]
pub(crate) fn jittered_array_power(array: &JitteredArray, omega: f64) -> f64 {
    let n = array.count as f64;
    let kept = sinc(array.jitter * omega).powi(2);
    // D² has the period 1 in pΩ. Near pΩ = 0 a quotient of sincs replaces 0/0.
    let phase = array.pitch * omega;
    let phase = phase - phase.round();
    let lines = n * sinc(n * phase) / sinc(phase);
    let strip = array.size * sinc(array.size * omega);
    strip * strip * (n * (1.0 - kept) + lines * lines * kept)
}
