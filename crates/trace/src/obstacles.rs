//! Finds the obstacles of light on a leg.

use crate::flat_leg::{FlatObstacle, Outline, PhotonEnd};
use crate::grid::Grid;
use crate::line::{direction, start};
use crate::mesh::BlockerMesh;
use crate::primitive::Primitive;
use crate::primitive_set::{PrimitiveHit, PrimitiveSet, TaggedPrimitive};
use crate::unbounded::Unbounded;
use etendue_field::{Frame, Mask, Rectangle, Shape, Side, Specular, TwoPlane};
use etendue_scene::{BlockerLayer, Event, Leg, MeshObject, Object, Scene, Surface};
use glam::DVec3;

/// The kind of obstacle that a photon meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum HitKind {
    Blocker,
    Surface {
        object: Object,
        material: ObstacleKind,
    },
}

/// The interaction of light with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ObstacleKind {
    Lambertian {
        albedo: f64,
    },
    Specular(Specular),
    /// Reflection by a BRDF.
    Reflects,
}

impl HitKind {
    /// The object that the photon meets if the obstacle is a surface, and `None` if it is
    /// a blocker.
    pub(crate) fn object(&self) -> Option<Object> {
        match self {
            Self::Blocker => None,
            Self::Surface { object, .. } => Some(*object),
        }
    }

    /// Checks whether the obstacle is the object `end`, on which a leg begins or ends.
    pub(crate) fn is(&self, end: Option<Object>) -> bool {
        end.is_some() && self.object() == end
    }
}

/// All obstacles of light on one leg, with the queries of the forward and the backward tracer.
///
/// A ray is given by its point in the plane at the beginning of the leg, and distances are
/// measured along the leg.
#[derive(Debug)]
pub(crate) struct Obstacles {
    primitives: PrimitiveSet<HitKind>,
    unbounded: Vec<Layer<Unbounded>>,
    semi_transparent: Vec<Layer<Mask>>,
}

/// A blocker that extends without bound in its plane: an opaque blocker or a semi-transparent mask.
#[derive(Clone, Debug)]
struct Layer<T> {
    distance: f64,
    /// The frame of the leg; `None` for the first leg.
    leg: Option<Frame>,
    what: T,
}

impl<T> Layer<T> {
    /// The distance along the leg at which a ray crosses the plane of the layer, and the
    /// crossing point in that plane.
    #[inline]
    fn crossing(&self, ray: &TwoPlane) -> (f64, [f64; 2]) {
        let Some(leg) = &self.leg else {
            let at = ray.travelled(self.distance);
            return (self.distance, [at.x, at.y]);
        };
        let (start, direction) = (
            leg.to_world(start(ray)),
            leg.vector_to_world(direction(ray)),
        );
        let along = (self.distance - start.z) / direction.z;
        let at = start + along * direction;
        (along, [at.x, at.y])
    }
}

