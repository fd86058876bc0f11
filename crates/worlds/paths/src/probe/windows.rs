//! Connects photons to the windows of a probe, directly and by reflection in smooth surfaces.

use super::Probe;
use super::lines::seen_by;
use crate::numbers::PathNumbers;
use crate::space::{Hit, Ray};
use etendue_field::{Crossing, Frame, TwoPlane, VirtualPlane};
use glam::DVec3;

/// Number of lines that are traced through a window, to find the objects that are seen through it.
const LINES: u64 = 4096;
/// The region of connections is larger than the region of the traced lines by this factor, because
/// other lines may lie slightly outside.
const MARGIN: f64 = 1.1;
/// Maximum slope of a connection.
const STEEPEST: f64 = 1.0;

/// Windows see lines of a leg, directly or in smooth surfaces. This is the region of these lines.
#[derive(Clone, Copy, Debug)]
struct LineRegion {
    /// The frame at the end of the leg.
    frame: Frame,
    /// Half-width along x and y.
    position: f64,
    /// Half-width along u and v.
    slope: f64,
    /// Whether some of the lines reach the sky.
    sees_sky: bool,
    /// Whether the surface at the end of the leg is smooth, so that light continues by reflection
    /// or refraction.
    is_smooth: bool,
}

impl LineRegion {
    /// Samples a direction from a point with two random numbers. Returns `None` if no line of the
    /// region passes through the point.
    fn sample(&self, from: DVec3, random: [f64; 2]) -> Option<DVec3> {
        let slopes = self.slopes(from)?;
        let [u, v] = [0, 1].map(|axis: usize| {
            let [low, high] = slopes[axis];
            low + random[axis] * (high - low)
        });
        let along = self.frame.vector_to_world(DVec3::new(u, v, 1.0));
        Some(along.normalize())
    }

    /// The density of [`Self::sample`] per solid angle.
    fn density(&self, from: DVec3, along: DVec3) -> f64 {
        let Some(slopes) = self.slopes(from) else {
            return 0.0;
        };
        let local = self.frame.vector_to_local(along);
        let [u, v] = [local.x, local.y].map(|across| across / local.z);
        let is_within = |x: f64, [low, high]: [f64; 2]| low <= x && x <= high;
        if local.z <= 0.0 || !is_within(u, slopes[0]) || !is_within(v, slopes[1]) {
            return 0.0;
        }
        let area: f64 = slopes.iter().map(|[low, high]| high - low).product();
        // Slopes are drawn uniformly; dω = du dv / (1 + u² + v²)^(3/2).
        let squared = 1.0 + u * u + v * v;
        squared * squared.sqrt() / area
    }

    /// The intervals in which u and v lie for lines through a point. For a point behind the
    /// end of the leg, positions do not limit the slopes.
    fn slopes(&self, from: DVec3) -> Option<[[f64; 2]; 2]> {
        let from = self.frame.to_local(from);
        let distance = -from.z;
        let interval = |x: f64| {
            if distance <= 0.0 {
                return Some([-self.slope, self.slope]);
            }
            let low = ((-self.position - x) / distance).max(-self.slope);
            let high = ((self.position - x) / distance).min(self.slope);
            (low < high).then_some([low, high])
        };
        Some([interval(from.x)?, interval(from.y)?])
    }

    fn include(&mut self, seen: &TwoPlane) {
        let larger = |a: f64, b: f64| MARGIN * a.abs().max(b.abs());
        self.position = self.position.max(larger(seen.x, seen.y));
        self.slope = self.slope.max(larger(seen.u, seen.v));
    }
}

/// A surface point that light leaves, with its directional intensity.
pub(super) struct LightSource<'s> {
    pub(super) position: DVec3,
    /// Flux per solid angle along a direction, W sr⁻¹.
    pub(super) intensity: &'s dyn Fn(DVec3) -> f64,
    /// Density per solid angle with which photons continue along a direction and are recorded.
    pub(super) density: &'s dyn Fn(DVec3) -> f64,
    /// Number of surfaces that the light has met so far, including this surface.
    pub(super) met: u32,
}

/// The windows of a probe, to which photons are connected.
#[derive(Debug)]
pub(super) struct WindowConnector<'a> {
    probe: &'a Probe<'a>,
    /// The region of each leg.
    regions: Vec<LineRegion>,
    /// For each plane, the reason why connections miss some of its light.
    pub(super) misses: Vec<Option<&'static str>>,
}

