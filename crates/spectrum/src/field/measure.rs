//! Measures a light field on a 4D grid.

use super::bins::RadialBins;
use super::cells::{FieldCells, FieldTransform};
use super::covariance::{FieldCovariance, GroupMoments, Moments};
use super::cross::{FullRadial, GroupPower, full_radial};
use super::spectrum::FieldSpectrum;
use crate::estimate::TooFewBatches;
use etendue_field::{Assignment, Crossing, FieldGrid, PhotonSource, PlaneTally, VirtualPlane};
use ndarray::Array4;
use rayon::prelude::*;
use std::ops::Range;

/// The minimum number of groups for a jackknife.
const MIN_GROUPS: usize = 3;

/// Options for measuring a light field on a 4D grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldOptions {
    /// The method that assigns a ray to cells.
    pub assignment: Assignment,
    /// Number of independent groups of batches from which errors are estimated. The number is at
    /// least 3, and at most the number of batches.
    pub groups: usize,
    /// Whether the grids of all groups are kept in memory. If the grids are not kept, photons are
    /// traced twice: once for the sum of all groups, and once for each group. The result is
    /// bitwise the same, whether the grids are kept or not.
    pub keep: bool,
    /// Whether to return the spectra of all groups. If so, all of these spectra are in memory at
    /// the same time.
    pub spectra: bool,
    /// Whether the covariance of the spectrum is computed too, over the frequencies of the plane.
    /// If the covariance is computed, the grid extends to 1.5 times the largest frequencies of the
    /// plane. At the largest frequency of the plane, the alias is then an eighth of the spectrum at
    /// twice this frequency.
    pub covariance: bool,
}

impl Default for FieldOptions {
    /// The default options: triangular shaped clouds, 16 groups that are not kept, no
    /// spectra of groups, and no covariance.
    fn default() -> Self {
        Self {
            assignment: Assignment::Tsc,
            groups: 16,
            keep: false,
            spectra: false,
            covariance: false,
        }
    }
}

/// The largest frequency of the grid for a covariance, divided by the largest frequency of the
/// covariance.
const MARGIN: f64 = 1.5;

impl FieldOptions {
    /// The grid on which a plane is measured.
    #[must_use]
    pub fn grid(&self, plane: &VirtualPlane) -> FieldGrid {
        let mut slices = plane.grid;
        if self.covariance {
            slices.rho.spacing *= MARGIN;
            slices.nu.spacing *= MARGIN;
        }
        FieldGrid::new(&plane.window, &slices)
    }

    /// The number of bytes that [`measure_field`] needs on `threads` threads. The field,
    /// its spectrum, and the grids of all groups that are kept or being measured need these bytes.
    /// The caller should compare this number with the available memory before the measurement.
    #[must_use]
    pub fn bytes(&self, grid: &FieldGrid, threads: usize) -> u64 {
        let groups = self.groups.max(MIN_GROUPS);
        let grids = if self.keep || self.spectra {
            groups
        } else {
            groups.min(threads)
        };
        grid.bytes().saturating_mul(2 + grids as u64)
    }
}

/// The light field of a plane on its 4D grid, and the results derived from it.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldMeasurement {
    /// The grid.
    pub grid: FieldGrid,
    /// Number of photons that crossed the plane.
    pub tally: PlaneTally,
    /// The mean windowed light field, [x, y, u, v] ascending, at the cells' centres. The field is
    /// smoothed by the spline of the assignment. The unit of the field is the unit of L W, W m⁻²
    /// sr⁻¹.
    pub field: Array4<f64>,
    /// The spectrum of the field, divided by the transform of the spline.
    pub spectrum: FieldSpectrum,
    /// The full radial spectrum of the field.
    pub full_radial: FullRadial,
    /// The groups of batches that add up to the field, if their spectra were requested.
    pub groups: Vec<FieldGroup>,
    /// The covariance of the spectrum, if it was requested.
    pub covariance: Option<FieldCovariance>,
}

/// The contribution of a group of batches to the spectrum of a light field.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldGroup {
    /// The number of batches in the group, divided by the number of all batches.
    pub share: f64,
    /// The contribution of the group to the spectrum. The expectation of the contribution is
    /// `share` times the expectation of the spectrum.
    pub spectrum: FieldSpectrum,
}

