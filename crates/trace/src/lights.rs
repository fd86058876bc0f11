//! Traces several lights, each by a tracer of its own.

use crate::ahead::emit_group;
use crate::emit::Emitter;
use crate::numbers::Numbers;
use crate::photon_group::PHOTONS_PER_GROUP;
use crate::tracer::MAX_REDUCED_PHOTONS;
use crate::{Backward, LightNotFound, Tracer};
use etendue_field::{Crossing, Ledger, PhotonSource};
use etendue_scene::{RunSettings, Scene};
use etendue_transform::random::{self, Stream};
use fearless_simd::Level;

/// A source of the light of all lights of a scene. Each light has a tracer with its own random
/// numbers, and all tracers together trace the photons of the scene.
///
/// A batch has photons of each light. Their weights are multiplied by the ratio of the photons of
/// the batch to the photons of the light in the batch, so that the light of all lights adds up.
#[derive(Debug)]
pub struct AllLights<S> {
    lights: Vec<TracedScene<S>>,
    is_precise: bool,
}

/// A light with its tracer.
#[derive(Debug)]
struct TracedScene<S> {
    source: S,
    /// For each plane that the light may reach, the index of this plane in the whole scene.
    planes: Vec<usize>,
}

/// The number of photons from which the power of a light is estimated.
const TRIED: u64 = 1 << 14;
/// The share of the photons that is divided equally, so that no light is left to a few photons.
const EQUAL: f64 = 0.1;
/// Shares of photons are rounded to multiples of 2⁻²⁰, so they do not depend on rounding errors of
/// the power.
const SHARES: f64 = 1_048_576.0;

impl AllLights<Tracer> {
    /// Builds the tracers of photons ([`Tracer::new`]). The photons are divided by the power of the
    /// lights.
    #[must_use]
    pub fn photons(scene: &Scene) -> Self {
        Self::of_power(scene, Emitter::new, Tracer::new)
    }

    /// Builds the tracers that check them ([`Tracer::with_uniform_emission`]).
    #[must_use]
    pub fn with_uniform_emission(scene: &Scene) -> Self {
        Self::of_power(
            scene,
            Emitter::with_uniform_emission,
            Tracer::with_uniform_emission,
        )
    }

    /// Builds the tracers of two scenes with equally many lights ([`Tracer::pair`]). The photons of
    /// both are divided by the power of the lights of the first.
    #[must_use]
    pub fn pair(scenes: [&Scene; 2]) -> [Self; 2] {
        let powers = powers(scenes[0], Emitter::new);
        let [of_a, of_b] = scenes.map(|scene| divided(scene, &powers));
        let lights = of_a.zip(of_b).map(|((a, planes_of_a), (b, planes_of_b))| {
            let [a, b] = Tracer::pair([&a, &b]);
            let traced = |source, planes| TracedScene { source, planes };
            (traced(a, planes_of_a), traced(b, planes_of_b))
        });
        let (a, b): (Vec<_>, Vec<_>) = lights.unzip();
        [Self::new(scenes[0], a), Self::new(scenes[1], b)]
    }

    fn of_power(
        scene: &Scene,
        emitter: impl Fn(&Scene) -> Emitter,
        tracer: impl Fn(&Scene) -> Tracer,
    ) -> Self {
        let powers = powers(scene, emitter);
        let lights = divided(scene, &powers).map(|(of, planes)| TracedScene {
            source: tracer(&of),
            planes,
        });
        Self::new(scene, lights.collect())
    }
}

impl AllLights<Backward> {
    /// Builds the tracers of backward rays ([`Backward::new`]). The rays are divided equally among
    /// the lights.
    ///
    /// # Errors
    /// When rays from a plane cannot find a light.
    pub fn backward(scene: &Scene) -> Result<Self, LightNotFound> {
        let equal = vec![1.0; scene.lights().count()];
        let lights = divided(scene, &equal).map(|(of, planes)| {
            Ok(TracedScene {
                source: Backward::new(&of)?,
                planes,
            })
        });
        Ok(Self::new(scene, lights.collect::<Result<_, _>>()?))
    }
}

impl<S: PhotonSource> AllLights<S> {
    /// The tracer of each light, with the index in the whole scene of each plane that the
    /// light may reach.
    pub fn each(&self) -> impl Iterator<Item = (&S, &[usize])> {
        let lights = self.lights.iter();
        lights.map(|light| (&light.source, &light.planes[..]))
    }

    fn new(scene: &Scene, lights: Vec<TracedScene<S>>) -> Self {
        let is_precise = lights.iter().any(|light| light.source.is_precise());
        Self {
            is_precise: is_precise || scene.run.photons > MAX_REDUCED_PHOTONS,
            lights,
        }
    }
}

/// The seed of a light; the first light has the seed of the run.
fn seed(seed: u64, light: u64) -> u64 {
    if light == 0 {
        return seed;
    }
    let [low, high, ..] = random::words(seed, Stream::Light, light, 0);
    u64::from(low) | u64::from(high) << 32
}

