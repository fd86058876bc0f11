//! Computes the bandwidths of glossy reflections by the paper's criteria, and the exact and the
//! measured bandwidths.

use crate::sweep::values::{SweepPoint, message_at};
use etendue_compare::measured_bandwidth;
use etendue_field::{Term, VirtualPlane};
use etendue_pipeline::{Reporter, Work, measured};
use etendue_predict::{Applicability, criterion, exact_bandwidth};
use etendue_scene::Scene;
use etendue_store::{Failure, Method};
use etendue_theory::PathKind;
use etendue_theory::shading::Criterion;

/// The numbers of one plane at one point of the sweep.
#[derive(Clone, Debug)]
pub struct BandwidthRow {
    /// The values of the fields that are swept.
    pub point: Vec<f64>,
    /// The plane's name.
    pub plane: String,
    /// κ \[1/m\], θ₀ and θ₁ \[°\], d and d′ \[m\], and the bandwidth of the lobe \[cycles per
    /// radian\]. The next numbers, in cycles per unit slope, are B of Eq. 20, corrected and as
    /// printed, and B′ of Eq. 21, corrected and as printed. If the scene is measured, the exact
    /// bandwidth, the measured bandwidth and its standard error follow. `None` stands for a number
    /// that the plane does not have.
    pub numbers: Vec<Option<f64>>,
    /// Warnings to read before using the numbers.
    pub warnings: Vec<String>,
}

/// A row for each plane to which the criteria of Durand et al. 2005, Eqs. 20 and 21, apply.
/// If `measuring` is a method, the scene is measured by this method.
pub fn bandwidths(
    scene: &Scene,
    point: &SweepPoint,
    measuring: Option<Method>,
    reporter: &dyn Reporter,
) -> Result<Vec<BandwidthRow>, Failure> {
    let theories = Applicability::of_planes(scene);
    let all = scene.planes.iter().zip(&theories).enumerate();
    let planes: Vec<(usize, Criterion)> = all
        .filter_map(|(i, (plane, theory))| Some((i, criterion(scene, plane, theory)?)))
        .collect();
    let measuring = measuring.filter(|_| !planes.is_empty());
    let measure = |method| measured(scene, method, 0..scene.run.batches, reporter);
    let measurement = measuring.map(measure).transpose()?;
    let row = |(i, c): (usize, Criterion)| {
        let (plane, theory) = (&scene.planes[i], &theories[i]);
        let edge = |value: f64| c.blocker_distance.map(|_| value);
        let mut row = BandwidthRow {
            point: point.iter().map(|(_, value)| *value).collect(),
            plane: plane.name.clone(),
            numbers: vec![
                Some(c.curvature),
                Some(c.incidence.to_degrees()),
                Some(c.outgoing.to_degrees()),
                Some(c.distance),
                c.blocker_distance,
                Some(c.lobe_cutoff),
                Some(c.environment()),
                Some(c.printed_environment()),
                edge(c.blocker()),
                edge(c.printed_blocker()),
            ],
            warnings: beyond_criteria(plane, theory),
        };
        if let Some(measurement) = &measurement {
            let stage = reporter.begin(Work::Stage("predicting"));
            let exact = exact_bandwidth(scene, plane, theory);
            drop(stage);
            let found = measured_bandwidth(measurement, i).map_err(Failure::cannot_run)?;
            let (value, error) = (found.map(|f| f.value), found.map(|f| f.error));
            row.numbers.extend([exact, value, error]);
            let most = exact.into_iter().chain(value).fold(0.0, f64::max);
            row.warnings
                .extend(warning(plane, most).map(|text| message_at(point, text)));
        }
        Ok(row)
    };
    planes.into_iter().map(row).collect()
}

/// The effects that the criteria do not cover.
fn beyond_criteria(plane: &VirtualPlane, applicability: &Applicability) -> Vec<String> {
    let Some(view) = applicability.theory.path_of(PathKind::Scattered) else {
        return Vec::new();
    };
    let name = &view.system.surfaces[0].name;
    let (_, reflectance) = view.system.scatterer();
    let mut warnings = Vec::new();
    if !reflectance.is_uniform() {
        warnings.push(format!(
            "{}: the BRDF of {name} varies over the surface; the criteria use its sharpest lobe only",
            plane.name
        ));
    }
    let is_about_normal = |term: &Term| !term.brdf.lobe.is_about_mirror();
    if reflectance.terms.iter().any(is_about_normal) {
        warnings.push(format!(
            "{}: a lobe of {name} is centred on the normal, but the criteria assume that lobes are centred on the mirror direction",
            plane.name
        ));
    }
    warnings
}

/// Warns if the grid of frequencies limits a bandwidth. The last cell ends half a step beyond the
/// largest frequency. If a spectrum is flat over the grid, its bandwidth is 95 % of the frequency
/// at which the last cell ends.
fn warning(plane: &VirtualPlane, bandwidth: f64) -> Option<String> {
    const NEAR: f64 = 0.9;
    let nu = plane.grid.nu;
    let end = (NEAR * nu.max()).min(nu.max() - nu.spacing);
    (bandwidth >= end).then(|| {
        format!(
            "{}: a bandwidth of {:.3} is at the end of the range of frequencies (frequencies.nu.max is {}), so the spectrum may extend beyond this range",
            plane.name,
            bandwidth,
            nu.max()
        )
    })
}
