//! Implements the model of a system of specular surfaces and a plane behind the system. The model
//! has parameters and a prediction.

use super::central::CentralHit;
use super::{SpecularSystem, predict, with_rays};
use crate::model::{Model, Observed, Over, ShiftedModels};
use crate::nets::{RayBudget, RayNets, work_of_nets};
use crate::parameter::{New, Parameter, change_curvature, curvatures, resize};
use crate::predicted::Predicted;
use crate::work::PredictionWork;
use etendue_field::{Disc, Frame, Light, Orientation, Rectangle, Shape, Specular};
use glam::{DQuat, DVec3};

/// Values below this threshold, in metres or in the unit of a parameter, are treated as zero,
/// because they may be rounding errors.
const ROUNDING_OF_ZERO: f64 = 1e-9;

impl Model for Observed<SpecularSystem> {
    fn light(&self) -> &Light {
        &self.system.light
    }

    /// Distances of zero are not parameters. For example, light does not travel from a surface to a
    /// plane on this surface. If an environment is unobstructed, the distance to the plane is not a
    /// parameter either, because the light of the environment is the same everywhere.
    fn parameters(&self) -> Vec<Parameter> {
        let Self { system, plane } = self;
        let mut all = Parameter::of_light(&system.light);
        for (i, element) in system.elements.iter().enumerate() {
            all.push(Parameter::Travel(i));
            match element.event {
                Specular::ThinLens { .. } => {
                    all.push(Parameter::FocalLength(i));
                    continue;
                }
                Specular::Mirror => {}
                Specular::Refraction { .. } => all.push(Parameter::Index(i)),
            }
            all.push(Parameter::Incidence(i));
            let axes = curvatures(&element.patch).into_iter();
            all.extend(axes.map(|axis| Parameter::Curvature(i, axis)));
        }
        if plane.orientation == Orientation::Orthogonal || plane.is_arriving() {
            all.push(Parameter::Travel(system.elements.len()));
        }
        let is_there = |parameter: &Parameter| {
            if *parameter == Parameter::Travel(0) && system.is_alike_everywhere() {
                return false;
            }
            let value = self.value(*parameter);
            value.is_some_and(|value| value.abs() > ROUNDING_OF_ZERO)
                && ShiftedModels::nearby(self, *parameter).is_some()
        };
        all.retain(is_there);
        all
    }

    fn name(&self, parameter: Parameter) -> String {
        let elements = &self.system.elements;
        let name = |i: usize| elements.get(i).map_or("plane", |e| e.name.as_str());
        match parameter {
            Parameter::Travel(0) => format!("travel light to {}", name(0)),
            Parameter::Travel(i) => format!("travel {} to {}", name(i - 1), name(i)),
            Parameter::Incidence(i) => format!("incidence on {}", name(i)),
            Parameter::Curvature(i, axis) => format!("curvature {} of {}", axis + 1, name(i)),
            Parameter::Index(i) => format!("index of {}", name(i)),
            Parameter::FocalLength(i) => format!("focal length of {}", name(i)),
            _ => {
                let of_light = parameter.name_of_light(self.light(), "light");
                of_light.unwrap_or_else(|| panic!("this system has no parameter {parameter:?}"))
            }
        }
    }

    fn change(&mut self, parameter: Parameter, new: New<'_>) -> Option<()> {
        match parameter {
            Parameter::Travel(leg) => self.travel(leg, new)?,
            Parameter::Incidence(i) => {
                let hit = *self.system.hits()?.get(i)?;
                let by = new(hit.incidence.theta0) - hit.incidence.theta0;
                let frame = &mut self.system.elements.get_mut(i)?.patch.frame;
                *frame = tilted(frame, &hit, by);
            }
            Parameter::Curvature(i, axis) => self.curve(i, axis, new)?,
            Parameter::Index(i) => match &mut self.system.elements.get_mut(i)?.event {
                Specular::Refraction { front, back } => {
                    let denser = if *front > *back { front } else { back };
                    *denser = new(*denser);
                }
                _ => return None,
            },
            Parameter::FocalLength(i) => match &mut self.system.elements.get_mut(i)?.event {
                Specular::ThinLens { focal_length } => *focal_length = new(*focal_length),
                _ => return None,
            },
            _ => parameter.change_light(&mut self.system.light, new)?,
        }
        Some(())
    }

