//! The power |f_m|² of a light field at whole frequencies of the window, measured by photons.

use crate::VarianceError;
use etendue_field::{FrequencyAxis, PhotonSource, Profile, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_spectrum::Uncertain;
use etendue_spectrum::field::{FieldGroup, FieldOptions, measure_field};

/// The number of cells of the grid along each axis, divided by the largest frequency. A Nyquist
/// frequency of twice the largest frequency leaves little aliasing.
const CELLS_PER_FREQUENCY: usize = 4;

/// The range of the largest frequency along each axis.
pub const FREQUENCIES: std::ops::RangeInclusive<usize> = 2..=16;

/// The power |f_m|² at the frequencies |m_k| ≤ M along each axis, (x, u, y, v).
///
/// f_m = ∫ f(z) e^(−2πi m·z) dz over the window coordinates z in \[0, 1\]⁴, so the unit of the power
/// is the square of the unit of radiance. The power is estimated from products of independent
/// groups of photons. Therefore it contains no power of the photons' noise, and it may be negative.
#[derive(Clone, Debug)]
pub struct MeasuredPower {
    /// M.
    pub(crate) max: usize,
    /// The power in row-major order, from −M to M along each axis; 0 at m = 0.
    pub(crate) power: Vec<f64>,
    /// The same, with one group of photons left out.
    pub(crate) without_group: Vec<Vec<f64>>,
    /// The mean of f over the window, f_0.
    pub mean: Uncertain,
}

/// Returns a scene that sees one plane, whose windows are replaced by Box windows of the same
/// half-widths. The grid of this plane reaches twice `max` cycles per window.
#[must_use]
pub fn with_box_window(scene: &Scene, index: usize, max: usize) -> Scene {
    let mut scene = scene.seen_at(&[index]);
    for plane in &mut scene.planes {
        let Window { x, y, u, v } = plane.window;
        let [x, y, u, v] = [x, y, u, v].map(|profile| Profile::Box(profile.half_width()));
        plane.window = Window { x, y, u, v };
        let reaching = |profiles: [Profile; 2]| {
            let half_width = profiles.iter().map(Profile::half_width);
            let spacing = 0.5 / half_width.fold(f64::INFINITY, f64::min);
            let half = CELLS_PER_FREQUENCY / 2 * max;
            FrequencyAxis { half, spacing }
        };
        plane.grid.rho = reaching([x, y]);
        plane.grid.nu = reaching([u, v]);
    }
    scene
}

/// Returns the options with which the grid of a plane is measured.
#[must_use]
pub fn field_options() -> FieldOptions {
    FieldOptions {
        keep: true,
        spectra: true,
        ..FieldOptions::default()
    }
}

impl MeasuredPower {
    /// Measures the power at the only plane of a scene from [`with_box_window`], with the photons of
    /// `source`. `progress` is called with the number of photons as they are traced.
    ///
    /// # Errors
    ///
    /// Fails if fewer than three batches have photons.
    pub fn measure(
        scene: &Scene,
        source: &dyn PhotonSource,
        max: usize,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Self, VarianceError> {
        let plane = &scene.planes[0];
        let batches = 0..scene.run.batches;
        let field = measure_field(source, 0, plane, batches, &field_options(), progress)?;
        Ok(Self::of_groups(&field.groups, plane, max))
    }

    /// Returns the power from the spectra of independent groups of photons.
    ///
    /// The estimate of |f_m|² is Σ_(r≠s) Re(G_r conj G_s)/(1 − Σ a_r²), where group r contributes G_r
    /// to the spectrum and has the share a_r of the batches (docs/theory.md (13)).
    fn of_groups(groups: &[FieldGroup], plane: &VirtualPlane, max: usize) -> Self {
        let Window { x, y, u, v } = plane.window;
        let volume: f64 = [x, y, u, v].iter().map(|p| 2.0 * p.half_width()).product();
        let shares: Vec<f64> = groups.iter().map(|group| group.share).collect();
        let squares: f64 = shares.iter().map(|a| a * a).sum();
        let all = box_frequencies(max);
        let mut power = Vec::with_capacity(all.len());
        let mut without_group = vec![Vec::with_capacity(all.len()); groups.len()];
        for [x, u, y, v] in all {
            let of = |group: &FieldGroup| group.spectrum.at([x, y, u, v]) / volume;
            let values: Vec<_> = groups.iter().map(of).collect();
            let sum: etendue_field::Complex = values.iter().sum();
            let row = |r: usize| (values[r] * (sum - values[r]).conj()).re;
            let pairs: f64 = (0..values.len()).map(row).sum();
            let is_zero = [x, u, y, v] == [0; 4];
            let unless_zero = |value: f64| if is_zero { 0.0 } else { value };
            power.push(unless_zero(pairs / (1.0 - squares)));
            for (r, without) in without_group.iter_mut().enumerate() {
                let norm = (1.0 - shares[r]).powi(2) - (squares - shares[r] * shares[r]);
                without.push(unless_zero((pairs - 2.0 * row(r)) / norm));
            }
        }
        let zero = |group: &FieldGroup| group.spectrum.at_zero() / volume;
        Self {
            max,
            power,
            without_group,
            mean: mean(groups.iter().map(|group| (group.share, zero(group)))),
        }
    }

    /// Returns the sum of the power over all frequencies m ≠ 0 of the box.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.power.iter().sum()
    }

    /// Returns the power and the leave-one-out estimates of a linear function of the power.
    pub(crate) fn estimates(&self, of: impl Fn(&[f64]) -> f64) -> (f64, Vec<f64>) {
        let without = self.without_group.iter().map(|power| of(power));
        (of(&self.power), without.collect())
    }
}

/// Returns all frequencies of the box, in the order of [`MeasuredPower::power`].
#[expect(
    clippy::cast_possible_wrap,
    reason = "frequencies are at most 16 along each axis"
)]
pub(crate) fn box_frequencies(max: usize) -> Vec<[isize; 4]> {
    let max = max as isize;
    let axis = || -max..=max;
    let pairs = axis().flat_map(|x| axis().map(move |u| [x, u]));
    let pairs: Vec<[isize; 2]> = pairs.collect();
    let all = pairs
        .iter()
        .flat_map(|[x, u]| pairs.iter().map(|[y, v]| [*x, *u, *y, *v]));
    all.collect()
}

/// Returns the standard error of an estimate by the delete-one jackknife.
pub(crate) fn jackknife_error(without: &[f64]) -> f64 {
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let squares: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
    (squares * (n - 1.0) / n).sqrt()
}

/// Returns the sum of contributions of groups, and its error from the differences of the groups.
fn mean(groups: impl Iterator<Item = (f64, f64)>) -> Uncertain {
    let groups: Vec<(f64, f64)> = groups.collect();
    let value: f64 = groups.iter().map(|(_, part)| part).sum();
    let without = groups
        .iter()
        .map(|(share, part)| (value - part) / (1.0 - share));
    let error = jackknife_error(&without.collect::<Vec<_>>());
    Uncertain { value, error }
}
