//! One path of light from a lamp to the plane, for a point of the unit cube.

use super::lamp::{Lamp, Start};
use super::world::{Leaves, PlainSurface, PlainWorld, START};
use crate::second::masks::value;
use crate::second::vector::{Vector, distance, dot, length, plus, times, unit};

/// Numbers that a path may use: four at an environment, two at each surface and at the plane.
pub(super) const NUMBERS: usize = 14;

/// A point of the unit cube, whose coordinates are used in pairs.
pub(super) struct Draws<'a> {
    numbers: &'a [f64; NUMBERS],
    used: usize,
}

impl Draws<'_> {
    pub(super) fn next(&mut self) -> [f64; 2] {
        self.used += 2;
        [self.numbers[self.used - 2], self.numbers[self.used - 1]]
    }
}

/// What sends light into all directions.
enum Emitter<'a> {
    Lamp(&'a Lamp),
    Surface(&'a PlainSurface, Vector),
}

/// Light at a point.
struct Light<'a> {
    at: Vector,
    /// The flux, or flux per emission.
    weight: f64,
    /// The only direction of the light, unless an emitter sends it into all directions.
    along: Result<Vector, Emitter<'a>>,
    /// The surface that the light has left.
    left: Option<usize>,
}

/// A ray of the window, and the point of the last surface where it begins.
struct Seen {
    point: Vector,
    along: Vector,
    /// The window's weight times the range of rays in the window.
    weight: f64,
    /// The distance from the point to the plane.
    ahead: f64,
}

/// How a path is chosen.
#[derive(Clone, Copy, Debug)]
pub(super) enum Choice {
    /// From the lamp to the plane.
    Forward,
    /// From the lamp to the point of the last surface that a ray of the window sees. This takes a
    /// surface that scatters, and light that can be sent there.
    Connected,
}

impl PlainWorld {
    /// The light that a path brings into the window: flux times (1 + u² + v²)² times the
    /// window. The mean over the unit cube is the spectrum at zero frequency, ∫ L W.
    pub(super) fn light(&self, lamp: &Lamp, choice: Choice, numbers: &[f64; NUMBERS]) -> f64 {
        let mut draws = Draws { numbers, used: 0 };
        self.path(lamp, choice, &mut draws).unwrap_or(0.0)
    }

    /// Whether paths of a lamp may be connected.
    pub(super) fn connects(&self, lamp: &Lamp) -> bool {
        let scatters = |visit: &usize| self.surfaces[*visit].scatters();
        match &self.visits[..] {
            [] => false,
            [only] => scatters(only) && !lamp.is_beam(),
            [.., before, last] => scatters(before) && scatters(last),
        }
    }

    fn path(&self, lamp: &Lamp, choice: Choice, draws: &mut Draws<'_>) -> Option<f64> {
        if self.visits.is_empty() && lamp.is_far() {
            return self.environment(lamp, draws);
        }
        let seen = match choice {
            Choice::Forward => None,
            Choice::Connected => Some(self.seen(draws)?),
        };
        // The point of the first surface to which light is sent from far away.
        let mut aimed = None;
        let mut light = match lamp.start(draws) {
            Start::At(at, weight) => Light {
                at,
                weight,
                along: Err(Emitter::Lamp(lamp)),
                left: None,
            },
            Start::Along(at, along, weight) => Light {
                at,
                weight,
                along: Ok(along),
                left: None,
            },
            Start::Far(along, per_density) => {
                let surface = &self.surfaces[*self.visits.first()?];
                let (point, area) = match &seen {
                    Some(seen) if self.visits.len() == 1 => (seen.point, 1.0),
                    _ => surface.point(draws.next()),
                };
                let cosine = dot(along, surface.normal(point)).abs();
                aimed = Some(point);
                Light {
                    at: lamp.origin(point, along)?,
                    weight: per_density * area * cosine,
                    along: Ok(along),
                    left: None,
                }
            }
        };
        for (i, visit) in self.visits.iter().enumerate() {
            let seen = seen.as_ref().filter(|_| i + 1 == self.visits.len());
            let arrives = aimed.take().or(seen.map(|seen| seen.point));
            light = self.visit(&light, *visit, arrives, draws)?;
        }
        let Some(Seen {
            along,
            weight,
            ahead,
            ..
        }) = seen
        else {
            return self.at_plane(&light, draws);
        };
        let Err(Emitter::Surface(surface, arrived)) = light.along else {
            return None;
        };
        // Radiance is flux per solid angle over the cosine, here for light per area.
        let cosine = dot(along, surface.normal(light.at)).abs();
        let passes = self.passes(&light, along, ahead, self.end, false) * weight;
        if passes <= 0.0 {
            return None;
        }
        let radiance = light.weight * surface.scattered(light.at, arrived, along) / cosine;
        Some(radiance * passes)
    }