/// The power of each light.
fn powers(scene: &Scene, emitter: impl Fn(&Scene) -> Emitter) -> Vec<f64> {
    let lights = scene.lights().zip(0..);
    let power = |(of, number)| power(&emitter(of), seed(scene.run.seed, number));
    lights.map(power).collect()
}

/// The flux that an emitter sends out, estimated from photons that are not measured. If
/// the emission is aimed, it is the flux within the aim.
fn power(emitter: &Emitter, seed: u64) -> f64 {
    let stream = Stream::Power;
    let numbers = Numbers::Random { seed, stream };
    let firsts = (0..TRIED).step_by(PHOTONS_PER_GROUP);
    let groups = firsts.map(|at| emit_group(emitter, Level::new(), at..TRIED, &numbers));
    let fluxes = groups.map(|group| group.fluxes.iter().sum::<f64>());
    fluxes.sum::<f64>() / TRIED as f64
}

/// The scene of each light with its share of the photons and its own seed, and the indices
/// of its planes in the whole scene.
fn divided<'a>(
    scene: &'a Scene,
    powers: &'a [f64],
) -> impl Iterator<Item = (Scene, Vec<usize>)> + 'a {
    let counts = counts(scene.run.photons, scene.run.batches, powers);
    let lights = scene.lights().zip(counts).zip(0..);
    lights.map(|((of, photons), number)| {
        let run = RunSettings {
            photons,
            seed: seed(scene.run.seed, number),
            ..scene.run
        };
        let named = (0..of.planes.len()).filter_map(|own| {
            let whole = scene.plane_named(&of.planes[own].name)?;
            Some((own, whole))
        });
        let (own, planes): (Vec<usize>, Vec<usize>) = named.unzip();
        let of = Scene {
            run,
            other_lights: Vec::new(),
            ..of.seen_at(&own)
        };
        (of, planes)
    })
}

/// Divides photons by the power of lights. Each light has at least one photon in each batch.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share is between 0 and 2²⁰"
)]
fn counts(photons: u64, batches: u32, powers: &[f64]) -> Vec<u64> {
    let all: f64 = powers.iter().sum();
    let equal = 1.0 / powers.len() as f64;
    let mut before = 0.0;
    let mut begin = 0;
    let each = powers.iter().map(|power| {
        let own = if all > 0.0 { power / all } else { equal };
        before += EQUAL * equal + (1.0 - EQUAL) * own;
        let end = u128::from(photons) * (before * SHARES).round() as u128 / SHARES as u128;
        let end = u64::try_from(end).unwrap_or(u64::MAX);
        let count = end - begin;
        begin = end;
        count.max(u64::from(batches))
    });
    each.collect()
}

impl<S: PhotonSource> TracedScene<S> {
    /// Emits a part of a batch that has `all` photons of all lights.
    fn emit_part(
        &self,
        (batch, part): (u32, u32),
        all: u64,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let factor = all as f64 / self.source.emitted(batch) as f64;
        let mut scaled = Vec::new();
        let mut record = |plane: usize, crossings: &[Crossing]| {
            scaled.clear();
            scaled.extend(crossings.iter().map(|crossing| Crossing {
                weight: factor * crossing.weight,
                ..*crossing
            }));
            record(self.planes[plane], &scaled);
        };
        let ledger = self.source.emit_part(batch, part, &mut record, progress);
        ledger.scaled(factor)
    }
}

impl<S: PhotonSource> PhotonSource for AllLights<S> {
    fn emitted(&self, batch: u32) -> u64 {
        let lights = self.lights.iter();
        lights.map(|light| light.source.emitted(batch)).sum()
    }

    fn is_precise(&self) -> bool {
        self.is_precise
    }

    fn parts(&self, batch: u32) -> u32 {
        let lights = self.lights.iter();
        lights.map(|light| light.source.parts(batch)).sum()
    }

    fn emit_part(
        &self,
        batch: u32,
        part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let all = self.emitted(batch);
        let mut first = 0;
        for light in &self.lights {
            let parts = light.source.parts(batch);
            if part < first + parts {
                return light.emit_part((batch, part - first), all, record, progress);
            }
            first += parts;
        }
        Ledger::default()
    }
}

#[cfg(test)]
mod tests {
    use super::counts;

    #[test]
    fn photons_are_divided_by_power() {
        assert_eq!(
            counts(1 << 20, 32, &[3.0, 1.0]).iter().sum::<u64>(),
            1 << 20
        );
        let [strong, weak] = counts(1_000_000, 32, &[3.0, 1.0])[..] else {
            panic!("two lights");
        };
        assert!(strong.abs_diff(725_000) < 2 && weak.abs_diff(275_000) < 2);
        assert_eq!(counts(64, 64, &[1.0, 0.0]), [64, 64]);
        assert_eq!(counts(1000, 32, &[0.0, 0.0]), [500, 500]);
    }
}
