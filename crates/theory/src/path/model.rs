//! The parameters and the prediction of a path.

use super::rays::{self, CentralHit};
use super::{
    Interaction, Observed, PatchExtent, PathKind, PathMask, PathSurface, PathSystem, chain,
    reflections, scattering,
};
use crate::model::{Model, Over, STEPS_OF_EDGES, ShiftedModels};
use crate::nets::{RayBudget, RayNets, affordable_derivatives, work_of_nets};
use crate::obstacle::Obstacle;
use crate::parameter::{New, Parameter, change_curvature, curvatures, position, size_of_rim};
use crate::predicted::Predicted;
use crate::work::PredictionWork;
use etendue_field::{Complex, Frame, Light, Orientation, Patch, Specular};
use glam::{DQuat, DVec3};

/// Values below this threshold, in metres or in the unit of a parameter, are treated as zero,
/// because they may be rounding errors.
const ROUNDING_OF_ZERO: f64 = 1e-9;

/// The largest number of obstacles that have parameters.
const MAX_OBSTACLES: usize = 4;

/// Behind surfaces that scatter, the parameters albedo and lobe belong to the last of them. Other
/// albedos are not parameters, because the light field determines only the product of all albedos.
/// For a sum of BRDFs, albedo and lobe belong to the first BRDF.
impl Model for Observed {
    fn light(&self) -> &Light {
        &self.system.light
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut all = Parameter::of_light(&self.system.light);
        let masks = self.system.masks.iter().enumerate();
        let masks = masks.flat_map(|(i, one)| Parameter::of_mask(&one.mask, i));
        all.extend(masks.filter(|parameter| self.is_parameter(*parameter)));
        let surfaces = self.system.first_visits();
        all.extend(surfaces.flat_map(|(i, surface)| surface.rim(i)));
        all.extend(self.system.parameters_of_obstacles());
        let Some(last) = self.system.last_scatterer() else {
            all.extend(self.specular_parameters());
            all.retain(|parameter| self.is_parameter(*parameter));
            return all;
        };
        for (number, surface) in self.system.first_visits() {
            let patch = &surface.patch;
            let axes = curvatures(patch).into_iter();
            let curved = axes.filter(|axis| patch.curvature[*axis] != 0.0);
            all.extend(curved.map(|axis| Parameter::Curvature(number, axis)));
        }
        all.push(Parameter::Albedo);
        if self.system.surfaces[last].clone().lobe_mut().is_some() {
            all.push(Parameter::Lobe);
        }
        all
    }

    fn keep_affordable(&self, parameters: &mut Vec<Parameter>, budget: RayBudget) {
        let edges = parameters.iter().filter(|parameter| parameter.places());
        let others = parameters.len() - edges.count();
        let mut left = affordable_derivatives(budget).saturating_sub(others);
        parameters.retain(|parameter| {
            let is_kept = !parameter.places() || left > 0;
            left = left.saturating_sub(usize::from(is_kept && parameter.places()));
            is_kept
        });
    }

    fn name(&self, parameter: Parameter) -> String {
        let surfaces = self.system.before_plane();
        let name = |i: usize| surfaces.get(i).map_or("plane", |s| s.name.as_str());
        let last = self.system.last_scatterer();
        match (parameter, last) {
            (Parameter::Albedo, Some(last)) => format!("albedo of {}", name(last)),
            (Parameter::Lobe, Some(last)) => {
                let mut surface = surfaces[last].clone();
                let number = surface.lobe_mut().map_or("number", |(number, _)| number);
                format!("{number} of {}", name(last))
            }
            (Parameter::Travel(0), _) => format!("travel light to {}", name(0)),
            (Parameter::Travel(i), _) => format!("travel {} to {}", name(i - 1), name(i)),
            (Parameter::Incidence(i), _) => format!("incidence on {}", name(i)),
            (Parameter::SurfaceSize(i, axis), _) => {
                let is_rectangle = matches!(surfaces[i].extent, PatchExtent::Rectangle(_));
                size_of_rim(is_rectangle, axis, name(i))
            }
            (Parameter::SurfacePosition(i, axis), _) => position(axis, name(i)),
            (Parameter::ObstacleSize(i, axis), _) => {
                let Obstacle { name, form, .. } = &self.system.obstacles[i];
                size_of_rim(form.sizes() == 2, axis, name)
            }
            (Parameter::ObstaclePosition(i, axis), _) => {
                position(axis, &self.system.obstacles[i].name)
            }
            (Parameter::Curvature(i, axis), _) => format!("curvature {} of {}", axis + 1, name(i)),
            (Parameter::Index(i), _) => format!("index of {}", name(i)),
            (Parameter::FocalLength(i), _) => format!("focal length of {}", name(i)),
            _ => {
                let mask = parameter.mask().and_then(|i| self.system.masks.get(i));
                let named = match mask {
                    Some(PathMask { name, mask, .. }) => parameter.name_of_mask(mask, name),
                    None => parameter.name_of_light(self.light(), "light"),
                };
                named.unwrap_or_else(|| panic!("this path has no parameter {parameter:?}"))
            }
        }
    }

