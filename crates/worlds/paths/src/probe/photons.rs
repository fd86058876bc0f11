//! Photons of a probe.

use super::windows::{LightSource, WindowConnector};
use super::{Budget, Probe};
use crate::lights::{EmissionTarget, chosen, mixed};
use crate::numbers::PathNumbers;
use crate::paths::ROULETTE;
use crate::space::{Hit, Ray};
use etendue_field::{Crossing, Ledger, PhotonSource};
use glam::DVec3;

/// Photons of a [`Probe`], the independent check of [`BackwardProbe`](super::BackwardProbe).
///
/// These photons leave the lights. At each point where a photon hits or leaves a surface, a
/// direction through the windows is drawn for it. The direction leads to the windows directly, or
/// by reflection in the smooth surfaces on the central ray. Directions for light of the sky are
/// drawn in the same way. Photons cannot find light that other smooth surfaces send into a window.
/// [`PhotonProbe::misses`] reports the planes that such light reaches.
#[derive(Debug)]
pub struct PhotonProbe<'a> {
    probe: &'a Probe<'a>,
    budget: Budget,
    /// The regions of each surface that the windows see.
    targets: Vec<EmissionTarget>,
    windows: WindowConnector<'a>,
}

impl<'a> PhotonProbe<'a> {
    /// Creates the photons of a probe.
    #[must_use]
    pub fn new(probe: &'a Probe<'a>, budget: Budget) -> Self {
        Self {
            probe,
            budget,
            targets: probe.targets(),
            windows: WindowConnector::new(probe, budget.seed),
        }
    }

    /// The reason why photons do not find all light that reaches a plane. The reason
    /// follows from the objects that are seen through the window of the plane.
    #[must_use]
    pub fn misses(&self, plane: usize) -> Option<&'static str> {
        self.windows.misses[plane]
    }

    #[expect(
        clippy::too_many_lines,
        reason = "the function follows one photon from surface to surface"
    )]
    fn photon(&self, number: u64, record: &mut dyn FnMut(usize, Crossing)) {
        let paths = self.probe.paths;
        let mut numbers = PathNumbers::new(self.budget.seed, number);
        self.windows.connect_sky(&mut numbers, record);
        let emitted = paths
            .lights
            .emit(&paths.geometry, numbers.draw(), &self.targets);
        let Some(emitted) = emitted else {
            return;
        };
        let (mut ray, mut flux) = (emitted.ray, emitted.flux);
        if let Some(flash) = emitted.flash {
            let intensity = |along: DVec3| flash.shine * along.dot(flash.normal).max(0.0);
            self.windows.connect(
                &LightSource {
                    position: flash.position,
                    intensity: &intensity,
                    density: &|_| 0.0,
                    met: 0,
                },
                &mut numbers,
                record,
            );
        }
        // A photon without flux ends here, but light of its emission point has already been sent to
        // the windows.
        let first = flux;
        if first <= 0.0 {
            return;
        }
        for met in 1..=paths.depth {
            let Some(hit) = paths.stopped(&ray, &mut numbers) else {
                return;
            };
            let wi = hit.frame.transpose() * -ray.along;
            let scatter = paths.scatter(&hit);
            let intensity = |along: DVec3| {
                let wo = hit.frame.transpose() * along;
                flux * scatter.value(&hit.point, wi, wo) * tilt(&hit, ray.along, along)
            };
            if !scatter.is_smooth() {
                self.windows.connect(
                    &LightSource {
                        position: hit.position,
                        intensity: &intensity,
                        density: &|along| self.onward_density(&hit, ray.along, along),
                        met,
                    },
                    &mut numbers,
                    record,
                );
            }
            let Some(onward) = self.onward(&hit, ray.along, &mut numbers) else {
                return;
            };
            flux *= onward.share;
            if let Some(density) = onward.density {
                let source = (hit.position, met);
                let photon = (onward.along, flux, density);
                self.windows.continued(source, photon, &mut numbers, record);
            }
            let [survives] = numbers.draw();
            let share = (flux / first).min(0.95);
            if met >= ROULETTE {
                if survives >= share {
                    return;
                }
                flux /= share;
            }
            ray = Ray::new(hit.position, onward.along);
        }
    }

    /// How a photon continues from a hit; `None` if it is absorbed. Half of the photons
    /// follow the material, and the other half are aimed at the regions that the windows see.
    fn onward(&self, hit: &Hit, arriving: DVec3, numbers: &mut PathNumbers<'_>) -> Option<Onward> {
        let scatter = self.probe.paths.scatter(hit);
        let wi = hit.frame.transpose() * -arriving;
        let [a, b, pick] = numbers.draw();
        let target = match scatter.is_smooth() {
            true => None,
            false => chosen(&self.targets, pick),
        };
        let along = match target {
            Some(target) => target.toward(hit.position, [a, b]),
            None => {
                let bounce = scatter.sample(&hit.point, wi, numbers.draw())?;
                let along = (hit.frame * bounce.wi).normalize();
                if bounce.density.is_none() {
                    // For mirrors and smooth glass, the factor undoes the division by squared
                    // indices, which applies to radiance and not to power. Only photons that are
                    // not aimed get this factor.
                    let half = if scatter.is_smooth() { 1.0 } else { 2.0 };
                    return Some(Onward {
                        along,
                        share: half * bounce.weight * scatter.squared_index(wi, bounce.wi),
                        density: None,
                    });
                }
                along
            }
        };
        let density = self.onward_density(hit, arriving, along);
        let wo = hit.frame.transpose() * along;
        let share = scatter.value(&hit.point, wi, wo) * tilt(hit, arriving, along) / density;
        (share > 0.0).then_some(Onward {
            along,
            share,
            density: Some(density),
        })
    }

    /// The density, per solid angle, with which photons continue from a hit in a direction.
    /// Delta components are left out.
    fn onward_density(&self, hit: &Hit, arriving: DVec3, along: DVec3) -> f64 {
        let [wi, wo] = [-arriving, along].map(|of| hit.frame.transpose() * of);
        let plain = self.probe.paths.scatter(hit).density(&hit.point, wo, wi);
        mixed(plain, &self.targets, |target| {
            target.density(hit.position, along)
        })
    }
}

/// The continuation of a photon from a surface.
struct Onward {
    along: DVec3,
    /// The share of the flux that the photon keeps.
    share: f64,
    /// The density of the direction per solid angle; `None` after a mirror or smooth interface.
    density: Option<f64>,
}

/// A factor. The BSDF times the cosine to the shading normal, multiplied by this factor,
/// gives flux. For flux, both cosines refer to the geometric normal.
fn tilt(hit: &Hit, arriving: DVec3, leaving: DVec3) -> f64 {
    (leaving.dot(hit.normal) / arriving.dot(hit.normal)).abs()
}

impl PhotonSource for PhotonProbe<'_> {
    fn emitted(&self, _batch: u32) -> u64 {
        self.budget.each
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let first = u64::from(batch) * self.budget.each;
        let mut found: Vec<Vec<Crossing>> = vec![Vec::new(); self.probe.planes.len()];
        for block in self.budget.blocks() {
            for photon in block.clone() {
                self.photon(first + photon, &mut |plane, crossing| {
                    found[plane].push(crossing);
                });
            }
            for (plane, crossings) in found.iter_mut().enumerate() {
                record(plane, crossings);
                crossings.clear();
            }
            progress(block.end - block.start);
        }
        Ledger::default()
    }
}
