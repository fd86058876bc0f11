//! Light that a curved surface scatters by a BRDF, as theory sees it.

use crate::Class;
use crate::first_order::{FirstOrder, FirstOrderChain, distance};
use crate::prediction::{PredictedParameter, Prediction, steps};
use crate::system::{in_frame, is_free, layers_before};
use etendue_field::{ProjectionGrid, VirtualPlane};
use etendue_scene::{Event, Object, Scene};
use etendue_spectrum::PROJECTION_BINS;
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

impl Prediction {
    /// What the quadrature over the plane says, and the first-order chain.
    pub(crate) fn by_scattering(
        scene: &Scene,
        plane: &VirtualPlane,
        system: &System,
        at: &Plane,
    ) -> Self {
        let (window, grid) = (&plane.window, &plane.grid);
        let exact = scattering::exact(system, at, window, grid);
        let chain = scattering::chain(system, at);
        let linear = chain
            .as_ref()
            .and_then(|chain| scattering::linear(system, at, window, grid, chain, &exact));
        let first_order = chain.zip(linear).map(|(chain, slices)| FirstOrder {
            chain: FirstOrderChain {
                error: distance(&slices, &exact.slices),
                matrix: chain.rays().matrix,
                covariance: [exact.covariance, None],
                foci: Vec::new(),
                as_printed: false,
            },
            slices,
        });
        let parameters = system.parameters().into_iter().filter_map(|parameter| {
            Some(PredictedParameter {
                name: system.name_of(parameter),
                unit: system.unit_of(parameter).to_owned(),
                value: system.value(parameter)?,
                derivative: scattering::derivative(system, at, parameter, window, grid, &exact)?,
            })
        });
        let cells = ProjectionGrid::new(window, PROJECTION_BINS);
        Self {
            class: Class::FirstOrder,
            steps: steps(scene, plane),
            quadrature_error: Some(exact.quadrature_error),
            first_order,
            replicates: Vec::new(),
            unblocked: 0.0,
            projection: scattering::projection(system, at, window, &cells),
            parameters: parameters.collect(),
            slices: exact.slices,
            cuts: Vec::new(),
        }
    }
}
