//! Slices of scattered light, over scrambled nets of rays.

use super::draw::{Lights, Rays, Strategy};
use super::exact::Leaving;
use super::incoming::Part;
use super::linear::Linear;
use super::parameter::Parameter;
use super::{Chain, System};
use crate::geometry::Matrix;
use crate::mask::Masks;
use crate::nets::{self, Budget, DIMENSIONS, Integrand, Moved, Node};
use crate::rays::Plane;
use etendue_field::{
    Complex, EnvironmentMap, Light, Projection, ProjectionGrid, SliceGrid, Slices, TwoPlane, Window,
};
use glam::DVec3;

/// A prediction of a scattered light field.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The slices of the windowed spectrum: the mean of the replicates.
    pub slices: Slices,
    /// Independent predictions, none of which is biased.
    pub replicates: Vec<Slices>,
    /// ‖error‖/‖F‖: the standard error of the mean of the replicates. Infinite if no light arrives.
    pub error: f64,
    /// Rays that were summed.
    pub nodes: f64,
    strategy: Strategy,
    /// Second central moments of the windowed light field, in the plane's coordinates; `None` if no
    /// light arrives.
    pub covariance: Option<Matrix<4>>,
    /// The windowed light field integrated over y and v, as means over cells of (x, u).
    pub projection: Projection,
}

/// The windowed spectrum of what a surface scatters.
///
/// Rays are drawn at the plane, and for each four parts of the light that shines on the point it
/// leaves (docs/theory.md, Eq. 40). `chain` is that of [`chain`](super::chain()); it tells where
/// rays are worth drawing. Unit: W m⁻² sr⁻¹ · m², on a surface W m⁻² sr⁻¹ · m² rad². The same bytes
/// on any number of threads.
#[must_use]
pub fn predict(
    system: &System,
    plane: &Plane,
    chain: Option<&Chain>,
    (window, grid, picture): (&Window, &SliceGrid, &ProjectionGrid),
    budget: Budget,
) -> Prediction {
    let field = |strategy| Field::new(system, plane, window, chain, strategy);
    let strategy = best(system, |strategy| {
        nets::trial(&field(strategy), (window, grid)).powi(2) * strategy.time()
    });
    let field = field(strategy);
    let budget = Budget {
        nodes: budget.nodes / cost(system),
        ..budget
    };
    let mut sums = nets::sums(&field, (window, grid), picture.bins, budget);
    let replicates = sums.slices.swap_remove(0);
    Prediction {
        slices: nets::mean(replicates.iter()),
        replicates,
        error: sums.error,
        nodes: sums.nodes,
        strategy,
        covariance: sums.covariance,
        projection: sums.projection,
    }
}

/// How many times as long a ray takes as one of few lobes of light.
fn cost(system: &System) -> f64 {
    const FEW: f64 = 16.0;
    match &system.light {
        Light::Environment { environment } => match &environment.map {
            EnvironmentMap::Lobes(lobes) => 1.0 + lobes.len() as f64 / FEW,
            EnvironmentMap::LatLong(_) => 1.0,
        },
        _ => 1.0,
    }
}

/// The strategy that costs least, each choice being tried once.
fn best(system: &System, cost: impl Fn(Strategy) -> f64) -> Strategy {
    let mut best = Strategy::default();
    let mut least = cost(best);
    for choice in 0..best.neighbours().len() {
        let next = best.neighbours()[choice].in_effect(system);
        if next == best {
            continue;
        }
        let tried = cost(next);
        if tried < least {
            (best, least) = (next, tried);
        }
    }
    best
}

/// What differs a little from a prediction, over the same rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Differences {
    /// The slices that the first-order chain predicts less those of the prediction; `None` where
    /// the central ray does not arrive.
    pub linear: Option<Slices>,
    /// The derivatives of the slices, per unit of each parameter.
    pub derivatives: Vec<Slices>,
}

