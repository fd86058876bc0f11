//! Plans how many more rays and photons the planes of a probe need for a verdict.

use super::scene::RESOLUTION;
use etendue_field::whole;
use std::f64::consts::FRAC_1_SQRT_2;

/// The noise that both estimates of a plane together should have, as a share of the spectrum. It is
/// below the resolution because the noise of few rays is itself uncertain.
const TARGET: f64 = 0.8 * RESOLUTION;
/// The largest number of rays or photons that an estimate may have.
const MAX_RAYS: f64 = (1_u64 << 28) as f64;
/// Limits of the factor by which an estimate grows. A smaller factor would discard almost as many
/// rays as it traces. Above the larger factor, the noise of few rays is not trusted.
const GROWTH: [f64; 2] = [2.0, 16.0];
/// An estimate may always grow to this number of rays.
const FEW_RAYS: f64 = (1_u64 << 20) as f64;

/// How many rays or photons an estimate has, and its noise as a share of the spectrum. The noise is
/// infinite if no light was found, or if the noise exceeds the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effort {
    pub(super) count: u64,
    pub(super) noise: f64,
}

impl Effort {
    /// The number of rays with which the noise is this share, at least the present number.
    pub(super) fn needed(self, share: f64) -> f64 {
        self.count as f64 * (self.noise / share).powi(2).max(1.0)
    }

    /// The number of rays to trace next, so that the noise becomes this share. The number is
    /// 0 if the noise is small enough, and infinity if it would be too large.
    fn next(self, share: f64) -> f64 {
        if self.noise <= share {
            return 0.0;
        }
        let [count, needed] = [self.count as f64, self.needed(share)];
        let most = (GROWTH[1] * count).max(FEW_RAYS);
        let next = needed.clamp(GROWTH[0] * count, most);
        // The noise of few rays does not prove that too many are needed.
        let is_few = next <= MAX_RAYS / GROWTH[1];
        if next > MAX_RAYS || (needed > MAX_RAYS && !is_few) {
            return f64::INFINITY;
        }
        next
    }
}

/// The shares of noise that the backward rays and the other estimate should have, if the
/// backward rays have this noise now.
pub(super) fn targets(rays: f64) -> [f64; 2] {
    let half = TARGET * FRAC_1_SQRT_2;
    [half, (TARGET * TARGET - rays.min(half).powi(2)).sqrt()]
}

/// The effort so far at a plane that is undecided.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneEffort {
    /// The number of the plane.
    pub(super) plane: usize,
    /// Backward rays.
    pub(super) rays: Effort,
    /// Photons; `None` if they do not find all light of the plane.
    pub(super) photons: Option<Effort>,
    /// BSDF rays; `None` if they do not find all light of the plane.
    pub(super) bsdf_rays: Option<Effort>,
}

impl PlaneEffort {
    /// The numbers of backward rays, photons and BSDF rays to trace next, where either
    /// photons or BSDF rays suffice. Returns `None` if the plane needs too many.
    fn next(&self) -> Option<[f64; 3]> {
        let [own, other] = targets(self.rays.noise);
        let of = |effort: Option<Effort>| effort.map_or(f64::INFINITY, |it| it.next(other));
        let next = [self.rays.next(own), of(self.photons), of(self.bsdf_rays)];
        let [rays, photons, bsdf_rays] = next;
        (rays.is_finite() && photons.min(bsdf_rays).is_finite()).then_some(next)
    }
}

/// The numbers of rays and photons to trace next.
#[derive(Debug, Default, PartialEq)]
pub(super) struct TracePlan {
    /// Planes with their numbers of backward rays.
    pub(super) rays: Vec<(usize, u64)>,
    /// Photons, which serve all planes.
    pub(super) photons: Option<u64>,
    /// Planes with their numbers of BSDF rays.
    pub(super) bsdf_rays: Vec<(usize, u64)>,
}