    /// Draws a ray of the window and follows its line back to the last surface. If the line meets
    /// the surface more than once, only its last point sends light along it.
    fn seen(&self, draws: &mut Draws<'_>) -> Option<Seen> {
        let (point, along, weight) = self.ray(draws);
        let surface = &self.surfaces[*self.visits.last()?];
        let ahead = -surface.hits(point, along).pop()?;
        Some(Seen {
            point: plus(point, -ahead, along),
            along,
            weight,
            ahead,
        })
    }

    /// The light after its next surface. If the point where it `arrives` is given, light is
    /// per area there; it is lost if it meets another part of the surface before.
    fn visit(
        &self,
        light: &Light<'_>,
        visit: usize,
        arrives: Option<Vector>,
        draws: &mut Draws<'_>,
    ) -> Option<Light<'_>> {
        let surface = &self.surfaces[visit];
        let (point, along, area) = match &light.along {
            Ok(along) => {
                let first = || {
                    let hits = surface.hits(light.at, *along);
                    let t = hits.into_iter().find(|t| *t > self.begins(light.at))?;
                    Some(plus(light.at, t, *along))
                };
                (arrives.or_else(first)?, *along, 1.0)
            }
            Err(_) => {
                let (point, area) = match arrives {
                    Some(point) => (point, 1.0),
                    None => surface.point(draws.next()),
                };
                let along = unit(plus(point, -1.0, light.at));
                (point, along, area * dot(along, surface.normal(point)).abs())
            }
        };
        let passes = self.passes(light, along, distance(light.at, point), Some(visit), true);
        let weight = light.flux(along, point, passes * area);
        if weight <= 0.0 {
            return None;
        }
        let along = match surface.leaves(point, along) {
            Leaves::Along(to) => Ok(to),
            Leaves::Scattered => Err(Emitter::Surface(surface, along)),
            Leaves::Nowhere => return None,
        };
        Some(Light {
            at: point,
            weight,
            along,
            left: Some(visit),
        })
    }

    fn at_plane(&self, light: &Light<'_>, draws: &mut Draws<'_>) -> Option<f64> {
        let plane = &self.plane;
        let (point, along, area) = match &light.along {
            Ok(along) => {
                let [.., height] = plane.coordinates(light.at);
                let t = -height / dot(*along, plane.d);
                (plus(light.at, t, *along), *along, 1.0)
            }
            Err(_) => {
                let (at, area) = self.lit(light.at, draws.next())?;
                let point = plane.point(at);
                let towards = unit(plus(point, -1.0, light.at));
                let along = times(dot(towards, plane.d).signum(), towards);
                (point, along, area * dot(along, plane.d))
            }
        };
        let [dx, dy, dz] = plane.components(along);
        let ahead = dot(plus(point, -1.0, light.at), along);
        // A plane that cuts a surface also counts light that leaves the surface beyond the plane.
        if dz <= 0.0 || (ahead <= 0.0 && light.left.is_none()) {
            return None;
        }
        let [x, y, _] = plane.coordinates(point);
        let weight = self.weight([x, y, dx / dz, dy / dz]);
        if weight <= 0.0 {
            return None;
        }
        let passes = self.passes(light, along, ahead, self.end, false);
        Some(light.flux(along, point, passes * area) * weight / dz.powi(4))
    }

    /// The light of an environment at a plane of the first leg, for a ray of the window.
    fn environment(&self, lamp: &Lamp, draws: &mut Draws<'_>) -> Option<f64> {
        let (point, along, weight) = self.ray(draws);
        let from = lamp.origin(point, along)?;
        let light = Light {
            at: from,
            weight: 1.0,
            along: Ok(along),
            left: None,
        };
        let ahead = dot(plus(point, -1.0, from), along);
        let passes = self.passes(&light, along, ahead, self.end, false);
        Some(lamp.radiance(along) * passes * weight)
    }

    /// Draws a ray of the window: its point in the plane, its direction, and the window's weight
    /// times the range of rays.
    fn ray(&self, draws: &mut Draws<'_>) -> (Vector, Vector, f64) {
        let (at, area) = self.place(draws.next());
        let halves = [self.window[2], self.window[3]].map(|profile| profile.half_width());
        let [a, b] = draws.next();
        let [u, v] = [(2.0 * a - 1.0) * halves[0], (2.0 * b - 1.0) * halves[1]];
        let weight = area * 4.0 * halves[0] * halves[1] * self.weight([at[0], at[1], u, v]);
        let along = unit(self.plane.vector([u, v, 1.0]));
        (self.plane.point(at), along, weight)
    }

    /// A point of the window's support in the plane, and the area of the support.
    fn place(&self, [a, b]: [f64; 2]) -> (Vector, f64) {
        let [x, y] = [self.window[0], self.window[1]].map(|profile| profile.half_width());
        let at = [(2.0 * a - 1.0) * x, (2.0 * b - 1.0) * y, 0.0];
        (at, 4.0 * x * y)
    }

    /// A point of the part of the plane from which light of a point has slopes in the window,
    /// and the area of this part.
    fn lit(&self, from: Vector, numbers: [f64; 2]) -> Option<(Vector, f64)> {
        let [x, y, z] = self.plane.coordinates(from);
        let (mut at, mut area) = ([0.0; 3], 1.0);
        for (axis, from) in [x, y].into_iter().enumerate() {
            let half = self.window[axis].half_width();
            let reach = z.abs() * self.window[axis + 2].half_width();
            let [low, high] = [(from - reach).max(-half), (from + reach).min(half)];
            if low >= high {
                return None;
            }
            at[axis] = low + (high - low) * numbers[axis];
            area *= high - low;
        }
        Some((at, area))
    }

    fn weight(&self, at: [f64; 4]) -> f64 {
        let each = self.window.iter().zip(at);
        each.map(|(profile, t)| value(profile, t, "")).product()
    }

    /// The distance up to which hits are the origin of a ray itself.
    fn begins(&self, at: Vector) -> f64 {
        START * (1.0 + length(at) + length(self.plane.origin))
    }

    /// The share of light that travels a distance. The surface `end` stops no light; if the
    /// light arrives at it (`arrives`), it must be the first hit.
    fn passes(
        &self,
        light: &Light<'_>,
        along: Vector,
        to: f64,
        end: Option<usize>,
        arrives: bool,
    ) -> f64 {
        let from = self.begins(light.at);
        for (i, surface) in self.surfaces.iter().enumerate() {
            let is_end = Some(i) == end;
            let limit = if Some(i) == light.left {
                // Light is lost if its line meets the surface again, even beyond the end.
                f64::INFINITY
            } else if is_end && !arrives {
                continue;
            } else if is_end {
                to * (1.0 - 1e-7) - from
            } else {
                to
            };
            let is_met = |t: &f64| *t > from && *t < limit;
            if surface.hits(light.at, along).iter().any(is_met) {
                return 0.0;
            }
        }
        let masks = self.masks.iter();
        masks
            .map(|mask| mask.passes(light.at, along, [from, to]))
            .product()
    }
}

impl Light<'_> {
    /// The flux that reaches a point through an area orthogonal to the direction; light that
    /// has only one direction does not spread, so the area is a share of its flux.
    fn flux(&self, along: Vector, point: Vector, area: f64) -> f64 {
        // Some BRDFs take long.
        if area <= 0.0 {
            return 0.0;
        }
        let per_angle = match &self.along {
            Ok(_) => return self.weight * area,
            Err(Emitter::Lamp(lamp)) => lamp.emits(along),
            Err(Emitter::Surface(surface, arrived)) => surface.scattered(self.at, *arrived, along),
        };
        self.weight * per_angle * area / distance(self.at, point).powi(2)
    }
}
