//! A scene with one mirror. The steps of the mirror can be changed and compared with the scene's
//! photons.

use super::TableRun;
use super::steps::Steps;
use crate::predicted;
use etendue_compare::FirstOrderReport;
use etendue_theory::geometry::{Edition, Matrix, SpectrumMap};
use etendue_theory::path::rays;
use etendue_theory::{Model, Parameter};

/// A scene with one mirror, and the operators (steps) of this mirror.
pub(super) struct MirrorBench<'a> {
    pub(super) outcome: &'a TableRun,
    pub(super) distance: f64,
    pub(super) theta0: f64,
    pub(super) shape: Matrix<2>,
}

impl<'a> MirrorBench<'a> {
    /// # Panics
    /// Panics if the scene is not one sphere or plane.
    pub(super) fn new(outcome: &'a TableRun) -> Self {
        let view = outcome.system(outcome.planes.len() - 1);
        let value = |p: Parameter| view.value(p).expect("one mirror");
        let k = value(Parameter::Curvature(0, 0));
        Self {
            outcome,
            distance: value(Parameter::Travel(0)),
            theta0: value(Parameter::Incidence(0)),
            shape: [[k, 0.0], [0.0, k]],
        }
    }

    pub(super) fn sound(&self) -> Steps {
        Steps::sound(self.distance, self.theta0, self.shape)
    }

    /// The largest difference between the chain composed of the steps and the chain that
    /// theory derives from the scene.
    pub(super) fn apart(&self, plane: usize) -> f64 {
        let Some(read) = rays::chain(&self.outcome.system(plane), Edition::Corrected) else {
            return f64::NAN;
        };
        let put = self.sound().chain(&self.outcome.scene.planes[plane]);
        let entries = |m: &SpectrumMap<4>| {
            let mut all = m.matrix.as_flattened().to_vec();
            all.extend(m.phase);
            all.push(m.factor);
            all
        };
        let pairs = entries(&read.map).into_iter().zip(entries(&put));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Compares the photons of a plane with the chain composed of the given steps, by the rule
    /// for first-order chains.
    pub(super) fn judged(&self, plane: usize, steps: &Steps) -> FirstOrderReport {
        let view = self.outcome.system(plane);
        let place = &self.outcome.scene.planes[plane];
        let map = steps.chain(place);
        let slices = predicted::linear(&view, &place.window, &place.grid, &map);
        let defect = rays::defect(&view, &map, &place.window).expect("light arrives");
        let of = (&self.outcome.scene, &self.outcome.measurement, plane);
        predicted::judged_chain(of, &self.outcome.predictions[plane], slices, defect)
    }
}
