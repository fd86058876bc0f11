//! Parameters of a model that can be estimated from a measurement.

use etendue_field::{ConvexPolygon, Hole, Light, LightValues, Mask, Patch, Rectangle, Shape};

/// A parameter of a [`Model`](crate::Model). An index is the index of an operator of a chain or of
/// a surface of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The side of a rectangular light along X (0) or Y (1), or the radius of a disc (0).
    SourceSize(usize),
    /// The position of a light's centre along X (0) or Y (1). The central ray does not move.
    SourcePosition(usize),
    /// The exponent n of a spot's cosⁿθ.
    SpotExponent,
    /// The first (0) or the second (1) width of a light's picture.
    ImageWidth(usize),
    /// The distance of a step of travel. On a path, this is the length of a leg of the central
    /// ray. The leg starts at a surface, or at the light (0), and ends at the next surface or at
    /// the plane. If the length changes, all surfaces after the leg and the plane move along D.
    Travel(usize),
    /// The size of a shape of an opaque mask, or of the hole of an aperture: the index of the mask,
    /// of the shape, and of the axis. For a rectangle, it is the side along this axis; for a bar,
    /// which is a rectangle of unlimited length, it is the width; for a disc, it is the radius; for
    /// a polygon, it is the extent along X, and the polygon scales about its centroid. A mask of
    /// more than four shapes has one size: that of its first shape, and all its shapes scale by the
    /// same factor about their centres.
    BlockerSide(usize, usize, usize),
    /// The position of a shape of an opaque mask, or of the hole of an aperture, along X (0) or Y
    /// (1): the index of the mask, of the shape, and of the axis. For a polygon, it is the centroid.
    /// A mask of more than four shapes has one position, which is the mean of the centres, and all
    /// shapes move together. Half-planes do not move.
    BlockerPosition(usize, usize, usize),
    /// The position of a corner of a polygonal hole along X (0) or Y (1): the index of the mask, of
    /// the corner in the scene's order, and of the axis. The other corners do not move. The corners
    /// of a hole with more than eight corners are not parameters.
    HoleCorner(usize, usize, usize),
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
    /// The side of a rectangular surface along X (0) or Y (1), or the aperture of a patch (0).
    SurfaceSize(usize, usize),
    /// The position of the vertex of a surface along X (0) or Y (1) of its patch, from the point
    /// where the central ray meets the surface.
    SurfacePosition(usize, usize),
    /// The side of an obstacle that is a rectangle along its X (0) or Y (1), or the aperture of an
    /// obstacle that is a patch (0), with the index of the obstacle.
    ObstacleSize(usize, usize),
    /// The position of the centre or the vertex of an obstacle along X (0), Y (1) or D (2) of the
    /// light's frame; for a mesh, it is the centre of the box that encloses it.
    ObstaclePosition(usize, usize),
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
    /// The parameters of a light.
    pub(crate) fn of_light(light: &Light) -> Vec<Self> {
        let mut light = light.clone();
        let LightValues {
            shape,
            image,
            exponent,
        } = light.values();
        let of_shape = |shape: &mut Shape| {
            let sizes = size_axes(std::slice::from_ref(shape)).into_iter();
            let positions = [0, 1].map(Self::SourcePosition);
            sizes.map(Self::SourceSize).chain(positions)
        };
        let of_shape = shape.into_iter().flat_map(of_shape);
        let exponent = exponent.filter(|n| **n > 0.0).map(|_| Self::SpotExponent);
        let of_image = image.map(|_| [0, 1].map(Self::ImageWidth));
        let of_image = of_image.into_iter().flatten();
        of_shape.chain(exponent).chain(of_image).collect()
    }

    /// The index of the mask to which the parameter belongs, or `None` if it has no mask.
    pub(crate) fn mask(self) -> Option<usize> {
        match self {
            Self::BlockerSide(i, ..)
            | Self::BlockerPosition(i, ..)
            | Self::HoleCorner(i, ..)
            | Self::HalfPlaneEdge(i, _)
            | Self::GratingFrequency(i)
            | Self::GratingPhase(i) => Some(i),
            _ => None,
        }
    }

    /// Checks whether the parameter places edges or a light. Its value may be zero, and its finite
    /// differences need large steps.
    pub(crate) fn places(self) -> bool {
        matches!(self, Self::SourcePosition(_)) || self.is_of_rim() || self.mask().is_some()
    }

    /// Checks whether the parameter places the rim of a surface, which light may not reach.
    #[must_use]
    pub fn is_of_rim(self) -> bool {
        matches!(
            self,
            Self::SurfaceSize(..)
                | Self::SurfacePosition(..)
                | Self::ObstacleSize(..)
                | Self::ObstaclePosition(..)
        )
    }

    /// The unit of the parameter, or an empty string for a dimensionless parameter.
    pub(crate) fn unit(self, light: &Light) -> &'static str {
        match self {
            Self::ImageWidth(_) if !light.is_distant() => "",
            Self::SpotExponent | Self::Index(_) | Self::Albedo | Self::Lobe => "",
            Self::GratingPhase(_) | Self::Incidence(_) => "rad",
            Self::GratingFrequency(_) | Self::Curvature(..) => "1/m",
            Self::SourceSize(_)
            | Self::SourcePosition(_)
            | Self::ImageWidth(_)
            | Self::Travel(_)
            | Self::BlockerSide(..)
            | Self::BlockerPosition(..)
            | Self::HoleCorner(..)
            | Self::HalfPlaneEdge(..)
            | Self::SurfaceSize(..)
            | Self::SurfacePosition(..)
            | Self::ObstacleSize(..)
            | Self::ObstaclePosition(..)
            | Self::FocalLength(_) => "m",
        }
    }

    /// The scale of the parameter. A change of the parameter is small if it is small
    /// compared with this scale.
    pub(crate) fn scale(self, value: f64) -> f64 {
        match self {
            // The distance from the central ray tells nothing about how far an edge may move.
            Self::SourcePosition(_)
            | Self::SurfacePosition(..)
            | Self::ObstaclePosition(..)
            | Self::BlockerPosition(..)
            | Self::HoleCorner(..)
            | Self::HalfPlaneEdge(..) => 1.0,
            Self::Incidence(_) | Self::Curvature(..) | Self::Albedo | Self::Lobe => {
                value.abs().max(0.1)
            }
            _ if value == 0.0 => 1.0,
            _ => value.abs(),
        }
    }

    /// The readable name of a light's parameter; `name` is the name of the light.
    pub(crate) fn name_of_light(self, light: &Light, name: &str) -> Option<String> {
        Some(match self {
            Self::SourceSize(axis) => {
                let word = size_word(std::slice::from_ref(light.shape()?), axis);
                format!("{word} of {name}")
            }
            Self::SourcePosition(axis) => position(axis, name),
            Self::SpotExponent => format!("exponent of {name}"),
            Self::ImageWidth(axis) => format!("width {} of image", axis + 1),
            _ => return None,
        })
    }

    /// Replaces the value of the parameter in a light by `new(value)`. Returns `None` if the light
    /// does not have the parameter.
    pub(crate) fn change_light(self, light: &mut Light, new: New<'_>) -> Option<()> {
        let values = light.values();
        match self {
            Self::SourceSize(axis) => resize(std::slice::from_mut(values.shape?), axis, new),
            Self::SourcePosition(axis) => {
                reposition(std::slice::from_mut(values.shape?), axis, new);
            }
            Self::SpotExponent => {
                let exponent = values.exponent?;
                *exponent = new(*exponent);
            }
            Self::ImageWidth(axis) => {
                let width = &mut values.image?.width[axis];
                *width = new(*width);
            }
            _ => return None,
        }
        Some(())
    }

    /// The parameters of a mask; `index` is the index of its operator.
    pub(crate) fn of_mask(mask: &Mask, index: usize) -> Vec<Self> {
        let shapes = shapes_of(mask);
        let groups = shapes.chunks(group_size(shapes)).enumerate();
        let of_shapes = groups.flat_map(|(number, group)| {
            let sizes = size_axes(group).into_iter();
            let sizes = sizes.map(move |axis| Self::BlockerSide(index, number, axis));
            let axes = movable_axes(group).into_iter();
            sizes.chain(axes.map(move |axis| Self::BlockerPosition(index, number, axis)))
        });
        let others = match mask {
            Mask::Opaque { half_planes, .. } => {
                let edges = 0..half_planes.len();
                edges.map(|edge| Self::HalfPlaneEdge(index, edge)).collect()
            }
            Mask::Aperture(Hole::Shape(_)) => Vec::new(),
            Mask::Aperture(Hole::Polygon(polygon)) => {
                let [x, y] = [0, 1].map(|axis| Self::BlockerPosition(index, 0, axis));
                let few = Some(polygon.corners().len()).filter(|count| *count <= MAX_CORNERS);
                let corners = 0..few.unwrap_or(0);
                let corners =
                    corners.flat_map(|i| [0, 1].map(|axis| Self::HoleCorner(index, i, axis)));
                [Self::BlockerSide(index, 0, 0), x, y]
                    .into_iter()
                    .chain(corners)
                    .collect()
            }
            Mask::Grating(_) => vec![Self::GratingFrequency(index), Self::GratingPhase(index)],
        };
        of_shapes.chain(others).collect()
    }

    /// The readable name of a mask's parameter; `name` is the name of the mask.
    pub(crate) fn name_of_mask(self, mask: &Mask, name: &str) -> Option<String> {
        let shapes = shapes_of(mask);
        let size = group_size(shapes);
        let of = |number: usize| match shapes.len() > size {
            true => format!("shape {} of {name}", number + 1),
            false => name.to_owned(),
        };
        Some(match (self, mask) {
            (Self::BlockerSide(..), Mask::Aperture(Hole::Polygon(_))) => format!("width of {name}"),
            (Self::BlockerSide(_, number, axis), _) => {
                let group = shapes.chunks(size).nth(number)?;
                format!("{} of {}", size_word(group, axis), of(number))
            }
            (Self::BlockerPosition(_, number, axis), _) => position(axis, &of(number)),
            (Self::HoleCorner(_, corner, axis), _) => {
                format!("{} of corner {} of {name}", ["x", "y"][axis], corner + 1)
            }
            (Self::HalfPlaneEdge(_, edge), Mask::Opaque { half_planes, .. }) => {
                let number = (half_planes.len() > 1).then(|| format!(" {}", edge + 1));
                format!("edge{} of {name}", number.unwrap_or_default())
            }
            (Self::GratingFrequency(_), _) => format!("frequency of {name}"),
            (Self::GratingPhase(_), _) => format!("phase of {name}"),
            _ => return None,
        })
    }

    /// Replaces the value of the parameter in a mask by `new(value)`. Returns `None` if the mask
    /// does not have the parameter.
    pub(crate) fn change_mask(self, mask: &mut Mask, new: New<'_>) -> Option<()> {
        match (self, mask) {
            (Self::BlockerSide(..), Mask::Aperture(hole @ Hole::Polygon(_))) => {
                let width = hole.bounds().size[0];
                let factor = new(width) / width;
                let fixed = hole.moments().centroid;
                *hole = hole.mapped(factor, fixed.map(|c| c - factor * c));
            }
            (Self::BlockerPosition(_, _, axis), Mask::Aperture(hole @ Hole::Polygon(_))) => {
                let old = hole.moments().centroid[axis];
                let mut shift = [0.0; 2];
                shift[axis] = new(old) - old;
                *hole = hole.mapped(1.0, shift);
            }
            (Self::HoleCorner(_, corner, axis), Mask::Aperture(Hole::Polygon(polygon))) => {
                let mut corners = polygon.in_given_order();
                let coordinate = corners.get_mut(corner)?.get_mut(axis)?;
                *coordinate = new(*coordinate);
                *polygon = ConvexPolygon::new(corners)?;
            }
            (Self::HalfPlaneEdge(_, edge), Mask::Opaque { half_planes, .. }) => {
                let half = half_planes.get_mut(edge)?;
                half.edge = new(half.edge);
            }
            (Self::GratingFrequency(_), Mask::Grating(grating)) => {
                grating.frequency = new(grating.frequency);
            }
            (Self::GratingPhase(_), Mask::Grating(grating)) => grating.phase = new(grating.phase),
            (_, mask) => {
                let shapes = match mask {
                    Mask::Opaque { shapes, .. } => shapes.as_mut_slice(),
                    Mask::Aperture(Hole::Shape(shape)) => std::slice::from_mut(shape),
                    Mask::Aperture(Hole::Polygon(_)) | Mask::Grating(_) => return None,
                };
                let mut groups = shapes.chunks_mut(group_size(shapes));
                match self {
                    Self::BlockerSide(_, number, axis) => resize(groups.nth(number)?, axis, new),
                    Self::BlockerPosition(_, number, axis) => {
                        reposition(groups.nth(number)?, axis, new);
                    }
                    _ => return None,
                }
            }
        }
        Some(())
    }
}

