//! Predictions for lights that are finite lists of rays. The windowed spectrum of such a light is a
//! sum over the rays (docs/theory.md, section 2).
//!
//! Each ray is followed through the chain: travel changes the ray's position, masks attenuate the
//! ray, and the window multiplies its weight. The only error of the prediction is therefore the
//! error of the transform. The prediction and the tracer share neither random numbers nor code for
//! intersections.

use crate::barrier::Barrier;
use crate::model::Over;
use crate::nets::RayNets;
use crate::predicted::Predicted;
use crate::work::PredictionWork;
use crate::{Chain, Operator};
use etendue_field::{
    FluxRay, Projection, ProjectionGrid, RayLight, SliceGrid, Slices, TwoPlane, Window,
};
use etendue_transform::SliceTransform;
use ndarray::Array2;

/// A step of a chain, prepared for many rays.
enum RayStep<'a> {
    Travel(f64),
    Mask(Barrier<'a>),
    Cosine,
}

/// The slices and the picture of the rays that pass through a chain.
///
/// # Panics
/// Panics if the chain has a diffuse reflection.
pub(super) fn predicted(
    chain: &Chain,
    rays: &RayLight,
    (window, grid, picture): Over<'_>,
) -> Predicted {
    let (slices, projection) = sums(
        GivenRays::new(chain, rays, window).arriving(),
        grid,
        picture,
    );
    let open: Vec<RayStep<'_>> = chain
        .operators
        .iter()
        .filter(|operator| !matches!(operator, Operator::Visibility { .. }))
        .map(step)
        .collect();
    let unblocked = rays.rays().iter();
    let unblocked = unblocked.filter_map(|given| arrives(given, &open, window));
    Predicted {
        unblocked: unblocked.map(|(_, weight)| weight).sum(),
        ..Predicted::exact(slices, projection)
    }
}

/// The rays of a list at the end of a chain, as a single net.
pub(super) struct GivenRays<'a> {
    rays: &'a RayLight,
    steps: Vec<RayStep<'a>>,
    window: &'a Window,
}

impl<'a> GivenRays<'a> {
    pub(super) fn new(chain: &'a Chain, rays: &'a RayLight, window: &'a Window) -> Self {
        Self {
            rays,
            steps: chain.operators.iter().map(step).collect(),
            window,
        }
    }

    fn arriving(&self) -> impl Iterator<Item = (TwoPlane, f64)> {
        let rays = self.rays.rays().iter();
        rays.filter_map(|given| arrives(given, &self.steps, self.window))
    }
}

impl RayNets for GivenRays<'_> {
    fn count(&self) -> usize {
        1
    }

    fn emit(&self, _net: usize, each: &mut dyn FnMut(&TwoPlane, f64)) {
        self.arriving().for_each(|(ray, weight)| each(&ray, weight));
    }
}

/// Estimates the work of [`predicted`], which is to spread each ray over 8 × 8 cells of each
/// azimuth and to transform the grids.
pub(super) fn work(rays: &RayLight, grid: &SliceGrid) -> PredictionWork {
    let [azimuths, rows, columns] = grid.half_shape().map(|n| n as f64);
    let spread = 100.0 * azimuths * rays.rays().len() as f64;
    PredictionWork {
        steps: spread + 1e3 * azimuths * rows * columns,
        bytes: SliceTransform::new(grid).bytes(),
        bytes_each: 0.0,
        drivers: format!("{} rays of a file", rays.rays().len()),
    }
}

fn step(operator: &Operator) -> RayStep<'_> {
    match operator {
        Operator::Travel { distance, .. } => RayStep::Travel(*distance),
        Operator::Visibility { mask, .. } => RayStep::Mask(Barrier::new(0.0, mask)),
        Operator::Cosine { .. } => RayStep::Cosine,
        Operator::Diffuse { name, .. } => panic!("rays of a file cannot pass the diffuse {name}"),
    }
}

