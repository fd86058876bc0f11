//! Intersects a ray with all surfaces of a small world, eight pieces at a time and without
//! branches, in f64.

use super::form::Form;
use super::ray::{Ray, Spot};
use super::tree::{PieceName, WHOLE};
use super::triangle::TriangleRay;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8, mask64x8};
use glam::{DAffine3, DVec3};

/// Number of pieces that are tested together.
const WIDTH: usize = 8;

/// A number for each of the pieces that are tested together.
type PieceLanes<S> = f64x8<S>;

/// All pieces of a world, in groups.
#[derive(Debug)]
pub(super) struct PieceGroups {
    groups: Vec<PieceGroup>,
    level: Level,
}

/// Pieces of one kind. PieceLanes without a piece have NaN numbers, and are never hit.
#[derive(Clone, Debug)]
struct PieceGroup {
    kind: PieceKind,
    count: usize,
    names: [PieceName; WIDTH],
    numbers: [[f64; WIDTH]; 12],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PieceKind {
    /// Its numbers are the coordinates of its corners.
    Triangle,
    /// The numbers of this and of the other kinds are the map to local coordinates, by columns.
    Rectangle,
    Disc,
    Sphere,
    Cylinder,
}

/// What a piece is.
#[derive(Clone, Copy, Debug)]
pub(super) enum PieceShape<'a> {
    /// A triangle, given by its corners.
    Triangle([DVec3; 3]),
    /// A surface, with the map from the world to its coordinates.
    Whole(&'a Form, &'a DAffine3),
}

impl PieceShape<'_> {
    /// The kind and the numbers of a piece; `None` for a mesh.
    fn numbers(self) -> Option<(PieceKind, [DVec3; 4])> {
        match self {
            Self::Triangle([a, b, c]) => Some((PieceKind::Triangle, [a, b, c, DVec3::NAN])),
            Self::Whole(form, to_local) => {
                let kind = match form {
                    Form::Rectangle => PieceKind::Rectangle,
                    Form::Disc => PieceKind::Disc,
                    Form::Sphere => PieceKind::Sphere,
                    Form::Cylinder => PieceKind::Cylinder,
                    Form::Mesh(_) => return None,
                };
                let [x, y, z] = to_local.matrix3.to_cols_array_2d().map(DVec3::from_array);
                Some((kind, [x, y, z, to_local.translation]))
            }
        }
    }
}

impl PieceGroups {
    /// Groups pieces by kind. Returns `None` if a piece is a whole mesh.
    pub(super) fn new<'a>(
        pieces: impl Iterator<Item = (PieceName, PieceShape<'a>)>,
    ) -> Option<Self> {
        let mut groups: Vec<PieceGroup> = Vec::new();
        for (name, shape) in pieces {
            let (kind, numbers) = shape.numbers()?;
            let open = |group: &PieceGroup| group.kind == kind && group.count < WIDTH;
            let place = groups.iter().position(open).unwrap_or(groups.len());
            if place == groups.len() {
                groups.push(PieceGroup {
                    kind,
                    count: 0,
                    names: [name; WIDTH],
                    numbers: [[f64::NAN; WIDTH]; 12],
                });
            }
            groups[place].add(name, numbers);
        }
        let level = Level::new();
        Some(Self { groups, level })
    }

    /// The first hit of a ray at a distance strictly within bounds, and the index of the
    /// surface.
    #[inline]
    pub(super) fn first(&self, ray: &Ray, within: [f64; 2]) -> Option<(usize, Spot)> {
        let sight = TriangleRay::new(ray.from, ray.along);
        let (distance, group, lane) =
            dispatch!(self.level, simd => self.nearest(simd, ray, &sight, within))?;
        let group = &self.groups[group];
        let PieceName { surface, triangle } = group.names[lane];
        let weights = (triangle != WHOLE)
            .then(|| sight.meets(&group.corners(lane)))
            .flatten()
            .map_or_else(Default::default, |(_, weights)| weights);
        let spot = Spot {
            distance,
            triangle,
            weights,
        };
        Some((surface as usize, spot))
    }

