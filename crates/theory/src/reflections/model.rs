//! Implements the model of several surfaces in sequence and a plane behind them. The model has
//! parameters and a prediction.

use super::{Interaction, PathSurface, ReflectionSystem, predict};
use crate::model::{Model, Observed, Over, ShiftedModels};
use crate::nets::{RayBudget, RayNets, work_of_nets};
use crate::parameter::{New, Parameter, change_curvature, curvatures};
use crate::predicted::Predicted;
use crate::rays::shrunk_light;
use crate::work::PredictionWork;
use etendue_field::{Complex, Light, Pattern, Reflectance, Weight};

impl ReflectionSystem {
    fn before_plane(&self) -> &[PathSurface] {
        &self.surfaces[..self.visited]
    }

    /// Returns the system with a light, textures and, unless `keeps_lobes`, lobes `factor` times as
    /// wide. A Lambertian lobe has no width and stays as it is. Returns `None` if a lobe stays as it
    /// is and the light that it receives does not become narrower, which is so for an environment
    /// and between several surfaces.
    ///
    /// If windows become narrower and frequencies higher by the same factor, the error of
    /// first-order maps falls with the factor.
    #[must_use]
    pub fn shrunk(&self, factor: f64, keeps_lobes: bool) -> Option<Self> {
        let is_environment = matches!(self.light, Light::Environment { .. });
        let is_lit_narrowly = self.visited == 1 && !is_environment;
        let mut system = self.clone();
        system.light = shrunk_light(&self.light, factor);
        for surface in &mut system.surfaces[..self.visited] {
            match &mut surface.interaction {
                Interaction::Specular(_) => {}
                Interaction::Diffuse { .. } if is_lit_narrowly => {}
                Interaction::Diffuse { .. } => return None,
                Interaction::Reflects(reflectance) => {
                    let lobes = if keeps_lobes { 1.0 } else { factor };
                    let have_width = shrink(reflectance, factor, lobes);
                    if (keeps_lobes || !have_width) && !is_lit_narrowly {
                        return None;
                    }
                }
            }
        }
        Some(system)
    }

    /// Returns the last surface that scatters light before the plane.
    fn last_scatterer(&self) -> Option<usize> {
        self.before_plane().iter().rposition(PathSurface::scatters)
    }
}

/// Makes the patterns of a reflectance `factor` times as wide, and its lobes `lobes` times as wide.
/// Returns whether all lobes have a width.
fn shrink(reflectance: &mut Reflectance, factor: f64, lobes: f64) -> bool {
    let Reflectance { terms, texture } = reflectance;
    let mut have_width = true;
    for term in &mut *terms {
        match term.brdf.lobe.number_mut() {
            Some(("exponent", exponent)) => *exponent /= lobes * lobes,
            Some((_, roughness)) => *roughness *= lobes,
            None => have_width = false,
        }
    }
    let weights = terms.iter_mut().filter_map(|term| match &mut term.weight {
        Weight::One => None,
        Weight::Pattern(pattern) | Weight::Rest(pattern) => Some(pattern),
    });
    for pattern in weights.chain(texture) {
        match pattern {
            Pattern::Cosine(grating) => grating.frequency /= factor,
            Pattern::Checkerboard { period } => *period *= factor,
            Pattern::Picture(picture) => picture.size = picture.size.map(|side| side * factor),
        }
    }
    have_width
}

impl PathSurface {
    /// Returns the albedo of the surface, if the surface scatters light. For a sum of BRDFs, this
    /// is the albedo of the first BRDF.
    fn albedo_mut(&mut self) -> Option<&mut f64> {
        match &mut self.interaction {
            Interaction::Specular(_) => None,
            Interaction::Diffuse { albedo } => Some(albedo),
            Interaction::Reflects(reflectance) => Some(&mut reflectance.first_mut().albedo),
        }
    }

    /// Returns the exponent or the roughness of the surface's lobe, with the name of that
    /// parameter.
    fn lobe_mut(&mut self) -> Option<(&'static str, &mut f64)> {
        match &mut self.interaction {
            Interaction::Reflects(reflectance) => reflectance.first_mut().lobe.number_mut(),
            Interaction::Specular(_) | Interaction::Diffuse { .. } => None,
        }
    }