    fn change(&mut self, parameter: Parameter, new: New<'_>) -> Option<()> {
        let last = self.system.last_scatterer();
        match parameter {
            Parameter::Albedo => {
                let albedo = self.system.surfaces[last?].albedo_mut()?;
                *albedo = new(*albedo);
            }
            Parameter::Lobe => {
                let (_, number) = self.system.surfaces[last?].lobe_mut()?;
                *number = new(*number);
            }
            Parameter::Travel(leg) => self.travel(leg, new)?,
            Parameter::Incidence(i) => {
                let hit = *self.system.hits()?.get(i)?;
                let by = new(hit.incidence.theta0) - hit.incidence.theta0;
                let frame = &mut self.system.surfaces.get_mut(i)?.patch.frame;
                *frame = tilted(frame, &hit, by);
            }
            Parameter::Curvature(i, axis) => {
                self.reshape(i, |patch, _| change_curvature(patch, axis, new))?;
            }
            Parameter::SurfaceSize(i, axis) => self.resize(i, axis, new)?,
            Parameter::SurfacePosition(i, axis) => self.move_sideways(i, axis, new)?,
            Parameter::ObstacleSize(i, axis) => {
                self.system.obstacles.get_mut(i)?.form.resize(axis, new)?;
            }
            Parameter::ObstaclePosition(i, axis) => {
                self.system.obstacles.get_mut(i)?.form.reposition(axis, new);
            }
            Parameter::Index(i) => match &mut self.system.surfaces.get_mut(i)?.interaction {
                Interaction::Specular(Specular::Refraction { front, back }) => {
                    let denser = if *front > *back { front } else { back };
                    *denser = new(*denser);
                }
                _ => return None,
            },
            Parameter::FocalLength(i) => match &mut self.system.surfaces.get_mut(i)?.interaction {
                Interaction::Specular(Specular::ThinLens { focal_length }) => {
                    *focal_length = new(*focal_length);
                }
                _ => return None,
            },
            _ => match parameter.mask() {
                Some(i) => parameter.change_mask(&mut self.system.masks.get_mut(i)?.mask, new)?,
                None => parameter.change_light(&mut self.system.light, new)?,
            },
        }
        // A surface that light visits twice has changed at both visits.
        match parameter {
            Parameter::Incidence(i)
            | Parameter::Curvature(i, _)
            | Parameter::SurfaceSize(i, _)
            | Parameter::SurfacePosition(i, _)
            | Parameter::Index(i)
            | Parameter::FocalLength(i) => self.system.repeat(i),
            Parameter::Albedo | Parameter::Lobe => self.system.repeat(last?),
            _ => {}
        }
        Some(())
    }

    /// A prediction. Where surfaces scatter, it includes the difference between the
    /// first-order chain and the exact slices. If the last of these surfaces has a single BRDF, all
    /// light is proportional to its albedo, so the derivative with respect to the albedo is exact.
    fn predict(&self, parameters: &[Parameter], over: Over<'_>, budget: RayBudget) -> Predicted {
        let last = self.system.last_scatterer();
        let surface = last.map(|last| self.system.surfaces[last].clone());
        let albedo = surface.filter(PathSurface::is_in_proportion);
        let albedo = albedo.and_then(|mut surface| surface.albedo_mut().copied());
        let albedo = albedo.filter(|albedo| *albedo > 0.0);
        let is_factor = |parameter: &Parameter| *parameter == Parameter::Albedo && albedo.is_some();
        let others = parameters.iter().filter(|parameter| !is_factor(parameter));
        let shifted = |parameter: &Parameter| {
            if !parameter.places() {
                return ShiftedModels::nearby(self, *parameter);
            }
            let step = self.step(*parameter, (over.0, over.1), STEPS_OF_EDGES)?;
            ShiftedModels::new(self, *parameter, step, |moved| moved)
        };
        let moved: Option<Vec<_>> = others.map(shifted).collect();
        let moved = moved.expect("parameters of the path");
        let mut found = self.predicted(&moved, over, budget);
        let factor = parameters.iter().position(is_factor);
        if let Some((albedo, i)) = albedo.zip(factor) {
            let mut derivative = found.slices.clone();
            derivative.half /= Complex::from(albedo);
            found.derivatives.insert(i, derivative);
        }
        found
    }

