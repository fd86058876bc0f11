//! Draws the spectrum of a plane with the ellipses of its covariances.

use crate::pictures;
use crate::table::spaced;
use etendue_field::grouped;
use etendue_figures::{AxisQuantity, Ellipse, Ellipses, Figure, Picture, ellipses};
use etendue_pipeline::covariance::SceneCovariances;
use etendue_predict::SliceMoment;
use etendue_scene::Scene;
use etendue_spectrum::CrossPower;
use etendue_store::Failure;

/// The spectrum of plane number `index` at azimuth 0 with the ellipses of the spectrum's
/// second moments.
pub fn drawn(scene: &Scene, found: &SceneCovariances, index: usize) -> Result<Figure, Failure> {
    let (plane, measurement) = (&scene.planes[index], &found.measurement);
    let report = &found.reports[index];
    let power = CrossPower::of_slice(measurement, index, 0).map_err(Failure::cannot_run)?;
    let power = power.power();
    let ellipse = |name: &str, of: fn(&SliceMoment) -> Option<f64>| {
        let [a, b, c] = report.slice.each_ref().map(of);
        let covariance = [a?, b?, c?];
        Some(Ellipse {
            name: format!("{name}, two standard deviations"),
            covariance,
        })
    };
    let all = [
        ellipse("covariance tracing", |m| m.traced),
        ellipse("exact spectrum", |m| m.found.predicted),
        ellipse("photons", |m| m.found.measured),
    ];
    let title = format!("{}: power at azimuth 0", spaced(&plane.name));
    let photons = grouped(measurement.emitted());
    let note = format!(
        "{}, {photons} photons; moments over the frequencies shown",
        scene.name
    );
    ellipses(&Ellipses {
        title: &title,
        note: &note,
        picture: Picture::new(pictures::spectrum_axes(plane), power.view()),
        quantity: AxisQuantity::new("|*S*_{0}|^{2}", ""),
        scale: pictures::DECIBEL,
        ellipses: all,
    })
    .map_err(Failure::cannot_run)
}
