//! Rank-1 lattices of random numbers, chosen for the frequencies of virtual planes.
//!
//! Point i of a lattice of N points is the fractional part of i·g/N + shift, with a vector g of whole
//! numbers. Shifted at random, a lattice estimates a Fourier coefficient of a function with an error
//! that is the sum of the function's coefficients at all other points of the dual lattice around
//! it, {h: h·g = 0 mod N} (Sloan and Joe 1994, *Lattice Methods for Multiple Integration*, section
//! 2.7). Light has most of its power at low frequencies. So a lattice has little noise at the
//! frequencies of slices if no point of the dual lattice is near the difference of these
//! frequencies and zero.

use crate::lanes::lanes;
use crate::photon_group::PHOTONS_PER_GROUP;
use crate::proposal::Proposal;
use etendue_field::VirtualPlane;
use etendue_scene::Scene;
use etendue_transform::random::{self, Stream};
use fearless_simd::{Level, dispatch};
use std::ops::Range;

/// One lattice for each proposal of an emission that is aimed at a window. Proposals that are aimed at
/// a surface use a net: their rays are no linear function of random numbers.
#[derive(Debug)]
pub(crate) struct Lattices {
    /// The vectors g / N, in units of 2⁻⁶⁴.
    steps: Vec<Option<[u64; 4]>>,
}

/// The points of the lattices of a batch. The photons of the batch are divided evenly among the
/// proposals, in the order of their numbers.
#[derive(Debug)]
pub(crate) struct LatticePoints {
    /// The steps and the shift of each lattice; `None` for a net.
    lattices: Vec<Option<[[u64; 4]; 2]>>,
    /// The number of the first photon of the batch, and the number of photons.
    first: u64,
    count: u64,
    /// The share of the photons that each proposal has.
    shares: Vec<f64>,
}

/// Random numbers of a group of photons.
pub(crate) struct LatticeGroup {
    pub(crate) words: [[u32; PHOTONS_PER_GROUP]; 4],
    /// The proposal of each photon.
    pub(crate) proposals: [usize; PHOTONS_PER_GROUP],
}

/// The least and largest number of lattices that are tried for each proposal.
const TRIALS: [u64; 2] = [8, 256];

/// The number of photons for each lattice that is tried, and the largest number of azimuths of all
/// planes for which all lattices are tried. So the choice takes a small part of the time of a run.
const PHOTONS_PER_TRIAL: u64 = 4096;
const AZIMUTHS: usize = 8;

/// The number of lattices that are compared with the replicas of the spectrum behind blockers.
const SHORTLIST: usize = 8;

/// The smallest number of points of a lattice.
const MIN_POINTS: u64 = 64;

/// The coefficients with which basis vectors of a dual lattice are added up run from −`COEFFICIENT`
/// to `COEFFICIENT`.
const COEFFICIENT: i32 = 3;

/// The frequencies at which a virtual plane's slices are computed.
#[derive(Debug, PartialEq)]
struct PlaneFrequencies {
    /// Distance of the plane from the light.
    distance: f64,
    /// Sine and cosine of each azimuth.
    azimuths: Vec<(f64, f64)>,
    /// The largest frequencies (ρ, ν).
    largest: [f64; 2],
    /// The widths of the spectrum of the window over ρ and ν.
    widths: [f64; 2],
}

impl PlaneFrequencies {
    /// The frequencies of a virtual plane in coordinates of the first leg. Behind a surface,
    /// the angle at which light arrives has little influence, so only positions count.
    fn new(scene: &Scene, plane: &VirtualPlane) -> Self {
        let window = &plane.window;
        let half = |a: f64, b: f64| (a * b).sqrt();
        let grid = &plane.grid;
        let (distance, nu) = match plane.leg {
            0 => (plane.distance, grid.nu.max()),
            _ => (scene.path.first_hit(), 0.0),
        };
        Self {
            distance,
            azimuths: (0..grid.azimuths)
                .map(|k| libm::sincos(grid.azimuth(k)))
                .collect(),
            largest: [grid.rho.max(), nu],
            widths: [
                0.5 / half(window.x.half_width(), window.y.half_width()),
                0.5 / half(window.u.half_width(), window.v.half_width()),
            ],
        }
    }

