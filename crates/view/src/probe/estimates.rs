//! Estimates the light at each plane of a probe in two ways, until they can be compared.

use super::effort::{Effort, PlaneEffort, TracePlan};
use super::found::{Found, SecondEstimate, verdict};
use super::scene::{ALPHA, BATCHES, ProbeRequest, RESOLUTION, budget};
use etendue_compare::{Prediction, Test, Verdict, compare, sidak};
use etendue_field::PhotonSource;
use etendue_paths::{BackwardProbe, PhotonProbe, Probe};
use etendue_pipeline::{Reporter, Work};
use etendue_spectrum::bandwidth::{bandwidth_nu, bandwidth_rho};
use etendue_spectrum::estimate;
use etendue_spectrum::{CrossPower, Measurement, measure};
use etendue_store::Failure;
use std::rc::Rc;

/// The largest number of comparisons of a plane.
const MAX_COMPARISONS: usize = 6;
/// The difference between the seed of BSDF rays and the seed of the backward rays.
const BSDF_SEED: u64 = 1 << 63;

/// An estimate of the light at a plane.
#[derive(Clone, Debug)]
struct LightEstimate {
    light: Rc<Measurement>,
    effort: Effort,
}

/// Both estimates of the light at a plane, and their comparison.
struct PlaneEstimates {
    rays: LightEstimate,
    photons: LightEstimate,
    bsdf_rays: Option<LightEstimate>,
    /// The reason why photons do not find all light of the plane.
    misses: Option<&'static str>,
    /// The comparison by the better judge; `None` after an estimate changed.
    found: Option<(Found, Prediction)>,
}

impl PlaneEstimates {
    /// Returns the estimate with which the backward rays are compared.
    fn judge(&self) -> (SecondEstimate, &LightEstimate) {
        match &self.bsdf_rays {
            Some(rays)
                if self.misses.is_some() || rays.effort.noise < self.photons.effort.noise =>
            {
                (SecondEstimate::BsdfRays, rays)
            }
            _ => (SecondEstimate::Photons, &self.photons),
        }
    }
}

/// A probe whose light is estimated.
struct Estimator<'a> {
    request: &'a ProbeRequest,
    probe: &'a Probe<'a>,
    reporter: &'a dyn Reporter,
}

/// Estimates the light at all planes by backward rays, and by photons or by rays that find lights
/// only by directions sampled from BSDFs. Unless the request fixes the number of photons, planes
/// that are undecided get more rays and photons.
pub(super) fn measured(
    request: &ProbeRequest,
    probe: &Probe<'_>,
    reporter: &dyn Reporter,
) -> Result<Vec<(Found, Prediction)>, Failure> {
    let estimator = Estimator {
        request,
        probe,
        reporter,
    };
    let mut planes = estimator.first()?;
    for comparison in 1.. {
        for (i, plane) in planes.iter_mut().enumerate() {
            if plane.found.is_none() {
                plane.found = Some(estimator.compared(i, plane)?);
            }
        }
        let is_open = |plane: &PlaneEstimates| {
            let verdict = plane.found.as_ref().map(|(found, _)| verdict(found));
            verdict == Some(Verdict::Undecided)
        };
        let open = (0..planes.len()).filter(|i| is_open(&planes[*i]));
        let plan = estimator.plan(&planes, &open.collect::<Vec<usize>>());
        if comparison == MAX_COMPARISONS || plan == TracePlan::default() {
            break;
        }
        estimator.follow(&plan, &mut planes)?;
    }
    let mut all: Vec<(Found, Prediction)> = planes.into_iter().filter_map(|of| of.found).collect();
    for (found, _) in &mut all {
        found.comparison.report.verdict = verdict(found);
    }
    Ok(all)
}

