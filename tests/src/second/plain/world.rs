//! Reads a scene file into objects of the world, as docs/scene.md describes each field.

use super::lamp::Lamp;
use super::mask::PlainMask;
use crate::second::files::luminance;
use crate::second::paths::{Legs, Turn};
use crate::second::pattern::Pattern;
use crate::second::smooth::{Form, Smooth};
use crate::second::surfaces::{focused, refracted};
use crate::second::vector::{Axes, Vector, distance, dot, length, plus, times, turned, unit};
use etendue_field::{AngleTable, Brdf, Fresnel, Grating, Lobe, Orientation, Profile, Quantity};
use etendue_scene::{
    AxisName, BrdfFile, ColorFile, EventFile, FormFile, FresnelFile, PatternFile, Place, SceneFile,
    SurfaceFile,
};
use std::f64::consts::PI;

/// Rays start this share of a length beyond their origin, so that they do not hit it.
pub(super) const START: f64 = 1e-9;

/// A scene without legs: objects at their places in the world. Legs and frames exist only for the
/// plane, which belongs to the central ray.
pub(super) struct PlainWorld {
    pub(super) lamps: Vec<Lamp>,
    pub(super) masks: Vec<PlainMask>,
    pub(super) surfaces: Vec<PlainSurface>,
    /// The surfaces that light visits before the plane, in order.
    pub(super) visits: Vec<usize>,
    /// The surface that ends the leg of the plane.
    pub(super) end: Option<usize>,
    pub(super) plane: Axes,
    /// The profiles of the window in x, y, u and v.
    pub(super) window: [Profile; 4],
}

pub(super) struct PlainSurface {
    shape: Shape,
    interaction: Interaction,
}

enum Shape {
    Rectangle(Axes, [f64; 2]),
    Smooth(Smooth),
}

enum Interaction {
    Lambertian(f64),
    Mirror,
    Refraction([f64; 2]),
    Lens(f64),
    Reflects {
        terms: Vec<(Brdf, Weight)>,
        texture: Option<Pattern>,
    },
}

enum Weight {
    One,
    Of(Pattern),
    /// One minus the pattern.
    Without(Pattern),
}

/// How light leaves a surface.
pub(super) enum Leaves {
    /// In one direction.
    Along(Vector),
    /// Scattered; [`PlainSurface::scattered`] gives the share for each direction.
    Scattered,
    Nowhere,
}

impl PlainWorld {
    /// The world of a scene file whose first plane is at a distance on the central ray, or
    /// `None` if the file uses something that the plain tracer does not have: meshes, pictures, ray
    /// files, and other planes.
    pub(super) fn new(file: &SceneFile) -> Option<Self> {
        let d = unit(file.path.direction);
        let x = file.path.x_axis;
        let light = |center: Vector| Axes::new(center, d, x);
        let lamps = std::iter::once(&file.light).chain(&file.other_lights);
        let lamps: Option<Vec<Lamp>> = lamps.map(|lamp| Lamp::new(lamp, light)).collect();
        let masks = file.blockers.iter().map(|mask| PlainMask::new(mask, light));
        let surfaces = file.surfaces.iter().map(|s| PlainSurface::new(s, d, x));
        let surfaces: Vec<PlainSurface> = surfaces.collect::<Option<_>>()?;
        let all = file.path.visits.iter().map(|visit| {
            let named = |surface: &SurfaceFile| surface.name() == visit;
            file.surfaces.iter().position(named)
        });
        let all: Vec<usize> = all.collect::<Option<_>>()?;
        let plane = &file.planes[0];
        let Place::Distance(at) = plane.at else {
            return None;
        };
        if plane.orientation != Orientation::Orthogonal || plane.quantity != Quantity::Radiance {
            return None;
        }
        let window = plane.window.as_ref().unwrap_or(&file.window);
        let (wx, wu) = (window.x, window.u);
        let start = light(lamps.as_ref()?[0].center());
        let leaves = file.path.leaves;
        let (plane, legs) = central(start, &surfaces, &all, leaves, at)?;
        Some(Self {
            lamps: lamps?,
            masks: masks.collect::<Option<_>>()?,
            surfaces,
            visits: all[..legs].to_vec(),
            end: all.get(legs).copied(),
            plane,
            window: [wx, window.y.unwrap_or(wx), wu, window.v.unwrap_or(wu)],
        })
    }
}

