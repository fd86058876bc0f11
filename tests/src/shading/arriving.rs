//! Computes the light of an environment that arrives at a sphere, by a quadrature that is
//! independent of the nets of theory.

use etendue_field::{Complex, Environment, Slices, TwoPlane, VirtualPlane};
use etendue_scene::Scene;
use glam::DVec3;
use std::f64::consts::TAU;

/// Two numbers of nodes of the midpoint rule. The first number is for each of x and y, and the
/// second number is for each of θ and φ. At the highest frequency, there are more than four nodes
/// per cycle.
const NODES: [usize; 2] = [40, 36];

/// A sphere in an unoccluded environment.
pub(super) struct Sphere<'a> {
    pub(super) scene: &'a Scene,
    pub(super) environment: &'a Environment,
    /// Curvature of the sphere per metre, positive if convex.
    pub(super) k: f64,
}

impl Sphere<'_> {
    /// The windowed spectrum at the scene's plane on the sphere, in local normals.
    ///
    /// `turn` is −1 if (θ, φ) are the angles of the direction from which light comes, rotated
    /// about the normal. `turn` is +1 if the angles (θ, φ) are not rotated about the normal.
    pub(super) fn slices(&self, turn: f64) -> Slices {
        let plane = &self.scene.planes[0];
        let w = &plane.window;
        let [places, angles] = NODES;
        let [xs, ys] = [w.x, w.y].map(|p| midpoints(p.half_width(), places));
        let [us, vs] = [w.u, w.v].map(|p| midpoints(p.half_width(), angles));
        let volume = [w.x, w.y, w.u, w.v]
            .iter()
            .zip([places, places, angles, angles])
            .map(|(p, n)| 2.0 * p.half_width() / n as f64)
            .product::<f64>();
        let grid = plane.grid;
        let mut slices = Slices::zeros(grid);
        let directions: Vec<[f64; 2]> = pairs(&us, &vs).collect();
        for [x, y] in pairs(&xs, &ys) {
            let values: Vec<f64> = directions
                .iter()
                .map(|&[u, v]| {
                    let ray = TwoPlane { x, y, u, v };
                    let light = self.radiance(plane, &ray, turn);
                    volume * w.value(&ray) * plane.factor(&ray) * light
                })
                .collect();
            for k in 0..grid.azimuths {
                let (sin, cos) = grid.azimuth(k).sin_cos();
                // A slice along one azimuth depends only on one component of the position and on
                // one component of the angle.
                let place = x * cos + y * sin;
                for (n, nu) in grid.nu.values().into_iter().enumerate() {
                    let terms = directions.iter().zip(&values).map(|([u, v], value)| {
                        Complex::cis(-TAU * nu * (u * cos + v * sin)) * value
                    });
                    let inner: Complex = terms.sum();
                    for m in 0..=grid.rho.half {
                        let rho = m as f64 * grid.rho.spacing;
                        slices.half[[k, m, n]] += Complex::cis(-TAU * rho * place) * inner;
                    }
                }
            }
        }
        slices
    }

    fn radiance(&self, plane: &VirtualPlane, ray: &TwoPlane, turn: f64) -> f64 {
        let [s, t] = [self.k * ray.x, self.k * ray.y];
        let normal = DVec3::new(s, t, (1.0 - s * s - t * t).sqrt());
        let ((sin, cos), (up, across)) = (
            (turn * (ray.u + plane.longitude)).sin_cos(),
            (turn * ray.v).sin_cos(),
        );
        let local = plane.frame.turned_to(plane.frame.vector_to_world(normal));
        let from = local.vector_to_world(DVec3::new(across * sin, up, across * cos));
        let along = self.scene.path.frame.vector_to_local(-from);
        // Dividing by the cosine converts the integral over the tangent plane to an integral over
        // the area of the sphere.
        self.environment.radiance(along) / normal.z
    }
}

fn midpoints(half: f64, count: usize) -> Vec<f64> {
    let at = |i: usize| half * ((2.0 * i as f64 + 1.0) / count as f64 - 1.0);
    (0..count).map(at).collect()
}

fn pairs<'a>(a: &'a [f64], b: &'a [f64]) -> impl Iterator<Item = [f64; 2]> + 'a {
    a.iter().flat_map(|a| b.iter().map(|b| [*a, *b]))
}