    /// The first hit of a ray with one surface.
    pub(super) fn first_of(
        &self,
        surface: usize,
        ray: &Ray,
        [from, until]: [f64; 2],
    ) -> Option<Spot> {
        let sight = TriangleRay::new(ray.from, ray.along);
        let lanes = self
            .groups
            .iter()
            .flat_map(|group| (0..group.count).map(move |lane| (group, lane)));
        let spots = lanes.filter_map(|(group, lane)| {
            let name = group.names[lane];
            let of_surface = name.surface as usize == surface && name.triangle != WHOLE;
            let (distance, weights) = sight.meets(&group.corners(lane)).filter(|_| of_surface)?;
            (distance > from && distance < until).then_some(Spot {
                distance,
                triangle: name.triangle,
                weights,
            })
        });
        spots.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Checks whether a ray hits anything at a distance strictly within bounds.
    #[inline]
    pub(super) fn is_occluded(&self, ray: &Ray, within: [f64; 2]) -> bool {
        let sight = TriangleRay::new(ray.from, ray.along);
        dispatch!(self.level, simd => self.any(simd, ray, &sight, within))
    }

    /// The distance, the group and the lane of the first hit.
    #[inline(always)]
    fn nearest<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        sight: &TriangleRay,
        [from, until]: [f64; 2],
    ) -> Option<(f64, usize, usize)> {
        let mut best = PieceLanes::splat(simd, until);
        let mut groups = PieceLanes::splat(simd, 0.0);
        let mut number = 0.0;
        for group in &self.groups {
            let (at, is_on) = group.crossings(simd, ray, sight, from);
            let is_nearer = is_on & at.simd_lt(best);
            best = is_nearer.select(at, best);
            groups = is_nearer.select(PieceLanes::splat(simd, number), groups);
            number += 1.0;
        }
        let (low, high) = best.split();
        let (low, high) = low.min(high).split();
        let [a, b] = low.min(high).into();
        let distance = a.min(b);
        let lane = best.simd_eq(PieceLanes::splat(simd, distance)).to_bitmask();
        let lane = lane.trailing_zeros() as usize % WIDTH;
        (distance < until).then(|| (distance, etendue_field::whole(groups[lane]), lane))
    }

    #[inline(always)]
    fn any<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        sight: &TriangleRay,
        [from, until]: [f64; 2],
    ) -> bool {
        let mut is_met = mask64x8::splat(simd, false);
        for group in &self.groups {
            let (at, is_on) = group.crossings(simd, ray, sight, from);
            is_met |= is_on & at.simd_lt(until);
        }
        is_met.any_true()
    }
}

impl PieceGroup {
    fn add(&mut self, name: PieceName, numbers: [DVec3; 4]) {
        let lane = self.count;
        self.names[lane] = name;
        for (i, vector) in numbers.iter().enumerate() {
            for axis in 0..3 {
                self.numbers[3 * i + axis][lane] = vector[axis];
            }
        }
        self.count += 1;
    }

    /// The corners of a triangle.
    #[inline]
    fn corners(&self, lane: usize) -> [DVec3; 3] {
        let number = |corner: usize, axis: usize| self.numbers[3 * corner + axis][lane];
        [0, 1, 2].map(|i| DVec3::new(number(i, 0), number(i, 1), number(i, 2)))
    }