/// Follows the central ray to a distance from its start. Returns the axes there and the number of
/// surfaces that it has left.
fn central(
    mut leg: Axes,
    surfaces: &[PlainSurface],
    visits: &[usize],
    leaves: Option<Vector>,
    mut left: f64,
) -> Option<(Axes, usize)> {
    for (i, visit) in visits.iter().enumerate() {
        let surface = &surfaces[*visit];
        let hits = surface.hits(leg.origin, leg.d);
        let t = hits.into_iter().find(|t| *t > START)?;
        if left < t {
            return Some((travelled(leg, left), i));
        }
        left -= t;
        leg = travelled(leg, t);
        let facing = surface.normal(leg.origin);
        let normal = times(-dot(facing, leg.d).signum(), facing);
        let next = visits.get(i + 1).map(|next| surfaces[*next].vertex());
        let towards = match surface.leaves(leg.origin, leg.d) {
            Leaves::Along(to) => to,
            Leaves::Nowhere => return None,
            Leaves::Scattered => match (next, leaves) {
                (Some(next), _) => unit(plus(next, -1.0, leg.origin)),
                (None, Some(leaves)) => unit(leaves),
                (None, None) if surface.is_glossy() => {
                    plus(leg.d, -2.0 * dot(leg.d, normal), normal)
                }
                (None, None) => times(-1.0, leg.d),
            },
        };
        let turn = if dot(towards, normal) < 0.0 {
            Turn::Through(towards)
        } else {
            Turn::Back(towards)
        };
        leg = Legs::after(&leg, normal, turn, "");
    }
    Some((travelled(leg, left), visits.len()))
}

fn travelled(leg: Axes, by: f64) -> Axes {
    Axes {
        origin: plus(leg.origin, by, leg.d),
        ..leg
    }
}

impl PlainSurface {
    fn new(file: &SurfaceFile, d: Vector, x: Vector) -> Option<Self> {
        match file {
            SurfaceFile::Rectangle {
                center,
                size,
                facing,
                albedo,
                ..
            } => {
                let normal = unit(facing.unwrap_or(times(-1.0, d)));
                // X of the path, or Y if the normal is along X.
                let path = Axes::new(*center, d, x);
                let axes = Axes::new(*center, normal, edge(normal, &path));
                Some(Self {
                    shape: Shape::Rectangle(axes, *size),
                    interaction: Interaction::Lambertian(grey(albedo)),
                })
            }
            SurfaceFile::Smooth {
                center,
                facing,
                form,
                along,
                aperture,
                event,
                ..
            } => {
                let path = Axes::new(*center, d, x);
                let along = along.unwrap_or_else(|| edge(unit(*facing), &path));
                let form = match *form {
                    FormFile::Plane | FormFile::Sphere(0.0) | FormFile::Cylinder(0.0) => {
                        Form::Plane
                    }
                    FormFile::Sphere(k) => Form::Sphere(k),
                    FormFile::Cylinder(k) => Form::Cylinder(k),
                    FormFile::Paraboloid(k, l) => Form::Paraboloid(k, l),
                };
                let axes = Axes::new(*center, *facing, along);
                Some(Self {
                    shape: Shape::Smooth(Smooth {
                        axes,
                        form,
                        aperture: *aperture,
                    }),
                    interaction: interaction(event)?,
                })
            }
            SurfaceFile::Mesh { .. } => None,
        }
    }

    fn axes(&self) -> &Axes {
        match &self.shape {
            Shape::Rectangle(axes, _) => axes,
            Shape::Smooth(smooth) => &smooth.axes,
        }
    }

    fn vertex(&self) -> Vector {
        self.axes().origin
    }

    fn is_glossy(&self) -> bool {
        match &self.interaction {
            Interaction::Reflects { terms, .. } => !matches!(terms[0].0.lobe, Lobe::Lambertian),
            _ => false,
        }
    }

