//! Parameters of a model that can be estimated from a measurement.

use etendue_field::{Disc, Hole, Light, Patch, Rectangle, Shape};

/// A parameter of a [`Model`](crate::Model). An index is the index of an operator of a chain or of
/// a surface of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The size of a light. For a rectangle, it is the side along X, and the aspect ratio is
    /// constant. For a disc, it is the radius.
    SourceSize,
    /// The exponent n of a spot's cosⁿθ.
    SpotExponent,
    /// The first width of a light's picture; the ratio of the two widths is constant.
    ImageWidth,
    /// The distance of a step of travel. On a path, this is the length of a leg of the central
    /// ray. The leg starts at a surface, or at the light (0), and ends at the next surface or at
    /// the plane. If the length changes, all surfaces after the leg and the plane move along D.
    Travel(usize),
    /// The size of the first shape of an opaque mask, or of the hole of an aperture. For a
    /// rectangle, it is the side along X; for a bar, which is a rectangle of unlimited length, it
    /// is the width; for a disc, it is the radius; for a polygon, it is the extent along X. All
    /// shapes of the mask scale by the same factor about their centres, and a polygon scales about
    /// its centroid.
    BlockerSide(usize),
    /// The position of an opaque mask's shapes, or of the hole of an aperture, along X (0) or Y (1).
    /// The value is the mean of the shapes' centres, or the centroid of a polygon. All shapes of the
    /// mask move together; its half-planes do not move.
    BlockerPosition(usize, usize),
    /// The edge of a half-plane of an opaque mask, with the index of the half-plane; the mask's
    /// other edges do not move.
    HalfPlaneEdge(usize, usize),
    /// The frequency of a grating.
    GratingFrequency(usize),
    /// The phase of a grating.
    GratingPhase(usize),
    /// The angle of incidence θ₀ of the central ray on a patch; a change turns only this patch
    /// about B.
    Incidence(usize),
    /// A curvature of a patch, k₁ (0) or k₂ (1). Other curvatures of the patch change too if they
    /// are equal to this curvature. The patch's vertex does not move.
    Curvature(usize, usize),
    /// The index of refraction of the denser side of a surface.
    Index(usize),
    /// The focal length of a lens.
    FocalLength(usize),
    /// The albedo of a BRDF, which is a factor of its value.
    Albedo,
    /// The exponent or the roughness of the BRDF's lobe.
    Lobe,
}

impl Parameter {
    /// Returns the parameters of a light.
    pub(crate) fn of_light(light: &Light) -> Vec<Self> {
        match light {
            Light::Area { exponent, .. } if *exponent > 0.0 => {
                vec![Self::SourceSize, Self::SpotExponent]
            }
            Light::Area { .. } => vec![Self::SourceSize],
            Light::Projector { .. } | Light::Beam { .. } => vec![Self::ImageWidth],
            _ => Vec::new(),
        }
    }

    /// Returns the unit of the parameter, or an empty string for a dimensionless parameter.
    pub(crate) fn unit(self, light: &Light) -> &'static str {
        match self {
            Self::ImageWidth if matches!(light, Light::Projector { .. }) => "",
            Self::SpotExponent | Self::Index(_) | Self::Albedo | Self::Lobe => "",
            Self::GratingPhase(_) | Self::Incidence(_) => "rad",
            Self::GratingFrequency(_) | Self::Curvature(..) => "1/m",
            Self::SourceSize
            | Self::ImageWidth
            | Self::Travel(_)
            | Self::BlockerSide(_)
            | Self::BlockerPosition(..)
            | Self::HalfPlaneEdge(..)
            | Self::FocalLength(_) => "m",
        }
    }

    /// Returns the scale of the parameter. A change of the parameter is small if it is small
    /// compared with this scale.
    pub(crate) fn scale(self, value: f64) -> f64 {
        match self {
            // The distance from the central ray tells nothing about how far an edge may move.
            Self::BlockerPosition(..) | Self::HalfPlaneEdge(..) => 1.0,
            Self::Incidence(_) | Self::Curvature(..) | Self::Albedo | Self::Lobe => {
                value.abs().max(0.1)
            }
            _ if value == 0.0 => 1.0,
            _ => value.abs(),
        }
    }

    /// Returns the readable name of a light's parameter; `name` is the name of the light.
    pub(crate) fn name_of_light(self, light: &Light, name: &str) -> Option<String> {
        match (self, light) {
            (Self::SourceSize, Light::Area { shape, .. }) => {
                Some(format!("{} of {name}", size_of(shape).0))
            }
            (Self::SpotExponent, _) => Some(format!("exponent of {name}")),
            (Self::ImageWidth, _) => Some("width of image".to_owned()),
            _ => None,
        }
    }

    /// Replaces the value of the parameter in a light by `new(value)`. Returns `None` if the light
    /// does not have the parameter.
    pub(crate) fn change_light(self, light: &mut Light, new: New<'_>) -> Option<()> {
        match (self, light) {
            (Self::SourceSize, Light::Area { shape, .. }) => {
                resize(std::slice::from_mut(shape), new);
            }
            (Self::SpotExponent, Light::Area { exponent, .. }) => *exponent = new(*exponent),
            (Self::ImageWidth, Light::Projector { image, .. } | Light::Beam { image, .. }) => {
                let factor = new(image.width[0]) / image.width[0];
                image.width = image.width.map(|w| w * factor);
            }
            _ => return None,
        }
        Some(())
    }
}