/// A ray at the end of a chain and the ray's contribution to the windowed light field, or
/// `None` if this contribution is zero.
fn arrives(
    FluxRay { ray, flux }: &FluxRay,
    steps: &[RayStep<'_>],
    window: &Window,
) -> Option<(TwoPlane, f64)> {
    // Radiance is flux divided by dx dy cos θ dω, and cos θ dω = du dv / (1 + u² + v²)²
    // (docs/conventions.md).
    let secant_squared = 1.0 + ray.u * ray.u + ray.v * ray.v;
    let measure = secant_squared * secant_squared;
    let (mut ray, mut weight) = (*ray, flux * measure);
    for step in steps {
        match step {
            RayStep::Travel(distance) => {
                ray.x += distance * ray.u;
                ray.y += distance * ray.v;
            }
            RayStep::Mask(barrier) => weight *= barrier.transmittance(ray.x, ray.y),
            RayStep::Cosine => weight /= measure,
        }
        if weight == 0.0 {
            return None;
        }
    }
    let weight = weight * window.value(&ray);
    (weight != 0.0).then_some((ray, weight))
}

fn sums(
    all: impl Iterator<Item = (TwoPlane, f64)>,
    grid: &SliceGrid,
    picture: &ProjectionGrid,
) -> (Slices, Projection) {
    let transform = SliceTransform::new(grid);
    let mut sum = transform.accumulator();
    let mut values = Array2::zeros((picture.bins, picture.bins));
    for (ray, weight) in all {
        sum.deposit(&ray, weight);
        if let Some(cell) = picture.cell(ray.x, ray.u) {
            values[cell] += weight / picture.cell_area();
        }
    }
    let grid = *picture;
    (sum.finish(1.0), Projection { grid, values })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::*;
    use etendue_field::Light;
    use etendue_field::{Complex, FrequencyAxis, Profile, cis};
    use std::f64::consts::TAU;
    use std::sync::Arc;

    /// Tests that the sum over rays on a regular grid of positions and slopes of a square
    /// Lambertian light converges to the light's closed form.
    #[test]
    fn many_rays_of_a_square_light_are_its_closed_form() {
        let n = 24;
        let (half, slope) = (0.1, 0.5);
        let at = |i: i32| (2.0 * f64::from(i) + 1.0) / f64::from(n) - 1.0;
        let mut rays = Vec::new();
        let cell = (2.0 * half / f64::from(n)).powi(2) * (2.0 * slope / f64::from(n)).powi(2);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            for (k, l) in (0..n).flat_map(|k| (0..n).map(move |l| (k, l))) {
                let ray = TwoPlane {
                    x: half * at(i),
                    y: half * at(j),
                    u: slope * at(k),
                    v: slope * at(l),
                };
                let flux = cell / (ray.secant_squared() * ray.secant_squared());
                rays.push(FluxRay { ray, flux });
            }
        }
        let rays = Arc::new(RayLight::new(rays, 0.0).unwrap());
        let steps = [(0.5, None), (0.3, Some(grating(0, 2.0, 0.3))), (0.2, None)];
        let closed = chain_of(lambertian(square([0.0; 2], 2.0 * half)), steps.clone());
        let given = chain_of(Light::Rays { rays: rays.clone() }, steps);
        let window = window(Profile::Hann(0.4), Profile::Hann(0.5));
        let axis = |spacing| FrequencyAxis { half: 2, spacing };
        let grid = SliceGrid {
            azimuths: 2,
            rho: axis(1.5),
            nu: axis(1.0),
        };
        let picture = ProjectionGrid::new(&window, 4);
        let over = (&window, &grid, &picture);
        let expected = super::super::slices(&closed, &window, &grid);
        let found = predicted(&given, &rays, over);
        let off = |slices: &Slices| {
            let pairs = slices.half.iter().zip(&expected.half);
            let worst = pairs.map(|(a, b)| (a - b).norm_sqr().sqrt());
            worst.fold(0.0, f64::max) / expected.at_zero()
        };
        // A midpoint rule of 24 cells that ends at the edge of the light has an error of order
        // 1/24², the square of the cell size.
        assert!(off(&found.slices) < 4e-3, "{}", off(&found.slices));
        // A deliberately wrong prediction without travel fails the comparison.
        let mut wrong = given;
        wrong.operators.remove(0);
        assert!(off(&predicted(&wrong, &rays, over).slices) > 0.1);
        // The slices are compared with the plain sum over rays at one frequency.
        let (rho, nu) = (1.5, -1.0);
        let mut plain = Complex::ZERO;
        for FluxRay { ray, flux } in rays.rays() {
            let [x, y] = [ray.x + ray.u, ray.y + ray.v];
            let masked = 0.5 * (1.0 + 0.9 * libm::cos(TAU * 2.0 * (ray.x + 0.8 * ray.u) + 0.3));
            let seen = TwoPlane { x, y, ..*ray };
            let weight = flux * ray.secant_squared().powi(2) * masked * window.value(&seen);
            plain += weight * cis(-TAU * (rho * x + nu * ray.u));
        }
        let fast = found.slices.half[[0, 1, 1]];
        assert!((fast - plain).norm_sqr().sqrt() < 1e-6 * expected.at_zero()); // the bound of the transform is 2e-7 of the weights
    }
}
