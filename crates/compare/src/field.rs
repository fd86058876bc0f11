//! The spectrum of a plane on a 4D grid as theory predicts it.

use crate::applicability::{Applicability, Theory};
use crate::budget::budget;
use etendue_field::{Assignment, FieldGrid, ProjectionGrid, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use etendue_spectrum::field::{FieldGroup, FieldSpectrum, FieldTransform, RadialBins};
use etendue_theory::{Chain, Harmonics, Model, RayNets};
use ndarray::{Array2, Array4};
use rayon::prelude::*;

/// The spectrum of a windowed light field on a 4D grid, on which a measurement is put alike.
#[derive(Clone, Debug)]
pub enum PredictedField {
    /// The expectation of the measurement, aliasing included.
    Exact {
        /// The spectrum.
        spectrum: FieldSpectrum,
        /// The power without aliasing, [|Ωxy|, |Ωuv|]; `None` where the rays of a file are put on the grid.
        alias_free: Option<Array2<f64>>,
    },
    /// Independent estimates of it, by rays that are put on the grid as photons are.
    Sampled(Vec<FieldSpectrum>),
}

impl PredictedField {
    /// What theory says of a plane: a closed form, or in `groups` of nets of rays. `None` where no theory applies, or
    /// no ray arrives.
    #[must_use]
    pub fn new(
        scene: &Scene,
        plane: &VirtualPlane,
        applicability: &Applicability,
        (grid, assignment): (FieldGrid, Assignment),
        groups: usize,
    ) -> Option<Self> {
        if applicability.dark.is_some() {
            let spectrum = FieldTransform::new(grid, assignment);
            return Some(Self::Exact {
                spectrum: spectrum.spectrum(spectrum.cells()),
                alias_free: None,
            });
        }
        let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let over = (&plane.window, &plane.grid, &cells);
        let budget = budget(scene);
        let mut found = None;
        let put = &mut |rays: &dyn RayNets| {
            found = Some(on_grid(
                rays,
                &FieldTransform::new(grid, assignment),
                groups,
            ));
        };
        match &applicability.theory {
            Theory::Parallel(chain) => {
                let is_sampled = chain.is_sampled(over, budget);
                let exact = (!is_sampled).then(|| closed_form(chain, plane, (grid, assignment)));
                if let Some(exact) = exact.flatten() {
                    return Some(exact);
                }
                chain.with_rays(over, budget, put);
            }
            Theory::Specular(view) => view.with_rays(over, budget, put),
            Theory::Scattering(view) => view.with_rays(over, budget, put),
            Theory::None => {}
        }
        found
    }

    /// What another measurement says, where no theory applies.
    #[must_use]
    pub fn reference(groups: Vec<FieldGroup>) -> Self {
        let scaled = groups.into_iter().map(|FieldGroup { share, spectrum }| {
            let values = spectrum.values.mapv(|value| value / share);
            FieldSpectrum { values, ..spectrum }
        });
        Self::Sampled(scaled.collect())
    }

    /// Its spectra: one of an exact prediction, or one of each group.
    pub(crate) fn spectra(&self) -> &[FieldSpectrum] {
        match self {
            Self::Exact { spectrum, .. } => std::slice::from_ref(spectrum),
            Self::Sampled(spectra) => spectra,
        }
    }
}

/// The closed form between parallel planes; `None` behind a receiver, and for the rays of a file.
fn closed_form(
    chain: &Chain,
    plane: &VirtualPlane,
    (grid, assignment): (FieldGrid, Assignment),
) -> Option<PredictedField> {
    if matches!(chain.source.light, etendue_field::Light::Rays { .. }) {
        return None;
    }
    let on_grid = Harmonics::on_grid(chain, &plane.window, &grid, assignment)?;
    let axes = [0, 1, 2, 3];
    let spacing = axes.map(|axis| grid.spacing(axis));
    let half = axes.map(|axis| grid.cells[axis] / 2);
    let alias_free = Harmonics::new(chain, &plane.window, spacing, half)?;
    let multiples = |index: [usize; 4]| axes.map(|axis| grid.harmonic(axis, index[axis]));
    let [power] = RadialBins::new(&grid).means(|at| [alias_free.at(multiples(at)).norm_sqr()]);
    let [nx, ny, nu, nv] = grid.cells;
    let row = |x: usize| {
        let values = (0..ny * nu * (nv / 2 + 1)).map(|i| {
            let (y, u, v) = (
                i / (nu * (nv / 2 + 1)),
                i / (nv / 2 + 1) % nu,
                i % (nv / 2 + 1),
            );
            on_grid.at(multiples([x, y, u, v]))
        });
        values.collect::<Vec<_>>()
    };
    let rows: Vec<_> = (0..nx).into_par_iter().map(row).collect();
    let values = Array4::from_shape_vec((nx, ny, nu, nv / 2 + 1), rows.concat());
    Some(PredictedField::Exact {
        spectrum: FieldSpectrum {
            grid,
            assignment,
            values: values.expect("a value for each frequency"),
        },
        alias_free: Some(power),
    })
}

/// Rays on a grid: each group the mean of neighbouring nets.
fn on_grid(rays: &dyn RayNets, transform: &FieldTransform, groups: usize) -> PredictedField {
    let nets = rays.count();
    let groups = groups.min(nets);
    let group = |group: usize| {
        let members = group * nets / groups..(group + 1) * nets / groups;
        let share = 1.0 / members.len() as f64;
        let mut cells = transform.cells();
        for net in members {
            rays.emit(net, &mut |ray, weight| cells.deposit(ray, share * weight));
        }
        transform.spectrum(cells)
    };
    let mut spectra: Vec<_> = (0..groups).into_par_iter().map(group).collect();
    if nets > 1 {
        return PredictedField::Sampled(spectra);
    }
    PredictedField::Exact {
        spectrum: spectra.swap_remove(0),
        alias_free: None,
    }
}