    /// How near each of several frequencies (ρ, ν) along x and y, of light at the light, is to
    /// a frequency of the slices: between 0 and the number of azimuths.
    #[inline(always)]
    fn nearness(&self, [along_x, along_y]: &[[VectorLanes; 2]; 2]) -> VectorLanes {
        let at = |[rho, nu]: &[VectorLanes; 2]| lanes(|i| nu[i] - rho[i] * self.distance);
        let (rho, nu) = ([along_x[0], along_y[0]], [at(along_x), at(along_y)]);
        let squared = |axis: usize, along: f64, across: f64| {
            let beyond = (along.abs() - self.largest[axis]).max(0.0);
            (across * across + beyond * beyond) / (self.widths[axis] * self.widths[axis])
        };
        let mut sum = [0.0; PHOTONS_PER_GROUP];
        for &(sin, cos) in &self.azimuths {
            let turned = |axis: usize, [x, y]: &[VectorLanes; 2], i: usize| {
                squared(axis, x[i] * cos + y[i] * sin, y[i] * cos - x[i] * sin)
            };
            sum =
                lanes(|i| sum[i] + 1.0 / ((1.0 + turned(0, &rho, i)) * (1.0 + turned(1, &nu, i))));
        }
        sum
    }
}

impl Lattices {
    /// Returns lattices for batches of `count` photons; `None` if there are too few photons for
    /// lattices.
    pub(crate) fn new(scene: &Scene, proposals: &[[Proposal; 2]], count: u64) -> Option<Self> {
        let points = count / proposals.len() as u64;
        let is_point = proposals.iter().flatten().any(Proposal::is_point);
        if is_point || points < MIN_POINTS || points > u64::from(u32::MAX) {
            return None;
        }
        let mut targets: Vec<PlaneFrequencies> = Vec::new();
        for target in scene
            .planes
            .iter()
            .map(|plane| PlaneFrequencies::new(scene, plane))
        {
            if !targets.contains(&target) {
                targets.push(target);
            }
        }
        let azimuths: usize = targets.iter().map(|target| target.azimuths.len()).sum();
        let trials = (TRIALS[1] * AZIMUTHS as u64 / azimuths as u64)
            .min(scene.run.photons / PHOTONS_PER_TRIAL)
            .clamp(TRIALS[0], TRIALS[1]);
        let replicas = replicas(scene);
        let (all, level) = (coefficients(), Level::new());
        let best = |frequencies: &Frequencies| {
            let generators = (0..trials).filter_map(|i| generator(i, points));
            let rated = |replicas: &[Replica], g| {
                let over = (&targets[..], replicas);
                let rated =
                    dispatch!(level, _simd => badness(&all, frequencies, over, (points, g)));
                (rated, g)
            };
            let mut tried: Vec<_> = generators.map(|g| rated(&[DIRECT], g)).collect();
            tried.sort_by(|a, b| a.0.total_cmp(&b.0));
            let shortlist = tried.iter().take(SHORTLIST);
            let best = shortlist.map(|(_, g)| rated(&replicas, *g));
            let (_, best) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
            // Multiplied by the second number, the lattice has the same points in another order, in
            // which photons of a group do not fall on the same cells.
            Some(best.map(|g| fraction(g * best[1] % points, points)))
        };
        let mut chosen: Vec<(Frequencies, Option<[u64; 4]>)> = Vec::new();
        let steps = proposals.iter().map(|proposal| {
            if !proposal.iter().all(Proposal::begins_in_window) {
                return None;
            }
            let frequencies = proposal.each_ref().map(Proposal::frequencies);
            let known = chosen.iter().find(|(earlier, _)| *earlier == frequencies);
            let steps = known.map_or_else(|| best(&frequencies), |(_, steps)| *steps);
            chosen.push((frequencies, steps));
            steps
        });
        let steps: Vec<_> = steps.collect();
        let has_any = steps.iter().any(Option::is_some);
        has_any.then_some(Self { steps })
    }

    /// The points for a batch whose photons have the numbers `range`.
    pub(crate) fn of(
        &self,
        seed: u64,
        stream: Stream,
        batch: u32,
        range: &Range<u64>,
    ) -> LatticePoints {
        let (first, count) = (range.start, range.end - range.start);
        let number = self.steps.len() as u64;
        let start = |p: u64| (count * p).div_ceil(number);
        let shift = |p: u32| {
            let [a, b] =
                [0, 1].map(|half| random::words(seed, stream, u64::from(batch), 2 * p + half));
            [0, 1, 2, 3].map(|i| u64::from(a[i]) << 32 | u64::from(b[i]))
        };
        LatticePoints {
            lattices: (0..)
                .zip(&self.steps)
                .map(|(p, steps)| steps.map(|steps| [steps, shift(p)]))
                .collect(),
            first,
            count,
            shares: (0..number)
                .map(|p| (start(p + 1) - start(p)) as f64 / count as f64)
                .collect(),
        }
    }
}