/// Returns the axes of the curvatures of a patch that are parameters; equal curvatures are a
/// single parameter.
pub(crate) fn curvatures(patch: &Patch) -> Vec<usize> {
    let [k1, k2, _] = patch.curvature;
    if same(k1, k2) { vec![0] } else { vec![0, 1] }
}

/// Changes the curvature of a patch along an axis, and all curvatures of the patch that are equal
/// to it.
pub(crate) fn change_curvature(patch: &mut Patch, axis: usize, new: New<'_>) -> Option<()> {
    let old = *patch.curvature.get(axis)?;
    let value = new(old);
    for (i, k) in patch.curvature.iter_mut().enumerate() {
        if i == axis || old != 0.0 && same(*k, old) {
            *k = value;
        }
    }
    Some(())
}

/// Checks whether two curvatures are equal up to rounding error.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// The new value of a parameter as a function of the old one.
pub(crate) type New<'a> = &'a mut dyn FnMut(f64) -> f64;

/// The largest side that a scene can state. A rectangle with a larger side is a bar.
const MAX_SIDE: f64 = 1e9;

/// Returns the size of a shape that is a parameter, with the word for this size in the parameter's
/// name.
pub(crate) fn size_of(shape: &Shape) -> (&'static str, f64) {
    match shape {
        Shape::Rectangle(Rectangle { size: [x, y], .. }) if x.max(*y) > MAX_SIDE => {
            ("width", x.min(*y))
        }
        Shape::Rectangle(rectangle) => ("side", rectangle.size[0]),
        Shape::Disc(disc) => ("radius", disc.radius),
    }
}

/// Sets the size of the first shape, and scales all shapes by the same factor.
pub(crate) fn resize(shapes: &mut [Shape], new: New<'_>) {
    let (_, size) = size_of(&shapes[0]);
    let factor = new(size) / size;
    for shape in shapes {
        match shape {
            Shape::Rectangle(rectangle) => rectangle.size = rectangle.size.map(|s| s * factor),
            Shape::Disc(disc) => disc.radius *= factor,
        }
    }
}

/// Sets the mean position of shapes along an axis, and moves all shapes by the same distance.
pub(crate) fn reposition(shapes: &mut [Shape], axis: usize, new: New<'_>) {
    let centers = shapes.iter().map(|shape| shape.bounds().center[axis]);
    let old = centers.sum::<f64>() / shapes.len() as f64;
    let by = new(old) - old;
    for shape in shapes {
        let (Shape::Rectangle(Rectangle { center, .. }) | Shape::Disc(Disc { center, .. })) = shape;
        center[axis] += by;
    }
}

/// Sets the position of a hole along an axis.
pub(crate) fn reposition_hole(hole: &mut Hole, axis: usize, new: New<'_>) {
    match hole {
        Hole::Shape(shape) => reposition(std::slice::from_mut(shape), axis, new),
        Hole::Polygon(_) => {
            let old = hole.moments().centroid[axis];
            let mut shift = [0.0; 2];
            shift[axis] = new(old) - old;
            *hole = hole.mapped(1.0, shift);
        }
    }
}

/// Returns the axes along which a displacement of the shapes changes the light: all axes along
/// which a shape ends.
pub(crate) fn movable_axes(shapes: &[Shape]) -> Vec<usize> {
    let ends = |shape: &Shape, axis: usize| match shape {
        Shape::Rectangle(rectangle) => rectangle.size[axis] <= MAX_SIDE,
        Shape::Disc(_) => true,
    };
    let axes = [0, 1].into_iter();
    axes.filter(|axis| shapes.iter().any(|shape| ends(shape, *axis)))
        .collect()
}

/// Returns the word for the size of a hole in parameter names.
pub(crate) fn hole_word(hole: &Hole) -> &'static str {
    match hole {
        Hole::Shape(shape) => size_of(shape).0,
        Hole::Polygon(_) => "width",
    }
}

/// Sets the size of a hole.
pub(crate) fn resize_hole(hole: &mut Hole, new: New<'_>) {
    match hole {
        Hole::Shape(shape) => resize(std::slice::from_mut(shape), new),
        Hole::Polygon(_) => {
            let width = hole.bounds().size[0];
            let factor = new(width) / width;
            let fixed = hole.moments().centroid;
            *hole = hole.mapped(factor, fixed.map(|c| c - factor * c));
        }
    }
}