/// The first-order chain's slices and the derivatives by some parameters, all as differences of the
/// radiance of the same rays: good to about a per cent of what they are.
///
/// Parts of the light move with the light, so that its edges are no edges of a difference. Shadows
/// do not move with masks: what is lit on one side alone adds noise, the less the farther the sides
/// are apart.
#[must_use]
pub fn differences(
    system: &System,
    plane: &Plane,
    chain: Option<&Chain>,
    moved: &[Moved<(System, Plane)>],
    (window, grid): (&Window, &SliceGrid),
    prediction: &Prediction,
) -> Differences {
    let strategy = prediction.strategy;
    let (albedo, moved): (Vec<_>, Vec<_>) =
        (moved.iter().enumerate()).partition(|(_, moved)| system.is_brightened(&moved.sides[0].0));
    let field = Field::new(system, plane, window, chain, strategy);
    let around = Around {
        linear: chain.and_then(|chain| Linear::new(system, chain)),
        moved: moved
            .iter()
            .map(|(_, moved)| {
                (
                    moved.apart,
                    moved
                        .sides
                        .each_ref()
                        .map(|side| Side::new(side, &field, strategy)),
                )
            })
            .collect(),
        field: &field,
    };
    let mut means = nets::means(&around, window, grid).into_iter();
    let linear = around.linear.as_ref().and_then(|_| means.next());
    let mut derivatives: Vec<Slices> = means.collect();
    for (i, _) in albedo {
        let mut slices = prediction.slices.clone();
        slices.half /= Complex::from(system.reflectance.brdf.albedo);
        derivatives.insert(i, slices);
    }
    Differences {
        linear,
        derivatives,
    }
}

impl System {
    /// Whether another system differs in an albedo alone that all of the light is proportional to.
    fn is_brightened(&self, other: &Self) -> bool {
        let albedo = self.reflectance.brdf.albedo;
        let mut same = other.clone();
        same.reflectance.brdf.albedo = albedo;
        albedo > 0.0 && self.reflectance.blend.is_none() && same == *self && other != self
    }

    /// It with a little more and a little less of a parameter; `None` if it does not have that.
    #[must_use]
    pub fn moved(&self, plane: &Plane, parameter: Parameter) -> Option<Moved<(Self, Plane)>> {
        const STEP: f64 = 1e-3;
        let value = self.value(parameter)?;
        let step = STEP * value.abs().max(0.1);
        let at = |value| Some((self.with(parameter, value)?, *plane));
        Some(Moved {
            apart: 2.0 * step,
            sides: [at(value + step)?, at(value - step)?],
        })
    }
}

/// A light field as it is.
struct Field<'a> {
    system: &'a System,
    plane: &'a Plane,
    window: &'a Window,
    masks: Masks<'a>,
    rays: Rays,
    lights: Lights<'a>,
}

impl<'a> Field<'a> {
    fn new(
        system: &'a System,
        plane: &'a Plane,
        window: &'a Window,
        chain: Option<&Chain>,
        strategy: Strategy,
    ) -> Self {
        let normal = chain.map_or(DVec3::NEG_Z, |chain| chain.frame.d);
        Self {
            system,
            plane,
            window,
            masks: Masks::new(&system.layers),
            rays: Rays::new(system, window, chain, strategy),
            lights: Lights::new(system, normal, strategy),
        }
    }

    /// A ray, what its radiance is multiplied by, and where it leaves the surface.
    fn draw(&self, [a, b, c, d, ..]: &[f64; DIMENSIONS]) -> Option<([f64; 4], f64, Leaving)> {
        let (z, density) = self.rays.draw([*a, *b, *c, *d]);
        let [x, y, u, v] = z;
        let seen = self.window.value(&TwoPlane { x, y, u, v }) * self.plane.factor(z);
        let factor = seen / density;
        if seen <= 0.0 || !factor.is_finite() {
            return None;
        }
        Some((z, factor, self.system.leaving(self.plane, z)?))
    }

    /// The radiance of a ray, of what a part of the light shines.
    fn radiance(&self, leaving: &Leaving, part: Part) -> f64 {
        radiance(self.system, self.plane, &self.masks, leaving, part)
    }
}

