use super::central::Hit;
use super::{Plane, System};
use etendue_field::{Frame, Light, Orientation, Shape, Specular};
use glam::{DQuat, DVec3};

/// A number of a [`System`] and the [`Plane`] behind it that a measurement may be asked for.
/// Indices are those of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The first width of a picture, the second keeping the proportion.
    ImageWidth,
    /// The side of a rectangular light along X, its other side keeping the proportion, or the
    /// radius of a disc.
    SourceSize,
    /// The way of the central ray from an element, or the light (0), to the next, or the plane:
    /// whatever comes later moves along D.
    Travel(usize),
    /// The angle of incidence θ₀ of the central ray: the patch turns about B, and nothing else
    /// does.
    Incidence(usize),
    /// A curvature of a patch, k₁ (0) or k₂ (1). Those that equal it, and k₃, go with it on spheres
    /// and cylinders. The vertex stays.
    Curvature(usize, usize),
    /// Index of refraction of the denser side of a surface.
    Index(usize),
    /// The focal length of a lens.
    FocalLength(usize),
}

impl System {
    /// All parameters up to a plane, in the order light meets them.
    #[must_use]
    pub fn parameters(&self, plane: &Plane) -> Vec<Parameter> {
        let mut all = vec![];
        match self.light {
            Light::Area { .. } => all.push(Parameter::SourceSize),
            Light::Projector { .. } | Light::Beam { .. } => all.push(Parameter::ImageWidth),
            Light::Point { .. } | Light::Environment { .. } => {}
        }
        for (i, element) in self.elements.iter().enumerate() {
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
            all.push(Parameter::Curvature(i, 0));
            let [k1, k2, k3] = element.patch.curvature;
            if !(same(k1, k2) && same(k1, k3) && k1 != 0.0) {
                all.push(Parameter::Curvature(i, 1));
            }
        }
        if plane.orientation == Orientation::Orthogonal || plane.arriving {
            all.push(Parameter::Travel(self.elements.len()));
        }
        all
    }

    /// The parameter in words, e.g. "incidence on mirror".
    #[must_use]
    pub fn name(&self, parameter: Parameter) -> String {
        let name = |i: usize| self.elements.get(i).map_or("plane", |e| e.name.as_str());
        match parameter {
            Parameter::ImageWidth => "width of image".into(),
            Parameter::SourceSize => match self.light {
                Light::Area {
                    shape: Shape::Disc(_),
                    ..
                } => "radius of light".into(),
                _ => "side of light".into(),
            },
            Parameter::Travel(0) => format!("travel light to {}", name(0)),
            Parameter::Travel(i) => format!("travel {} to {}", name(i - 1), name(i)),
            Parameter::Incidence(i) => format!("incidence on {}", name(i)),
            Parameter::Curvature(i, axis) => format!("curvature {} of {}", axis + 1, name(i)),
            Parameter::Index(i) => format!("index of {}", name(i)),
            Parameter::FocalLength(i) => format!("focal length of {}", name(i)),
        }
    }

