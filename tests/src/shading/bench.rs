//! A plane of a valid scene, measured and predicted, for comparison with faults.

use crate::predicted;
use crate::scenes::{tampered, traced};
use etendue_compare::Residuals;
use etendue_field::{
    Complex, Crossing, Grating, Pattern, Reflectance, Slices, Term, VirtualPlane, Weight,
};
use etendue_predict::path;
use etendue_scene::{Event, Scene};
use etendue_spectrum::{Measurement, estimate};
use etendue_theory::Observed;
use etendue_theory::path::{Interaction, chain};
use glam::DVec3;

/// A scene with one plane, the photons at this plane, and their prediction.
pub(super) struct Bench {
    pub(super) scene: Scene,
    pub(super) photons: Measurement,
    pub(super) sound: Slices,
}

impl Bench {
    /// # Panics
    /// Panics if the plane is not after a BRDF.
    pub(super) fn new(scene: Scene) -> Self {
        let view = seen(&scene);
        let sound = said(&view, &scene.planes[0]);
        Self::of(scene, sound)
    }

    /// Creates a bench whose prediction is given.
    pub(super) fn of(scene: Scene, sound: Slices) -> Self {
        let photons = traced(&scene);
        Self {
            scene,
            photons,
            sound,
        }
    }

    /// Predicts the slices at the plane for a modified reflectance.
    pub(super) fn predicted(&self, change: impl Fn(&mut Reflectance)) -> Slices {
        let mut view = seen(&self.scene);
        if let Interaction::Reflects(reflectance) = &mut view.system.surfaces[0].interaction {
            change(reflectance);
        }
        said(&view, &self.scene.planes[0])
    }

    /// The photons of a modified scene, with modified crossings.
    pub(super) fn tampered(
        &self,
        change: impl Fn(&mut Scene),
        crossing: impl Fn(&Scene, Crossing) -> Crossing + Sync,
    ) -> Measurement {
        let mut scene = self.scene.clone();
        change(&mut scene);
        tampered(&scene, |_, c| Some(crossing(&self.scene, c)))
    }

    /// The p-value of the comparison of photons with a prediction.
    ///
    /// # Panics
    /// Panics if there is no light and no light is predicted.
    pub(super) fn p_value(&self, photons: &Measurement, said: &Slices) -> f64 {
        let p = Residuals::new(photons, 0, said).p_value(self.scene.run.seed);
        p.expect("light")
    }

    /// The norm of the difference of two slices, ‖a − b‖, divided by the norm of the
    /// prediction without a fault.
    pub(super) fn apart(&self, a: &Slices, b: &Slices) -> f64 {
        let norm = |values: &mut dyn Iterator<Item = Complex>| {
            values.map(|v| v.norm_sqr()).sum::<f64>().sqrt()
        };
        let pairs = a.half.iter().zip(&b.half);
        norm(&mut pairs.map(|(a, b)| a - b)) / norm(&mut self.sound.half.iter().copied())
    }
}

/// The measured slices.
///
/// # Panics
/// Panics if there are too few batches.
pub(super) fn mean(photons: &Measurement) -> Slices {
    let estimate = estimate::slices(photons, 0);
    estimate.expect("a scene has 64 batches").mean
}

fn seen(scene: &Scene) -> Observed {
    path(scene, &scene.planes[0]).expect("a plane behind a BRDF")
}

fn said(view: &Observed, plane: &VirtualPlane) -> Slices {
    let chain = chain(view).expect("a central ray");
    let [exact, _] = predicted::scattered(view, plane, &chain);
    exact
}

/// The BRDF of a scene, for modification.
///
/// # Panics
/// Panics if the scene has no BRDF.
pub(super) fn reflectance(scene: &mut Scene) -> &mut Reflectance {
    match &mut scene.patches[0].event {
        Event::Reflects(reflectance) => reflectance,
        Event::Specular(_) => panic!("a surface with a BRDF"),
    }
}

/// Changes every grating among the weights of BRDFs.
pub(super) fn each_weight(reflectance: &mut Reflectance, change: impl Fn(&mut Grating)) {
    for Term { weight, .. } in &mut reflectance.terms {
        if let Weight::Pattern(Pattern::Cosine(grating)) | Weight::Rest(Pattern::Cosine(grating)) =
            weight
        {
            change(grating);
        }
    }
}

/// Two unit vectors in the axes (T, B, N) of a flat surface: the direction of a photon,
/// and the direction from the photon's position to a projector.
pub(super) fn on_flat(scene: &Scene, crossing: &Crossing) -> [DVec3; 2] {
    let plane = &scene.planes[0];
    let ray = crossing.ray;
    let ((sin, cos), (up, across)) = ((ray.u + plane.longitude).sin_cos(), ray.v.sin_cos());
    let place = DVec3::new(ray.x, ray.y, 0.0);
    let light = plane.frame.to_local(scene.path.frame.origin);
    let away = DVec3::new(across * sin, up, across * cos);
    [away, (light - place).normalize()]
}
