//! Estimates the light at each plane of a probe in two ways, until they can be compared.

use super::effort::{Effort, PlaneEffort, TracePlan, targets};
use super::found::{Found, SecondEstimate, verdict};
use super::scene::{ALPHA, BATCHES, ProbeRequest, RESOLUTION, budget, seed_at};
use etendue_compare::{Prediction, TESTS, Test, Verdict, compare, sidak};
use etendue_field::PhotonSource;
use etendue_paths::{BackwardProbe, PhotonProbe, Probe};
use etendue_pipeline::{Reporter, Work};
use etendue_spectrum::bandwidth::Along;
use etendue_spectrum::estimate;
use etendue_spectrum::{CrossPower, Measurement, measure};
use etendue_store::Failure;
use std::rc::Rc;

/// The largest number of comparisons of a plane: by photons, by BSDF rays, and after more rays.
const MAX_COMPARISONS: usize = 5;
/// The difference between the seed of BSDF rays and the seed of the backward rays.
const BSDF_SEED: u64 = 1 << 63;

/// An estimate of the light at a plane.
#[derive(Clone, Debug)]
struct LightEstimate {
    light: Rc<Measurement>,
    /// The number of the plane in `light`.
    index: usize,
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
    /// The estimate with which the backward rays are compared.
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

    /// Checks whether more rays may change the verdict. If no light was found, BSDF rays that were
    /// not yet tried may find some.
    fn is_open(&self, is_untried: bool) -> bool {
        self.found.as_ref().is_some_and(|(found, _)| {
            verdict(found) == Verdict::Undecided || (found.is_dark() && is_untried)
        })
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
        let open =
            (0..planes.len()).filter(|i| planes[*i].is_open(estimator.is_untried(&planes[*i])));
        let open: Vec<usize> = open.collect();
        let plan = estimator.plan(&planes, &open);
        if comparison == estimator.comparisons() || plan == TracePlan::default() {
            break;
        }
        estimator.follow(&plan, &mut planes, &open)?;
    }
    let mut all: Vec<(Found, Prediction)> = planes.into_iter().filter_map(|of| of.found).collect();
    for (found, _) in &mut all {
        found.comparison.report.verdict = verdict(found);
    }
    Ok(all)
}

impl Estimator<'_> {
    /// The largest number of comparisons of a plane.
    fn comparisons(&self) -> usize {
        match self.request.photons {
            Some(_) => 2,
            None => MAX_COMPARISONS,
        }
    }

    /// Checks whether BSDF rays would find all light of a plane, and were not yet traced.
    fn is_untried(&self, plane: &PlaneEstimates) -> bool {
        plane.bsdf_rays.is_none() && self.probe.bsdf_finds_lights()
    }

    fn first(&self) -> Result<Vec<PlaneEstimates>, Failure> {
        let request = self.request;
        let backward = BackwardProbe::new(self.probe, budget(request.rays, request.seed));
        let backward = self.trace(self.probe, &backward, request.rays);
        let photons = PhotonProbe::new(self.probe, budget(request.first_photons(), !request.seed));
        let light = self.trace(self.probe, &photons, request.first_photons());
        let planes = (0..self.probe.planes.len()).map(|i| {
            Ok(PlaneEstimates {
                rays: estimate_of(&backward, i, request.rays)?,
                photons: estimate_of(&light, i, request.first_photons())?,
                bsdf_rays: None,
                misses: photons.misses(i),
                found: None,
            })
        });
        planes.collect()
    }

    /// Plans the next rays of the undecided planes.
    fn plan(&self, planes: &[PlaneEstimates], open: &[usize]) -> TracePlan {
        let untried = open.iter().filter(|i| self.is_untried(&planes[**i]));
        let count = self.request.first_bsdf_rays();
        let bsdf_rays: Vec<(usize, u64)> = untried.map(|i| (*i, count)).collect();
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

    /// Traces the rays of a plan. The estimates of planes that are not open stay as they are.
    fn follow(
        &self,
        plan: &TracePlan,
        planes: &mut [PlaneEstimates],
        open: &[usize],
    ) -> Result<(), Failure> {
        let seed = self.request.seed;
        for (i, count) in &plan.rays {
            let probe = self.probe.at_plane(*i);
            let rays = BackwardProbe::new(&probe, budget(*count, seed_at(seed, *i)));
            planes[*i].rays = estimate_of(&self.trace(&probe, &rays, *count), 0, *count)?;
        }
        for (i, count) in &plan.bsdf_rays {
            let probe = self.probe.at_plane(*i);
            let seed = seed_at(seed.wrapping_add(BSDF_SEED), *i);
            let rays = BackwardProbe::new(&probe, budget(*count, seed));
            if let Some(rays) = rays.by_bsdf() {
                let light = self.trace(&probe, &rays, *count);
                planes[*i].bsdf_rays = Some(estimate_of(&light, 0, *count)?);
            }
        }
        if let Some(count) = plan.photons {
            let photons = PhotonProbe::new(self.probe, budget(count, !seed));
            let light = self.trace(self.probe, &photons, count);
            for i in open {
                planes[*i].photons = estimate_of(&light, *i, count)?;
            }
        }
        for i in open {
            planes[*i].found = None;
        }
        Ok(())
    }

    fn trace(&self, probe: &Probe<'_>, source: &dyn PhotonSource, count: u64) -> Rc<Measurement> {
        let bar = self.reporter.begin(Work::Photons(count));
        Rc::new(measure(source, &probe.planes, 0..BATCHES, &|done| {
            bar.advance(done);
        }))
    }

    /// Compares the two estimates of a plane.
    fn compared(&self, i: usize, plane: &PlaneEstimates) -> Result<(Found, Prediction), Failure> {
        let test = Test {
            level: sidak(ALPHA, TESTS * self.comparisons() * self.probe.planes.len()),
            resolution: RESOLUTION,
            seed: self.request.seed,
        };
        let (judge, other) = plane.judge();
        let LightEstimate {
            light,
            index,
            effort,
        } = &plane.rays;
        let prediction = Prediction::measured(&other.light, other.index);
        let prediction = prediction.map_err(Failure::cannot_run)?;
        let comparison = compare(light, *index, &prediction, &test).map_err(Failure::cannot_run)?;
        let azimuths = 0..self.probe.planes[i].grid.azimuths;
        let varying = light.without_mean(*index);
        let power = CrossPower::of_replicates(&varying, azimuths).map_err(Failure::cannot_run)?;
        let [own, others] = targets(effort.noise);
        let found = Found {
            comparison,
            nu: power.bandwidth(Along::Nu),
            rho: power.bandwidth(Along::Rho),
            judge,
            counts: [effort.count, other.effort.count],
            needed: [effort.needed(own), other.effort.needed(others)],
            misses: plane.misses,
            covariance: None,
            variance: None,
        };
        Ok((found, prediction))
    }
}

fn estimate_of(
    light: &Rc<Measurement>,
    index: usize,
    count: u64,
) -> Result<LightEstimate, Failure> {
    let noise = estimate::noise(light, index).map_err(Failure::cannot_run)?;
    Ok(LightEstimate {
        light: Rc::clone(light),
        index,
        effort: Effort {
            count,
            noise: noise.unwrap_or(f64::INFINITY),
        },
    })
}