    /// The unit of a parameter; empty if it is a number.
    #[must_use]
    pub fn unit(&self, parameter: Parameter) -> &'static str {
        match parameter {
            Parameter::ImageWidth if matches!(self.light, Light::Projector { .. }) => "",
            Parameter::Index(_) => "",
            Parameter::Incidence(_) => "rad",
            Parameter::Curvature(..) => "1/m",
            Parameter::ImageWidth
            | Parameter::SourceSize
            | Parameter::Travel(_)
            | Parameter::FocalLength(_) => "m",
        }
    }

    /// Its value, in its unit. `None` if the system does not have it, or its central ray does not
    /// arrive.
    #[must_use]
    pub fn value(&self, plane: &Plane, parameter: Parameter) -> Option<f64> {
        let mut value = None;
        self.changed(plane, parameter, |current| {
            value = Some(current);
            current
        })?;
        value
    }

    /// The same system and plane with another value of one parameter, in its unit. `None` as for
    /// [`value`](Self::value).
    #[must_use]
    pub fn with(&self, plane: &Plane, parameter: Parameter, value: f64) -> Option<(Self, Plane)> {
        self.changed(plane, parameter, |_| value)
    }

    /// The same system with a light `factor` times as large: the picture's widths over slopes or
    /// positions, or the shape about the central ray.
    ///
    /// With windows as much narrower and frequencies as much higher, what first-order maps leave
    /// out falls with the factor (docs/theory.md, section 7).
    #[must_use]
    pub fn shrunk(&self, factor: f64) -> Self {
        let mut system = self.clone();
        match &mut system.light {
            Light::Projector { image, .. } | Light::Beam { image, .. } => {
                image.width = image.width.map(|w| w * factor);
                if let Some(grating) = &mut image.grating {
                    grating.frequency /= factor;
                }
            }
            Light::Area { shape, .. } => {
                resize(shape, factor);
                let (Shape::Rectangle(etendue_field::Rectangle { center, .. })
                | Shape::Disc(etendue_field::Disc { center, .. })) = shape;
                *center = center.map(|c| c * factor);
            }
            Light::Point { .. } | Light::Environment { .. } => {}
        }
        system
    }

    fn changed(
        &self,
        plane: &Plane,
        parameter: Parameter,
        new: impl FnOnce(f64) -> f64,
    ) -> Option<(Self, Plane)> {
        let mut system = self.clone();
        let mut moved = *plane;
        match parameter {
            Parameter::ImageWidth | Parameter::SourceSize => change_light(&mut system.light, new)?,
            Parameter::Travel(leg) => {
                let (from, along) = self.leg(leg)?;
                let to = match self.hits()?.get(leg) {
                    Some(hit) => hit.arriving.origin,
                    None => plane.frame.origin,
                };
                let distance = (to - from).dot(along);
                let by = along * (new(distance) - distance);
                for element in system.elements.iter_mut().skip(leg) {
                    element.patch.frame.origin += by;
                }
                moved.frame.origin += by;
                if let Some(patch) = &mut moved.patch {
                    patch.frame.origin += by;
                }
            }
            Parameter::Incidence(i) => {
                let hit = *self.hits()?.get(i)?;
                let by = new(hit.incidence.theta0) - hit.incidence.theta0;
                let frame = &mut system.elements.get_mut(i)?.patch.frame;
                *frame = tilted(frame, &hit, by);
            }
            Parameter::Curvature(i, axis) => {
                let patch = &mut system.elements.get_mut(i)?.patch;
                let current = *patch.curvature.get(axis)?;
                let value = new(current);
                let sphere_or_cylinder = patch.curvature[2] != 0.0;
                for (k, other) in patch.curvature.iter_mut().enumerate() {
                    let goes_along = sphere_or_cylinder && current != 0.0 && same(*other, current);
                    if k == axis || goes_along {
                        *other = value;
                    }
                }
                // A leaving plane with local normals is on the surface itself.
                let patch = *patch;
                if i + 1 == self.elements.len() && !plane.arriving && moved.patch.is_some() {
                    moved.patch = Some(patch);
                }
            }
            Parameter::Index(i) => match &mut system.elements.get_mut(i)?.event {
                Specular::Refraction { front, back } => {
                    let denser = if *front > *back { front } else { back };
                    *denser = new(*denser);
                }
                _ => return None,
            },
            Parameter::FocalLength(i) => match &mut system.elements.get_mut(i)?.event {
                Specular::ThinLens { focal_length } => *focal_length = new(*focal_length),
                _ => return None,
            },
        }
        Some((system, moved))
    }

    /// Where a leg starts, and along what.
    fn leg(&self, leg: usize) -> Option<(DVec3, DVec3)> {
        if leg == 0 {
            return Some((DVec3::ZERO, DVec3::Z));
        }
        let hit = *self.hits()?.get(leg - 1)?;
        Some((hit.leaving.origin, hit.leaving.d))
    }
}

/// A patch's frame turned about B at the central hit until θ₀ has grown by an angle.
fn tilted(frame: &Frame, hit: &Hit, by: f64) -> Frame {
    let turn = DQuat::from_axis_angle(hit.incidence.b, -by);
    let center = hit.arriving.origin;
    Frame {
        origin: center + turn * (frame.origin - center),
        x: turn * frame.x,
        y: turn * frame.y,
        d: turn * frame.d,
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

fn change_light(light: &mut Light, new: impl FnOnce(f64) -> f64) -> Option<()> {
    match light {
        Light::Projector { image, .. } | Light::Beam { image, .. } => {
            let factor = new(image.width[0]) / image.width[0];
            image.width = image.width.map(|w| w * factor);
        }
        Light::Area { shape, .. } => {
            let size = match shape {
                Shape::Rectangle(rectangle) => rectangle.size[0],
                Shape::Disc(disc) => disc.radius,
            };
            resize(shape, new(size) / size);
        }
        Light::Point { .. } | Light::Environment { .. } => return None,
    }
    Some(())
}

fn resize(shape: &mut Shape, factor: f64) {
    match shape {
        Shape::Rectangle(rectangle) => rectangle.size = rectangle.size.map(|s| s * factor),
        Shape::Disc(disc) => disc.radius *= factor,
    }
}
