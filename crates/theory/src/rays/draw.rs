//! How rays of the light are drawn: by the light, or by where they are aimed at.
//!
//! To first order a ray of the light lands where the central ray's neighbourhood maps it. So a
//! place in the window, or slopes there, tell which ray of the light to follow; where that ray
//! really lands is found by following it. The density of what is drawn is known exactly, whatever
//! the rays do. A window that is narrow beside what the first order leaves out is met by few of
//! them: rays of all four coordinates are followed back from it as they go.

use super::back::Back;
use super::emission::{Emission, point_of};
use super::{Plane, System};
use crate::geometry::{Map, Matrix};
use crate::nets::{DIMENSIONS, Density, Target};
use etendue_field::{Shape, Window};

/// What rays are drawn by. No choice is best everywhere: they are tried on the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RayStrategy {
    /// The picture of the light.
    Picture,
    /// Positions at the plane; of an area light, also points of it.
    Positions,
    /// Slopes at the plane; of an area light, also points of it.
    Slopes,
    /// Positions and slopes at the plane, of an area light.
    Plane,
}

impl RayStrategy {
    pub(super) const ALL: [Self; 4] = [Self::Positions, Self::Slopes, Self::Picture, Self::Plane];
}

/// Draws rays (x, y, u, v) of the light.
#[derive(Clone, Debug)]
pub(super) struct Draw {
    emission: Emission,
    by: By,
}

#[derive(Clone, Debug)]
enum By {
    Picture([Density; 2]),
    /// Two coordinates at the plane.
    Aim {
        targets: [Target; 2],
        /// Where rays of the central point land: those coordinates of the central ray.
        center: [f64; 2],
        /// How they change with the light's position, and with its other two coordinates.
        position: Matrix<2>,
        inverse: Matrix<2>,
        determinant: f64,
    },
    /// All four, as rays go.
    Back {
        window: Box<[Density; 4]>,
        back: Back,
    },
    /// All four, to first order.
    Map {
        targets: Box<[Target; 4]>,
        map: Map<4>,
        determinant: f64,
    },
}

impl Draw {
    /// `center` is where the central ray lands and `jacobian` how that changes with the ray; `None`
    /// where they do not tell rays apart. Without a plane all rays land as they tell.
    pub(super) fn new(
        (system, plane): (&System, Option<&Plane>),
        window: &Window,
        (center, jacobian): &([f64; 4], Matrix<4>),
        strategy: RayStrategy,
    ) -> Option<Self> {
        let emission = system.emission();
        let profiles = [window.x, window.y, window.u, window.v];
        let aim = |row: usize| {
            let block = |columns: [usize; 2]| -> Matrix<2> {
                crate::geometry::from_fn(|i, j| jacobian[row + i][columns[j]])
            };
            let aimed = Map::linear(block(emission.inner));
            if !tells_apart(&aimed) {
                return None;
            }
            Some(By::Aim {
                targets: [0, 1].map(|i| Target::new(&profiles[row + i])),
                center: [center[row], center[row + 1]],
                position: block([0, 1]),
                inverse: aimed.inverse()?.matrix,
                determinant: aimed.det().abs(),
            })
        };
        let by = match strategy {
            RayStrategy::Picture => By::Picture(system.picture_densities()?),
            RayStrategy::Positions => aim(0)?,
            RayStrategy::Slopes => aim(2)?,
            RayStrategy::Plane => {
                emission.shape?;
                if let Some(plane) = plane {
                    let back = Back::new(system, plane);
                    let window = Box::new(profiles.map(|profile| Density::of(&profile)));
                    let by = By::Back { window, back };
                    return Some(Self { emission, by });
                }
                let rays = Map {
                    matrix: *jacobian,
                    offset: *center,
                };
                if !tells_apart(&rays) {
                    return None;
                }
                By::Map {
                    targets: Box::new(profiles.map(|profile| Target::new(&profile))),
                    map: rays.inverse()?,
                    determinant: rays.det().abs(),
                }
            }
        };
        Some(Self { emission, by })
    }

    /// A ray and its density in the emission's coordinates; `None` for one that the light does not
    /// emit.
    pub(super) fn draw(&self, at: &[f64; DIMENSIONS]) -> Option<([f64; 4], f64)> {
        let [a, b, c, d, ..] = *at;
        let Emission { inner, shape, .. } = &self.emission;
        let placed = |outer: [f64; 2], coordinates: [f64; 2]| {
            let mut ray = [outer[0], outer[1], 0.0, 0.0];
            ray[inner[0]] = coordinates[0];
            ray[inner[1]] = coordinates[1];
            ray
        };
        match &self.by {
            By::Picture([first, second]) => {
                let [s, t] = [first.quantile(a), second.quantile(b)];
                Some((placed([0.0; 2], [s, t]), first.value(s) * second.value(t)))
            }
            By::Aim {
                targets: [first, second],
                center,
                position,
                inverse,
                determinant,
            } => {
                let (outer, of_light) = match shape {
                    Some(shape) => (point_of(shape, [c, d]), 1.0 / shape.area()),
                    None => ([0.0; 2], 1.0),
                };
                let [s, t] = [first.quantile(a), second.quantile(b)];
                let from = crate::geometry::times(position, &outer);
                let left = [s - center[0] - from[0], t - center[1] - from[1]];
                let ray = placed(outer, crate::geometry::times(inverse, &left));
                let density = first.value(s) * second.value(t) * determinant * of_light;
                Some((ray, density))
            }
            By::Back { window, back } => {
                let drawn: [[f64; 2]; 4] = std::array::from_fn(|i| window[i].draw(at[i]));
                let (ray, spread) = back.ray(drawn.map(|[z, _]| z))?;
                let density: f64 = drawn.iter().map(|[_, density]| density).product();
                self.emits(&ray).then_some((ray, density * spread))
            }
            By::Map {
                targets,
                map,
                determinant,
            } => {
                let shares = [a, b, c, d];
                let z: [f64; 4] = std::array::from_fn(|i| targets[i].quantile(shares[i]));
                let ray = map.apply(z);
                let density: f64 = (0..4).map(|i| targets[i].value(z[i])).product();
                self.emits(&ray).then_some((ray, density * determinant))
            }
        }
    }

    /// Whether a ray begins in the light.
    fn emits(&self, [x, y, ..]: &[f64; 4]) -> bool {
        let shape = self.emission.shape.as_ref();
        shape.is_some_and(|shape: &Shape| shape.contains(*x, *y))
    }
}

/// Whether a map takes no direction of rays nearly to nothing, as it does at a focus.
fn tells_apart<const N: usize>(map: &Map<N>) -> bool {
    let size = |row: &[f64; N]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
    let most: f64 = map.matrix.iter().map(size).product();
    map.det().abs() > 1e-8 * most
}