    fn with_rays(&self, over: Over<'_>, budget: RayBudget, then: &mut dyn FnMut(&dyn RayNets)) {
        match self.kind() {
            PathKind::Specular => rays::with_rays(self, over, budget, then),
            PathKind::Scattered => {
                scattering::with_rays(self, chain(self).as_ref(), over, budget, then);
            }
            PathKind::Several => reflections::with_rays(self, over, budget, then),
        }
    }

    fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork {
        work_of_nets(over.1, budget)
    }
}

impl Observed {
    /// The prediction, with the derivatives between pairs of changed models.
    pub(crate) fn predicted(
        &self,
        moved: &[ShiftedModels<Self>],
        over: Over<'_>,
        budget: RayBudget,
    ) -> Predicted {
        match self.kind() {
            PathKind::Specular => rays::predict(self, moved, over, budget),
            PathKind::Scattered => {
                scattering::predict(self, chain(self).as_ref(), moved, over, budget)
            }
            PathKind::Several => reflections::predict(self, moved, over, budget),
        }
    }

    /// What a path of specular surfaces has as parameters, apart from those of its light.
    fn specular_parameters(&self) -> Vec<Parameter> {
        let Self { system, plane } = self;
        let mut all = Vec::new();
        let is_first = |i: usize| system.first_visits().any(|(first, _)| first == i);
        for (i, surface) in system.before_plane().iter().enumerate() {
            all.push(Parameter::Travel(i));
            match surface.event() {
                _ if !is_first(i) => continue,
                Some(Specular::ThinLens { .. }) => {
                    all.push(Parameter::FocalLength(i));
                    continue;
                }
                Some(Specular::Refraction { .. }) => all.push(Parameter::Index(i)),
                Some(Specular::Mirror) | None => {}
            }
            all.push(Parameter::Incidence(i));
            let axes = curvatures(&surface.patch).into_iter();
            all.extend(axes.map(|axis| Parameter::Curvature(i, axis)));
        }
        if plane.orientation == Orientation::Orthogonal || plane.is_arriving() {
            all.push(Parameter::Travel(system.visited));
        }
        all
    }

    /// Checks whether a parameter has a value from which it can change. Distances of zero are not
    /// parameters. For example, light does not travel from a surface to a plane on this surface. If
    /// an environment is unobstructed, the distance to the plane is not a parameter either, because
    /// the light of the environment is the same everywhere.
    fn is_parameter(&self, parameter: Parameter) -> bool {
        if parameter == Parameter::Travel(0) && self.system.is_alike_everywhere() {
            return false;
        }
        // All edges but corners can move. To try it, all shapes of masks would be copied.
        if parameter.places() && !matches!(parameter, Parameter::HoleCorner(..)) {
            return true;
        }
        let value = self.value(parameter);
        value.is_some_and(|value| parameter.places() || value.abs() > ROUNDING_OF_ZERO)
            && ShiftedModels::nearby(self, parameter).is_some()
    }

    /// Changes the length of a leg, and moves the plane and all surfaces after the leg.
    fn travel(&mut self, leg: usize, new: New<'_>) -> Option<()> {
        // A surface that is visited on both sides of the leg cannot move away from itself.
        let (before, after) = self.system.surfaces.split_at_checked(leg)?;
        let is_before = |surface: &PathSurface| before.iter().any(|one| one.name == surface.name);
        if after.iter().any(is_before) {
            return None;
        }
        let (from, along) = self.system.leg(leg)?;
        let to = match self.system.hits()?.get(leg) {
            Some(hit) => hit.arriving.origin,
            None => self.plane.frame.origin,
        };
        let distance = (to - from).dot(along);
        let by = along * (new(distance) - distance);
        for surface in self.system.surfaces.iter_mut().skip(leg) {
            surface.patch.frame.origin += by;
            surface.hit += by;
        }
        self.plane.frame.origin += by;
        if let Some(patch) = &mut self.plane.patch {
            patch.frame.origin += by;
        }
        Some(())
    }

