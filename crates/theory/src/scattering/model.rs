//! Implements the model of a surface with a BRDF and a plane behind it. The model has parameters
//! and a prediction.

use super::{ScatteringSystem, chain, predict, with_rays};
use crate::model::{Model, Observed, Over, ShiftedModels};
use crate::nets::{RayBudget, RayNets, work_of_nets};
use crate::parameter::{New, Parameter, change_curvature, curvatures};
use crate::predicted::Predicted;
use crate::work::PredictionWork;
use etendue_field::{Complex, Light, Lobe};

impl Model for Observed<ScatteringSystem> {
    fn light(&self) -> &Light {
        &self.system.light
    }

    fn parameters(&self) -> Vec<Parameter> {
        let ScatteringSystem {
            light,
            patch,
            reflectance,
            ..
        } = &self.system;
        let mut all = Parameter::of_light(light);
        let axes = curvatures(patch).into_iter();
        let curved = axes.filter(|axis| patch.curvature[*axis] != 0.0);
        all.extend(curved.map(|axis| Parameter::Curvature(0, axis)));
        all.push(Parameter::Albedo);
        if reflectance.first().lobe != Lobe::Lambertian {
            all.push(Parameter::Lobe);
        }
        all
    }

    fn name(&self, parameter: Parameter) -> String {
        let name = &self.system.name;
        match parameter {
            Parameter::Albedo => format!("albedo of {name}"),
            Parameter::Lobe => {
                let mut lobe = self.system.reflectance.first().lobe;
                let number = lobe.number_mut().map_or("number", |(number, _)| number);
                format!("{number} of {name}")
            }
            Parameter::Curvature(_, axis) => format!("curvature {} of {name}", axis + 1),
            _ => {
                let of_light = parameter.name_of_light(self.light(), "light");
                of_light.unwrap_or_else(|| panic!("this surface has no parameter {parameter:?}"))
            }
        }
    }

    /// For a sum of BRDFs, the parameters albedo and lobe belong to the first BRDF.
    fn change(&mut self, parameter: Parameter, new: New<'_>) -> Option<()> {
        let ScatteringSystem {
            light,
            patch,
            reflectance,
            ..
        } = &mut self.system;
        match parameter {
            Parameter::Albedo => {
                let first = reflectance.first_mut();
                first.albedo = new(first.albedo);
            }
            Parameter::Lobe => {
                let (_, number) = reflectance.first_mut().lobe.number_mut()?;
                *number = new(*number);
            }
            Parameter::Curvature(0, axis) => change_curvature(patch, axis, new)?,
            _ => parameter.change_light(light, new)?,
        }
        Some(())
    }

    /// Returns a prediction that includes the difference between the first-order chain and the
    /// exact slices. If the reflectance is a single BRDF, all light is proportional to the albedo,
    /// so the derivative with respect to the albedo is exact.
    fn predict(&self, parameters: &[Parameter], over: Over<'_>, budget: RayBudget) -> Predicted {
        let only = self.system.reflectance.only().map(|brdf| brdf.albedo);
        let factor = only.filter(|albedo| *albedo > 0.0);
        let is_factor = |parameter: &Parameter| *parameter == Parameter::Albedo && factor.is_some();
        let others = parameters.iter().filter(|parameter| !is_factor(parameter));
        let moved: Option<Vec<_>> = others
            .map(|other| ShiftedModels::nearby(self, *other))
            .collect();
        let moved = moved.expect("parameters of the surface");
        let mut found = predict(self, chain(self).as_ref(), &moved, over, budget);
        if let (Some(i), Some(albedo)) = (parameters.iter().position(is_factor), factor) {
            let mut derivative = found.slices.clone();
            derivative.half /= Complex::from(albedo);
            found.derivatives.insert(i, derivative);
        }
        found
    }

    fn with_rays(&self, over: Over<'_>, budget: RayBudget, then: &mut dyn FnMut(&dyn RayNets)) {
        with_rays(self, chain(self).as_ref(), over, budget, then);
    }

    fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork {
        work_of_nets(over.1, budget)
    }
}