impl Obstacles {
    /// Collects the obstacles around a leg of the path.
    #[expect(
        clippy::too_many_lines,
        reason = "the function has a case for each kind of obstacle"
    )]
    pub(crate) fn new(scene: &Scene, leg: &Leg) -> Self {
        let mut primitives = Vec::new();
        let (mut unbounded, mut semi_transparent) = (Vec::new(), Vec::new());
        let around = Around(leg.frame);
        let later = leg.leaves.map(|_| leg.frame);
        let is_met = |layer: &&BlockerLayer| later.is_some() || layer.distance > 0.0;
        for layer in scene.blockers.iter().filter(is_met) {
            let distance = layer.distance;
            match &layer.mask {
                Mask::Opaque {
                    shapes,
                    half_planes,
                } => {
                    primitives.extend(around.layer(distance, shapes).into_iter().map(
                        |primitive| {
                            let tag = HitKind::Blocker;
                            TaggedPrimitive { primitive, tag }
                        },
                    ));
                    unbounded.extend(half_planes.iter().map(|half| Layer {
                        distance,
                        leg: later,
                        what: Unbounded::HalfPlane(*half),
                    }));
                }
                Mask::Aperture(hole) => unbounded.push(Layer {
                    distance,
                    leg: later,
                    what: Unbounded::Aperture(hole.clone()),
                }),
                mask => semi_transparent.push(Layer {
                    distance,
                    leg: later,
                    what: mask.clone(),
                }),
            }
        }
        for (i, surface) in scene.surfaces.iter().enumerate() {
            let object = Object::Surface(i);
            let albedo = surface.albedo;
            let material = ObstacleKind::Lambertian { albedo };
            primitives.push(TaggedPrimitive {
                primitive: around.surface(surface),
                tag: HitKind::Surface { object, material },
            });
        }
        for (i, object) in scene.patches.iter().enumerate() {
            let material = match object.event {
                Event::Specular(event) => ObstacleKind::Specular(event),
                Event::Reflects(_) => ObstacleKind::Reflects,
            };
            primitives.push(TaggedPrimitive {
                primitive: Primitive::Smooth(Box::new(object.patch.seen_from(&leg.frame))),
                tag: HitKind::Surface {
                    object: Object::Patch(i),
                    material,
                },
            });
        }
        for (i, mesh) in scene.meshes.iter().enumerate() {
            let object = Object::Mesh(i);
            let material = match (&mesh.smooth, mesh.albedo) {
                (Some(smooth), _) => Some(ObstacleKind::Specular(smooth.event)),
                (None, albedo) => albedo.map(|albedo| ObstacleKind::Lambertian { albedo }),
            };
            let surface = |material| HitKind::Surface { object, material };
            let tag = material.map_or(HitKind::Blocker, surface);
            primitives.push(TaggedPrimitive {
                primitive: around.mesh(mesh),
                tag,
            });
        }
        let ends = [0, 1].map(|axis| scene.light.extent(axis));
        let ends = ends.as_flattened().iter().map(|end| end.abs());
        // If a ray starts farther to the side than the bound `origins`, the hierarchy tests the ray
        // from a nearer point.
        let origins = ends.filter(|end| end.is_finite()).fold(0.0, f64::max);
        Self {
            primitives: PrimitiveSet::new(&primitives, origins),
            unbounded,
            semi_transparent,
        }
    }

    /// The obstacles beyond the beginning of the leg if all of them lie across the leg or
    /// are meshes at which light ends. `end` is the object that ends the leg. Returns `None` for any
    /// other obstacles, and for surfaces that do not scatter light by Lambert's law.
    pub(crate) fn flat(&self, end: Option<Object>) -> Option<Vec<FlatObstacle>> {
        let unbounded = self.unbounded.iter().map(|layer| {
            layer.leg.is_none().then_some(FlatObstacle {
                distance: layer.distance,
                nearest: layer.distance,
                outline: Outline::Unbounded(layer.what.clone()),
                end: PhotonEnd::ABSORBED,
            })
        });
        let primitives = self.primitives.primitives().iter().map(|target| {
            let (extent, outline) = match &target.primitive {
                Primitive::Flat { distance, shape } => ([*distance; 2], Outline::Shape(*shape)),
                Primitive::Grid(grid) => ([grid.distance; 2], Outline::Grid(grid.clone())),
                // Light is followed no further from its hit, so any hit will do.
                Primitive::Mesh(mesh) if !target.tag.is(end) => {
                    (mesh.extent()?, Outline::Mesh(mesh.clone()))
                }
                _ => return None,
            };
            let [nearest, distance] = extent;
            let end = match target.tag {
                HitKind::Blocker => PhotonEnd::ABSORBED,
                HitKind::Surface {
                    material: ObstacleKind::Lambertian { albedo },
                    ..
                } => PhotonEnd {
                    absorbed: 1.0 - albedo,
                    stopped: albedo,
                    arrives: target.tag.is(end),
                    ..PhotonEnd::default()
                },
                HitKind::Surface { .. } => return None,
            };
            Some(FlatObstacle {
                distance,
                nearest,
                outline,
                end,
            })
        });
        let all: Option<Vec<FlatObstacle>> = unbounded.chain(primitives).collect();
        let all = all.filter(|_| self.semi_transparent.is_empty());
        all.map(|all| all.into_iter().filter(|one| one.distance > 0.0).collect())
    }

    /// The first obstacle that a ray meets beyond `from`, and the distance of this
    /// obstacle.
    #[inline]
    pub(crate) fn closest_hit(
        &self,
        ray: &TwoPlane,
        from: f64,
    ) -> Option<(f64, PrimitiveHit<'_, HitKind>)> {
        let first = self.primitives.closest_hit(ray, from);
        let mut nearest = first.map_or(f64::INFINITY, |(distance, _)| distance);
        let mut blocked = false;
        for layer in &self.unbounded {
            let (distance, [x, y]) = layer.crossing(ray);
            let meets = distance > from && distance < nearest && layer.what.contains(x, y);
            if meets {
                nearest = distance;
                blocked = true;
            }
        }
        if blocked {
            Some((nearest, UNBOUNDED.met(0)))
        } else {
            first
        }
    }

    /// The transmittance of semi-transparent masks along a ray between the distance
    /// `from` and a plane.
    #[inline]
    pub(crate) fn transmittance(
        &self,
        ray: &TwoPlane,
        from: f64,
        distance: f64,
        side: Side,
    ) -> f64 {
        let met = self.semi_transparent.iter().filter_map(|layer| {
            let (at, [x, y]) = layer.crossing(ray);
            let passed = at > from && is_passed(at, distance, side);
            passed.then(|| layer.what.transmittance(x, y))
        });
        met.product()
    }

    /// Checks whether a ray meets an object anywhere beyond `from`, even if the ray meets other
    /// obstacles first.
    pub(crate) fn meets(&self, object: Option<Object>, ray: &TwoPlane, from: f64) -> bool {
        let other = |what: &HitKind| !what.is(object);
        self.primitives
            .is_occluded(ray, from, f64::INFINITY, false, other)
    }

    /// Checks whether another point of the same object, beyond `from`, hides the point at a given
    /// distance on a ray.
    pub(crate) fn is_behind(
        &self,
        own: Option<Object>,
        ray: &TwoPlane,
        from: f64,
        distance: f64,
    ) -> bool {
        let other = |what: &HitKind| !what.is(own);
        // Hits just before the point are ignored, because each may be the point itself, shifted
        // by a rounding error.
        let distance = distance - ROUNDING * distance.abs();
        self.primitives
            .is_occluded(ray, from, distance, false, other)
    }

    /// The share of light on a ray that reaches a plane from the distance `from`. The
    /// search goes backwards from the plane. Objects that `ignored` accepts do not occlude.
    pub(crate) fn visibility(
        &self,
        ray: &TwoPlane,
        from: f64,
        distance: f64,
        side: Side,
        ignored: impl Fn(&HitKind) -> bool,
    ) -> f64 {
        let beyond_bounds = || {
            self.unbounded.iter().any(|layer| {
                let (at, [x, y]) = layer.crossing(ray);
                at > from && is_passed(at, distance, side) && layer.what.contains(x, y)
            })
        };
        let inclusive = side == Side::After;
        if self
            .primitives
            .is_occluded(ray, from, distance, inclusive, ignored)
            || beyond_bounds()
        {
            return 0.0;
        }
        self.transmittance(ray, from, distance, side)
    }
}