impl<'a> WindowConnector<'a> {
    /// Traces lines back from all windows to find the objects that are seen through the windows.
    pub(super) fn new(probe: &'a Probe<'a>, seed: u64) -> Self {
        let region = |leg: usize| {
            let planes = probe.planes.iter().filter(|plane| plane.leg == leg);
            let end = &probe.legs[leg].frame;
            let position = planes.map(|VirtualPlane { window, frame, .. }| {
                let distance = (end.origin - frame.origin).length();
                window.x.half_width() + window.u.half_width() * distance
            });
            LineRegion {
                frame: *end,
                position: position.fold(0.0, f64::max),
                slope: probe.legs[leg].slope,
                sees_sky: false,
                is_smooth: false,
            }
        };
        let mut found = Self {
            probe,
            regions: (0..probe.legs.len()).map(region).collect(),
            misses: Vec::new(),
        };
        found.misses = probe
            .planes
            .iter()
            .zip(0_u64..)
            .map(|(plane, i)| {
                let lines = i * LINES..(i + 1) * LINES;
                // All lines are traced, because each may enlarge a region.
                lines.fold(None, |missed, number| {
                    let mut numbers = PathNumbers::new(seed, number);
                    missed.or(found.explore(plane, &mut numbers))
                })
            })
            .collect();
        found
    }

