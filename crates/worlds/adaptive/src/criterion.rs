//! Computes the bandwidth of light across the picture by the criteria of Durand et al. 2005, Eqs.
//! 20 and 21, with corrections.
//!
//! A lobe reflects light from directions around the axis of the lobe, and keeps frequencies up to
//! its cutoff Ω_ρ. From one pixel to the next, the axis r turns by ∂r and the point on the surface
//! moves by ∂p. An object at a distance d' then moves relative to the axis by the component of ∂p
//! across r, divided by d'. Hence the bandwidth along a direction of the picture is Ω_ρ |∂r +
//! ∂p/d'| cycles per pixel. In the plane of incidence of a sphere, the bandwidth is Ω_ρ |1 + d (cos
//! θ₀/d' + 2k)/cos θ₁| times the angle of a pixel. This formula is Eq. 21 together with the factors
//! that are missing in the paper. Without the term that contains d', it is Eq. 20. Finite
//! differences on the screen include the angle of view, the distance and both curvatures, as the
//! paper states. The printed equations use only the larger curvature, and are isotropic.

use crate::metric::Metric;
use crate::visible::{OFFSETS, SeenPlace, SeenSurface, Visible, at};
use etendue_paths::Nearness;
use etendue_world::Camera;
use glam::DVec3;

/// The formula for the bandwidth of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BandwidthCriterion {
    /// Eqs. 20 and 21 with corrections and half-shadows, along each direction.
    Corrected,
    /// Eqs. 20 and 21 as printed, isotropic.
    Printed,
}

impl BandwidthCriterion {
    /// The squared bandwidth of a pixel, (cycles per pixel)², or `None` if nothing is to be
    /// shaded.
    pub(crate) fn squared(
        self,
        visible: &Visible,
        camera: &Camera,
        pixel: [usize; 2],
        nearness: Nearness,
    ) -> Option<Metric> {
        match self {
            Self::Corrected => corrected(visible, pixel, nearness),
            Self::Printed => {
                let bandwidth = printed(visible, camera, pixel, nearness)?;
                Some(Metric::even(bandwidth * bandwidth))
            }
        }
    }
}

fn corrected(visible: &Visible, pixel: [usize; 2], nearness: Nearness) -> Option<Metric> {
    let places = visible.of_pixel(pixel);
    let first = places.iter().find_map(shaded)?;
    let [right, down] = steps(places, first.shape);
    let across = |step: &PixelStep| step.position.reject_from_normalized(first.axis);
    let turned = |step: &PixelStep| step.axis + nearness.reflected * across(step);
    let lobe = of_columns(turned(&right), turned(&down)).times(first.cutoff * first.cutoff);
    let shadow = of_columns(right.position, down.position).times(nearness.shadow * nearness.shadow);
    Some(lobe.plus(shadow))
}

/// The bandwidth of a pixel, in cycles per pixel, by Eq. 21 of Durand et al. 2005 as
/// printed, B' = d/(n·v) (1/d' + 2k) Ω_ρ. Without blockers, 1/d' = 0, this is Eq. 20. As the paper
/// does, it computes 2kd/(n·v) by finite differences on the screen: twice the turn of the normal
/// from pixel to pixel, in the direction where it is largest. A surface without a lobe has the
/// cutoff of its cosine as Ω_ρ.
fn printed(
    visible: &Visible,
    camera: &Camera,
    pixel: [usize; 2],
    Nearness { reflected, .. }: Nearness,
) -> Option<f64> {
    let places = visible.of_pixel(pixel);
    let (i, first) = (0..)
        .zip(places)
        .find_map(|(i, place)| Some((i, shaded(place)?)))?;
    let [right, down] = steps(places, first.shape);
    let along = camera.look(at(pixel, i), [0.0; 2]).along;
    let largest = |right, down| of_columns(right, down).largest().max(0.0).sqrt();
    let turn = largest(right.normal, down.normal);
    // Seen from the eye, the point moves by d times the angle of a pixel.
    let across = [right, down].map(|step| step.position.reject_from_normalized(along));
    let moved = largest(across[0], across[1]);
    let cosine = (-first.normal.dot(along)).max(GRAZING);
    Some(first.cutoff * (2.0 * turn + reflected * moved / cosine))
}

