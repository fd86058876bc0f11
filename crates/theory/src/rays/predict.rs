//! Slices behind specular surfaces.

use super::draw::{Draw, Strategy};
use super::parameter::Parameter;
use super::region::{Field, Finder, Neighbourhood, neighbourhood};
use super::{Plane, System};
use crate::geometry::{Map, Matrix, SpectrumMap};
use crate::mask::Masks;
use crate::nets::{self, Budget, DIMENSIONS, Integrand, Moved, Node};
use etendue_field::{
    Complex, Mask, Projection, ProjectionGrid, SliceGrid, Slices, TwoPlane, Window,
};
use glam::DVec3;

/// A prediction by rays.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySlices {
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// Independent predictions of which they are the mean, none of them biased; empty where a rule
    /// converges.
    pub replicates: Vec<Slices>,
    /// ‖error‖/‖F‖: the standard error of the mean of the replicates, or twice what finer rules
    /// change. Infinite if no ray arrives beside the central one.
    pub error: f64,
    /// Second central moments of the windowed light field, in the plane's coordinates; `None` if no
    /// light arrives.
    pub covariance: Option<Matrix<4>>,
    /// The windowed light field integrated over y and v, as means over cells of (x, u).
    pub projection: Projection,
    /// `None` if no ray arrives beside the central one.
    strategy: Option<Strategy>,
}

/// What a prediction is over: a window, frequencies and the cells of a picture.
pub type Over<'a> = (&'a Window, &'a SliceGrid, &'a ProjectionGrid);

/// Where neither is asked for.
const NO_PICTURES: Budget = Budget {
    nodes: 0.0,
    error: f64::INFINITY,
};
/// Rays of a picture and of moments, where slices are by a rule.
const FOR_PICTURES: Budget = Budget {
    nodes: 1e6,
    error: 0.0,
};

/// The slices of the windowed spectrum, rays followed through the geometry as it is.
///
/// Of a projector, point or beam without opaque masks by a midpoint rule, where that converges;
/// else over nets of rays. Unit: W m⁻² sr⁻¹ · m², on a surface W m⁻² sr⁻¹ · m² rad². The same bytes
/// on any number of threads.
#[must_use]
pub fn exact(system: &System, plane: &Plane, over: Over<'_>, budget: Budget) -> RaySlices {
    let masks = Masks::new(&system.layers);
    let field = exact_field(system, plane, &masks);
    let lands = neighbourhood(system, plane);
    let strategy = lands.and_then(|lands| best(&field, system, &lands, over));
    predict(
        &field,
        system,
        lands.zip(strategy),
        over,
        [budget, FOR_PICTURES],
    )
}

/// The slices that a first-order chain predicts, such as that of [`chain`](super::chain()), over
/// the same rays.
///
/// The radiance of ray z at the light goes to A z + t, A being the transpose of the map's matrix
/// and t its phase, and its spectrum is multiplied by the map's factor: F = factor · ∫ ℓ(z) W(A z +
/// t) e^(−2πi Ω·(A z + t)) dz. Masks of the first leg are exact.
#[must_use]
pub fn linear(
    system: &System,
    plane: &Plane,
    over: Over<'_>,
    map: &SpectrumMap<4>,
    budget: Budget,
) -> RaySlices {
    let masks = Masks::new(&system.layers);
    let rays = rays(map);
    let lands = (rays.offset, rays.matrix);
    let field = linear_field(system, plane, &masks, map);
    let strategy = best(&field, system, &lands, over);
    let way = strategy.map(|strategy| (lands, strategy));
    predict(&field, system, way, over, [budget, NO_PICTURES])
}

/// The derivatives of the exact slices by some parameters, per unit of each.
///
/// Central differences, the rays of both sides drawn alike: good to about a per cent.
#[must_use]
pub fn derivatives(
    moved: &[Moved<(System, Plane)>],
    over: Over<'_>,
    prediction: &RaySlices,
) -> Vec<Slices> {
    let zeros = || vec![Slices::zeros(*over.1); moved.len()];
    let Some(strategy) = prediction.strategy else {
        return zeros();
    };
    let sides = || moved.iter().flat_map(|moved| &moved.sides);
    let masks: Vec<_> = sides()
        .map(|(system, _)| Masks::new(&system.layers))
        .collect();
    let draws: Option<Vec<Draw>> = sides()
        .map(|(system, plane)| {
            let lands = neighbourhood(system, plane)?;
            Draw::new(system, over.0, &lands, strategy)
        })
        .collect();
    let Some(draws) = draws else { return zeros() };
    let fields: Vec<Drawn<'_>> = sides()
        .zip(masks.iter().zip(&draws))
        .map(|((system, plane), (masks, draw))| Drawn {
            field: Box::new(exact_field(system, plane, masks)),
            draw,
            window: over.0,
        })
        .collect();
    let mut means = nets::means(&fields[..], over.0, over.1).into_iter();
    let derivative = |moved: &Moved<(System, Plane)>| {
        let (mut above, below) = (means.next()?, means.next()?);
        above.half -= &below.half;
        above.half /= Complex::from(moved.apart);
        Some(above)
    };
    moved.iter().filter_map(derivative).collect()
}