pub(crate) fn position(axis: usize, name: &str) -> String {
    format!("position {} of {name}", ["x", "y", "z"][axis])
}

/// The name of a side or of the aperture of an object.
pub(crate) fn size_of_rim(is_rectangle: bool, axis: usize, name: &str) -> String {
    match is_rectangle {
        true => format!("side {} of {name}", ["x", "y"][axis]),
        false => format!("aperture of {name}"),
    }
}

/// The axes of the curvatures of a patch that are parameters; equal curvatures are a
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

/// The largest number of shapes of a mask that have parameters of their own.
const MAX_SEPARATE: usize = 4;

/// The largest number of corners of a polygonal hole that are parameters.
const MAX_CORNERS: usize = 8;

/// The shapes of a mask or of its hole; none for a polygon or a grating.
pub(crate) fn shapes_of(mask: &Mask) -> &[Shape] {
    match mask {
        Mask::Opaque { shapes, .. } => shapes,
        Mask::Aperture(Hole::Shape(shape)) => std::slice::from_ref(shape),
        Mask::Aperture(Hole::Polygon(_)) | Mask::Grating(_) => &[],
    }
}

/// How many shapes of a mask share their parameters.
fn group_size(shapes: &[Shape]) -> usize {
    if shapes.len() > MAX_SEPARATE {
        shapes.len()
    } else {
        1
    }
}

