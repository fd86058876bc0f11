//! The prediction of light that a curved surface scatters by a BRDF.

use crate::budget::budget;
use crate::class::Class;
use crate::first_order::{FirstOrder, FirstOrderChain, distance};
use crate::prediction::{PredictedParameter, Prediction};
use etendue_field::{ProjectionGrid, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use etendue_theory::rays::Plane;
use etendue_theory::scattering::{self, System};

impl Prediction {
    /// What nets of rays over the plane say, and the first-order chain.
    pub(crate) fn by_scattering(
        scene: &Scene,
        plane: &VirtualPlane,
        system: &System,
        at: &Plane,
        steps: Vec<String>,
    ) -> Self {
        let (window, grid) = (&plane.window, &plane.grid);
        let cells = ProjectionGrid::new(window, PROJECTION_BINS);
        let chain = scattering::chain(system, at);
        let over = (window, grid, &cells);
        let exact = scattering::predict(system, at, chain.as_ref(), over, budget(scene));
        let all = system.parameters().into_iter();
        let (all, moved): (Vec<_>, Vec<_>) = all
            .filter_map(|parameter| Some((parameter, system.moved(at, parameter)?)))
            .unzip();
        let over = (window, grid);
        let around = scattering::differences(system, at, chain.as_ref(), &moved, over, &exact);
        let first_order = chain.as_ref().zip(around.linear);
        let first_order = first_order.map(|(chain, difference)| {
            // Its noise is that of the exact prediction; the difference has little of its own.
            let near = |slices: &Slices| Slices {
                half: &slices.half + &difference.half,
                ..*slices
            };
            let slices = near(&exact.slices);
            FirstOrder {
                chain: FirstOrderChain {
                    error: distance(&slices, &exact.slices),
                    matrix: chain.rays().matrix,
                    covariance: [exact.covariance, None],
                    foci: Vec::new(),
                    as_printed: false,
                },
                slices,
                replicates: exact.replicates.iter().map(near).collect(),
            }
        });
        let parameters = all.into_iter().zip(around.derivatives);
        let parameters = parameters.filter_map(|(parameter, derivative)| {
            Some(PredictedParameter {
                name: system.name_of(parameter),
                unit: system.unit_of(parameter).to_owned(),
                value: system.value(parameter)?,
                derivative,
            })
        });
        Self {
            class: Class::FirstOrder,
            steps,
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