impl LatticePoints {
    /// The share of the photons that each proposal has.
    pub(crate) fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// The random numbers of a group of photons that begins with `photon`. `net` returns the
    /// group's numbers from a net.
    #[inline(always)]
    pub(crate) fn group(
        &self,
        photon: u64,
        net: impl Fn() -> [[u32; PHOTONS_PER_GROUP]; 4],
    ) -> LatticeGroup {
        let number = self.lattices.len() as u64;
        let first = photon - self.first;
        let proposal = |i: usize| {
            let index = (first + i as u64).min(self.count - 1);
            usize::try_from(index * number / self.count).unwrap_or(0)
        };
        let word = |i: usize, k: usize, [steps, shift]: &[[u64; 4]; 2]| {
            let start = first.wrapping_mul(steps[k]).wrapping_add(shift[k]);
            (start.wrapping_add((i as u64).wrapping_mul(steps[k])) >> 32) as u32
        };
        let (begin, end) = (proposal(0), proposal(PHOTONS_PER_GROUP - 1));
        if begin == end {
            return LatticeGroup {
                words: match &self.lattices[begin] {
                    Some(lattice) => {
                        let column = |k: usize| lanes(|i| word(i, k, lattice));
                        [column(0), column(1), column(2), column(3)]
                    }
                    None => net(),
                },
                proposals: [begin; PHOTONS_PER_GROUP],
            };
        }
        let proposals = lanes(proposal);
        let net = net();
        let words = [0, 1, 2, 3].map(|k| {
            lanes(|i| match &self.lattices[proposals[i]] {
                Some(lattice) => word(i, k, lattice),
                None => net[k][i],
            })
        });
        LatticeGroup { words, proposals }
    }
}

/// Returns g/N in units of 2⁻⁶⁴.
#[expect(clippy::cast_possible_truncation, reason = "g < N")]
fn fraction(g: u64, points: u64) -> u64 {
    ((u128::from(g) << 64) / u128::from(points)) as u64
}

/// The vector (1, a, a², a³) modulo N, for a number a drawn at random (Korobov 1960); `None`
/// if a and N have a common divisor.
fn generator(candidate: u64, points: u64) -> Option<[u64; 4]> {
    let [word, ..] = random::words(0, Stream::Lattice, candidate, 0);
    let a = 1 + u64::from(word) % (points - 1);
    let mut divisor = [a, points];
    while divisor[0] > 0 {
        divisor = [divisor[1] % divisor[0], divisor[0]];
    }
    let square = a * a % points;
    (divisor[1] == 1).then_some([1, a, square, square * a % points])
}

/// A part of the spectrum of light behind blockers: the frequency (ρ, ν) at the light along x and y to
/// which blockers move the spectrum of the light, and the power relative to that of the light.
#[derive(Clone, Copy, Debug)]
struct Replica {
    along: [[f64; 2]; 2],
    power: f64,
}

/// The spectrum of the light itself.
const DIRECT: Replica = Replica {
    along: [[0.0; 2]; 2],
    power: 1.0,
};

/// The power of a first replica relative to that of the light: that of a square wave.
const REPLICA_POWER: f64 = 0.1;

/// The spectrum of the light, and its first replicas behind periodic blockers.
fn replicas(scene: &Scene) -> Vec<Replica> {
    let mut all = vec![DIRECT];
    for layer in scene.blockers.iter().filter(|layer| layer.distance > 0.0) {
        let Some(pitch) = layer.pitch else { continue };
        for (i, j) in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (i, j))) {
            if (i, j) != (0, 0) {
                let at = |order: i32| {
                    [
                        f64::from(order) / pitch,
                        f64::from(order) * layer.distance / pitch,
                    ]
                };
                all.push(Replica {
                    along: [at(i), at(j)],
                    power: REPLICA_POWER,
                });
            }
        }
    }
    all
}

/// The matrices of [`Proposal::frequencies`] along x and y.
type Frequencies = [[[f64; 2]; 2]; 2];

/// One value for each of several vectors of a dual lattice.
type VectorLanes = [f64; PHOTONS_PER_GROUP];

/// The coefficients of all sums of basis vectors, except that opposite sums are the same.
fn coefficients() -> Vec<[f64; 4]> {
    let each = || -COEFFICIENT..=COEFFICIENT;
    let pairs = || each().flat_map(move |a| each().map(move |b| [a, b]));
    let all = pairs().flat_map(|[a, b]| pairs().map(move |[c, d]| [a, b, c, d]));
    all.filter(|all| *all > [0; 4])
        .map(|all| all.map(f64::from))
        .collect()
}

