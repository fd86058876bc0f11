//! Traces photons over a first leg on which all obstacles and planes lie across the leg, many
//! photons at a time.

use crate::grid::Grid;
use crate::lanes::{inside, inside_polygon, lanes};
use crate::mesh::BlockerMesh;
use crate::mesh_order::{OrderMemory, meet_mesh};
use crate::photon_group::{Hits, PHOTONS_PER_GROUP, PhotonGroup};
use crate::plane_on_leg::PlaneOnLeg;
use crate::unbounded::Unbounded;
use etendue_field::{Crossing, Hole, Ledger, Shape, Side, TwoPlane};
use fearless_simd::{Level, dispatch};

/// A first leg on which all planes lie across the leg and all obstacles lie across the leg or are
/// meshes between planes. So all photons meet them in the same order.
#[derive(Debug)]
pub(crate) struct FlatLeg {
    /// The obstacles beyond the light, the farthest first.
    obstacles: Vec<FlatObstacle>,
    planes: Vec<FlatPlane>,
    /// What becomes of a photon that meets no obstacle, each obstacle in order, or carries no light.
    ends: Vec<PhotonEnd>,
    level: Level,
}

/// An obstacle across the leg, or a mesh.
#[derive(Debug)]
pub(crate) struct FlatObstacle {
    /// The distance of the obstacle; for a mesh, the distance of its farthest point.
    pub(crate) distance: f64,
    /// The distance of the nearest point.
    pub(crate) nearest: f64,
    pub(crate) outline: Outline,
    pub(crate) end: PhotonEnd,
}

/// The points of an obstacle.
#[derive(Debug)]
pub(crate) enum Outline {
    Shape(Shape),
    Grid(Box<Grid>),
    Unbounded(Unbounded),
    Mesh(Box<BlockerMesh>),
}

/// What becomes of a photon: the shares of its flux that are added to the ledger, and whether it
/// arrives at the surface that ends the leg.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PhotonEnd {
    pub(crate) absorbed: f64,
    pub(crate) escaped: f64,
    pub(crate) stopped: f64,
    pub(crate) arrives: bool,
}

/// A virtual plane across the leg.
#[derive(Debug)]
pub(crate) struct FlatPlane {
    plane: usize,
    distance: f64,
    /// The number of obstacles at or beyond the plane.
    obstacles: usize,
}

/// The largest number of obstacles that are tested one after another. More obstacles are left to
/// their hierarchy.
const MAX_OBSTACLES: usize = 16;

impl PhotonEnd {
    pub(crate) const ABSORBED: Self = Self {
        absorbed: 1.0,
        escaped: 0.0,
        stopped: 0.0,
        arrives: false,
    };
    const ESCAPED: Self = Self {
        absorbed: 0.0,
        escaped: 1.0,
        ..Self::ABSORBED
    };
}

impl FlatLeg {
    /// Returns `None` if a plane does not lie across the leg, lies inside a mesh or beyond the
    /// surface that ends the leg, if photons may meet two different obstacles in either order, or
    /// if there are many obstacles.
    pub(crate) fn new(mut obstacles: Vec<FlatObstacle>, planes: &[PlaneOnLeg]) -> Option<Self> {
        obstacles.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        let in_order = |(i, far): (usize, &FlatObstacle)| {
            let nearer = &obstacles[i + 1..];
            nearer
                .iter()
                .all(|near| far.is_beyond(near) || far.end == near.end)
        };
        let is_inside = |plane: &PlaneOnLeg, obstacle: &FlatObstacle| {
            is_crossed(plane, obstacle.distance) && !is_crossed(plane, obstacle.nearest)
        };
        let is_outside_all = |plane| !obstacles.iter().any(|obstacle| is_inside(plane, obstacle));
        if !planes
            .iter()
            .all(|plane| plane.is_across() && is_outside_all(plane))
        {
            return None;
        }
        let planes: Vec<FlatPlane> = planes
            .iter()
            .map(|plane| FlatPlane {
                plane: plane.plane,
                distance: plane.distance,
                obstacles: obstacles
                    .partition_point(|obstacle| is_crossed(plane, obstacle.distance)),
            })
            .collect();
        let last = obstacles.iter().position(|obstacle| obstacle.end.arrives);
        let is_flat = planes
            .iter()
            .all(|plane| last.is_none_or(|last| last < plane.obstacles))
            && obstacles.len() <= MAX_OBSTACLES
            && obstacles.iter().enumerate().all(in_order);
        let ends = [PhotonEnd::ESCAPED].into_iter();
        let ends = ends.chain(obstacles.iter().map(|obstacle| obstacle.end));
        let ends = ends.chain([PhotonEnd::default()]).collect();
        is_flat.then_some(Self {
            ends,
            obstacles,
            planes,
            level: Level::new(),
        })
    }

    /// Checks whether there are meshes on the leg.
    pub(crate) fn has_meshes(&self) -> bool {
        let mut outlines = self.obstacles.iter().map(|obstacle| &obstacle.outline);
        outlines.any(|outline| matches!(outline, Outline::Mesh(_)))
    }