    /// Checks whether all light that the surface scatters is proportional to the surface's albedo.
    fn is_in_proportion(&self) -> bool {
        match &self.interaction {
            Interaction::Reflects(reflectance) => reflectance.only().is_some(),
            Interaction::Specular(_) | Interaction::Diffuse { .. } => true,
        }
    }
}

/// The parameters albedo and lobe belong to the last surface that scatters light. Other albedos are
/// not parameters, because the light field determines only the product of all albedos.
impl Model for Observed<ReflectionSystem> {
    fn light(&self) -> &Light {
        &self.system.light
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut all = Parameter::of_light(&self.system.light);
        for (number, surface) in self.system.before_plane().iter().enumerate() {
            let patch = &surface.patch;
            let axes = curvatures(patch).into_iter();
            let curved = axes.filter(|axis| patch.curvature[*axis] != 0.0);
            all.extend(curved.map(|axis| Parameter::Curvature(number, axis)));
        }
        if let Some(last) = self.system.last_scatterer() {
            all.push(Parameter::Albedo);
            if self.system.surfaces[last].clone().lobe_mut().is_some() {
                all.push(Parameter::Lobe);
            }
        }
        all
    }

    fn name(&self, parameter: Parameter) -> String {
        let last = self.system.last_scatterer();
        let last = last.map(|last| &self.system.surfaces[last]);
        match (parameter, last) {
            (Parameter::Albedo, Some(surface)) => format!("albedo of {}", surface.name),
            (Parameter::Lobe, Some(surface)) => {
                let mut lobe = surface.clone();
                let number = lobe.lobe_mut().map_or("number", |(number, _)| number);
                format!("{number} of {}", surface.name)
            }
            (Parameter::Curvature(number, axis), _) => {
                let name = &self.system.surfaces[number].name;
                format!("curvature {} of {name}", axis + 1)
            }
            _ => {
                let of_light = parameter.name_of_light(self.light(), "light");
                of_light.unwrap_or_else(|| panic!("these surfaces have no parameter {parameter:?}"))
            }
        }
    }

    fn change(&mut self, parameter: Parameter, new: New<'_>) -> Option<()> {
        let last = self.system.last_scatterer();
        let ReflectionSystem {
            light, surfaces, ..
        } = &mut self.system;
        match parameter {
            Parameter::Albedo => {
                let albedo = surfaces[last?].albedo_mut()?;
                *albedo = new(*albedo);
            }
            Parameter::Lobe => {
                let (_, number) = surfaces[last?].lobe_mut()?;
                *number = new(*number);
            }
            Parameter::Curvature(number, axis) => {
                change_curvature(&mut surfaces[number].patch, axis, new)?;
            }
            _ => parameter.change_light(light, new)?,
        }
        Some(())
    }

    /// Returns a prediction that includes the difference between the first-order chain and the
    /// exact slices.
    fn predict(&self, parameters: &[Parameter], over: Over<'_>, budget: RayBudget) -> Predicted {
        let last = self.system.last_scatterer();
        let surface = last.map(|last| self.system.surfaces[last].clone());
        let albedo = surface.filter(PathSurface::is_in_proportion);
        let albedo = albedo.and_then(|mut surface| surface.albedo_mut().copied());
        let albedo = albedo.filter(|albedo| *albedo > 0.0);
        let is_factor = |parameter: &Parameter| *parameter == Parameter::Albedo && albedo.is_some();
        let others = parameters.iter().filter(|parameter| !is_factor(parameter));
        let moved: Option<Vec<_>> = others
            .map(|other| ShiftedModels::nearby(self, *other))
            .collect();
        let moved = moved.expect("parameters of these surfaces");
        let mut found = predict::predict(self, &moved, over, budget);
        let factor = parameters.iter().position(is_factor);
        if let Some((albedo, i)) = albedo.zip(factor) {
            let mut derivative = found.slices.clone();
            derivative.half /= Complex::from(albedo);
            found.derivatives.insert(i, derivative);
        }
        found
    }

    fn with_rays(&self, over: Over<'_>, budget: RayBudget, then: &mut dyn FnMut(&dyn RayNets)) {
        predict::with_rays(self, over, budget, then);
    }

    fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork {
        work_of_nets(over.1, budget)
    }
}