/// Measures the light field at plane number `index` of `source` on the grid from
/// [`FieldOptions::grid`].
///
/// The batches and photons are the same as in [`measure`](crate::measure). The field and the
/// spectrum are unweighted means over batches, as in [`estimate::slices`](crate::estimate::slices).
/// The i-th non-empty batch belongs to group i mod R. One thread measures a group sequentially, and
/// groups are summed in order, so the result is bitwise identical on any number of threads.
///
/// One call measures only one plane, because the grids of a plane need much memory: see
/// [`FieldOptions::bytes`]. `progress` is called with the number of photons as they are traced.
/// Each photon counts twice unless the grids of groups are kept.
///
/// # Errors
///
/// Fails if fewer than three batches have photons.
pub fn measure_field(
    source: &dyn PhotonSource,
    index: usize,
    plane: &VirtualPlane,
    batches: Range<u32>,
    options: &FieldOptions,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<FieldMeasurement, TooFewBatches> {
    // A batch without photons says nothing about noise.
    let batches: Vec<u32> = batches.filter(|b| source.emitted(*b) > 0).collect();
    if batches.len() < MIN_GROUPS {
        return Err(TooFewBatches {
            have: batches.len(),
            need: MIN_GROUPS,
        });
    }
    let grid = options.grid(plane);
    let run = GroupContext {
        source,
        index,
        plane,
        groups: options.groups.clamp(MIN_GROUPS, batches.len()),
        batches,
        spectra: options.spectra,
        transform: FieldTransform::new(grid, options.assignment),
        progress,
    };
    let (sum, tally, kept) = run.sum(options.keep);
    let field = sum.field();
    let spectrum = run.transform.spectrum(sum);
    let bins = RadialBins::new(&grid);
    let moments = options.covariance.then(|| Moments::new(grid, &plane.grid));
    // Powers of groups need the spectrum of all groups. Groups whose grids are not kept are
    // traced again.
    let mut found = run.powers(&bins, moments.as_ref(), &spectrum, kept);
    let groups = found.iter_mut().filter_map(|found| found.spectrum.take());
    let groups = groups.collect();
    let powers: Vec<&GroupPower> = found.iter().map(|found| &found.power).collect();
    let of_groups = found.iter().filter_map(|found| found.moments.as_ref());
    Ok(FieldMeasurement {
        full_radial: full_radial(&bins, &powers),
        covariance: moments.map(|moments| FieldCovariance::new(&moments, of_groups)),
        groups,
        grid,
        tally,
        field,
        spectrum,
    })
}

/// The result of one group of batches.
struct OfGroup {
    power: GroupPower,
    moments: Option<GroupMoments>,
    /// The spectrum of the group, if spectra of groups are requested.
    spectrum: Option<FieldGroup>,
}

/// The data that all groups share.
struct GroupContext<'a> {
    source: &'a dyn PhotonSource,
    index: usize,
    plane: &'a VirtualPlane,
    batches: Vec<u32>,
    groups: usize,
    spectra: bool,
    transform: FieldTransform,
    progress: &'a (dyn Fn(u64) + Sync),
}

impl GroupContext<'_> {
    /// The sum of the grids of all groups, and the grids of the groups if they are kept.
    fn sum(&self, keep: bool) -> (FieldCells, PlaneTally, Vec<FieldCells>) {
        let mut sum = self.transform.cells();
        let mut tally = PlaneTally::default();
        let mut kept = Vec::new();
        for wave in self.waves() {
            let groups: Vec<_> = wave
                .into_par_iter()
                .map(|group| self.trace(group))
                .collect();
            for (cells, group_tally) in groups {
                sum.add(&cells);
                tally.add(&group_tally);
                if keep {
                    kept.push(cells);
                }
            }
        }
        (sum, tally, kept)
    }

    /// The contribution of each group to the power, where `all` is the spectrum of the
    /// sum of all groups.
    fn powers(
        &self,
        bins: &RadialBins,
        moments: Option<&Moments>,
        all: &FieldSpectrum,
        kept: Vec<FieldCells>,
    ) -> Vec<OfGroup> {
        let mut kept = kept.into_iter();
        let mut powers = Vec::new();
        for wave in self.waves() {
            let groups: Vec<_> = wave.map(|group| (group, kept.next())).collect();
            powers.par_extend(groups.into_par_iter().map(|(group, cells)| {
                let cells = cells.unwrap_or_else(|| self.trace(group).0);
                let share = self.members(group).len() as f64 / self.batches.len() as f64;
                let spectrum = self.transform.spectrum(cells);
                OfGroup {
                    power: GroupPower::new(bins, share, &spectrum, all),
                    moments: moments
                        .map(|moments| GroupMoments::new(moments, share, &spectrum, all)),
                    spectrum: self.spectra.then_some(FieldGroup { share, spectrum }),
                }
            }));
        }
        powers
    }

    /// Returns ranges of groups; the groups of one range are processed at the same time. A range
    /// has as many groups as there are threads, which limits the number of grids in memory.
    fn waves(&self) -> impl Iterator<Item = Range<usize>> {
        let threads = rayon::current_num_threads();
        let starts = (0..self.groups).step_by(threads);
        starts.map(move |start| start..(start + threads).min(self.groups))
    }

    /// The numbers of the batches of a group.
    fn members(&self, group: usize) -> impl ExactSizeIterator<Item = u32> {
        self.batches
            .iter()
            .skip(group)
            .step_by(self.groups)
            .copied()
    }

    /// Traces the photons of a group of batches, and puts them on a grid.
    fn trace(&self, group: usize) -> (FieldCells, PlaneTally) {
        let mut cells = self.transform.cells();
        let mut tally = PlaneTally::default();
        let VirtualPlane { window, .. } = self.plane;
        for batch in self.members(group) {
            let scale = 1.0 / (self.source.emitted(batch) as f64 * self.batches.len() as f64);
            let record = &mut |plane: usize, crossings: &[Crossing]| {
                if plane != self.index {
                    return;
                }
                for Crossing { ray, weight } in crossings {
                    tally.crossed += 1;
                    if !window.contains(ray) {
                        tally.outside += 1;
                        continue;
                    }
                    tally.inside += 1;
                    let weight = weight * window.value(ray) * self.plane.factor(ray);
                    cells.deposit(ray, scale * weight);
                }
            };
            self.source
                .emit(batch, record, &|photons| (self.progress)(photons));
        }
        (cells, tally)
    }
}
