//! The prediction of light that a curved surface scatters by a BRDF.

use crate::class::Class;
use crate::first_order::{FirstOrder, FirstOrderChain, distance};
use crate::prediction::{PredictedParameter, Prediction};
use etendue_field::{ProjectionGrid, VirtualPlane};
use etendue_spectrum::PROJECTION_BINS;
use etendue_theory::rays::Plane;
use etendue_theory::scattering::{self, System};

impl Prediction {
    /// What the quadrature over the plane says, and the first-order chain.
    pub(crate) fn by_scattering(
        plane: &VirtualPlane,
        system: &System,
        at: &Plane,
        steps: Vec<String>,
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
            replicates: Vec::new(),
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
            steps,
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
