//! What a prediction of scattered light takes, counted from its first rule.

use super::System;
use super::incoming::Rule as LightRule;
use super::predict::{MOST, Search};
use super::rule::Rule;
use crate::rays::Plane;
use crate::shadow::is_rectangular;
use crate::work::{MOST_PARTS, Work};
use etendue_field::{Fresnel, Light, Lobe, Mask, ProjectionGrid, Shape, SliceGrid, Window};

/// Steps beyond which no rule is refined.
const MOST_STEPS: f64 = 3e10;
/// Steps at a place, and for a shape that may be in the way.
const PLACE: f64 = 200.0;
const SHAPE: f64 = 3.0;
/// Steps to find what shines from a direction.
const SHINING: f64 = 40.0;
/// How many times as many nodes a rule has that is refined as often as most are.
const REFINED: f64 = 4.0;
/// Nodes across a picture.
const ACROSS: f64 = 6.0;

/// What a rule takes.
pub(super) struct Cost {
    /// Steps for each node of the light, those for shapes that are asked of each included.
    each: f64,
    /// Steps for a place.
    fixed: f64,
}

impl Cost {
    pub(super) fn new(system: &System, plane: &Plane) -> Self {
        let is_plain = |lobe, fresnel| (lobe, fresnel) == (Lobe::Lambertian, Fresnel::White);
        let reflectance = &system.reflectance;
        let brdf = &reflectance.brdf;
        let blends = reflectance.blend.is_some();
        let brdf = if is_plain(brdf.lobe, brdf.fresnel) && !blends {
            10.0
        } else {
            60.0
        };
        let is_parted = matches!(
            system.light,
            Light::Area {
                shape: Shape::Rectangle(_),
                ..
            }
        );
        // On the surface what shines on a place is found once for all directions in which it is seen.
        let shining = if plane.orientation.is_local() {
            0.0
        } else {
            SHINING
        };
        let (mut each, mut fixed) = (brdf + shining, PLACE);
        for (_, mask) in &system.layers {
            let shapes = match mask {
                Mask::Opaque {
                    shapes,
                    half_planes,
                } => shapes.len() + half_planes.len(),
                Mask::Grating(_) => 10,
            };
            // Rectangles are taken off a rectangular light once for each place, all else is asked of each node.
            if is_parted && is_rectangular(mask) {
                fixed += 8.0 * SHAPE * shapes as f64;
            } else {
                each += SHAPE * shapes as f64;
            }
        }
        Self { each, fixed }
    }

    /// Steps over all places of a rule, each of which sees so many nodes of the light.
    pub(super) fn of(&self, rule: Rule, seen: f64) -> f64 {
        rule.places() * (self.fixed + self.each * seen)
    }

    pub(super) fn is_beyond(&self, rule: Rule, seen: f64) -> bool {
        self.of(rule, seen) > MOST_STEPS
    }
}

/// Nodes of the light that the middle of the surface sees; `None` if what is in the way leaves too many parts of it.
fn seen(system: &System, plane: &Plane, rule: Rule) -> Option<f64> {
    let side = rule.light as f64;
    Some(match &system.light {
        Light::Area { shape, .. } => match (shape, system.leaving(plane, [0.0; 4])) {
            (Shape::Rectangle(rectangle), Some(leaving)) => {
                let parts = system.parts(leaving.point, rectangle, MOST_PARTS)?;
                parts.len() as f64 * side * side
            }
            _ => 2.0 * side * side,
        },
        Light::Environment { .. } => LightRule::new(rule.light, &system.light).directions() as f64,
        Light::Point { .. } | Light::Projector { .. } | Light::Beam { .. } => 1.0,
    })
}

/// What the slices, the first-order slices, all derivatives and the projection take.
#[must_use]
pub fn work(
    system: &System,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
    picture: &ProjectionGrid,
) -> Work {
    let search = Search::new(system, plane, window, grid);
    let (rule, cost) = (search.first(), Cost::new(system, plane));
    let Some(seen) = seen(system, plane, rule) else {
        return Work::endless(format!(
            "more than {MOST_PARTS} parts that shapes in different planes leave of the light"
        ));
    };
    let derivatives = system.parameters().len() as f64;
    // Trials along each axis with fewer nodes along the others, the rule itself for the exact slices and the chain's,
    // and two coarser ones for each derivative.
    let refined = (MOST / (rule.places() * seen)).clamp(1.0, REFINED);
    let tables = refined * (4.0 + 0.3 * derivatives);
    let places = rule.places();
    let [nx, ny, nu, nv] = rule.plane.map(|n| n as f64);
    let (across, slopes) = (nx * ny, nu * nv);
    let [azimuths, rows, columns] = grid.half_shape().map(|n| n as f64);
    let waves = rows * across + columns * slopes;
    let sums = azimuths * (40.0 * waves + 0.6 * rows * places + 1.2 * rows * slopes * columns);
    let light = 20_736.0 * (cost.fixed + 3.0 * cost.each * seen);
    let pixels = (picture.bins * picture.bins) as f64 * ACROSS * ACROSS;
    Work {
        steps: tables * (cost.of(rule, seen) + sums)
            + light
            + pixels * (cost.fixed + cost.each * seen),
        // Values by rows, then in one table, and of a trial beside.
        bytes: 24.0 * places,
        bytes_each: 16.0 * waves + 32.0 * rows * (slopes + columns) + 64.0 * seen,
        drivers: format!(
            "{tables} tables of {nx} x {ny} x {nu} x {nv} places x {seen} nodes of the light, {:.0} steps each and {:.0} for shapes, and {azimuths} x {rows} x {columns} frequencies",
            cost.each, cost.fixed
        ),
    }
}
