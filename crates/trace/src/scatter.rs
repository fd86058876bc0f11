use crate::emit::LAMBERTIAN;
use crate::proposal::Aim;
use etendue_field::{TwoPlane, random};
use etendue_scene::{Emission, Scene};
use std::f64::consts::TAU;

/// How light leaves the surface that the central ray visits, diffusely: a density over slopes at each of its
/// points, and a way to sample it. Rays are in the frame in which light leaves the surface.
#[derive(Clone, Debug)]
pub(crate) struct Scatterer {
    /// One aim for each plane after the reflection, along X and along Y; empty for plain scattering.
    aims: Vec<[Aim; 2]>,
}

impl Scatterer {
    /// `None` when no plane looks at the light that the surface reflects.
    pub(crate) fn new(scene: &Scene) -> Option<Self> {
        let after: Vec<_> = scene.planes.iter().filter(|p| p.reflections > 0).collect();
        if after.is_empty() {
            return None;
        }
        let aims = match scene.run.emission {
            Emission::Aimed => after
                .iter()
                .map(|plane| {
                    let (w, d) = (&plane.window, plane.distance - scene.path.length);
                    [Aim::new(d, &w.x, &w.u), Aim::new(d, &w.y, &w.v)]
                })
                .collect(),
            Emission::Plain => Vec::new(),
        };
        Some(Self { aims })
    }

    /// A ray that leaves from (x, y), and its density with respect to du dv; `None` when the chosen plane
    /// cannot be reached from there.
    #[inline]
    pub(crate) fn sample(&self, [x, y]: [f64; 2], words: [u32; 4]) -> Option<(TwoPlane, f64)> {
        let r = words.map(random::unit);
        if self.aims.is_empty() {
            let (sin, cos) = (TAU * r[1]).sin_cos();
            let slope = (r[0] / (1.0 - r[0])).sqrt();
            let [u, v] = [slope * cos, slope * sin];
            let ray = TwoPlane { x, y, u, v };
            let secant_squared = ray.secant_squared();
            return Some((ray, 1.0 / (LAMBERTIAN * secant_squared * secant_squared)));
        }
        let [along_x, along_y] = &self.aims[random::index(words[2], self.aims.len())];
        let [u, v] = [along_x.sample(x, r[0])?, along_y.sample(y, r[1])?];
        let densities = self
            .aims
            .iter()
            .map(|[a, b]| a.density(x, u) * b.density(y, v));
        let density = densities.sum::<f64>() / self.aims.len() as f64;
        (density > 0.0).then_some((TwoPlane { x, y, u, v }, density))
    }
}
