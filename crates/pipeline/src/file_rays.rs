//! The rays of a ray file, each once, in place of photons.

use etendue_field::{Crossing, Ledger, Mask, PhotonSource, TwoPlane};
use etendue_predict::Applicability;
use etendue_scene::Scene;
use etendue_store::Failure;
use etendue_theory::geometry::AffineMap;
use etendue_theory::{ChainAction, ChainStep};

/// Number of rays that are recorded at a time.
const BLOCK: usize = 4096;

/// The rays of a file that is the light of a scene. Ray i is in batch i modulo the number of
/// batches, so that the spread between batches tells how well the rays represent the light.
#[derive(Debug)]
pub(crate) struct FileRays {
    /// The rays of each batch, at the light.
    batches: Vec<Vec<Crossing>>,
    /// The steps from the light to each plane.
    chains: Vec<Vec<FileRayStep>>,
}

impl FileRays {
    /// The rays of a scene's light at its planes.
    ///
    /// # Errors
    /// When the light is no ray file, when the file has fewer rays than the scene has batches, or
    /// when a plane lies behind a surface.
    pub(crate) fn new(scene: &Scene) -> Result<Self, Failure> {
        let Some(rays) = scene.light.listed() else {
            let what = "the light is no ray file, so no rays are given; use another --method";
            return Err(Failure::bad_input(what));
        };
        let (rays, count) = (rays.rays(), scene.run.batches as usize);
        if rays.len() < count {
            return Err(Failure::bad_input(format!(
                "the file has {} rays that go forward; allowed: at least one for each of {count} batches",
                rays.len()
            )));
        }
        let mut batches = vec![Vec::with_capacity(rays.len() / count + 1); count];
        for (i, of) in rays.iter().enumerate() {
            let secant_squared = of.ray.secant_squared();
            batches[i % count].push(Crossing {
                ray: of.ray,
                weight: of.flux * secant_squared * secant_squared,
            });
        }
        // The mean over batches, each divided by its number of rays, is the sum over all rays.
        for batch in &mut batches {
            let scale = (count * batch.len()) as f64;
            batch.iter_mut().for_each(|ray| ray.weight *= scale);
        }
        let chains = scene.planes.iter().map(|plane| {
            let steps = Applicability::new(scene, plane).chain_steps(scene, plane);
            let known = steps.and_then(|steps| steps.into_iter().map(FileRayStep::of).collect());
            known.ok_or_else(|| {
                Failure::bad_input(format!(
                    "given rays do not reach plane {}; allowed: planes perpendicular to the central ray, before the first surface",
                    plane.name
                ))
            })
        });
        Ok(Self {
            batches,
            chains: chains.collect::<Result<_, _>>()?,
        })
    }
}

/// A step of a chain that acts on one ray at a time.
#[derive(Debug)]
enum FileRayStep {
    Map(AffineMap<4>),
    Mask(Mask),
}

impl FileRayStep {
    fn of(step: ChainStep) -> Option<Self> {
        match step.action {
            ChainAction::Map(map) => Some(Self::Map(map.rays())),
            ChainAction::Mask(mask) => Some(Self::Mask(mask)),
            ChainAction::SlopeCosine | ChainAction::AngleCosine | ChainAction::Other => None,
        }
    }
}

/// A ray after the steps of a chain.
fn after(steps: &[FileRayStep], Crossing { ray, mut weight }: Crossing) -> Crossing {
    let mut z = [ray.x, ray.y, ray.u, ray.v];
    for step in steps {
        match step {
            FileRayStep::Map(map) => z = map.apply(z),
            FileRayStep::Mask(mask) => weight *= mask.transmittance(z[0], z[1]),
        }
    }
    let [x, y, u, v] = z;
    let ray = TwoPlane { x, y, u, v };
    Crossing { ray, weight }
}

impl PhotonSource for FileRays {
    fn emitted(&self, batch: u32) -> u64 {
        self.batches[batch as usize].len() as u64
    }

    fn emit_part(
        &self,
        batch: u32,
        _part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        for block in self.batches[batch as usize].chunks(BLOCK) {
            for (plane, steps) in self.chains.iter().enumerate() {
                let there = block.iter().map(|ray| after(steps, *ray));
                let there: Vec<Crossing> = there.filter(|ray| ray.weight > 0.0).collect();
                record(plane, &there);
            }
            progress(block.len() as u64);
        }
        Ledger::default()
    }
}
