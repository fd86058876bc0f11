use crate::proposal::Proposal;
use etendue_field::{TwoPlane, random};
use etendue_scene::{Emission, Light, Scene};
use std::f64::consts::{PI, TAU};

/// How rays leave the light: a density over (x, y, u, v) at the light, and a way to sample it.
#[derive(Clone, Debug)]
pub struct Emitter {
    light: Light,
    /// One proposal for each plane, as factors over (x, u) and (y, v); empty for plain emission.
    proposals: Vec<[Proposal; 2]>,
}

impl Emitter {
    /// The emitter of a scene.
    ///
    /// Aimed emission is a mixture, with equal shares, of one proposal for each virtual plane whose window
    /// the light reaches. Where it reaches none, emission is plain: every window stays empty all the same.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let light = scene.light;
        let proposal = |plane: &etendue_field::VirtualPlane| {
            let (w, d) = (&plane.window, plane.distance);
            let extent = |axis| light.rectangle.extent(axis);
            Some([
                Proposal::new(d, extent(0), &w.x, &w.u)?,
                Proposal::new(d, extent(1), &w.y, &w.v)?,
            ])
        };
        let proposals = match scene.run.emission {
            Emission::Aimed => scene.planes.iter().filter_map(proposal).collect(),
            Emission::Plain => Vec::new(),
        };
        Self { light, proposals }
    }

    /// A ray from eight random words.
    #[inline]
    #[must_use]
    pub fn sample(&self, words: [[u32; 4]; 2]) -> TwoPlane {
        let r = words[0].map(random::unit);
        if self.proposals.is_empty() {
            return self.plain(r);
        }
        let last = self.proposals.len() - 1;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number in 0..count"
        )]
        let which = (random::unit(words[1][0]) * self.proposals.len() as f64) as usize;
        let [along_x, along_y] = &self.proposals[which.min(last)];
        let [x, u] = along_x.sample([r[0], r[1]]);
        let [y, v] = along_y.sample([r[2], r[3]]);
        TwoPlane { x, y, u, v }
    }

    /// Uniform over the light's area, by the cosine over direction.
    fn plain(&self, r: [f64; 4]) -> TwoPlane {
        let [x, y] = [0, 1].map(|axis| {
            let [low, high] = self.light.rectangle.extent(axis);
            low + r[axis] * (high - low)
        });
        // A uniform point of the unit disc lies below a direction that follows the cosine.
        let (sin, cos) = (TAU * r[3]).sin_cos();
        let slope = (r[2] / (1.0 - r[2])).sqrt();
        TwoPlane {
            x,
            y,
            u: slope * cos,
            v: slope * sin,
        }
    }

    /// The density of [`Self::sample`] with respect to dx dy du dv.
    #[inline]
    #[must_use]
    pub fn density(&self, ray: &TwoPlane) -> f64 {
        if self.proposals.is_empty() {
            // cos θ dω / π = du dv / (π (1 + u² + v²)²)
            let secant_squared = ray.secant_squared();
            return 1.0 / (self.light.rectangle.area() * PI * secant_squared * secant_squared);
        }
        let sum: f64 = self
            .proposals
            .iter()
            .map(|[along_x, along_y]| {
                along_x.density([ray.x, ray.u]) * along_y.density([ray.y, ray.v])
            })
            .sum();
        sum / self.proposals.len() as f64
    }

    /// Radiance over density: what a sampled ray stands for in radiance space.
    #[inline]
    #[must_use]
    pub fn weight(&self, ray: &TwoPlane) -> f64 {
        let density = self.density(ray);
        // Rounding can put a ray on the very edge, where the density is zero: it carries nothing.
        if density > 0.0 {
            self.light.radiance / density
        } else {
            0.0
        }
    }
}