/// Checks whether a shape ends along an axis.
fn ends(shape: &Shape, axis: usize) -> bool {
    shape.bounds().size[axis] <= MAX_SIDE
}

/// The axes of the sizes of shapes: one for each side of a single rectangle, and otherwise
/// one.
fn size_axes(shapes: &[Shape]) -> Vec<usize> {
    let axes = [0, 1].into_iter();
    let finite = axes.filter(|axis| ends(&shapes[0], *axis));
    match shapes {
        [Shape::Rectangle(_)] => finite.collect(),
        _ => finite.take(1).collect(),
    }
}

/// The word for the size of shapes along an axis.
fn size_word(shapes: &[Shape], axis: usize) -> &'static str {
    match shapes {
        [Shape::Disc(_), ..] => "radius",
        [Shape::Rectangle(Rectangle { size: [x, y], .. }), ..] if x.max(*y) > MAX_SIDE => "width",
        [_] => ["side x", "side y"][axis],
        _ => "side",
    }
}

/// Sets the size of shapes. Several shapes scale by the same factor along both axes.
fn resize(shapes: &mut [Shape], axis: usize, new: New<'_>) {
    let old = match &shapes[0] {
        Shape::Disc(disc) => disc.radius,
        shape => shape.bounds().size[axis],
    };
    let factor = new(old) / old;
    match shapes {
        [Shape::Rectangle(rectangle)] => rectangle.size[axis] *= factor,
        _ => {
            for shape in shapes {
                *shape = shape
                    .mapped(factor, [0.0; 2])
                    .centered_at(shape.bounds().center);
            }
        }
    }
}

/// Sets the mean position of shapes along an axis, and moves all shapes by the same distance.
fn reposition(shapes: &mut [Shape], axis: usize, new: New<'_>) {
    let centers = shapes.iter().map(|shape| shape.bounds().center[axis]);
    let old = centers.sum::<f64>() / shapes.len() as f64;
    let by = new(old) - old;
    let mut shift = [0.0; 2];
    shift[axis] = by;
    for shape in shapes {
        *shape = shape.mapped(1.0, shift);
    }
}

/// The axes along which a displacement of the shapes changes the light: all axes along
/// which a shape ends.
fn movable_axes(shapes: &[Shape]) -> Vec<usize> {
    let axes = [0, 1].into_iter();
    axes.filter(|axis| shapes.iter().any(|shape| ends(shape, *axis)))
        .collect()
}
