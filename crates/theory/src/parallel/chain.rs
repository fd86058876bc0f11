//! Chains: a light and the operators on its light field along the path.

use crate::light::{ParallelEmitter, closed_form};
use crate::parameter::shapes_of;
use etendue_field::{Hole, Light, Mask, Shape};

/// The light, which is in a plane perpendicular to the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The name of the light, which messages use.
    pub name: String,
    /// The light, with coordinates relative to the central ray.
    pub light: Light,
}

/// A step that changes the light field along the path.
#[derive(Clone, Debug, PartialEq)]
pub enum Operator {
    /// Free travel (docs/theory.md (2)): ℓ'(x, u) = ℓ(x − d u, u), ℓ̂'(Ωx, Ωu) = ℓ̂(Ωx, Ωu + d Ωx)
    /// (Durand et al. 2005, Eq. 3). [`AffineMap::travel`](crate::geometry::AffineMap::travel) is
    /// the same step as a map. In a chain, the distances of consecutive steps are added, and
    /// polygons are sheared by the total distance.
    Travel {
        /// Name of the plane from which the light travels.
        from: String,
        /// Name of the plane at which the light arrives.
        to: String,
        /// The distance d, in metres.
        distance: f64,
    },
    /// A mask in the plane that the light has reached (Durand et al. 2005, Eq. 4). An opaque mask
    /// multiplies radiance by 1 minus the sum of its shapes and half-planes, which must not overlap
    /// each other. An aperture multiplies radiance by 1 in its hole and by 0 elsewhere. A grating
    /// multiplies radiance by a cosine pattern.
    Visibility {
        /// Name of the mask.
        name: String,
        /// The mask's transmission as a function of position relative to the central ray.
        mask: Mask,
    },
    /// A product with G = (1 + u² + v²)⁻² (docs/theory.md (7)). This product converts radiance to
    /// differential irradiance.
    Cosine {
        /// Name of the surface.
        name: String,
    },
    /// Diffuse reflection: the integral over both slopes, times albedo/π. The result is exitant
    /// radiance, which is constant in slope (Durand et al. 2005, section 5.1). The factor G is a
    /// separate [`Cosine`](Self::Cosine) operator before the reflection.
    ///
    /// After the reflection the central ray returns along −D, with x' = −x and y' = y. The only
    /// operator allowed after a diffuse reflection is travel.
    Diffuse {
        /// Name of the surface.
        name: String,
        /// The ratio of reflected to incident flux.
        albedo: f64,
    },
}

/// A light path: the source and the operators on its light field in the order of propagation.
///
/// The predicted light field is the radiance after the last operator, in two-plane coordinates. If
/// the last operator is a cosine, the predicted field is the differential irradiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The light.
    pub source: Source,
    /// The operators on the light field, in the order of propagation. At most one operator is a
    /// diffuse reflection, after which only travel is allowed.
    pub operators: Vec<Operator>,
}

/// A plane with a mask, relative to the end of a [`ChainSegment`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaskLayer<'a> {
    /// The distance from the mask to the end of the segment, in metres. The ray (x, u) crossed the
    /// mask at x − distance · u.
    pub(crate) distance: f64,
    pub(crate) mask: &'a Mask,
}

/// The reflection by a diffuse surface at the end of a [`ChainSegment`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DiffuseReflection {
    pub(crate) albedo: f64,
    /// Distance that the light travels after the reflection, in metres.
    pub(crate) after: f64,
}

/// The part of a chain up to its diffuse surface. If the chain has no diffuse surface, the segment
/// is the whole chain. Distances are relative to the end of the segment.
#[derive(Clone, Debug)]
pub(crate) struct ChainSegment<'a> {
    pub(crate) light: ParallelEmitter,
    /// Distance from the light to the end of the segment, in metres.
    pub(crate) distance: f64,
    /// The masks along the path, in the order of propagation.
    pub(crate) layers: Vec<MaskLayer<'a>>,
    /// Number of factors G along the segment.
    pub(crate) cosines: u32,
    pub(crate) reflection: Option<DiffuseReflection>,
}

impl Chain {
    /// The segment of the chain with its light, masks and reflection.
    ///
    /// # Panics
    /// Panics if the light has no closed form, or if an operator other than travel follows a diffuse
    /// reflection.
    pub(crate) fn path(&self) -> ChainSegment<'_> {
        let mut path = ChainSegment {
            light: closed_form(&self.source.light).unwrap_or_else(|why| panic!("{why}")),
            distance: 0.0,
            layers: Vec::new(),
            cosines: 0,
            reflection: None,
        };
        for operator in self.operators.iter().rev() {
            match operator {
                Operator::Travel { distance, .. } => path.distance += distance,
                Operator::Visibility { mask, .. } => path.layers.push(MaskLayer {
                    distance: path.distance,
                    mask,
                }),
                Operator::Cosine { .. } => path.cosines += 1,
                Operator::Diffuse { name, albedo } => {
                    let only_travel =
                        path.layers.is_empty() && path.cosines == 0 && path.reflection.is_none();
                    assert!(only_travel, "only travel may follow the diffuse {name}");
                    path.reflection = Some(DiffuseReflection {
                        albedo: *albedo,
                        after: path.distance,
                    });
                    path.distance = 0.0;
                }
            }
        }
        path.layers.reverse();
        path
    }
}

impl ChainSegment<'_> {
    /// The shapes of the light: a single shape, or an empty slice for a point light.
    pub(crate) fn light_shapes(&self) -> &[Shape] {
        self.light.shape.as_slice()
    }

    /// The total power p of the factor (1 + u² + v²)^p: the power of the light, minus 2
    /// for each cosine operator.
    pub(crate) fn slope_power(&self) -> f64 {
        self.light.power - 2.0 * f64::from(self.cosines)
    }

    /// The shapes in each plane that has edges: first the shapes of the light, then the
    /// shapes of each opaque mask, or the hole of each aperture.
    pub(crate) fn planes(&self) -> Vec<&[Shape]> {
        let masks = self.layers.iter().map(|layer| layer.mask);
        let with_edges = masks.filter(|mask| !matches!(mask, Mask::Grating(_)));
        std::iter::once(self.light_shapes())
            .chain(with_edges.map(shapes_of))
            .collect()
    }

    /// Checks whether any mask is an aperture whose hole is a polygon. Such a chain has no closed
    /// form.
    pub(crate) fn has_polygons(&self) -> bool {
        let mut layers = self.layers.iter();
        layers.any(|layer| matches!(layer.mask, Mask::Aperture(Hole::Polygon(_))))
    }

    /// Checks whether the light or any mask contains a disc.
    pub(crate) fn has_discs(&self) -> bool {
        let planes = self.planes();
        let mut all = planes.into_iter().flatten();
        all.any(|shape| matches!(shape, Shape::Disc(_)))
    }
}