    /// Replaces `hits` by the obstacles that photons meet.
    pub(crate) fn hits_of_all(
        &self,
        groups: &[PhotonGroup],
        hits: &mut Vec<Hits>,
        order: &mut OrderMemory,
    ) {
        hits.clear();
        hits.extend(groups.iter().map(|photons| self.hits(photons)));
        for (number, obstacle) in (1..).zip(&self.obstacles) {
            if let Outline::Mesh(mesh) = &obstacle.outline {
                // Photons that meet a nearer obstacle are not tested.
                meet_mesh(mesh, number, (groups, hits), order);
            }
        }
    }

    /// The obstacles that photons meet, if there are no meshes.
    #[inline]
    pub(crate) fn hits(&self, photons: &PhotonGroup) -> Hits {
        dispatch!(self.level, _simd => self.flat_hits(photons))
    }

    /// Reports the virtual planes before the obstacles that photons meet, and adds to the ledger
    /// what becomes of the photons. Returns the indices and the distances of photons that arrive
    /// at the surface that ends the leg.
    #[inline]
    pub(crate) fn trace(
        &self,
        photons: &PhotonGroup,
        hits: &Hits,
        crossings: &mut [Vec<Crossing>],
        ledger: &mut Ledger,
    ) -> impl Iterator<Item = (usize, f64)> {
        dispatch!(self.level, _simd => {
            for plane in &self.planes {
                plane.record(photons, hits, &mut crossings[plane.plane]);
            }
        });
        for (hit, flux) in hits.iter().zip(photons.fluxes) {
            let end = &self.ends[*hit];
            ledger.absorbed += end.absorbed * flux;
            ledger.escaped += end.escaped * flux;
            ledger.stopped += end.stopped * flux;
        }
        let arrives = |(_, hit): &(usize, usize)| self.ends[*hit].arrives;
        let arrivals = hits.iter().copied().enumerate().filter(arrives);
        arrivals.map(|(i, hit)| (i, self.obstacles[hit - 1].distance))
    }

    /// The number of the flat obstacle that each photon meets.
    #[inline(always)]
    fn flat_hits(&self, photons: &PhotonGroup) -> Hits {
        let none = self.obstacles.len() + 1;
        let mut hits: Hits = lanes(|i| if photons.weights[i] > 0.0 { 0 } else { none });
        for (number, obstacle) in (1..).zip(&self.obstacles) {
            let [x, y] = photons.positions(obstacle.distance);
            let is_inside = match &obstacle.outline {
                Outline::Shape(shape) => inside(shape, [&x, &y]),
                Outline::Grid(grid) => grid.contains_each([&x, &y]),
                Outline::Unbounded(unbounded) => covered(unbounded, [&x, &y]),
                Outline::Mesh(_) => continue,
            };
            hits = lanes(|i| {
                if is_inside[i] {
                    hits[i].max(number)
                } else {
                    hits[i]
                }
            });
        }
        hits
    }
}

/// Checks whether light crosses a plane before it meets an obstacle.
fn is_crossed(plane: &PlaneOnLeg, obstacle: f64) -> bool {
    match plane.side {
        Side::Before => plane.distance <= obstacle,
        Side::After => plane.distance < obstacle,
    }
}

impl FlatObstacle {
    /// Checks whether all photons that meet both obstacles meet the other obstacle first.
    fn is_beyond(&self, other: &Self) -> bool {
        self.nearest > other.distance
    }
}

/// Checks which points lie in an unbounded blocker.
#[inline(always)]
fn covered<const N: usize>(unbounded: &Unbounded, [x, y]: [&[f64; N]; 2]) -> [bool; N] {
    let is_open = match unbounded {
        Unbounded::HalfPlane(half_plane) => return lanes(|i| half_plane.contains(x[i], y[i])),
        Unbounded::Aperture(Hole::Shape(shape)) => inside(shape, [x, y]),
        Unbounded::Aperture(Hole::Polygon(polygon)) => inside_polygon(polygon, [x, y]),
    };
    lanes(|i| !is_open[i])
}

impl FlatPlane {
    /// Records the photons that meet no obstacle before the plane.
    #[inline(always)]
    fn record(&self, photons: &PhotonGroup, hits: &Hits, crossings: &mut Vec<Crossing>) {
        let [x, y] = photons.positions(self.distance);
        let [_, _, u, v] = &photons.rays;
        for i in 0..PHOTONS_PER_GROUP {
            let count = crossings.len();
            let [x, y, u, v] = [x[i], y[i], u[i], v[i]];
            crossings.push(Crossing {
                ray: TwoPlane { x, y, u, v },
                weight: photons.weights[i],
            });
            // The crossing is kept or removed without a branch, because the processor could not
            // predict it.
            crossings.truncate(count + usize::from(hits[i] <= self.obstacles));
        }
    }
}
