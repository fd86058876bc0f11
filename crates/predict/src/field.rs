//! Predicts the spectrum of a plane on a 4D grid.

use crate::applicability::Applicability;
use crate::budget::budget;
use crate::theories::Theory;
use etendue_compare::PredictedField;
use etendue_field::{Assignment, FieldGrid, ProjectionGrid, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use etendue_spectrum::field::{FieldSpectrum, FieldTransform, RadialBins};
use etendue_theory::{Chain, Harmonics, Model, RayNets};
use ndarray::Array4;
use rayon::prelude::*;

/// The prediction of theory for a plane, either in closed form or by nets of rays in
/// `groups` groups. Returns `None` if no theory applies, if no ray arrives, or if the scene has
/// several lights.
#[must_use]
pub fn predict_field(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
    (grid, assignment): (FieldGrid, Assignment),
    groups: usize,
) -> Option<PredictedField> {
    // The sum over several lights is not implemented.
    if !scene.other_lights.is_empty() {
        return None;
    }
    if applicability.dark.is_some() {
        let spectrum = FieldTransform::new(grid, assignment);
        return Some(PredictedField::Exact {
            spectrum: Box::new(spectrum.spectrum(spectrum.cells())),
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
        Theory::Path(view) => view.with_rays(over, budget, put),
        Theory::None => {}
    }
    found
}

/// The largest number of products in a closed form. This number of products takes some ten seconds
/// on one core. If a closed form has more products, nets of rays replace it. An example is a disc,
/// which consists of many rectangles.
const MAX_PRODUCTS: usize = 4_000_000_000;

/// The closed form between parallel planes. Returns `None` behind a receiver, for the rays
/// of a file, and where the closed form would take too long.
fn closed_form(
    chain: &Chain,
    plane: &VirtualPlane,
    (grid, assignment): (FieldGrid, Assignment),
) -> Option<PredictedField> {
    if chain.source.light.listed().is_some() {
        return None;
    }
    let on_grid = Harmonics::on_grid(chain, &plane.window, &grid, assignment)?;
    let frequencies = grid.cells.iter().product::<usize>() / 2;
    if on_grid.terms().saturating_mul(frequencies) > MAX_PRODUCTS {
        return None;
    }
    let alias_free = alias_free(chain, plane, (grid, assignment))?;
    Some(PredictedField::Exact {
        spectrum: Box::new(spectrum(&on_grid, (grid, assignment))),
        alias_free: Some(RadialBins::new(&grid).power(&alias_free)),
    })
}

/// The spectrum itself, without the effects of the grid.
fn alias_free(
    chain: &Chain,
    plane: &VirtualPlane,
    (grid, assignment): (FieldGrid, Assignment),
) -> Option<FieldSpectrum> {
    let axes = [0, 1, 2, 3];
    let spacing = axes.map(|axis| grid.spacing(axis));
    let half = axes.map(|axis| grid.cells[axis] / 2);
    let harmonics = Harmonics::new(chain, &plane.window, spacing, half)?;
    Some(spectrum(&harmonics, (grid, assignment)))
}

/// The spectrum at the frequencies of a grid. Along v, the frequencies start at zero.
fn spectrum(harmonics: &Harmonics, (grid, assignment): (FieldGrid, Assignment)) -> FieldSpectrum {
    let [nx, ny, nu, nv] = grid.cells;
    let mut values = Array4::zeros((nx, ny, nu, nv / 2 + 1));
    let mut slabs: Vec<_> = values.outer_iter_mut().enumerate().collect();
    slabs.par_iter_mut().for_each(|(x, slab)| {
        for ((y, u, v), value) in slab.indexed_iter_mut() {
            let index = [*x, y, u, v];
            *value = harmonics.at([0, 1, 2, 3].map(|axis| grid.harmonic(axis, index[axis])));
        }
    });
    FieldSpectrum {
        grid,
        assignment,
        values,
    }
}

/// Puts rays on a grid; each group is the mean of neighbouring nets.
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
        spectrum: Box::new(spectra.swap_remove(0)),
        alias_free: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_compare::FullRadialReport;
    use etendue_scene::{SceneFile, resolve};
    use etendue_spectrum::field::FieldGroup;
    use etendue_theory::RayBudget;

    #[test]
    fn closed_forms_alias_as_rays_do() {
        let text = "(light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
            blockers: [Shapes(name: \"b\", center: (0, 0, 0.5), shapes: [Rectangle(center: (0.1, 0), size: (0.1, 0.2))])],
            surfaces: [Rectangle(name: \"floor\", center: (0, 0, 1), size: (9, 9))],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"floor\"]),
            planes: [(name: \"p\", at: Before(\"floor\"))], window: (x: Hann(0.5), u: Hann(0.5)),
            frequencies: (azimuths: 2, rho: (max: 4), nu: (max: 4)))";
        let file = SceneFile::parse(text).unwrap();
        let scene = resolve("test", file, ".".as_ref(), u64::MAX).unwrap();
        let plane = &scene.planes[0];
        let grid = FieldGrid::new(&plane.window, &plane.grid);
        let over = (grid, Assignment::Tsc);
        let Theory::Parallel(chain) = Applicability::new(&scene, plane).theory else {
            panic!("parallel planes");
        };
        let cells = ProjectionGrid::new(&plane.window, 1);
        let budget = RayBudget::new(32.0 * f64::from(1 << 15), 0.0);
        let mut rays = None;
        chain.with_rays((&plane.window, &plane.grid, &cells), budget, &mut |nets| {
            let transform = FieldTransform::new(grid, Assignment::Tsc);
            rays = Some(on_grid(nets, &transform, 16));
        });
        let Some(PredictedField::Sampled(rays)) = rays else {
            panic!("nets of rays");
        };
        let share = 1.0 / 16.0;
        let group = |spectrum: FieldSpectrum| FieldGroup {
            share,
            spectrum: FieldSpectrum {
                values: spectrum.values.mapv(|value| value * share),
                ..spectrum
            },
        };
        let groups: Vec<FieldGroup> = rays.into_iter().map(group).collect();
        let bins = RadialBins::new(&grid);
        let p = |exact: &PredictedField| {
            let report = FullRadialReport::new(&bins, &groups, exact, 1);
            report.power.p_value.unwrap()
        };
        let closed = closed_form(&chain, plane, over).unwrap();
        assert!(p(&closed) > 0.01); // a single test with fixed nets
        // The injected fault is the spectrum without the effects of the grid.
        let fault = PredictedField::Exact {
            spectrum: Box::new(alias_free(&chain, plane, over).unwrap()),
            alias_free: None,
        };
        assert!(p(&fault) < 1e-3);
    }
}
