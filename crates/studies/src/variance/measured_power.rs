//! The power |f_m|² of a light field at whole frequencies of the window, measured by photons.

use crate::variance::VarianceError;
use crate::variance::power_estimate::{GroupShares, PowerEstimate, jackknife_error};
use etendue_field::{Complex, FrequencyAxis, PhotonSource, Profile, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_spectrum::Uncertain;
use etendue_spectrum::field::{FieldGroup, FieldOptions, measure_field};

/// The number of cells of the grid along each axis, divided by the largest frequency. A Nyquist
/// frequency of twice the largest frequency leaves little aliasing.
const CELLS_PER_FREQUENCY: usize = 4;

/// The range of the largest frequency along each axis.
pub const FREQUENCIES: std::ops::RangeInclusive<usize> = 2..=16;

/// The default largest frequency along each axis.
pub const DEFAULT_FREQUENCIES: usize = 8;

/// The power |f_m|² at the frequencies |m_k| ≤ M along each axis, (x, u, y, v).
///
/// f_m = ∫ f(z) e^(−2πi m·z) dz over the window coordinates z in \[0, 1\]⁴, so the unit of the power
/// is the square of the unit of radiance.
#[derive(Clone, Debug)]
pub struct MeasuredPower {
    /// M.
    pub(crate) max: usize,
    /// The power in row-major order, from −M to M along each axis; 0 at m = 0.
    pub spectrum: PowerEstimate,
    /// The mean of f over the window, f_0.
    pub mean: Uncertain,
}

/// A scene that sees one plane, [with a Box window](box_window), by photons that suit
/// [grids](Scene::on_grids).
#[must_use]
pub fn with_box_window(scene: &Scene, index: usize, max: usize) -> Scene {
    let mut scene = scene.seen_at(&[index]).on_grids();
    for plane in &mut scene.planes {
        *plane = box_window(plane, max);
    }
    scene
}

/// A plane whose windows are replaced by Box windows of the same half-widths. The grid of
/// this plane reaches twice `max` cycles per window.
#[must_use]
pub fn box_window(plane: &VirtualPlane, max: usize) -> VirtualPlane {
    let mut plane = plane.clone();
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
    plane
}

/// The options with which the grid of a plane is measured.
#[must_use]
pub fn field_options() -> FieldOptions {
    FieldOptions {
        keep: true,
        spectra: true,
        ..FieldOptions::default()
    }
}

impl MeasuredPower {
    /// Measures the power at a plane with a [Box window](box_window), which is plane 0 of
    /// `source`. `progress` is called with the number of photons as they are traced.
    ///
    /// # Errors
    ///
    /// Fails if fewer than three batches have photons.
    pub fn measure(
        plane: &VirtualPlane,
        (source, batches): (&dyn PhotonSource, u32),
        max: usize,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Self, VarianceError> {
        let options = field_options();
        let field = measure_field(source, 0, plane, 0..batches, &options, progress)?;
        Ok(Self::of_groups(&field.groups, plane, max))
    }

    /// The power from the spectra of independent groups of photons.
    ///
    /// The estimate of |f_m|² is Σ_(r≠s) Re(G_r conj G_s)/(1 − Σ a_r²), where group r contributes G_r
    /// to the spectrum and has the share a_r of the batches.
    fn of_groups(groups: &[FieldGroup], plane: &VirtualPlane, max: usize) -> Self {
        let Window { x, y, u, v } = plane.window;
        let volume: f64 = [x, y, u, v].iter().map(|p| 2.0 * p.half_width()).product();
        let shares = GroupShares::new(groups.iter().map(|group| group.share).collect());
        let all = box_frequencies(max);
        let mut power = Vec::with_capacity(all.len());
        let mut without_group = vec![Vec::with_capacity(all.len()); groups.len()];
        for [x, u, y, v] in &all {
            let of = |group: &FieldGroup| group.spectrum.at([*x, *y, *u, *v]) / volume;
            let values: Vec<Complex> = groups.iter().map(of).collect();
            let sum: Complex = values.iter().sum();
            let product = |value: &Complex| (value * (sum - value).conj()).re;
            let is_zero = [*x, *u, *y, *v] == [0; 4];
            let products = values
                .iter()
                .map(|v| if is_zero { 0.0 } else { product(v) });
            let products: Vec<f64> = products.collect();
            power.push(shares.power(&products));
            for (r, without) in without_group.iter_mut().enumerate() {
                without.push(shares.power_without(&products, r));
            }
        }
        let zero = |group: &FieldGroup| group.spectrum.at_zero() / volume;
        Self {
            max,
            spectrum: PowerEstimate {
                power,
                without_group,
                is_last: all.iter().map(|m| is_in_last_octave(m, max)).collect(),
            },
            mean: mean(groups.iter().map(|group| (group.share, zero(group)))),
        }
    }
}

/// All frequencies of the box, in the order of [`MeasuredPower::power`].
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

/// Checks whether a frequency is in the last octave of the box.
pub(crate) fn is_in_last_octave(m: &[isize; 4], max: usize) -> bool {
    m.iter().any(|m| 2 * m.unsigned_abs() > max)
}

/// The sum of contributions of groups, and its error from the differences of the groups.
fn mean(groups: impl Iterator<Item = (f64, f64)>) -> Uncertain {
    let groups: Vec<(f64, f64)> = groups.collect();
    let value: f64 = groups.iter().map(|(_, part)| part).sum();
    let without = groups
        .iter()
        .map(|(share, part)| (value - part) / (1.0 - share));
    let error = jackknife_error(&without.collect::<Vec<_>>());
    Uncertain { value, error }
}