/// The smallest cosine of the view in Eq. 21, which has no value at 0.
const GRAZING: f64 = 1e-3;

/// The principal curvature of larger magnitude in a pixel, per unit of length, positive if
/// convex; NaN if nothing is shaded.
pub(crate) fn curvature(visible: &Visible, pixel: [usize; 2]) -> f64 {
    let places = visible.of_pixel(pixel);
    let first = places.iter().find_map(shaded);
    first.map_or(f64::NAN, |first| bend(&steps(places, first.shape)))
}

/// Computes the principal curvature of larger magnitude from the change of normals between pixels.
fn bend(steps: &[PixelStep; 2]) -> f64 {
    let [a, b] = steps;
    let lengths = of_columns(a.position, b.position);
    let turns = Metric {
        xx: a.normal.dot(a.position),
        xy: 0.5 * (a.normal.dot(b.position) + b.normal.dot(a.position)),
        yy: b.normal.dot(b.position),
    };
    let determinant = lengths.determinant();
    if determinant <= 0.0 {
        return 0.0;
    }
    // `both` is the trace of the shape operator, and `product` is its determinant.
    let both =
        (lengths.yy * turns.xx - 2.0 * lengths.xy * turns.xy + lengths.xx * turns.yy) / determinant;
    let product = turns.determinant() / determinant;
    let root = (0.25 * both * both - product).max(0.0).sqrt();
    0.5 * both + root.copysign(both)
}

/// The surface at a point if the surface scatters light.
pub(crate) fn shaded(place: &SeenPlace) -> Option<&SeenSurface> {
    place
        .surface
        .as_ref()
        .filter(|surface| surface.cutoff > 0.0 && surface.factors.iter().any(|f| *f > 0.0))
}

/// The change of axis, normal and position from one pixel to the next.
#[derive(Clone, Copy, Debug, Default)]
struct PixelStep {
    axis: DVec3,
    normal: DVec3,
    position: DVec3,
}

/// Fits a plane to the points of a pixel. Returns its slopes, which are the steps to the right and
/// down. The steps are zero unless all points are on this shape.
fn steps(places: &[SeenPlace], shape: usize) -> [PixelStep; 2] {
    let mut steps = [PixelStep::default(); 2];
    for (place, offset) in places.iter().zip(OFFSETS) {
        let Some(surface) = shaded(place).filter(|surface| surface.shape == shape) else {
            return [PixelStep::default(); 2];
        };
        for (step, at) in steps.iter_mut().zip(offset) {
            // The offsets along the two axes are orthogonal, and the sum of the squares along each
            // axis is 5/16.
            let weight = (at - 0.5) * 16.0 / 5.0;
            step.axis += weight * surface.axis;
            step.normal += weight * surface.normal;
            step.position += weight * surface.position;
        }
    }
    steps
}

