//! Searches for light in the window that meets objects that theory ignores.
//!
//! A few thousand rays fill the window uniformly and find the occluders of much of the light. An
//! object that occludes little of the light may lie between these rays, at the edge or in the
//! corner of the window. For each object that theory ignores, the rays that pass nearest are moved
//! until they meet the object or come no nearer. The distance to the object decreases smoothly
//! during these moves, so even the smallest object is found.

use super::clearance::{PathPiece, Suspect};
use super::rays::{RayDraw, bright, lattice};
use super::surroundings::{Meets, Surroundings};

/// Number of rays with light in the window that are followed for a plane.
const LIT_RAYS: usize = 3000;
/// Number of rays that are tried to find rays with light in the window.
const TRIED_RAYS: u32 = 60_000;
/// Number of rays nearest to an object that are moved towards it.
const STARTS: usize = 4;
/// Number of moves of each ray.
const MOVES: u32 = 300;
/// Length of the first moves. It is the spacing of 3000 rays, which fill a window of four axes with
/// seven rays along each axis.
const FIRST_MOVE: f64 = 0.15;
/// If a move brings the ray nearer, the next move is longer by this factor; otherwise the next move
/// is shorter. The two factors keep the length constant if one move in twelve brings the ray
/// nearer. This share is small because most moves fail in a corner of the window, where most axes
/// are at their ends.
const LONGER: f64 = 1.5;
const SHORTER: f64 = 0.964;
/// An object is out of reach if its distance from the nearest ray exceeds this share of the range
/// of distances. The nearest corner of a window of four axes is only a seventh of the range away
/// from the nearest ray.
const REACH: f64 = 0.5;
/// Light whose strength is below this share of the largest strength is ignored. A shadow in such
/// light has 10⁻⁶ of the power of a shadow in the strongest light, and 10⁹ photons cannot resolve
/// it.
const FAINT: f64 = 1e-3;

/// Rays that theory follows from the light to a plane.
pub(super) trait Followed {
    /// Returns the amount of light that a ray brings into the window, and the first object on its
    /// way that theory ignores, if there is one. Returns `None` if the ray brings no light.
    fn check(&self, draw: &RayDraw) -> Option<(f64, Option<Meets>)>;

    /// Returns the amount of light that a ray brings along theory's path, and the pieces of that
    /// path; `None` if the ray brings no light.
    fn pieces(&self, draw: &RayDraw) -> Option<(f64, Vec<PathPiece>)>;

    /// Returns the surroundings of the path.
    fn around(&self) -> &Surroundings<'_>;
}

/// Returns everything that rays meet and theory ignores.
pub(super) fn found(rays: &impl Followed) -> Vec<Meets> {
    let checked = (0..TRIED_RAYS).filter_map(|index| {
        let draw = RayDraw::new(index);
        let (light, meets) = rays.check(&draw)?;
        Some((light, (draw, meets)))
    });
    let lit = bright(checked, LIT_RAYS);
    let strongest = lit.iter().map(|(light, _)| *light).fold(0.0, f64::max);
    let mut found: Vec<Meets> = lit.iter().filter_map(|(_, (_, meets))| *meets).collect();
    let paths = lit.iter().filter_map(|(_, (draw, _))| {
        let (light, pieces) = rays.pieces(draw)?;
        (light > FAINT * strongest).then_some((*draw, pieces))
    });
    let paths: Vec<(RayDraw, Vec<PathPiece>)> = paths.collect();
    let Some((_, pieces)) = paths.first() else {
        return found;
    };
    let around = rays.around();
    let all: Vec<&[PathPiece]> = paths.iter().map(|(_, pieces)| pieces.as_slice()).collect();
    for suspect in Suspect::all(around, &all) {
        if found.contains(&suspect.meets(around, &pieces[suspect.leg])) {
            continue;
        }
        let search = Search {
            rays,
            suspect,
            faint: FAINT * strongest,
        };
        let mut starts = search.starts(&paths).into_iter();
        found.extend(starts.find_map(|start| search.approach(start)));
    }
    found
}

/// The search for a ray that meets one object on one leg.
struct Search<'a, R> {
    rays: &'a R,
    suspect: Suspect,
    /// Light weaker than this limit does not count.
    faint: f64,
}

impl<R: Followed> Search<'_, R> {
    fn gap(&self, pieces: &[PathPiece]) -> f64 {
        self.suspect
            .gap(self.rays.around(), &pieces[self.suspect.leg])
    }

    /// Returns the rays that pass nearest to the object, with their distances. The list is empty if
    /// the object is out of reach.
    fn starts(&self, paths: &[(RayDraw, Vec<PathPiece>)]) -> Vec<(f64, RayDraw)> {
        let gaps = paths.iter().map(|(draw, pieces)| (self.gap(pieces), *draw));
        let mut gaps: Vec<(f64, RayDraw)> = gaps.filter(|(gap, _)| gap.is_finite()).collect();
        gaps.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let [Some((nearest, _)), Some((farthest, _))] = [gaps.first(), gaps.last()] else {
            return Vec::new();
        };
        let is_within_reach = *nearest <= REACH * (farthest - nearest);
        gaps.truncate(if is_within_reach { STARTS } else { 0 });
        gaps
    }

    /// Moves a ray towards the object; returns what the ray meets, if it meets anything.
    fn approach(&self, (mut gap, mut at): (f64, RayDraw)) -> Option<Meets> {
        let mut length = FIRST_MOVE;
        for number in 0..MOVES {
            if gap <= 0.0 {
                let meets = self.rays.check(&at).and_then(|(_, meets)| meets);
                if meets.is_some() {
                    return meets;
                }
            }
            let moved = moved(&at, length, number);
            let nearer = self.rays.pieces(&moved).and_then(|(light, pieces)| {
                let nearer = self.gap(&pieces);
                (light > self.faint && nearer < gap).then_some(nearer)
            });
            if let Some(nearer) = nearer {
                (gap, at) = (nearer, moved);
                length *= LONGER;
            } else {
                length *= SHORTER;
            }
        }
        None
    }
}

/// Returns a draw that differs from another by at most `length` along each axis. Two of three moves
/// go along one axis, because in a corner of the window few other moves stay inside the window.
fn moved(from: &RayDraw, length: f64, number: u32) -> RayDraw {
    let step = lattice(number);
    let mut numbers = from.numbers;
    for (axis, x) in numbers.iter_mut().enumerate() {
        let [turn, along] = [number % 3, number / 3 % 6];
        if turn == 0 || along as usize == axis {
            *x = (*x + length * (2.0 * step[axis] - 1.0)).clamp(0.0, 1.0);
        }
    }
    RayDraw { numbers, ..*from }
}