    pub(super) fn scatters(&self) -> bool {
        matches!(
            self.interaction,
            Interaction::Lambertian(_) | Interaction::Reflects { .. }
        )
    }

    /// Whether a BRDF of the surface takes long to compute, because its masking is an integral.
    pub(super) fn is_slow(&self) -> bool {
        let is_slow = |brdf: &Brdf| matches!(brdf.lobe, Lobe::Beckmann { .. } | Lobe::Ggx { .. });
        match &self.interaction {
            Interaction::Reflects { terms, .. } => terms.iter().any(|(brdf, _)| is_slow(brdf)),
            _ => false,
        }
    }

    /// The distances of hits along a ray, nearest first.
    pub(super) fn hits(&self, start: Vector, along: Vector) -> Vec<f64> {
        match &self.shape {
            Shape::Smooth(smooth) => smooth.hits(start, along),
            Shape::Rectangle(axes, size) => {
                let [.., height] = axes.coordinates(start);
                let t = -height / dot(along, axes.d);
                let [x, y, _] = axes.coordinates(plus(start, t, along));
                let is_inside = 2.0 * x.abs() <= size[0] && 2.0 * y.abs() <= size[1];
                if is_inside { vec![t] } else { Vec::new() }
            }
        }
    }

    /// The normal on the side that the surface faces.
    pub(super) fn normal(&self, point: Vector) -> Vector {
        match &self.shape {
            Shape::Rectangle(axes, _) => axes.d,
            Shape::Smooth(smooth) => smooth.normal(point),
        }
    }

    /// A point for two uniform numbers, and the area that one unit of them covers there.
    pub(super) fn point(&self, [a, b]: [f64; 2]) -> (Vector, f64) {
        match &self.shape {
            Shape::Rectangle(axes, size) => {
                let at = [(a - 0.5) * size[0], (b - 0.5) * size[1], 0.0];
                (axes.point(at), size[0] * size[1])
            }
            Shape::Smooth(smooth) => {
                let (radius, around) = (smooth.aperture * a.sqrt(), 2.0 * PI * b);
                let point = smooth.point(radius * around.cos(), radius * around.sin());
                let slant = dot(smooth.normal(point), smooth.axes.d);
                (point, PI * smooth.aperture * smooth.aperture / slant)
            }
        }
    }

    /// How light that arrives at a point along a direction leaves the surface.
    pub(super) fn leaves(&self, point: Vector, along: Vector) -> Leaves {
        let normal = self.normal(point);
        let through = |to: Option<Vector>| to.map_or(Leaves::Nowhere, Leaves::Along);
        match &self.interaction {
            Interaction::Lambertian(_) => Leaves::Scattered,
            Interaction::Reflects { .. } if dot(along, normal) < 0.0 => Leaves::Scattered,
            Interaction::Reflects { .. } => Leaves::Nowhere,
            Interaction::Mirror => Leaves::Along(turned(times(-1.0, along), normal, PI)),
            Interaction::Refraction(indices) => through(refracted(along, normal, *indices)),
            Interaction::Lens(focal) => {
                let to = focused(along, self.axes(), point, *focal);
                // A ray through the centre of the lens goes on.
                let is_central = distance(point, self.vertex()) < 1e-9 * focal.abs();
                Leaves::Along(if is_central { along } else { to })
            }
        }
    }

    /// Returns the flux per solid angle that a unit of flux, which arrives along `along`, leaves
    /// towards the direction `to`, sr⁻¹.
    pub(super) fn scattered(&self, point: Vector, along: Vector, to: Vector) -> f64 {
        let facing = self.normal(point);
        let normal = times(-dot(facing, along).signum(), facing);
        let cosine = dot(to, normal);
        if cosine <= 0.0 {
            return 0.0;
        }
        match &self.interaction {
            Interaction::Lambertian(albedo) => albedo / PI * cosine,
            Interaction::Reflects { terms, texture } => {
                let [s, t, _] = self.axes().coordinates(point);
                let at = |pattern: &Pattern| pattern.value([s, t], "");
                let local = Axes::new(point, normal, any_other(normal));
                let [wi, wo] = [times(-1.0, along), to].map(|a| local.components(a));
                let sum = terms.iter().map(|(brdf, weight)| {
                    let weight = match weight {
                        Weight::One => 1.0,
                        Weight::Of(pattern) => at(pattern),
                        Weight::Without(pattern) => 1.0 - at(pattern),
                    };
                    weight * crate::second::brdf::value(brdf, wi, wo, "")
                });
                texture.as_ref().map_or(1.0, at) * sum.sum::<f64>() * cosine
            }
            _ => 0.0,
        }
    }
}

