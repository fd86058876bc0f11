//! Traces photons over a first leg on which all obstacles and planes lie across the leg, many
//! photons at a time.

use crate::grid::Grid;
use crate::lanes::{inside, inside_polygon, lanes};
use crate::photon_group::{ABREAST, PhotonGroup};
use crate::plane_on_leg::PlaneOnLeg;
use crate::unbounded::Unbounded;
use etendue_field::{Crossing, Hole, Ledger, Shape, Side, TwoPlane};
use fearless_simd::{Level, dispatch};

/// A first leg on which all obstacles and planes lie across the leg, so their distances are the
/// same for all photons.
#[derive(Debug)]
pub(crate) struct FlatLeg {
    /// The obstacles beyond the light, the farthest first.
    obstacles: Vec<FlatObstacle>,
    planes: Vec<FlatPlane>,
    /// What becomes of a photon that meets no obstacle, each obstacle in order, or carries no light.
    ends: Vec<PhotonEnd>,
    level: Level,
}

/// An obstacle across the leg.
#[derive(Debug)]
pub(crate) struct FlatObstacle {
    pub(crate) distance: f64,
    pub(crate) outline: Outline,
    pub(crate) end: PhotonEnd,
}

/// The points of an obstacle across the leg.
#[derive(Debug)]
pub(crate) enum Outline {
    Shape(Shape),
    Grid(Box<Grid>),
    Unbounded(Unbounded),
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

/// For each photon, the number of the obstacle that the photon meets, from 1 on in the order of a
/// [`FlatLeg`]. The number 0 stands for no obstacle, and the number after the last for a photon that
/// carries no light.
type Hits = [usize; ABREAST];

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
    /// Returns `None` if a plane does not lie across the leg or lies beyond the surface that ends
    /// the leg, if two different obstacles have the same distance, or if there are many obstacles.
    #[expect(
        clippy::float_cmp,
        reason = "obstacles at the same distance are hit at the same time"
    )]
    pub(crate) fn new(mut obstacles: Vec<FlatObstacle>, planes: &[PlaneOnLeg]) -> Option<Self> {
        obstacles.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        let differ = |pair: &[FlatObstacle]| {
            pair[0].distance == pair[1].distance && pair[0].end != pair[1].end
        };
        if !planes.iter().all(PlaneOnLeg::is_across) {
            return None;
        }
        let planes: Vec<FlatPlane> = planes
            .iter()
            .map(|plane| FlatPlane {
                plane: plane.plane,
                distance: plane.distance,
                obstacles: obstacles.partition_point(|obstacle| match plane.side {
                    Side::Before => plane.distance <= obstacle.distance,
                    Side::After => plane.distance < obstacle.distance,
                }),
            })
            .collect();
        let last = obstacles.iter().position(|obstacle| obstacle.end.arrives);
        let is_flat = planes
            .iter()
            .all(|plane| last.is_none_or(|last| last < plane.obstacles))
            && obstacles.len() <= MAX_OBSTACLES
            && !obstacles.windows(2).any(differ);
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

    /// Traces photons from the light to the obstacles that they meet, and reports the virtual
    /// planes before these obstacles. Returns the indices and the distances of photons that arrive
    /// at the surface that ends the leg.
    #[inline]
    pub(crate) fn trace(
        &self,
        photons: &PhotonGroup,
        crossings: &mut [Vec<Crossing>],
        ledger: &mut Ledger,
    ) -> impl Iterator<Item = (usize, f64)> {
        let hits = dispatch!(self.level, _simd => {
            let hits = self.hits(photons);
            for plane in &self.planes {
                plane.record(photons, &hits, &mut crossings[plane.plane]);
            }
            hits
        });
        for (hit, flux) in hits.into_iter().zip(photons.fluxes) {
            let end = &self.ends[hit];
            ledger.absorbed += end.absorbed * flux;
            ledger.escaped += end.escaped * flux;
            ledger.stopped += end.stopped * flux;
        }
        let arrives = |(_, hit): &(usize, usize)| self.ends[*hit].arrives;
        let arrivals = hits.into_iter().enumerate().filter(arrives);
        arrivals.map(|(i, hit)| (i, self.obstacles[hit - 1].distance))
    }

    /// Returns the number of the obstacle that each photon meets.
    #[inline(always)]
    fn hits(&self, photons: &PhotonGroup) -> Hits {
        let none = self.obstacles.len() + 1;
        let mut hits: Hits = lanes(|i| if photons.weights[i] > 0.0 { 0 } else { none });
        for (number, obstacle) in (1..).zip(&self.obstacles) {
            let [x, y] = photons.positions(obstacle.distance);
            let is_inside = match &obstacle.outline {
                Outline::Shape(shape) => inside(shape, [&x, &y]),
                Outline::Grid(grid) => grid.contains_each([&x, &y]),
                Outline::Unbounded(unbounded) => covered(unbounded, [&x, &y]),
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
        for i in 0..ABREAST {
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
