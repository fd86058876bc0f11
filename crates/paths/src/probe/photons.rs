//! Photons of a probe.

use super::lines::SurfaceLeg;
use super::lines::seen_by;
use super::{Budget, Probe, Stop};
use crate::lights::{EmissionPoint, EmissionTarget, Emitted, chosen, mixed};
use crate::numbers::PathNumbers;
use crate::paths::ROULETTE;
use crate::space::{Hit, Ray};
use etendue_field::{Crossing, Ledger, PhotonSource, TwoPlane};
use glam::DVec3;

/// Photons of a [`Probe`], the independent check of [`BackwardProbe`](super::BackwardProbe).
///
/// These photons leave the lights. Wherever a photon hits or leaves a surface, a direction through
/// the windows is drawn for it. Photons cannot find light that a mirror or smooth glass sends into
/// a window, or the sky itself; [`PhotonProbe::misses`] reports where this matters.
#[derive(Debug)]
pub struct PhotonProbe<'a> {
    probe: &'a Probe<'a>,
    budget: Budget,
    /// The regions of each surface that the windows see.
    targets: Vec<EmissionTarget>,
}

/// Number of photons between two progress reports.
const BLOCK: u64 = 4096;
/// Number of lines through a window that are traced to find out what is seen through it.
const LINES: u64 = 4096;

/// A surface point that light leaves, with its directional intensity.
struct LightSource<'s> {
    position: DVec3,
    /// Flux per solid angle along a direction, W sr⁻¹.
    intensity: &'s dyn Fn(DVec3) -> f64,
    /// Number of surfaces met so far, this one included.
    met: u32,
}

impl<'a> PhotonProbe<'a> {
    /// Creates the photons of a probe.
    #[must_use]
    pub fn new(probe: &'a Probe<'a>, budget: Budget) -> Self {
        let targets = probe.stops.iter().zip(&probe.legs);
        let target = |(stop, leg): (&Stop, &SurfaceLeg)| EmissionTarget {
            center: stop.position,
            // The sphere covers the corners of the window, also on an inclined surface.
            radius: 2.0 * leg.wide(stop.distance) / stop.cosine().max(0.1),
        };
        Self {
            probe,
            budget,
            targets: targets.map(target).collect(),
        }
    }