    /// The distance of the first point of each piece beyond `from`, and whether there is
    /// one.
    #[inline(always)]
    fn crossings<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        sight: &TriangleRay,
        from: f64,
    ) -> (PieceLanes<S>, mask64x8<S>) {
        if self.kind == PieceKind::Triangle {
            let (at, is_on) = self.triangles(simd, sight);
            return (at, is_on & at.simd_gt(from));
        }
        let start = self.local(simd, ray.from, 1.0);
        let along = self.local(simd, ray.along, 0.0);
        match self.kind {
            PieceKind::Sphere | PieceKind::Cylinder => {
                let is_sphere = self.kind == PieceKind::Sphere;
                quadrics(simd, start, along, from, is_sphere)
            }
            kind => {
                let at = -start[2] / along[2];
                let x = start[0] + at * along[0];
                let y = start[1] + at * along[1];
                let off = if kind == PieceKind::Disc {
                    x * x + y * y
                } else {
                    x.abs().max(y.abs())
                };
                (at, off.simd_le(1.0) & at.simd_gt(from))
            }
        }
    }

    /// A point (`w` = 1) or a vector (`w` = 0) in local coordinates.
    #[inline(always)]
    fn local<S: Simd>(&self, simd: S, v: DVec3, w: f64) -> [PieceLanes<S>; 3] {
        [
            self.component(simd, 0, v, w),
            self.component(simd, 1, v, w),
            self.component(simd, 2, v, w),
        ]
    }

    #[inline(always)]
    fn component<S: Simd>(&self, simd: S, axis: usize, v: DVec3, w: f64) -> PieceLanes<S> {
        let x = self.number(simd, axis) * v.x;
        let y = self.number(simd, 3 + axis) * v.y;
        let z = self.number(simd, 6 + axis) * v.z;
        x + y + z + self.number(simd, 9 + axis) * w
    }

    #[inline(always)]
    fn number<S: Simd>(&self, simd: S, i: usize) -> PieceLanes<S> {
        PieceLanes::simd_from(simd, self.numbers[i])
    }

    /// Does the same as [`TriangleRay::meets`] with the same arithmetic, so that no ray passes
    /// between two triangles.
    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, sight: &TriangleRay) -> (PieceLanes<S>, mask64x8<S>) {
        let a = self.corner(simd, sight, 0);
        let b = self.corner(simd, sight, 1);
        let c = self.corner(simd, sight, 2);
        let (u, v, w) = (side(b, c), side(c, a), side(a, b));
        let is_on = u.min(v).min(w).simd_ge(0.0) | u.max(v).max(w).simd_le(0.0);
        let depth = u * a[2] + v * b[2] + w * c[2];
        (depth / (u + v + w) * sight.per_depth, is_on)
    }

    /// A corner of each triangle as seen along the ray.
    #[inline(always)]
    fn corner<S: Simd>(&self, simd: S, sight: &TriangleRay, i: usize) -> [PieceLanes<S>; 3] {
        let [x, y, z] = sight.axes();
        let z = self.number(simd, 3 * i + z) - sight.start.z;
        let x = self.number(simd, 3 * i + x) - sight.start.x;
        let y = self.number(simd, 3 * i + y) - sight.start.y;
        [x - z * sight.slopes.x, y - z * sight.slopes.y, z]
    }
}

#[inline(always)]
fn side<S: Simd>(p: [PieceLanes<S>; 3], q: [PieceLanes<S>; 3]) -> PieceLanes<S> {
    p[0] * q[1] - p[1] * q[0]
}

/// The distance of the first point beyond `from` of each sphere or cylinder, and whether
/// there is one.
#[inline(always)]
fn quadrics<S: Simd>(
    simd: S,
    start: [PieceLanes<S>; 3],
    along: [PieceLanes<S>; 3],
    from: f64,
    is_sphere: bool,
) -> (PieceLanes<S>, mask64x8<S>) {
    let weight = f64::from(u8::from(is_sphere));
    let a = dot(along, along, weight);
    // As in `form`, distances are measured from the point that is nearest to the axis.
    let middle = -dot(start, along, weight) / a;
    let x = start[0] + middle * along[0];
    let y = start[1] + middle * along[1];
    let z = start[2] + middle * along[2];
    let left = PieceLanes::splat(simd, 1.0) - dot([x, y, z], [x, y, z], weight);
    let half = (left / a).sqrt();
    let (near, far) = (middle - half, middle + half);
    let (mut is_near, mut is_far) = (near.simd_gt(from), far.simd_gt(from));
    if !is_sphere {
        is_near &= is_between(start[2] + near * along[2]);
        is_far &= is_between(start[2] + far * along[2]);
    }
    (is_near.select(near, far), is_near | is_far)
}

#[inline(always)]
fn dot<S: Simd>(p: [PieceLanes<S>; 3], q: [PieceLanes<S>; 3], weight: f64) -> PieceLanes<S> {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2] * weight
}

#[inline(always)]
fn is_between<S: Simd>(height: PieceLanes<S>) -> mask64x8<S> {
    height.simd_ge(0.0) & height.simd_le(1.0)
}