    /// Follows a line back from a window through smooth surfaces, and enlarges the regions of the
    /// legs. Returns the reason why no connection can find light along this line.
    fn explore(
        &mut self,
        plane: &VirtualPlane,
        numbers: &mut PathNumbers<'_>,
    ) -> Option<&'static str> {
        const SMOOTH: &str = "a smooth surface";
        let Probe { paths, legs, .. } = self.probe;
        let mut leg = plane.leg;
        let half = [plane.window.x, plane.window.u].map(|profile| profile.half_width());
        let [x, y, u, v] = numbers.draw().map(|drawn: f64| 2.0 * drawn - 1.0);
        let seen = TwoPlane {
            x: half[0] * x,
            y: half[0] * y,
            u: half[1] * u,
            v: half[1] * v,
        };
        let mut line = legs[leg].line(&paths.geometry, &plane.frame, &seen);
        loop {
            let Some(hit) = paths.stopped(&line, numbers) else {
                self.regions[leg].sees_sky |= paths.has_sky();
                return None;
            };
            let scatter = paths.scatter(&hit);
            if !scatter.has_mirror() {
                return None;
            }
            let wo = hit.frame.transpose() * -line.along;
            let bounce = scatter.sample(&hit.point, wo, numbers.draw())?;
            if bounce.density.is_some() {
                return None;
            }
            let along = (hit.frame * bounce.wi).normalize();
            leg += 1;
            let next = legs.get(leg).filter(|leg| leg.shape == Some(hit.shape));
            let Some(next) = next.filter(|leg| -along.dot(leg.frame.d) > 0.0) else {
                return Some(SMOOTH);
            };
            let seen = seen_by(&next.frame, hit.position, -along);
            if MARGIN * seen.u.abs().max(seen.v.abs()) > STEEPEST {
                return Some(SMOOTH);
            }
            self.regions[leg].is_smooth = true;
            self.regions[leg].include(&seen);
            line = Ray::new(hit.position, along);
        }
    }

    /// For each leg, samples a direction from a light source towards the windows of the leg.
    /// Records the light along this direction if nothing occludes it.
    pub(super) fn connect(
        &self,
        source: &LightSource<'_>,
        numbers: &mut PathNumbers<'_>,
        record: &mut dyn FnMut(usize, Crossing),
    ) {
        for number in 0..self.regions.len() {
            let drawn = numbers.draw();
            if !self.is_counted(number, source.met) {
                continue;
            }
            let region = &self.regions[number];
            let Some(along) = region.sample(source.position, drawn) else {
                continue;
            };
            let density = region.density(source.position, along);
            let flux = || (source.intensity)(along) / (density + (source.density)(along));
            self.pass(number, (source.position, along), &flux, numbers, record);
        }
    }

    /// Records a photon that continues from a source in a direction drawn with the density
    /// `density`, if windows see it. [`Self::connect`] finds the same light, so both results are
    /// combined by the balance heuristic (Veach and Guibas 1995).
    pub(super) fn continued(
        &self,
        (position, met): (DVec3, u32),
        (along, flux, density): (DVec3, f64, f64),
        numbers: &mut PathNumbers<'_>,
        record: &mut dyn FnMut(usize, Crossing),
    ) {
        for number in 0..self.regions.len() {
            let connected = self.regions[number].density(position, along);
            if connected > 0.0 && self.is_counted(number, met) {
                let flux = || flux * density / (density + connected);
                self.pass(number, (position, along), &flux, numbers, record);
            }
        }
    }

    /// Checks whether light that has met `met` surfaces counts as light on a leg.
    fn is_counted(&self, leg: usize, met: u32) -> bool {
        let paths = self.probe.paths;
        let all = met.saturating_add(u32::try_from(leg).unwrap_or(u32::MAX));
        all <= paths.depth && !(paths.hides_sources && all == 0)
    }

    /// Records light of the sky that reaches the windows directly or by reflection in smooth
    /// surfaces.
    pub(super) fn connect_sky(
        &self,
        numbers: &mut PathNumbers<'_>,
        record: &mut dyn FnMut(usize, Crossing),
    ) {
        let Probe { paths, legs, .. } = self.probe;
        let geometry = &paths.geometry;
        for (number, (leg, region)) in legs.iter().zip(&self.regions).enumerate() {
            if !region.sees_sky || !self.is_counted(number, 0) {
                continue;
            }
            let drawn: [f64; 4] = numbers.draw();
            let [x, y, u, v] = drawn.map(|drawn| 2.0 * drawn - 1.0);
            let [u, v] = [u, v].map(|side| side * region.slope);
            let at_end = [x, y].map(|side| side * region.position);
            let at_end = leg.frame.to_world(DVec3::new(at_end[0], at_end[1], 0.0));
            let along = leg.frame.vector_to_world(DVec3::new(u, v, 1.0)).normalize();
            let radiance = paths.shown(&Ray::new(at_end, -along), None, 1);
            let outside = at_end.distance(geometry.center) + 2.0 * geometry.radius;
            let volume = (4.0 * region.position * region.slope).powi(2);
            let flux = || radiance * volume / (1.0 + u * u + v * v).powi(2);
            let from = at_end - outside * along;
            self.pass(number, (from, along), &flux, numbers, record);
        }
    }

    /// Records light that travels from a point along a leg in all windows of this leg. If the
    /// surface at the end of the leg is smooth, passes the light on to the next leg.
    fn pass(
        &self,
        number: usize,
        (from, along): (DVec3, DVec3),
        flux: &dyn Fn() -> f64,
        numbers: &mut PathNumbers<'_>,
        record: &mut dyn FnMut(usize, Crossing),
    ) {
        let Probe { legs, planes, .. } = self.probe;
        let of_leg = planes
            .iter()
            .enumerate()
            .filter(|(_, plane)| plane.leg == number);
        let seen = of_leg.filter_map(|(i, plane)| {
            let ray = seen_by(&plane.frame, from, along);
            plane.window.contains(&ray).then_some((i, ray))
        });
        let seen: Vec<(usize, TwoPlane)> = seen.collect();
        let end = self.smooth_end(number, from, along);
        if seen.is_empty() && end.is_none() {
            return;
        }
        let flux = flux();
        if flux <= 0.0 {
            return;
        }
        let flux = flux * self.transmittance(number, from, along);
        if flux <= 0.0 {
            return;
        }
        for (i, ray) in seen {
            // An element du dv dx dy of light has the flux L du dv dx dy / (1 + u² + v²)².
            let weight = flux * (1.0 + ray.u * ray.u + ray.v * ray.v).powi(2);
            record(i, Crossing { ray, weight });
        }
        let Some(hit) = end else {
            return;
        };
        let paths = self.probe.paths;
        let scatter = paths.scatter(&hit);
        let arriving = hit.frame.transpose() * -along;
        let Some(bounce) = scatter.sample(&hit.point, arriving, numbers.draw()) else {
            return;
        };
        let onward = (hit.frame * bounce.wi).normalize();
        if bounce.density.is_none() && onward.dot(legs[number - 1].frame.d) > 0.0 {
            let share = bounce.weight * scatter.squared_index(arriving, bounce.wi);
            let flux = || flux * share * paths.opacity(&hit);
            self.pass(number - 1, (hit.position, onward), &flux, numbers, record);
        }
    }

    /// The point at which a line meets the smooth surface at the end of a leg. Returns
    /// `None` if the leg does not end at a smooth surface, or if windows do not see the line at
    /// this point.
    fn smooth_end(&self, number: usize, from: DVec3, along: DVec3) -> Option<Hit> {
        let region = &self.regions[number];
        if !region.is_smooth {
            return None;
        }
        let hit = self.probe.legs[number].start(&self.probe.paths.geometry, from, along)?;
        let at = seen_by(&self.probe.legs[number].frame, hit.position, along);
        (at.x.abs().max(at.y.abs()) <= region.position).then_some(hit)
    }

    /// Traces the line through a point back from the end of a leg, and returns the share of light
    /// that passes between this point and the end.
    fn transmittance(&self, leg: usize, position: DVec3, along: DVec3) -> f64 {
        let Probe { paths, legs, .. } = self.probe;
        let line = legs[leg].through(&paths.geometry, position, along);
        // If the line begins at the point itself, light leaves from the other side of the surface.
        let between = position - line.from;
        let is_before = between.dot(line.along) > 1e-6 * legs[leg].position;
        if !is_before {
            return 0.0;
        }
        let distance = between.length();
        paths.transmittance(&Ray::new(line.from, between / distance), distance)
    }
}