    fn predict(&self, parameters: &[Parameter], over: Over<'_>, budget: RayBudget) -> Predicted {
        let moved = parameters.iter();
        let moved = moved.map(|parameter| ShiftedModels::nearby(self, *parameter));
        let moved: Option<Vec<_>> = moved.collect();
        predict(
            self,
            &moved.expect("parameters of the system"),
            over,
            budget,
        )
    }

    fn with_rays(&self, over: Over<'_>, budget: RayBudget, then: &mut dyn FnMut(&dyn RayNets)) {
        with_rays(self, over, budget, then);
    }

    fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork {
        work_of_nets(over.1, budget)
    }
}

impl Observed<SpecularSystem> {
    /// Changes the length of a leg, and moves the plane and all surfaces after the leg.
    fn travel(&mut self, leg: usize, new: New<'_>) -> Option<()> {
        let (from, along) = self.system.leg(leg)?;
        let to = match self.system.hits()?.get(leg) {
            Some(hit) => hit.arriving.origin,
            None => self.plane.frame.origin,
        };
        let distance = (to - from).dot(along);
        let by = along * (new(distance) - distance);
        for element in self.system.elements.iter_mut().skip(leg) {
            element.patch.frame.origin += by;
        }
        self.plane.frame.origin += by;
        if let Some(patch) = &mut self.plane.patch {
            patch.frame.origin += by;
        }
        Some(())
    }

    /// Changes one curvature of the patch of surface `i`.
    fn curve(&mut self, i: usize, axis: usize, new: New<'_>) -> Option<()> {
        let is_last = i + 1 == self.system.elements.len();
        let patch = &mut self.system.elements.get_mut(i)?.patch;
        change_curvature(patch, axis, new)?;
        // A plane with local normals that light leaves is on the surface itself.
        if is_last && !self.plane.is_arriving() && self.plane.patch.is_some() {
            self.plane.patch = Some(*patch);
        }
        Some(())
    }
}

impl SpecularSystem {
    /// Returns the system with a light `factor` times as large. If the light has a picture, the
    /// factor scales the picture's widths. Otherwise the factor scales the light's shape about the
    /// central ray.
    ///
    /// If the light and the windows are scaled by a factor and the frequencies by its reciprocal,
    /// the error of first-order maps falls with the factor (docs/theory.md, section 7).
    #[must_use]
    pub fn shrunk(&self, factor: f64) -> Self {
        Self {
            light: shrunk_light(&self.light, factor),
            ..self.clone()
        }
    }

    /// Checks whether the light field is the same at all distances from the light.
    fn is_alike_everywhere(&self) -> bool {
        let is_environment = matches!(self.light, Light::Environment { .. });
        is_environment && self.layers.is_empty() && self.obstacles.is_empty()
    }

    /// Returns the start and the direction of the central ray's leg with the given index.
    fn leg(&self, leg: usize) -> Option<(DVec3, DVec3)> {
        if leg == 0 {
            return Some((DVec3::ZERO, DVec3::Z));
        }
        let hit = *self.hits()?.get(leg - 1)?;
        Some((hit.leaving.origin, hit.leaving.d))
    }
}

/// Returns a light `factor` times as large, about the central ray.
pub(crate) fn shrunk_light(light: &Light, factor: f64) -> Light {
    let mut light = light.clone();
    match &mut light {
        Light::Projector { image, .. } | Light::Beam { image, .. } => {
            image.width = image.width.map(|w| w * factor);
            if let Some(grating) = &mut image.grating {
                grating.frequency /= factor;
            }
        }
        Light::Area { shape, .. } => {
            resize(std::slice::from_mut(shape), &mut |size| size * factor);
            let (Shape::Rectangle(Rectangle { center, .. }) | Shape::Disc(Disc { center, .. })) =
                shape;
            *center = center.map(|c| c * factor);
        }
        _ => {}
    }
    light
}

/// Returns a patch's frame after a turn about B at the central ray's hit point. The turn increases
/// the angle of incidence θ₀ by `by`.
fn tilted(frame: &Frame, hit: &CentralHit, by: f64) -> Frame {
    let turn = DQuat::from_axis_angle(hit.incidence.b, -by);
    let center = hit.arriving.origin;
    Frame {
        origin: center + turn * (frame.origin - center),
        x: turn * frame.x,
        y: turn * frame.y,
        d: turn * frame.d,
    }
}