/// JᵀJ for the Jacobian J with the given columns.
fn of_columns(right: DVec3, down: DVec3) -> Metric {
    Metric {
        xx: right.length_squared(),
        xy: right.dot(down),
        yy: down.length_squared(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cutoffs::Cutoffs;
    use crate::shading::Shader;
    use etendue_paths::Paths;
    use etendue_theory::shading::Criterion;
    use etendue_world::{
        Camera, Geometry, Material, MicrofacetDistribution, Roughness, Shape, Texture, World,
    };
    use glam::DAffine3;

    const RADIUS: f64 = 0.5;
    const DISTANCE: f64 = 3.0;
    const ALPHA: f64 = 0.2;

    /// A rough metal ball before a camera of narrow pixels.
    fn seen() -> (Paths, Camera) {
        let scale = DAffine3::from_scale(DVec3::splat(RADIUS));
        let world = World {
            shapes: vec![Shape::new(Geometry::Sphere, scale, 0)],
            materials: vec![Material::Conductor(etendue_world::Conductor {
                index: None,
                reflectance: Texture::Constant(1.0),
                roughness: Some(Roughness {
                    distribution: MicrofacetDistribution::Beckmann,
                    alpha: [ALPHA; 2].map(Texture::Constant),
                }),
            })],
            ..World::default()
        };
        let points = [-DISTANCE * DVec3::Z, DVec3::ZERO, DVec3::Y];
        let camera = Camera::pinhole(points, 0.2, [801; 2], [1e-3, 1e6]);
        (Paths::new(&world), camera.expect("two different points"))
    }

    /// Compares the formulas of the theory crate for Eqs. 20 and 21, in the plane of incidence,
    /// with finite differences over one pixel.
    #[test]
    #[expect(clippy::too_many_lines, reason = "a test may be a list of cases")]
    fn screen_differences_are_the_criteria() {
        let (paths, camera) = seen();
        let cutoffs = Cutoffs::default();
        let shader = Shader {
            paths: &paths,
            camera: &camera,
            cutoffs: &cutoffs,
            each: 1,
            seed: 0,
        };
        let look = |_, at| (shader.place(at), ());
        let (visible, _) = Visible::new(camera.size, look, &|_| {});
        let slope = 0.4 / 801.0;
        let mut farthest: f64 = 0.0;
        for column in [400, 500, 600, 680] {
            let surface = shaded(&visible.of_pixel([column, 400])[0])
                .copied()
                .unwrap();
            let eye = DVec3::new(0.0, 0.0, -DISTANCE);
            let view = eye - surface.position;
            let angle = (surface.normal.dot(view) / view.length()).acos();
            for nearness in [0.0, 2.0] {
                let theory = Criterion {
                    curvature: RADIUS.recip(),
                    incidence: angle,
                    outgoing: angle,
                    distance: view.length(),
                    blocker_distance: (nearness > 0.0).then_some(1.0 / nearness),
                    lobe_cutoff: surface.cutoff,
                    environment_cutoff: f64::INFINITY,
                };
                let expected = if nearness > 0.0 {
                    theory.blocker()
                } else {
                    theory.environment()
                };
                let near = Nearness {
                    reflected: nearness,
                    shadow: 0.0,
                };
                let by = |which: BandwidthCriterion| {
                    let metric = which.squared(&visible, &camera, [column, 400], near);
                    metric.unwrap().xx.sqrt()
                };
                // The angle that a pixel subtends is proportional to the squared cosine of its
                // direction.
                let off = (column as f64 - 400.0) * slope;
                let found = by(BandwidthCriterion::Corrected) / (slope / (1.0 + off * off));
                // The tolerance covers the error of finite differences over a pixel, and the
                // change of the cosine within the pixel.
                assert!(
                    (found / expected - 1.0).abs() < 0.02,
                    "{column} {nearness}: {found} {expected}"
                );
                let printed = if nearness > 0.0 {
                    theory.printed_blocker()
                } else {
                    theory.printed_environment()
                };
                farthest = farthest.max((found / printed - 1.0).abs());
                // The printed criterion equals the criterion of the theory crate, and the curvature
                // equals the curvature of the ball.
                let drawn = by(BandwidthCriterion::Printed) / (slope / (1.0 + off * off));
                assert!(
                    (drawn / printed - 1.0).abs() < 0.02,
                    "{column} {nearness}: {drawn} {printed}"
                );
                let curvature = curvature(&visible, [column, 400]) * RADIUS;
                assert!((curvature - 1.0).abs() < 0.02, "{curvature}");
            }
        }
        // The printed equations lack the term 1 and a cosine, so their values differ noticeably.
        assert!(farthest > 0.05, "{farthest}");
    }
}