/// The axis of the path along which a surface with this normal has its edges: X, or Y if
/// the normal is along X.
fn edge(normal: Vector, path: &Axes) -> Vector {
    let aside = length(plus(path.x, -dot(path.x, normal), normal));
    if aside > 1e-9 { path.x } else { path.y }
}

fn any_other(normal: Vector) -> Vector {
    if normal[0].abs() < 0.7 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    }
}

pub(super) fn grey(color: &ColorFile) -> f64 {
    match color {
        ColorFile::Grey(value) => *value,
        ColorFile::Rgb(rgb) => luminance(*rgb),
    }
}

fn interaction(event: &EventFile) -> Option<Interaction> {
    let texture = |texture: &Option<PatternFile>| match texture {
        Some(texture) => pattern(texture).map(Some),
        None => Some(None),
    };
    Some(match event {
        EventFile::Mirror => Interaction::Mirror,
        EventFile::Refraction { front, back } => Interaction::Refraction([*front, *back]),
        EventFile::ThinLens(focal) => Interaction::Lens(*focal),
        EventFile::Reflects {
            brdf: first,
            other,
            blend,
            texture: factor,
        } => {
            let terms = match (other, blend) {
                (Some(other), Some(blend)) => vec![
                    (brdf(first), Weight::Of(pattern(blend)?)),
                    (brdf(other), Weight::Without(pattern(blend)?)),
                ],
                _ => vec![(brdf(first), Weight::One)],
            };
            Interaction::Reflects {
                terms,
                texture: texture(factor)?,
            }
        }
        EventFile::Sum {
            terms,
            texture: factor,
        } => {
            let terms = terms.iter().map(|term| {
                let weight = match &term.weight {
                    Some(weight) => Weight::Of(pattern(weight)?),
                    None => Weight::One,
                };
                Some((brdf(&term.brdf), weight))
            });
            Interaction::Reflects {
                terms: terms.collect::<Option<_>>()?,
                texture: texture(factor)?,
            }
        }
    })
}

fn pattern(file: &PatternFile) -> Option<Pattern> {
    Some(match file {
        PatternFile::Cosine {
            axis,
            frequency,
            modulation,
            phase,
        } => Pattern::Cosine(grating(*axis, [*frequency, *modulation, *phase])),
        PatternFile::Checkerboard(period) => Pattern::Checkerboard(*period),
        PatternFile::Picture { .. } => return None,
    })
}

pub(super) fn grating(axis: AxisName, [frequency, modulation, phase]: [f64; 3]) -> Grating {
    Grating {
        axis: number(axis),
        frequency,
        modulation,
        phase,
    }
}

pub(super) fn number(axis: AxisName) -> usize {
    match axis {
        AxisName::X => 0,
        AxisName::Y => 1,
    }
}

fn brdf(file: &BrdfFile) -> Brdf {
    let fresnel = match &file.fresnel {
        FresnelFile::White => Fresnel::White,
        FresnelFile::Dielectric(index) => Fresnel::Dielectric { index: *index },
        FresnelFile::Conductor { n, k } => Fresnel::Conductor {
            n: grey(n),
            k: grey(k),
        },
    };
    let table = |values: &Option<Vec<f64>>| {
        let values = values.clone()?.into();
        Some(AngleTable { values })
    };
    Brdf {
        incoming: table(&file.incoming),
        outgoing: table(&file.outgoing),
        ..Brdf::new(file.lobe.into(), grey(&file.albedo), fresnel)
    }
}