/// A measure of the noise of a lattice at the frequencies of all planes: the sum of
/// [`PlaneFrequencies::nearness`] over the shortest vectors of the dual lattice, around each part of the
/// spectrum. `coefficients` are those of [`coefficients()`].
#[inline(always)]
fn badness(
    coefficients: &[[f64; 4]],
    frequencies: &Frequencies,
    (targets, replicas): (&[PlaneFrequencies], &[Replica]),
    (points, g): (u64, [u64; 4]),
) -> f64 {
    let basis = dual_basis(points, g).map(|vector| vector.map(|h| h as f64));
    let mut sum = 0.0;
    for group in coefficients.chunks(PHOTONS_PER_GROUP) {
        let factors = |i: usize, k: usize| group.get(i).map_or(0.0, |factors| factors[k]);
        let h: [VectorLanes; 4] = [0, 1, 2, 3]
            .map(|axis| lanes(|i| (0..4).map(|k| factors(i, k) * basis[k][axis]).sum()));
        let along = [0, 1]
            .map(|i| frequencies[i].map(|[a, b]| lanes(|k| a * h[2 * i][k] + b * h[2 * i + 1][k])));
        for replica in replicas {
            let from = [0, 1].map(|i| [0, 1].map(|k| along[i][k].map(|f| f + replica.along[i][k])));
            let mut near = [0.0; PHOTONS_PER_GROUP];
            for target in targets {
                let target = target.nearness(&from);
                near = lanes(|i| near[i] + target[i]);
            }
            for near in near.iter().take(group.len()) {
                sum += replica.power * near;
            }
        }
    }
    sum
}

/// A basis of short vectors of the dual lattice: multiples of one vector
/// are subtracted from another until no vector becomes shorter.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a quotient of the lengths of short vectors"
)]
fn dual_basis(points: u64, [_, a, b, c]: [u64; 4]) -> [[i64; 4]; 4] {
    let [n, a, b, c] = [points, a, b, c].map(|number| i64::try_from(number).unwrap_or(i64::MAX));
    let mut basis = [[n, 0, 0, 0], [-a, 1, 0, 0], [-b, 0, 1, 0], [-c, 0, 0, 1]];
    let dot = |p: [i64; 4], q: [i64; 4]| -> i128 {
        (0..4).map(|i| i128::from(p[i]) * i128::from(q[i])).sum()
    };
    loop {
        let mut is_reduced = true;
        for i in 0..4 {
            for j in (0..4).filter(|j| *j != i) {
                let length = dot(basis[j], basis[j]);
                let times = (dot(basis[i], basis[j]) as f64 / length as f64).round() as i64;
                if times == 0 {
                    continue;
                }
                let reduced: [i64; 4] = std::array::from_fn(|k| basis[i][k] - times * basis[j][k]);
                if dot(reduced, reduced) < dot(basis[i], basis[i]) {
                    basis[i] = reduced;
                    is_reduced = false;
                }
            }
        }
        if is_reduced {
            return basis;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dual_basis_spans_the_dual_lattice() {
        for points in [64, 1000, 26_214, 1 << 17, 1_000_003] {
            let g = (0..).find_map(|i| generator(i, points)).unwrap();
            let basis = dual_basis(points, g);
            for h in basis {
                let product: i128 = (0..4).map(|i| i128::from(h[i]) * i128::from(g[i])).sum();
                assert_eq!(product.rem_euclid(i128::from(points)), 0, "{h:?}");
            }
            let rows = basis.map(|row| glam::DVec4::from(row.map(|h| h as f64)));
            let volume = glam::DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).determinant();
            assert!(
                (volume.abs() / points as f64 - 1.0).abs() < 1e-9,
                "{volume} of {points}"
            );
            // The shortest vector of a lattice of this volume has at most this length (Hermite).
            let length = rows
                .map(glam::DVec4::length)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            assert!(
                length <= 1.2 * libm::pow(points as f64, 0.25),
                "{length} of {points}"
            );
        }
    }

    /// Every photon of a batch has one point of the lattice of its proposal.
    #[test]
    fn groups_are_the_points_of_their_lattices() {
        let steps = [1, 7, 49, 43].map(|g| fraction(g, 301));
        let lattices = Lattices {
            steps: vec![Some(steps), None, Some(steps)],
        };
        let range = 5_000..5_903;
        let points = lattices.of(1, Stream::Lattice, 3, &range);
        assert_eq!(points.shares(), [1.0 / 3.0; 3]);
        let mut counts = [0; 3];
        for first in range.clone().step_by(PHOTONS_PER_GROUP) {
            let group = points.group(first, || [[9; PHOTONS_PER_GROUP]; 4]);
            for (i, photon) in (0..PHOTONS_PER_GROUP).zip(first..range.end) {
                let index = photon - range.start;
                let proposal = group.proposals[i];
                counts[proposal] += 1;
                assert_eq!(proposal as u64, index / 301);
                let word = match points.lattices[proposal] {
                    Some([steps, shift]) => {
                        index.wrapping_mul(steps[1]).wrapping_add(shift[1]) >> 32
                    }
                    None => 9,
                };
                assert_eq!(u64::from(group.words[1][i]), word);
            }
        }
        assert_eq!(counts, [301; 3]);
    }
}