    /// Returns the reason why photons miss light of a plane, found from what is seen through its
    /// window.
    #[must_use]
    pub fn misses(&self, plane: usize) -> Option<&'static str> {
        let Probe {
            paths,
            legs,
            planes,
            ..
        } = self.probe;
        let plane = &planes[plane];
        let half = [plane.window.x, plane.window.u].map(|profile| profile.half_width());
        (0..LINES).find_map(|number| {
            let mut numbers = PathNumbers::new(self.budget.seed, number);
            let [x, y, u, v] = numbers.draw().map(|drawn: f64| 2.0 * drawn - 1.0);
            let seen = TwoPlane {
                x: half[0] * x,
                y: half[0] * y,
                u: half[1] * u,
                v: half[1] * v,
            };
            let line = legs[plane.leg].line(&paths.geometry, &plane.frame, &seen);
            match paths.geometry.first(&line, [0.0, f64::INFINITY]) {
                None if paths.has_sky() => Some("the sky"),
                Some(hit) if paths.scatter(&hit).has_mirror() => Some("a smooth surface"),
                _ => None,
            }
        })
    }

    #[expect(
        clippy::too_many_lines,
        reason = "the function follows one photon from surface to surface"
    )]
    fn photon(&self, number: u64, record: &mut dyn FnMut(usize, Crossing)) {
        let paths = self.probe.paths;
        let mut numbers = PathNumbers::new(self.budget.seed, number);
        let emitted = paths
            .lights
            .emit(&paths.geometry, numbers.draw(), &self.targets);
        let Some(Emitted {
            mut ray,
            mut flux,
            flash,
        }) = emitted
        else {
            return;
        };
        if let Some(EmissionPoint {
            position,
            normal,
            shine,
        }) = flash
        {
            let intensity = |along: DVec3| shine * along.dot(normal).max(0.0);
            self.pass(
                &LightSource {
                    position,
                    intensity: &intensity,
                    met: 0,
                },
                &mut numbers,
                record,
            );
        }
        // A photon without flux ends here, but its emission point has already lit the windows.
        let first = flux;
        if first <= 0.0 {
            return;
        }
        for met in 1..=paths.depth {
            let Some(hit) = paths.geometry.first(&ray, [0.0, f64::INFINITY]) else {
                return;
            };
            let wi = hit.frame.transpose() * -ray.along;
            let scatter = paths.scatter(&hit);
            let intensity = |along: DVec3| {
                let wo = hit.frame.transpose() * along;
                flux * scatter.value(hit.uv, wi, wo) * tilt(&hit, ray.along, along)
            };
            if !scatter.is_smooth() {
                self.pass(
                    &LightSource {
                        position: hit.position,
                        intensity: &intensity,
                        met,
                    },
                    &mut numbers,
                    record,
                );
            }
            let Some((along, share)) = self.onward(&hit, ray.along, &mut numbers) else {
                return;
            };
            flux *= share;
            let [survives] = numbers.draw();
            let share = (flux / first).min(0.95);
            if met >= ROULETTE {
                if survives >= share {
                    return;
                }
                flux /= share;
            }
            ray = Ray {
                from: hit.position,
                along,
            };
        }
    }

    /// Returns the direction in which a photon continues from a hit, and the share of its flux.
    /// Half of the photons follow the material; the other half are aimed at the regions that the
    /// windows see.
    fn onward(
        &self,
        hit: &Hit,
        arriving: DVec3,
        numbers: &mut PathNumbers<'_>,
    ) -> Option<(DVec3, f64)> {
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
                let bounce = scatter.sample(hit.uv, wi, numbers.draw())?;
                let along = (hit.frame * bounce.wi).normalize();
                if bounce.density.is_none() {
                    // For mirrors and smooth glass, the factor undoes the division by squared
                    // indices, which applies to radiance and not to power. Only photons that are
                    // not aimed come here.
                    let half = if scatter.is_smooth() { 1.0 } else { 2.0 };
                    let share = half * bounce.weight * scatter.squared_index(wi, bounce.wi);
                    return Some((along, share));
                }
                along
            }
        };
        let wo = hit.frame.transpose() * along;
        let plain = scatter.density(hit.uv, wo, wi);
        let density = mixed(plain, &self.targets, |target| {
            target.density(hit.position, along)
        });
        let share = scatter.value(hit.uv, wi, wo) * tilt(hit, arriving, along) / density;
        (share > 0.0).then_some((along, share))
    }

    /// Draws a direction from a point through the windows of each leg, and records it if nothing
    /// occludes it.
    fn pass(
        &self,
        source: &LightSource<'_>,
        numbers: &mut PathNumbers<'_>,
        record: &mut dyn FnMut(usize, Crossing),
    ) {
        let Probe {
            paths,
            legs,
            planes,
            ..
        } = self.probe;
        for (number, leg) in legs.iter().enumerate() {
            let drawn: [f64; 2] = numbers.draw();
            let before = u32::try_from(number).unwrap_or(u32::MAX);
            let is_hidden = paths.hides_sources && source.met + before == 0;
            if is_hidden || source.met.saturating_add(before) > paths.depth {
                continue;
            }
            let [u, v] = drawn.map(|drawn| (2.0 * drawn - 1.0) * leg.slope);
            let secant_squared = 1.0 + u * u + v * v;
            let along = leg.frame.vector_to_world(DVec3::new(u, v, 1.0)).normalize();
            let of_leg = planes
                .iter()
                .enumerate()
                .filter(|(_, plane)| plane.leg == number);
            let seen = of_leg.filter_map(|(i, plane)| {
                let ray = seen_by(&plane.frame, source.position, along);
                plane.window.contains(&ray).then_some((i, ray))
            });
            let seen: Vec<(usize, TwoPlane)> = seen.collect();
            if seen.is_empty() {
                continue;
            }
            let intensity = (source.intensity)(along);
            if intensity <= 0.0 || !self.is_seen(number, source.position, along) {
                continue;
            }
            // Slopes are drawn uniformly; dω = du dv / (1 + u² + v²)^(3/2).
            let weight = intensity * 4.0 * leg.slope * leg.slope * secant_squared.sqrt();
            for (i, ray) in seen {
                record(i, Crossing { ray, weight });
            }
        }
    }

    /// Whether the line through a point, traced back from the end of a leg, hits that point first.
    fn is_seen(&self, leg: usize, position: DVec3, along: DVec3) -> bool {
        let Probe { paths, legs, .. } = self.probe;
        let line = legs[leg].through(&paths.geometry, position, along);
        // If the line begins at the point itself, light leaves on the other side of the surface.
        let is_before = (position - line.from).dot(line.along) > 1e-6 * legs[leg].reach;
        is_before && paths.geometry.is_clear(line.from, position)
    }
}

/// Returns the factor on the BSDF times the cosine to the shading normal that gives flux, for
/// which both cosines are to the geometric normal.
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
        for block in 0..self.budget.each.div_ceil(BLOCK) {
            let start = block * BLOCK;
            let count = BLOCK.min(self.budget.each - start);
            for photon in start..start + count {
                self.photon(first + photon, &mut |plane, crossing| {
                    found[plane].push(crossing);
                });
            }
            for (plane, crossings) in found.iter_mut().enumerate() {
                record(plane, crossings);
                crossings.clear();
            }
            progress(count);
        }
        Ledger::default()
    }
}