impl System {
    /// It with a little more and a little less of a parameter; `None` if it does not have that.
    #[must_use]
    pub fn moved(&self, plane: &Plane, parameter: Parameter) -> Option<Moved<(Self, Plane)>> {
        const STEP: f64 = 1e-3;
        let value = self.value(plane, parameter)?;
        let size = match parameter {
            Parameter::Incidence(_) | Parameter::Curvature(..) => value.abs().max(0.1),
            _ => value.abs(),
        };
        let step = STEP * size;
        let at = |value| self.with(plane, parameter, value);
        Some(Moved {
            apart: 2.0 * step,
            sides: [at(value + step)?, at(value - step)?],
        })
    }
}

fn exact_field<'a>(system: &'a System, plane: &'a Plane, masks: &'a Masks<'a>) -> impl Field + 'a {
    move |ray| {
        let flux = flux(system, masks, ray);
        if flux <= 0.0 {
            return None;
        }
        let (z, per_flux) = plane.coordinates(&system.follow(ray)?)?;
        Some((z, flux * per_flux))
    }
}

fn linear_field<'a>(
    system: &'a System,
    plane: &'a Plane,
    masks: &'a Masks<'a>,
    map: &'a SpectrumMap<4>,
) -> impl Field + 'a {
    let rays = rays(map);
    move |ray: [f64; 4]| {
        let [.., u, v] = ray;
        let radiance = flux(system, masks, ray) * (1.0 + u * u + v * v).powi(2);
        let z = rays.apply(ray);
        Some((z, map.factor * radiance * plane.factor(z)))
    }
}

/// What a map of spectra does to rays.
fn rays(map: &SpectrumMap<4>) -> Map<4> {
    Map {
        matrix: crate::geometry::transpose(&map.matrix),
        offset: map.phase,
    }
}

/// Flux per unit of the emission's coordinates of a ray that has passed the masks.
fn flux(system: &System, masks: &Masks<'_>, ray: [f64; 4]) -> f64 {
    let [x, y, u, v] = ray;
    system.emitted(ray) * masks.transmittance(DVec3::new(x, y, 0.0), [u, v])
}

fn predict(
    field: &impl Field,
    system: &System,
    way: Option<(Neighbourhood, Strategy)>,
    (window, grid, picture): Over<'_>,
    [of_slices, of_pictures]: [Budget; 2],
) -> RaySlices {
    let draw = way.and_then(|(lands, strategy)| Draw::new(system, window, &lands, strategy));
    let (Some((lands, strategy)), Some(draw)) = (way, draw) else {
        return RaySlices::dark(grid, picture);
    };
    let drawn = [Drawn {
        field: Box::new(field),
        draw: &draw,
        window,
    }];
    let by_rule = || {
        let opaque = |(_, mask): &(f64, Mask)| matches!(mask, Mask::Opaque { .. });
        let emission = system.emission();
        if emission.shape.is_some() || system.layers.iter().any(opaque) {
            return None;
        }
        let finder = Finder {
            field,
            window,
            emission,
            neighbourhood: lands,
        };
        finder.slices(grid)
    };
    let by_rule = by_rule();
    let budget = if by_rule.is_some() {
        of_pictures
    } else {
        of_slices
    };
    let mut sums = nets::sums(&drawn[..], (window, grid), picture.bins, budget);
    let replicates = sums.slices.swap_remove(0);
    let (slices, replicates, error) = match by_rule {
        Some((slices, error)) => (slices, Vec::new(), error),
        None => (nets::mean(replicates.iter()), replicates, sums.error),
    };
    RaySlices {
        slices,
        replicates,
        error,
        covariance: sums.covariance,
        projection: sums.projection,
        strategy: Some(strategy),
    }
}

/// What draws rays with the least error.
fn best(
    field: &impl Field,
    system: &System,
    lands: &Neighbourhood,
    (window, grid, _): Over<'_>,
) -> Option<Strategy> {
    let tried = Strategy::ALL.iter().filter_map(|&strategy| {
        let draw = Draw::new(system, window, lands, strategy)?;
        let drawn = [Drawn {
            field: Box::new(field),
            draw: &draw,
            window,
        }];
        Some((nets::trial(&drawn[..], (window, grid)), strategy))
    });
    let best = tried.min_by(|(a, _), (b, _)| a.total_cmp(b));
    best.map(|(_, strategy)| strategy)
}

/// A light field and how its rays are drawn.
struct Drawn<'a> {
    field: Box<dyn Field + 'a>,
    draw: &'a Draw,
    window: &'a Window,
}

impl Integrand for [Drawn<'_>] {
    fn fields(&self) -> usize {
        self.len()
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], nodes: &mut [Node]) {
        for (drawn, node) in self.iter().zip(nodes) {
            let arrives = drawn.draw.draw(at).and_then(|(ray, density)| {
                let (z, weight) = (drawn.field)(ray)?;
                let [x, y, u, v] = z;
                let seen = drawn.window.value(&TwoPlane { x, y, u, v });
                let weight = weight * seen / density;
                weight.is_finite().then_some(Node { z, weight })
            });
            *node = arrives.unwrap_or(Node::DARK);
        }
    }
}

impl RaySlices {
    fn dark(grid: &SliceGrid, picture: &ProjectionGrid) -> Self {
        Self {
            slices: Slices::zeros(*grid),
            replicates: Vec::new(),
            error: f64::INFINITY,
            covariance: None,
            projection: Projection {
                grid: *picture,
                values: ndarray::Array2::zeros((picture.bins, picture.bins)),
            },
            strategy: None,
        }
    }
}