impl TracePlan {
    /// Plans the least work for the undecided planes. Photons serve all planes at once, and BSDF
    /// rays only one. A photon takes about as long as a BSDF ray.
    pub(super) fn new(open: &[PlaneEffort]) -> Self {
        let next = open.iter().filter_map(|of| Some((of.plane, of.next()?)));
        let next: Vec<(usize, [f64; 3])> = next.collect();
        let bsdf_rays = |limit: f64| {
            let rest = next.iter().filter(move |(_, [_, n, _])| *n > limit);
            rest.map(|(plane, [.., n])| (*plane, *n))
        };
        let work = |photons: f64| photons + bsdf_rays(photons).map(|(_, n)| n).sum::<f64>();
        let counts = next.iter().map(|(_, [_, n, _])| *n);
        let photons = counts
            .filter(|n| n.is_finite())
            .fold(0.0, |a, b| if work(b) < work(a) { b } else { a });
        Self {
            rays: counted(next.iter().map(|(plane, [n, ..])| (*plane, *n))),
            photons: (photons > 0.0).then(|| rounded(photons)),
            bsdf_rays: counted(bsdf_rays(photons)),
        }
    }
}

/// The planes that get rays, with the whole numbers of these rays.
fn counted(planes: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, u64)> {
    let some = planes.filter(|(_, n)| *n > 0.0);
    some.map(|(plane, n)| (plane, rounded(n))).collect()
}

/// A number of rays, rounded up.
fn rounded(rays: f64) -> u64 {
    whole(rays.ceil()) as u64
}

#[cfg(test)]
mod tests {
    use super::{Effort, PlaneEffort, TARGET, TracePlan};

    fn plane(plane: usize, rays: f64, photons: f64, bsdf_rays: f64) -> PlaneEffort {
        let count = 1 << 20;
        let effort = |noise| Effort { count, noise };
        PlaneEffort {
            plane,
            rays: effort(rays),
            photons: Some(effort(photons)),
            bsdf_rays: Some(effort(bsdf_rays)),
        }
    }

    /// Tests that the planned rays bring the noise of both estimates to the target.
    #[test]
    fn planned_rays_reach_the_target() {
        let of = plane(3, 0.1, 0.5, 0.11);
        let plan = TracePlan::new(&[of]);
        assert_eq!(plan.photons, None);
        let square = |(noise, count): (f64, u64)| noise * noise * f64::from(1 << 20) / count as f64;
        let left = [(0.1, plan.rays[0].1), (0.11, plan.bsdf_rays[0].1)].map(square);
        let noise = (left[0] + left[1]).sqrt();
        assert!((noise / TARGET - 1.0).abs() < 1e-5, "{noise}"); // rounding to whole rays
        assert_eq!([plan.rays[0].0, plan.bsdf_rays[0].0], [3, 3]);
    }

    /// Tests that photons are chosen where they serve several planes, and BSDF rays where one plane
    /// would need many photons.
    #[test]
    fn the_least_work_is_planned() {
        let even = [0, 1, 2].map(|i| plane(i, 0.01, 0.2, 0.15));
        let plan = TracePlan::new(&even);
        assert!(plan.photons.is_some() && plan.bsdf_rays.is_empty());
        let plan = TracePlan::new(&even[..1]);
        assert!(plan.photons.is_none() && plan.bsdf_rays.len() == 1);
        let [a, b, _] = even;
        let plan = TracePlan::new(&[a, b, plane(2, 0.01, 0.3, 0.1)]);
        assert_eq!(plan.bsdf_rays.len(), 1);
        assert_eq!(plan.bsdf_rays[0].0, 2);
        assert!(plan.rays.is_empty());
    }

    /// Tests that only the noisier of two estimates grows.
    #[test]
    fn precise_estimates_are_kept() {
        let plan = TracePlan::new(&[plane(1, 0.2, 0.001, 5.0)]);
        assert_eq!(plan.rays.len(), 1);
        assert!(plan.photons.is_none() && plan.bsdf_rays.is_empty());
    }

    /// Tests that a plane without hope takes no time, and that growth is limited.
    #[test]
    fn too_many_rays_are_not_traced() {
        let effort = |count, noise| Effort { count, noise };
        let mut of = plane(0, 0.01, 3.0, 0.7);
        of.photons = Some(effort(1 << 25, 3.0));
        assert_eq!(TracePlan::new(&[of]).bsdf_rays, [(0, 16 << 20)]);
        of.bsdf_rays = Some(effort(1 << 20, f64::INFINITY));
        assert_eq!(TracePlan::new(&[of]).bsdf_rays, [(0, 16 << 20)]);
        of.bsdf_rays = Some(effort(1 << 24, f64::INFINITY));
        assert_eq!(TracePlan::new(&[of]), TracePlan::default());
        let many = effort(1 << 28, 0.09);
        assert!(many.next(0.08).is_infinite());
        let few = effort(100, 0.081);
        assert!((few.next(0.08) - 200.0).abs() < 1e-9); // rounding
    }
}