    /// Changes the aperture of surface `i`, or its side along an axis.
    fn resize(&mut self, i: usize, axis: usize, new: New<'_>) -> Option<()> {
        self.reshape(i, |patch, extent| {
            match extent {
                PatchExtent::Whole => patch.aperture = new(patch.aperture),
                PatchExtent::Rectangle(size) => {
                    size[axis] = new(size[axis]);
                    patch.aperture = 0.5 * libm::hypot(size[0], size[1]);
                }
            }
            Some(())
        })
    }

    /// Changes the position of surface `i` along X or Y of its patch.
    fn move_sideways(&mut self, i: usize, axis: usize, new: New<'_>) -> Option<()> {
        let hit = self.system.surfaces.get(i)?.hit;
        self.reshape(i, |Patch { frame, .. }, _| {
            let along = [frame.x, frame.y][axis];
            let position = (frame.origin - hit).dot(along);
            frame.origin += (new(position) - position) * along;
            Some(())
        })
    }

    /// Changes the patch and the extent of surface `i`.
    fn reshape(
        &mut self,
        i: usize,
        change: impl FnOnce(&mut Patch, &mut PatchExtent) -> Option<()>,
    ) -> Option<()> {
        let is_last = i + 1 == self.system.visited;
        let PathSurface { patch, extent, .. } = self.system.surfaces.get_mut(i)?;
        change(patch, extent)?;
        // A plane with local normals that light leaves is on the surface itself.
        if is_last && !self.plane.is_arriving() && self.plane.patch.is_some() {
            self.plane.patch = Some(*patch);
        }
        Some(())
    }
}

impl PathSystem {
    /// The surfaces before the plane, without those that light has visited before.
    fn first_visits(&self) -> impl Iterator<Item = (usize, &PathSurface)> {
        let all = self.before_plane();
        let is_new = |(i, surface): &(usize, &PathSurface)| {
            all[..*i].iter().all(|before| before.name != surface.name)
        };
        all.iter().enumerate().filter(is_new)
    }

    /// The parameters of the obstacles, except an obstacle that is a surface of the path,
    /// if they are few.
    fn parameters_of_obstacles(&self) -> impl Iterator<Item = Parameter> {
        let obstacles = self.obstacles.iter().enumerate();
        let beside = obstacles.filter(|(_, obstacle)| obstacle.until.is_none());
        let few = beside.take_while(|_| self.obstacles.len() <= MAX_OBSTACLES);
        few.flat_map(|(i, obstacle)| {
            let sizes = 0..obstacle.form.sizes();
            let sizes = sizes.map(move |axis| Parameter::ObstacleSize(i, axis));
            sizes.chain((0..3).map(move |axis| Parameter::ObstaclePosition(i, axis)))
        })
    }

    /// Gives the patch and the interaction of a surface to all visits of this surface.
    fn repeat(&mut self, number: usize) {
        let PathSurface {
            name,
            patch,
            extent,
            interaction,
            ..
        } = self.surfaces[number].clone();
        for visit in self.surfaces.iter_mut().filter(|visit| visit.name == name) {
            visit.patch = patch;
            visit.extent = extent;
            visit.interaction = interaction.clone();
        }
    }

    /// Checks whether the light field is the same at all distances from the light.
    fn is_alike_everywhere(&self) -> bool {
        let is_environment = self.light.environment().is_some();
        is_environment && self.masks.is_empty() && self.obstacles.is_empty()
    }

    /// The start and the direction of the central ray's leg with the given index.
    fn leg(&self, leg: usize) -> Option<(DVec3, DVec3)> {
        if leg == 0 {
            return Some((DVec3::ZERO, DVec3::Z));
        }
        let hit = *self.hits()?.get(leg - 1)?;
        Some((hit.leaving.origin, hit.leaving.d))
    }

    /// The last surface that scatters light before the plane.
    fn last_scatterer(&self) -> Option<usize> {
        self.before_plane().iter().rposition(PathSurface::scatters)
    }
}

impl PathSurface {
    /// The albedo of the surface, if the surface scatters light. For a sum of BRDFs, this
    /// is the albedo of the first BRDF.
    fn albedo_mut(&mut self) -> Option<&mut f64> {
        match &mut self.interaction {
            Interaction::Specular(_) => None,
            Interaction::Diffuse { albedo } => Some(albedo),
            Interaction::Reflects(reflectance) => Some(&mut reflectance.first_mut().albedo),
        }
    }

    /// The exponent or the roughness of the surface's lobe, with the name of that
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

/// A patch's frame after a turn about B at the central ray's hit point. The turn increases
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