impl Estimator<'_> {
    fn first(&self) -> Result<Vec<PlaneEstimates>, Failure> {
        let [rays, photons] = [self.request.rays, self.request.first_photons()];
        let backward = BackwardProbe::new(self.probe, budget(rays, self.request.seed));
        let backward = self.trace(&backward, rays);
        let forward = PhotonProbe::new(self.probe, budget(photons, !self.request.seed));
        let misses = |i| forward.misses(i);
        let light = self.trace(&forward, photons);
        let planes = (0..self.probe.planes.len()).map(|i| {
            Ok(PlaneEstimates {
                rays: estimate_of(&backward, i, rays)?,
                photons: estimate_of(&light, i, photons)?,
                bsdf_rays: None,
                misses: misses(i),
                found: None,
            })
        });
        planes.collect()
    }

    /// Plans the next rays of the undecided planes.
    fn plan(&self, planes: &[PlaneEstimates], open: &[usize]) -> TracePlan {
        let can_bsdf = self.probe.bsdf_finds_lights();
        let untried = open
            .iter()
            .filter(|i| can_bsdf && planes[**i].bsdf_rays.is_none());
        let bsdf_rays: Vec<(usize, u64)> = untried
            .map(|i| (*i, self.request.first_photons()))
            .collect();
        if !bsdf_rays.is_empty() {
            return TracePlan {
                bsdf_rays,
                ..TracePlan::default()
            };
        }
        if self.request.photons.is_some() {
            return TracePlan::default();
        }
        let efforts = open.iter().map(|i| {
            let plane = &planes[*i];
            PlaneEffort {
                plane: *i,
                rays: plane.rays.effort,
                photons: plane.misses.is_none().then_some(plane.photons.effort),
                bsdf_rays: plane.bsdf_rays.as_ref().map(|rays| rays.effort),
            }
        });
        TracePlan::new(&efforts.collect::<Vec<PlaneEffort>>())
    }

    /// Traces the rays of a plan.
    fn follow(&self, plan: &TracePlan, planes: &mut [PlaneEstimates]) -> Result<(), Failure> {
        let seed = self.request.seed;
        for (i, count) in &plan.rays {
            let rays = BackwardProbe::new(self.probe, budget(*count, seed)).at_plane(*i);
            planes[*i].rays = estimate_of(&self.trace(&rays, *count), *i, *count)?;
            planes[*i].found = None;
        }
        for (i, count) in &plan.bsdf_rays {
            let seed = seed.wrapping_add(BSDF_SEED);
            let rays = BackwardProbe::new(self.probe, budget(*count, seed)).at_plane(*i);
            if let Some(rays) = rays.by_bsdf() {
                let found = estimate_of(&self.trace(&rays, *count), *i, *count)?;
                planes[*i].bsdf_rays = Some(found);
                planes[*i].found = None;
            }
        }
        if let Some(count) = plan.photons {
            let photons = PhotonProbe::new(self.probe, budget(count, !seed));
            let light = self.trace(&photons, count);
            for (i, plane) in planes.iter_mut().enumerate() {
                plane.photons = estimate_of(&light, i, count)?;
                plane.found = None;
            }
        }
        Ok(())
    }

    fn trace(&self, source: &dyn PhotonSource, count: u64) -> Rc<Measurement> {
        let bar = self.reporter.begin(Work::Photons(count));
        Rc::new(measure(source, &self.probe.planes, 0..BATCHES, &|done| {
            bar.advance(done);
        }))
    }

    /// Compares the two estimates of a plane.
    fn compared(&self, i: usize, plane: &PlaneEstimates) -> Result<(Found, Prediction), Failure> {
        let test = Test {
            level: sidak(ALPHA, MAX_COMPARISONS * self.probe.planes.len()),
            resolution: RESOLUTION,
            seed: self.request.seed,
        };
        let (judge, other) = plane.judge();
        let prediction = Prediction::measured(&other.light, i).map_err(Failure::cannot_run)?;
        let rays = &plane.rays.light;
        let comparison = compare(rays, i, &prediction, &test).map_err(Failure::cannot_run)?;
        let azimuths = 0..self.probe.planes[i].grid.azimuths;
        let varying = rays.without_mean(i);
        let power = CrossPower::of_replicates(&varying, azimuths).map_err(Failure::cannot_run)?;
        let found = Found {
            comparison,
            nu: power.bandwidth(bandwidth_nu),
            rho: power.bandwidth(bandwidth_rho),
            judge,
            counts: [plane.rays.effort.count, other.effort.count],
            misses: plane.misses,
            covariance: None,
            variance: None,
        };
        Ok((found, prediction))
    }
}

fn estimate_of(
    light: &Rc<Measurement>,
    plane: usize,
    count: u64,
) -> Result<LightEstimate, Failure> {
    let noise = estimate::noise(light, plane).map_err(Failure::cannot_run)?;
    Ok(LightEstimate {
        light: Rc::clone(light),
        effort: Effort {
            count,
            noise: noise.unwrap_or(f64::INFINITY),
        },
    })
}
