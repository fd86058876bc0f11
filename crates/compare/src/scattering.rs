//! Light that a curved surface scatters by a BRDF, as theory sees it.

use crate::Class;
use crate::first_order::{FirstOrder, FirstOrderChain, distance};
use crate::prediction::{PredictedParameter, Prediction, steps};
use crate::system::{in_frame, is_free, layers_before};
use etendue_field::{ProjectionGrid, VirtualPlane};
use etendue_scene::{Event, Object, Scene};
use etendue_spectrum::PROJECTION_BINS;
use etendue_theory::Budget;
use etendue_theory::rays::Plane;
use etendue_theory::scattering::{self, System};

/// The light, masks and the surface that lead to a plane which looks at light that has left it, and the plane; `None` where the first surface of
/// the path does not reflect by a BRDF, or is not the last before the plane, or light may meet anything else.
#[must_use]
pub fn scattered(scene: &Scene, plane: &VirtualPlane) -> Option<(System, Plane)> {
    if plane.leg != 1 || !is_free(scene) {
        return None;
    }
    let Object::Patch(i) = scene.path.legs[1].leaves?.object else {
        return None;
    };
    let object = &scene.patches[i];
    let Event::Reflects(reflectance) = &object.event else {
        return None;
    };
    let system = System {
        light: scene.light.clone(),
        layers: layers_before(scene, plane),
        name: object.name.clone(),
        patch: object.patch,
        reflectance: reflectance.clone(),
    };
    Some((system, in_frame(scene, plane)))
}

/// The largest error of a prediction by nets, whatever the photons.
const ENOUGH: f64 = 2e-3;
/// Rays of a prediction, as a share of the photons: then it takes less time than they do.
const SHARE: f64 = 0.25;
/// Fewest rays, for runs with few photons.
const FEWEST: f64 = 5e5;

/// How long a prediction by nets goes on: until its error is a fraction of the photons' noise, which
/// is some 25/√N of the spectrum, or until it has taken as long as they do.
pub(crate) fn budget(scene: &Scene) -> Budget {
    let photons = scene.run.photons as f64;
    Budget {
        nodes: (SHARE * photons).max(FEWEST),
        error: (8.0 / photons.sqrt()).min(ENOUGH),
    }
}

impl Prediction {
    /// What the quadrature over the plane says, and the first-order chain.
    pub(crate) fn by_scattering(
        scene: &Scene,
        plane: &VirtualPlane,
        system: &System,
        at: &Plane,
    ) -> Self {
        let (window, grid) = (&plane.window, &plane.grid);
        let cells = ProjectionGrid::new(window, PROJECTION_BINS);
        let chain = scattering::chain(system, at);
        let over = (window, grid, &cells);
        let exact = scattering::predict(system, at, chain.as_ref(), over, budget(scene));
        let all = system.parameters();
        let differences =
            scattering::differences(system, at, chain.as_ref(), &all, (window, grid), &exact);
        let first_order = chain.as_ref().zip(differences.linear);
        let first_order = first_order.map(|(chain, mut slices)| {
            slices.half += &exact.slices.half;
            FirstOrder {
                chain: FirstOrderChain {
                    error: distance(&slices, &exact.slices),
                    matrix: chain.rays().matrix,
                    covariance: [exact.covariance, None],
                    foci: Vec::new(),
                    as_printed: false,
                },
                slices,
            }
        });
        let parameters = all.into_iter().zip(differences.derivatives);
        let parameters = parameters.filter_map(|(parameter, derivative)| {
            Some(PredictedParameter {
                name: system.name_of(parameter),
                unit: system.unit_of(parameter).to_owned(),
                value: system.value(parameter)?,
                derivative: derivative?,
            })
        });
        Self {
            class: Class::FirstOrder,
            steps: steps(scene, plane),
            quadrature_error: Some(exact.error),
            first_order,
            replicates: exact.replicates,
            unblocked: 0.0,
            projection: exact.projection,
            parameters: parameters.collect(),
            slices: exact.slices,
            cuts: Vec::new(),
        }
    }
}