/// What a ray adds over the density with which it was drawn; nothing is nothing over any density.
fn over(radiance: f64, density: f64) -> f64 {
    if radiance == 0.0 {
        0.0
    } else {
        radiance / density
    }
}

/// The radiance of a ray at a plane, of what a part of the light shines, per unit of its measure.
fn radiance(
    system: &System,
    plane: &Plane,
    masks: &Masks<'_>,
    leaving: &Leaving,
    part: Part,
) -> f64 {
    let radiance = system.radiance(masks, leaving, part);
    if plane.orientation.is_local() {
        // On the surface itself the integral is over its area, larger than the tangent plane's.
        radiance / leaving.normal.dot(plane.frame.d).abs()
    } else {
        radiance
    }
}

impl Integrand for Field<'_> {
    fn fields(&self) -> usize {
        1
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], nodes: &mut [Node]) {
        let Some((z, factor, leaving)) = self.draw(at) else {
            return;
        };
        let parts = self.lights.each(&leaving, [at[4], at[5]]);
        let radiance = parts.map(|(part, density)| over(self.radiance(&leaving, part), density));
        nodes[0] = Node {
            z,
            weight: factor * radiance.sum::<f64>(),
        };
    }
}

/// A part of the light, if there is one, and the density with which it was drawn.
type Drawn = Option<(Part, f64)>;

/// A light field with a parameter changed.
///
/// Where it leaves a ray or the light as they are, it takes them from the light field itself.
struct Side<'a> {
    moves_surface: bool,
    moves_light: bool,
    system: &'a System,
    plane: &'a Plane,
    masks: Masks<'a>,
    lights: Lights<'a>,
}

impl<'a> Side<'a> {
    fn new((system, plane): &'a (System, Plane), field: &'a Field<'a>, strategy: Strategy) -> Self {
        let moves_surface = system.patch != field.system.patch || plane != field.plane;
        Self {
            moves_surface,
            moves_light: system.light != field.system.light
                || moves_surface && field.lights.is_by_lobe(),
            system,
            plane,
            masks: Masks::new(&system.layers),
            lights: field.lights.of(system, strategy),
        }
    }

    /// The radiance of a ray, over the density with which a part of the light was drawn. Beside it
    /// is what the light field itself has.
    fn radiance(&self, z: [f64; 4], at: [f64; 2], own: &(Leaving, Drawn)) -> Option<f64> {
        let (mut leaving, mut drawn) = *own;
        if self.moves_surface {
            leaving = self.system.leaving(self.plane, z)?;
        }
        if self.moves_light {
            drawn = self.lights.draw(&leaving, at);
        }
        let (part, density) = drawn?;
        let radiance = radiance(self.system, self.plane, &self.masks, &leaving, part);
        Some(over(radiance, density))
    }
}

/// What is around a light field: it to first order, and with parameters changed.
struct Around<'a> {
    field: &'a Field<'a>,
    linear: Option<Linear<'a>>,
    moved: Vec<(f64, [Side<'a>; 2])>,
}

impl Integrand for Around<'_> {
    fn fields(&self) -> usize {
        usize::from(self.linear.is_some()) + self.moved.len()
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], nodes: &mut [Node]) {
        let Self {
            field,
            linear,
            moved,
        } = self;
        let Some((z, factor, leaving)) = field.draw(at) else {
            return;
        };
        let at = [at[4], at[5]];
        let own = (leaving, field.lights.draw(&leaving, at));
        let mut nodes = nodes.iter_mut();
        let mut put = |difference: f64| {
            if let Some(node) = nodes.next() {
                let weight = factor * difference;
                *node = Node { z, weight };
            }
        };
        if let Some(linear) = linear {
            put(own.1.map_or(0.0, |(part, density)| {
                let exact = field.radiance(&leaving, part);
                over(linear.radiance(&field.masks, z, part) - exact, density)
            }));
        }
        for (apart, sides) in moved {
            let [above, below] = sides
                .each_ref()
                .map(|side| side.radiance(z, at, &own).unwrap_or(0.0));
            put((above - below) / apart);
        }
    }
}