/// The relative difference that rounding errors may make between two computations of a distance.
const ROUNDING: f64 = 1e-9;

/// If a ray hits an unbounded blocker, this primitive takes the place of the blocker.
static UNBOUNDED: TaggedPrimitive<HitKind> = TaggedPrimitive {
    primitive: Primitive::Flat {
        distance: 0.0,
        shape: Shape::Rectangle(Rectangle {
            center: [0.0; 2],
            size: [0.0; 2],
        }),
    },
    tag: HitKind::Blocker,
};

/// Checks whether light passes the position `obstacle` before it reaches a plane at `distance`.
fn is_passed(obstacle: f64, distance: f64, side: Side) -> bool {
    match side {
        Side::Before => obstacle < distance,
        Side::After => obstacle <= distance,
    }
}

/// A conversion from the frame at the light to the frame of a leg.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around(pub(crate) Frame);

impl Around {
    /// The primitives of the shapes in one plane of blockers.
    fn layer(&self, distance: f64, shapes: &[Shape]) -> Vec<Primitive> {
        let plane = self.0.decompose(&Frame::IDENTITY.travelled(distance));
        let forms: Vec<Primitive> = shapes
            .iter()
            .map(|shape| Self::flat(&plane, shape))
            .collect();
        let flat = forms.iter().map_while(|primitive| match primitive {
            Primitive::Flat { distance, shape } => Some((*distance, *shape)),
            _ => None,
        });
        let (distances, flat): (Vec<f64>, Vec<Shape>) = flat.unzip();
        match distances
            .first()
            .and_then(|distance| Grid::new(*distance, &flat))
        {
            Some(grid) if flat.len() == forms.len() => vec![Primitive::Grid(Box::new(grid))],
            _ => forms,
        }
    }

    pub(crate) fn surface(&self, surface: &Surface) -> Primitive {
        let shape = Shape::Rectangle(Rectangle {
            center: [0.0; 2],
            size: surface.size,
        });
        Self::flat(&self.0.decompose(&surface.frame), &shape)
    }

    pub(crate) fn mesh(&self, mesh: &MeshObject) -> Primitive {
        let normals = mesh.smooth.as_ref().map(|smooth| &smooth.normals);
        Primitive::Mesh(Box::new(BlockerMesh::new(&mesh.triangles, normals, self.0)))
    }

    /// The primitive of a flat shape in the XY plane of a frame. If the axes of this
    /// frame are the axes of the leg, the distances of hits are exact.
    #[expect(
        clippy::float_cmp,
        reason = "if rounding errors hide that numbers are equal, the general case is used, which is also correct"
    )]
    fn flat(frame: &Frame, shape: &Shape) -> Primitive {
        let across = frame.d.z.abs() == 1.0 && frame.x.x.abs() == 1.0;
        if !across {
            return Primitive::Oblique {
                frame: Box::new(*frame),
                shape: *shape,
            };
        }
        let [x, y] = shape.bounds().center;
        let at = frame.to_world(DVec3::new(x, y, 0.0));
        Primitive::Flat {
            distance: frame.origin.z,
            shape: shape.centered_at([at.x, at.y]),
        }
    }
}
